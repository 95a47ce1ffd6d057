// SPDX-License-Identifier: BSD-3-Clause
// The vector of a radar's calibration: its inverse, and that its columns are those of the blocks.
#include "rio/state/calibration.hpp"

#include <gtest/gtest.h>

#include "rio/core/so3.hpp"

namespace rio {
namespace {

TEST(CalibrationVector, CorrectionsLeadFromOneCalibrationToTheOther) {
  const RadarState from{{quaternion_exp({0.4, -0.7, 0.2}), {0.1, 0.2, -0.3}}, 0.02, -0.01};
  CalibrationVector c;
  c << 0.1, -0.2, 0.3, 0.01, 0.02, 0.03, -0.005, 0.004;
  const RadarState to = corrected(from, c);
  EXPECT_LT((corrections_between(from, to) - c).norm(), 1e-15);
  EXPECT_LT((to.T_BS.translation - Vector3d(0.11, 0.22, -0.27)).norm(), 1e-15);
  EXPECT_NEAR(to.doppler_scale, 0.015, 1e-15);
  EXPECT_NEAR(to.time_offset, -0.006, 1e-15);
  // the turn is about the axes of the radar
  const Vector3d turn = quaternion_log(from.T_BS.rotation.conjugate() * to.T_BS.rotation);
  EXPECT_LT((turn - Vector3d(0.1, -0.2, 0.3)).norm(), 1e-15);
}

TEST(CalibrationVector, ColumnsAreThoseOfTheBlocks) {
  CalibrationOptions options;
  const Layout all(options, 2, 3, 0, 2);
  const Layout second = all.of_radar(1);
  for (int i = 0; i < 6; ++i) EXPECT_EQ(calibration_column(second, i), second.extrinsics() + i);
  EXPECT_EQ(calibration_column(second, 6), second.column<DopplerScale>(0));
  EXPECT_EQ(calibration_column(second, 7), second.time_offset_column());
  options.rotation_sigma = options.translation_sigma = 0.0;
  options.doppler_scale_sigma = options.time_offset_sigma = 0.0;
  const Layout none(options, 2, 3);
  for (int i = 0; i < 8; ++i) EXPECT_EQ(calibration_column(none, i), -1);
}

}  // namespace
}  // namespace rio
