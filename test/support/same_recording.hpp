// SPDX-License-Identifier: BSD-3-Clause
// Two recordings with the same samples: stamps and IMU to the bit, points within rounding.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>

#include "rio/io/dataset.hpp"

namespace rio::test {

/// @param point largest distance of a point [m]
/// @param rate largest difference of a range rate [m/s]
/// @param rest called with each pair of detections, to compare what else they have
template <class Rest>
void expect_same_recording(const io::Dataset& read, const io::Dataset& put, double point,
                           double rate, const Rest& rest) {
  ASSERT_EQ(read.imu.size(), put.imu.size());
  for (std::size_t i = 0; i < put.imu.size(); ++i) {
    ASSERT_EQ(read.imu[i].time, put.imu[i].time);
    ASSERT_EQ(read.imu[i].gyro_B, put.imu[i].gyro_B);
    ASSERT_EQ(read.imu[i].accel_B, put.imu[i].accel_B);
  }
  ASSERT_EQ(read.scans.size(), put.scans.size());
  for (std::size_t i = 0; i < put.scans.size(); ++i) {
    ASSERT_EQ(read.scans[i].time, put.scans[i].time);
    ASSERT_EQ(read.scans[i].detections.size(), put.scans[i].detections.size());
    for (std::size_t k = 0; k < put.scans[i].detections.size(); ++k) {
      const RadarDetection& a = read.scans[i].detections[k];
      const RadarDetection& b = put.scans[i].detections[k];
      ASSERT_LE((a.point_S - b.point_S).norm(), point) << a.point_S << "\n\n" << b.point_S;
      ASSERT_LE(std::abs(a.range_rate - b.range_rate), rate);
      rest(a, b);
    }
  }
}

}  // namespace rio::test
