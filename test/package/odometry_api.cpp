// SPDX-License-Identifier: BSD-3-Clause
// The odometry API and all it includes must stay C++17: compiled as such, never run.
#include <algorithm>

#include "rio/aiding.hpp"
#include "rio/option_fields.hpp"
#include "rio/rio.hpp"

#if __cplusplus > 201703L
#error "this file tests C++17"
#endif

// its types have one layout, whatever -march and EIGEN_MAX_ALIGN_BYTES of the program
static_assert(std::max({alignof(rio::Options), alignof(rio::RadarScan), alignof(rio::ImuSample),
                        alignof(rio::NavState), alignof(rio::BodyCovariance),
                        alignof(rio::UpdateReport), alignof(rio::PointReport),
                        alignof(rio::LandmarkReport), alignof(rio::AidedState),
                        alignof(rio::AuxiliaryValues), alignof(rio::AidingMeasurement::Rows)}) ==
              alignof(double));

int main() {
  return rio::Odometry::create(rio::Options{}) ? 0 : 1;
}
