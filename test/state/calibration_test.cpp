// SPDX-License-Identifier: BSD-3-Clause
// The vector of a radar's calibration: its inverse, and that its columns are those of the blocks;
// which column of the state gets which prior and which random walk.
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

constexpr double kRotation = 0.01;
constexpr double kTranslation = 0.1;
constexpr double kDelay = 0.04;
constexpr double kScale = 0.005;
constexpr double kWalk = 0.1;
constexpr double kElevation = 0.07;

CalibrationOptions calibration() {
  return {kRotation, kTranslation, kDelay, kScale, kWalk, kElevation};
}

void expect_square(double sigma, const Eigen::VectorXd& variances, int column, int count = 1) {
  for (int c = column; c < column + count; ++c) {
    EXPECT_DOUBLE_EQ(variances[c - body::kSize], sigma * sigma) << "column " << c;
  }
}

TEST(ParameterNoise, EachParameterOfEachRadarHasItsOwn) {
  const Layout layout(calibration(), 2, 5, 0, 2);
  const ParameterNoise noise = parameter_noise(layout, calibration());
  ASSERT_EQ(noise.prior.size(), 18);
  ASSERT_EQ(noise.walk.size(), 18);
  for (std::size_t r = 0; r < 2; ++r) {
    const Layout own = layout.of_radar(r);
    const auto expect = [&](double sigma, double usual, int column, int count) {
      expect_square(sigma, noise.prior, column, count);
      expect_square(kWalk * usual, noise.walk, column, count);
    };
    expect(kRotation, 0.05, own.extrinsics(), 3);
    expect(kTranslation, 0.03, own.extrinsics() + 3, 3);
    expect(kScale, 0.02, own.doppler_scale(), 1);
    expect(kDelay, 0.03, own.time_offset(), 1);
    expect_square(kElevation, noise.prior, own.elevation_error());
    expect_square(0.0, noise.walk, own.elevation_error());
  }
}

TEST(ParameterNoise, AuxiliaryStatesFollowTheCalibration) {
  AuxiliaryStates states;
  ASSERT_TRUE(states.declare({"bias", 1, 3.0, 0.5}));
  ASSERT_TRUE(states.declare({"wind", 2, 4.0, 0.0}));
  const Layout layout(calibration(), 2, 5, states.size());
  const ParameterNoise noise = parameter_noise(layout, calibration(), states);
  ASSERT_EQ(noise.prior.size(), 12);
  expect_square(3.0, noise.prior, layout.auxiliary());
  expect_square(0.5, noise.walk, layout.auxiliary());
  expect_square(4.0, noise.prior, layout.auxiliary() + 1, 2);
  expect_square(0.0, noise.walk, layout.auxiliary() + 1, 2);
}

// A parameter with the prior 0 does not walk, although others of its block are estimated.
TEST(ParameterNoise, WhatIsNotEstimatedStays) {
  CalibrationOptions some;
  some = {kRotation, 0.0, 0.0, 0.0, kWalk, 0.0};
  const Layout layout(some, 0, 0);
  const ParameterNoise noise = parameter_noise(layout, some);
  ASSERT_EQ(noise.walk.size(), 6);
  expect_square(0.0, noise.prior, layout.extrinsics() + 3, 3);
  expect_square(0.0, noise.walk, layout.extrinsics() + 3, 3);
  some = {0.0, 0.0, 0.0, 0.0, kWalk, 0.0};
  EXPECT_EQ(parameter_noise(Layout(some, 0, 0), some).walk.size(), 0);
}

}  // namespace
}  // namespace rio
