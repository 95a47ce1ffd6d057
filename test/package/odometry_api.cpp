// SPDX-License-Identifier: BSD-3-Clause
// The odometry API and all it includes must stay C++17: compiled as such, never run.
#include "rio/option_fields.hpp"
#include "rio/rio.hpp"

#if __cplusplus > 201703L
#error "this file tests C++17"
#endif

int main() {
  return rio::Odometry::create(rio::Options{}) ? 0 : 1;
}
