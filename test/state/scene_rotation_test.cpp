// SPDX-License-Identifier: BSD-3-Clause
// The Gauss-Markov process of the scene's rotation.
#include "rio/state/scene_rotation.hpp"

#include <gtest/gtest.h>

namespace rio {
namespace {

constexpr double kSigma = 0.1;
constexpr double kPoints = 6.0;

TEST(SceneRotation, KeepsItsVarianceWhateverTheSteps) {
  const Vector3d stationary = scene_variance(kSigma, kPoints);
  for (const double distance : {0.0, 0.01, 1.0, 50.0}) {
    const SceneStep step(distance, kSigma, kPoints);
    const Vector3d after = step.decay * step.decay * stationary + step.variance;
    EXPECT_LT((after - stationary).norm(), 1e-15);
  }
}

TEST(SceneRotation, TwoStepsAreOneOfTheirSum) {
  const SceneStep first(0.4, kSigma, kPoints);
  const SceneStep second(1.1, kSigma, kPoints);
  const SceneStep both(1.5, kSigma, kPoints);
  EXPECT_NEAR(first.decay * second.decay, both.decay, 1e-15);
  const Vector3d variance = second.decay * second.decay * first.variance + second.variance;
  EXPECT_LT((variance - both.variance).norm(), 1e-15);
}

TEST(SceneRotation, AveragesOverThePointsInAzimuthAndElevation) {
  const Vector3d one = scene_variance(kSigma, 1.0);
  EXPECT_DOUBLE_EQ(one.y(), kSigma * kSigma);
  EXPECT_DOUBLE_EQ(one.z(), kSigma * kSigma);
  EXPECT_LT(one.x(), 0.02 * one.y());
  EXPECT_GT(one.x(), 0.0);
  EXPECT_LT((scene_variance(kSigma, 50.0) - one / 50.0).norm(), 1e-15);
}

TEST(SceneRotation, ReturnsToTheMounting) {
  const Vector3d off(0.02, -0.1, 0.05);
  RadarState radar;
  radar.mounting = quaternion_exp({0.4, -0.7, 0.2});
  radar.T_BS = {radar.mounting * quaternion_exp(off), Vector3d(0.1, 0.2, -0.3)};
  const RadarState before = radar;
  const SceneStep step(SceneStep::kLength, kSigma, kPoints);  // one length: it decays by e
  step.apply(&radar);
  const Vector3d left = quaternion_log(radar.mounting.conjugate() * radar.T_BS.rotation);
  EXPECT_LT((left - off * std::exp(-1.0)).norm(), 1e-15);
  EXPECT_EQ(radar.mounting.coeffs(), before.mounting.coeffs());
  EXPECT_EQ(radar.T_BS.translation, before.T_BS.translation);
}

}  // namespace
}  // namespace rio
