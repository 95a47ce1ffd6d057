// SPDX-License-Identifier: BSD-3-Clause
// Example 1: the whole estimator in a flight stack. Two calls a loop; the sensors here are a
// standing vehicle made up on the spot. The part between the markers is the README's.
#include <cstdio>

#include "rio/rio.hpp"

namespace {

// 200 Hz IMU and 10 Hz radar of a vehicle at rest, three metres in front of a wall.
struct Sensors {
  int count = 0;
  rio::ImuSample imu() {
    return {std::chrono::milliseconds(5 * ++count), {0.0, 0.0, 0.0}, {0.0, 0.0, 9.81}};
  }
  bool scan_ready() const { return count % 20 == 0; }
  rio::RadarScan scan() const {
    rio::RadarScan scan{std::chrono::milliseconds(5 * count), {}};
    for (int i = -6; i <= 6; ++i) scan.detections.push_back({{3.0, 0.2 * i, 0.1 * (i % 3)}, 0.0});
    return scan;
  }
};

}  // namespace

int main() {
  Sensors sensors;
  // [README]
  rio::Options options;                                 // every default, SI units
  options.radar.T_BS.translation = {0.10, 0.0, -0.05};  // where the radar sits on the IMU
  std::string why;
  auto odometry = rio::Odometry::create(options, &why);  // validates and allocates everything
  if (!odometry) return std::printf("%s\n", why.c_str()), 1;
  for (int i = 0; i < 1000; ++i) {
    if (odometry->add_imu(sensors.imu()) == rio::Status::kMoving) std::puts("hold still");
    if (sensors.scan_ready()) (void)odometry->add_scan(sensors.scan());  // its outcome is counted
  }
  const rio::NavState& now = odometry->now();  // pose, velocity, biases at IMU rate
  // [README]
  std::printf("position %.3f %.3f %.3f m\n", now.p_WB.x(), now.p_WB.y(), now.p_WB.z());
  return odometry->initialized() && now.p_WB.norm() < 0.05 ? 0 : 1;
}
