// SPDX-License-Identifier: BSD-3-Clause
#include "rio/frontend/scan_correction.hpp"

#include <gtest/gtest.h>

namespace rio {
namespace {

TEST(ScanCorrection, DividesRangeRatesByTheirScaleAndLeavesTheRest) {
  Options options;
  options.frontend.own_echoes = false;
  ScanCorrection correction(options);
  RadarDetection raw;
  raw.point_S = Vector3d(3.0, 1.0, -0.5);
  raw.range_rate = 1.027 * -2.0;
  DetectionList received(4);
  received.items.push_back(make_detection(raw, options.radar));
  Estimate x;
  x.doppler_scale = 0.027;
  const DetectionList& corrected = correction.correct(received, x, Matrix3d::Zero());
  ASSERT_EQ(corrected.items.size(), 1U);
  EXPECT_DOUBLE_EQ(corrected.items[0].range_rate, -2.0);
  EXPECT_EQ(corrected.items[0].point_S, received.items[0].point_S);
  EXPECT_EQ(corrected.items[0].sigma_doppler, received.items[0].sigma_doppler);
}

}  // namespace
}  // namespace rio
