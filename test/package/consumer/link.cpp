// SPDX-License-Identifier: BSD-3-Clause
#include <rio/rio.hpp>

static_assert(RIO_VERSION_NUMBER >= 100, "0.1 is asked for");

int main() {
  const auto odometry = rio::Odometry::create(rio::Options{});
  return odometry && odometry->add_imu({}) == rio::Status::kOk ? 0 : 1;
}
