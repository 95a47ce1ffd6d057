// SPDX-License-Identifier: BSD-3-Clause
#include "rio/frontend/ego_velocity.hpp"

#include <gtest/gtest.h>

#include "frontend/static_scan.hpp"

namespace rio {
namespace {

using test::list_of;
using test::static_points;
using test::static_rate;

/// Without folding; a prediction is exact.
EgoVelocity estimate(const DetectionList& scan, const std::optional<Vector3d>& predicted = {},
                     const FrontendOptions& options = {}) {
  EgoVelocity out;
  out.v_S.setConstant(1e9);  // whatever a scan before left behind
  out.inlier.fill(true);
  std::optional<RadarVelocity> velocity;
  if (predicted) velocity = {*predicted, Matrix3d::Zero()};
  EgoVelocityRansac(options).estimate(scan, velocity, &out);
  int marked = 0;
  for (std::size_t i = 0; i < kMaxDetections; ++i) {
    marked += out.inlier[i] ? 1 : 0;
    EXPECT_TRUE(i < scan.items.size() || !out.inlier[i]);
  }
  EXPECT_EQ(out.inliers, marked);
  return out;
}

TEST(EgoVelocity, IterationCount) {
  // smallest k with (1 - (1 - eps)^3)^k <= 1 - P
  EXPECT_EQ(ransac_iterations(0.4, 0.9999), 38);
  EXPECT_EQ(ransac_iterations(0.5, 0.9999), 69);
  EXPECT_EQ(ransac_iterations(0.0, 0.9999), 1);
  for (const double eps : {0.1, 0.3, 0.7}) {
    for (const double success : {0.9, 0.999}) {
      const int k = ransac_iterations(eps, success);
      const double dirty = 1.0 - std::pow(1.0 - eps, 3);
      EXPECT_LE(std::pow(dirty, k), 1.0 - success);
      EXPECT_GT(std::pow(dirty, k - 1), 1.0 - success);
    }
  }
}

TEST(EgoVelocity, ExactWithoutNoise) {
  test::Random random(1);
  for (int run = 0; run < 50; ++run) {
    const Vector3d v = run == 0 ? Vector3d::Zero() : random.normal_vector(2.0);
    const EgoVelocity out = estimate(list_of(static_points(random, 20, v)));
    EXPECT_TRUE(out.valid);
    EXPECT_EQ(out.inliers, 20);
    EXPECT_LT((out.v_S - v).norm(), 1e-11);
  }
}

/// Of two in five: half a metre per second and more off the static world.
double motion_of(std::size_t i, test::Random& random) {
  if (i % 5 >= 2) return 0.0;
  return random.uniform(0.5, 3.0) * (random.index(2) == 0 ? 1.0 : -1.0);
}

TEST(EgoVelocity, FindsTheStaticSetAmongOutliers) {
  constexpr double kSigma = 0.03;
  double found = 0.0;
  double claimed = 0.0;
  double right = 0.0;
  double sum_nees = 0.0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    test::Random random(seed);
    const Vector3d v = random.normal_vector(1.0);
    std::vector<RadarDetection> raw = static_points(random, 40, v, kSigma);
    for (std::size_t i = 0; i < raw.size(); ++i) raw[i].range_rate += motion_of(i, random);
    const EgoVelocity out = estimate(list_of(raw, test::exact_angles(), Time(seed * 66'000'000)));
    EXPECT_TRUE(out.valid) << seed;
    claimed += out.inliers;
    for (std::size_t i = 0; i < raw.size(); ++i) {
      if (i % 5 < 2) continue;
      found += 1.0;
      right += out.inlier[i] ? 1.0 : 0.0;
      sum_nees += std::pow(raw[i].point_S.normalized().dot(out.v_S - v) / kSigma, 2);
    }
  }
  EXPECT_GT(right / found, 0.999);    // the bound is five sigmas of the noise
  EXPECT_GT(right / claimed, 0.999);  // and a third of the smallest outlier
  // least squares over the true static set has NEES 3; sqrt(2 * 3 / 200) = 0.17
  EXPECT_NEAR(sum_nees / 200.0, 3.0, 0.6);
}

// A hypothesis must not earn inliers by being fast: (E2) widens the bound with its own speed.
TEST(EgoVelocity, FindsTheStaticSetWithTheAngleNoiseOfARadar) {
  int failures = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    test::Random random(seed);
    const Vector3d v = random.normal_vector(0.7);
    std::vector<RadarDetection> raw = static_points(random, 40, v);
    for (std::size_t i = 0; i < raw.size(); ++i) {
      raw[i].point_S.z() *= 0.45;  // 120 x 30 degrees
      raw[i].range_rate = static_rate(raw[i], v) + random.normal(0.03) + motion_of(i, random);
      raw[i].point_S = test::rotation_of(random.normal_vector(0.035)) * raw[i].point_S;
    }
    const DetectionList list = list_of(raw, RadarOptions{}, Time(seed * 66'000'000));
    failures += (estimate(list).v_S - v).norm() < 0.5 ? 0 : 1;
  }
  EXPECT_LE(failures, 4);  // 1e-4 draw no clean triple; a clean one of bad geometry is rare
}

TEST(EgoVelocity, SameScanSameResultWhateverCameBefore) {
  test::Random random(2);
  std::vector<RadarDetection> raw = static_points(random, 30, Vector3d(1.0, 0.5, -0.2), 0.08);
  for (std::size_t i = 0; i < 12; ++i) raw[i].range_rate = random.uniform(-3.0, 3.0);
  const DetectionList scan = list_of(raw, test::exact_angles(), Time(123456789));
  EgoVelocityRansac ransac{FrontendOptions{}};
  EgoVelocity first;
  ransac.estimate(scan, std::nullopt, &first);
  EgoVelocity other;
  ransac.estimate(list_of(static_points(random, 9, Vector3d::UnitX())), std::nullopt, &other);
  EgoVelocity again;
  ransac.estimate(scan, std::nullopt, &again);
  EXPECT_EQ(again.v_S, first.v_S);
  EXPECT_EQ(again.inlier, first.inlier);
}

TEST(EgoVelocity, SmallScansFallBackOnThePrediction) {
  test::Random random(3);
  const Vector3d v(1.0, -0.4, 0.3);
  for (int count = 0; count <= 4; ++count) {
    std::vector<RadarDetection> raw = static_points(random, count, v);
    const EgoVelocity alone = estimate(list_of(raw));
    EXPECT_FALSE(alone.valid) << count;
    EXPECT_EQ(alone.inliers, 0) << count;
    if (count == 0) continue;
    raw[0].range_rate += 1.0;
    const EgoVelocity helped = estimate(list_of(raw), v);
    EXPECT_FALSE(helped.valid) << count;  // no consensus, only the word of the IMU
    EXPECT_EQ(helped.v_S, v) << count;
    EXPECT_EQ(helped.inliers, count - 1) << count;
    EXPECT_FALSE(helped.inlier[0]) << count;
  }
}

TEST(EgoVelocity, NearlyCoplanarDirectionsAreNoConsensus) {
  test::Random random(4);
  const Vector3d v(1.0, 0.5, -0.3);
  for (const double thickness : {0.0, 1e-4}) {  // noise over 1e-4 would be a velocity of 300 m/s
    std::vector<RadarDetection> raw = static_points(random, 12, v);
    for (RadarDetection& d : raw) {
      d.point_S.z() = random.normal(thickness);
      d.range_rate = static_rate(d, v) + random.normal(0.03);
    }
    const EgoVelocity alone = estimate(list_of(raw));
    EXPECT_FALSE(alone.valid);
    EXPECT_EQ(alone.inliers, 0);
    // the prediction supplies what the plane cannot
    const EgoVelocity helped = estimate(list_of(raw), v);
    EXPECT_TRUE(helped.valid);
    EXPECT_EQ(helped.inliers, 12);
    EXPECT_EQ(helped.v_S, v);
  }
}

TEST(EgoVelocity, WrongPredictionDoesNotWinOverAClearConsensus) {
  test::Random random(5);
  for (int run = 0; run < 50; ++run) {
    const Vector3d v = random.normal_vector(1.0);
    const Vector3d wrong = v + 1.5 * random.direction();
    std::vector<RadarDetection> raw = static_points(random, 30, v, 0.03);
    for (std::size_t i = 0; i < 9; ++i) raw[i].range_rate = static_rate(raw[i], wrong);
    const EgoVelocity out = estimate(list_of(raw, test::exact_angles(), Time(run)), wrong);
    EXPECT_TRUE(out.valid);
    // a mover within 0.15 m/s of the static world counts as static and pulls; 1.5 would be the
    // wrong one
    EXPECT_LT((out.v_S - v).norm(), 0.4) << run;
    EXPECT_GE(out.inliers, 21);
  }
}

TEST(EgoVelocity, GoodPredictionWinsWhereDrawingFails) {
  // four in five are outliers: a clean triple has the odds 0.008, so 38 draws mostly miss
  int without = 0;
  int with = 0;
  for (unsigned seed = 1; seed <= 50; ++seed) {
    test::Random random(seed);
    const Vector3d v = random.normal_vector(1.0);
    std::vector<RadarDetection> raw = static_points(random, 60, v);
    for (std::size_t i = 12; i < 60; ++i) raw[i].range_rate += random.uniform(1.0, 8.0);
    const DetectionList scan = list_of(raw, test::exact_angles(), Time(seed));
    without += (estimate(scan).v_S - v).norm() < 0.1 ? 1 : 0;
    with += (estimate(scan, v).v_S - v).norm() < 0.1 ? 1 : 0;
  }
  EXPECT_EQ(with, 50);
  EXPECT_LT(without, 25);  // 1 - 0.992^38 = 0.26 of 50 draw a clean triple
}

TEST(EgoVelocity, InlierBoundIsTheWiderOfThresholdAndSigmas) {
  const Vector3d v(4.0, 0.0, 0.0);
  Detection d =
      make_detection(RadarDetection{Vector3d(0.0, 3.0, 0.0), 0.0, 10.0, 0.0}, test::exact_angles());
  const auto inlier = [&](double rate, double sigmas, double sigma_azimuth) {
    DetectionList scan;
    d.range_rate = rate;
    d.sigma_azimuth_S = Vector3d(-sigma_azimuth, 0.0, 0.0);
    scan.items.push_back(d);
    FrontendOptions options;
    options.ransac_threshold = 0.15;
    options.ransac_sigmas = sigmas;
    return estimate(scan, v, options).inlier[0];
  };
  EXPECT_TRUE(inlier(0.149, 0.0, 0.1));
  EXPECT_FALSE(inlier(0.151, 0.0, 0.1));
  EXPECT_FALSE(inlier(-0.151, 3.0, 0.0));  // 3 * 0.03
  // across the motion 0.1 rad are 0.4 m/s: 3 * hypot(0.03, 0.4) = 1.203
  EXPECT_TRUE(inlier(1.20, 3.0, 0.1));
  EXPECT_FALSE(inlier(-1.21, 3.0, 0.1));
}

}  // namespace
}  // namespace rio
