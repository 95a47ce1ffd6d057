// SPDX-License-Identifier: BSD-3-Clause
#include "rio/frontend/scan_correction.hpp"

#include <gtest/gtest.h>

namespace rio {
namespace {

TEST(ScanCorrection, DividesRangeRatesByTheirScaleAndLeavesTheRest) {
  Options options;
  options.frontend.own_echoes = false;
  ScanCorrection correction(options);
  DetectionList received(4);
  received.items.push_back(make_detection({{3.0, 1.0, -0.5}, 1.027 * -2.0}, options.radar));
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
