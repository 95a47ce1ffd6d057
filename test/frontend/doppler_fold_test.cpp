// SPDX-License-Identifier: BSD-3-Clause
// Folded range rates: the arithmetic, the consensus in spite of them, and what is left out.
#include "rio/frontend/doppler_fold.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "rio/frontend/frontend.hpp"
#include "rio/sim/catalogue.hpp"
#include "rio/sim/flight.hpp"
#include "support/random_state.hpp"

namespace rio {
namespace {

constexpr double kLimit = 1.5;  // [m/s]

RadarOptions folding_radar() {
  RadarOptions o;
  o.sigma_azimuth = o.sigma_elevation = 0.0;
  o.max_doppler = kLimit;
  return o;
}

double true_rate(const Detection& d, const Vector3d& v_S) {
  return -d.direction_S.dot(v_S);
}

// Static points over 120 x 60 degrees, their range rates noisy and folded.
DetectionList folded_scan(test::Random& random, int count, const Vector3d& v_S,
                          const RadarOptions& radar = folding_radar()) {
  RadarScan scan;
  scan.time = Time(static_cast<Time::rep>(random.index(1'000'000'000)));
  for (int i = 0; i < count; ++i) {
    const double az = random.uniform(-1.05, 1.05);
    const double el = random.uniform(-0.52, 0.52);
    RadarDetection raw;
    raw.point_S = random.uniform(1.0, 8.0) *
                  Vector3d(std::cos(el) * std::cos(az), std::cos(el) * std::sin(az), std::sin(el));
    raw.range_rate = sim::fold(-raw.point_S.normalized().dot(v_S) + random.normal(0.03), kLimit);
    scan.detections.push_back(raw);
  }
  DetectionList list;
  filter_detections(scan, radar, static_cast<int>(kMaxDetections), list);
  return list;
}

EgoVelocity estimate_folded(const DetectionList& scan,
                            const std::optional<RadarVelocity>& predicted,
                            const FrontendOptions& options = {}) {
  EgoVelocity out;
  EgoVelocityRansac(options, kLimit).estimate(scan, predicted, &out);
  return out;
}

RadarVelocity velocity(const Vector3d& v_S, double sigma) {
  return {v_S, sigma * sigma * Matrix3d::Identity()};
}

// Inliers whose unfolded rate is not that of the truth; 0.5 m/s is far from noise and fold.
int wrong_folds(const DetectionList& scan, const EgoVelocity& out, const Vector3d& v_S) {
  int wrong = 0;
  for (std::size_t i = 0; i < scan.items.size(); ++i) {
    const double error = out.range_rate[i] - true_rate(scan.items[i], v_S);
    wrong += out.inlier[i] && std::abs(error) > 0.5 ? 1 : 0;
  }
  return wrong;
}

TEST(DopplerFold, NearestRateOfTheSameFold) {
  const DopplerFold fold(kLimit);
  test::Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const double expected = random.uniform(-20.0, 20.0);
    const double truth = expected + random.uniform(-1.499, 1.499);
    EXPECT_NEAR(fold.nearest(sim::fold(truth, kLimit), expected), truth, 1e-12);
    EXPECT_LE(std::abs(fold.wrap(truth)), kLimit);
  }
  EXPECT_TRUE(fold.is_unique(0.499 * 0.499));  // 3 * 0.499 < 1.5
  EXPECT_FALSE(fold.is_unique(0.501 * 0.501));
}

TEST(DopplerFold, NoLimitNoFolding) {
  const DopplerFold none(0.0);
  EXPECT_FALSE(none.ambiguous());
  EXPECT_EQ(none.wrap(123.0), 123.0);
  EXPECT_EQ(none.nearest(-7.0, 55.0), -7.0);
  EXPECT_TRUE(none.is_unique(1e12));
}

TEST(DopplerFold, TheTrueFoldIsRecoveredWithAPrediction) {
  test::Random random(2);
  int folded = 0;
  for (int run = 0; run < 100; ++run) {
    const Vector3d v = 6.0 * random.direction();
    const DetectionList scan = folded_scan(random, 30, v);
    const EgoVelocity out = estimate_folded(scan, velocity(v + random.normal_vector(0.1), 0.1));
    EXPECT_TRUE(out.valid);
    EXPECT_EQ(out.inliers, 30) << run;
    EXPECT_EQ(wrong_folds(scan, out, v), 0) << run;
    EXPECT_LT((out.v_S - v).norm(), 0.2) << run;  // 0.03 over 30 points, elevation is narrow
    for (const Detection& d : scan.items) folded += std::abs(true_rate(d, v)) > kLimit ? 1 : 0;
  }
  EXPECT_GT(folded, 1500);  // else the test would show nothing
}

TEST(DopplerFold, HalfOfThePointsFoldedAndNoPrediction) {
  FrontendOptions options;
  options.ransac_outlier_ratio = 0.5;  // to a triple taken as measured a folded point is an outlier
  int runs = 0;
  for (unsigned seed = 1; seed <= 300; ++seed) {
    test::Random random(seed);
    const Vector3d v = 2.2 * random.direction();
    const DetectionList scan = folded_scan(random, 30, v);
    int folded = 0;
    for (const Detection& d : scan.items) folded += std::abs(true_rate(d, v)) > kLimit ? 1 : 0;
    if (folded < 13 || folded > 17) continue;
    ++runs;
    const EgoVelocity out = estimate_folded(scan, std::nullopt, options);
    EXPECT_TRUE(out.valid) << seed;
    EXPECT_LT((out.v_S - v).norm(), 0.2) << seed;
    EXPECT_EQ(wrong_folds(scan, out, v), 0) << seed;
    EXPECT_EQ(out.inliers, 30) << seed;
  }
  EXPECT_GE(runs, 20);
}

// At 4 m/s hardly a triple is free of folds, and the prediction knows nothing.
TEST(DopplerFold, AStartAtSpeedFindsTheFoldByItself) {
  test::Random random(3);
  for (int run = 0; run < 50; ++run) {
    const Vector3d v = Vector3d(4.0, 0.0, 0.0) + random.normal_vector(0.3);
    const DetectionList scan = folded_scan(random, 30, v);
    const EgoVelocity out = estimate_folded(scan, velocity(v + 3.0 * random.direction(), 2.0));
    EXPECT_TRUE(out.valid) << run;
    EXPECT_LT((out.v_S - v).norm(), 0.2) << run;
    EXPECT_EQ(wrong_folds(scan, out, v), 0) << run;
  }
}

// Unfolding towards a wrong prediction would lock its folds; the consensus does not.
TEST(DopplerFold, AWrongPredictionDoesNotChooseTheFold) {
  test::Random random(4);
  for (int run = 0; run < 100; ++run) {
    const Vector3d v = random.normal_vector(0.4);
    const Vector3d wrong = v + 2.8 * random.direction();
    const DetectionList scan = folded_scan(random, 30, v);
    const EgoVelocity out = estimate_folded(scan, velocity(wrong, 0.05));
    EXPECT_LT((out.v_S - v).norm(), 0.2) << run;
    EXPECT_EQ(wrong_folds(scan, out, v), 0) << run;
  }
}

// Points in three directions only: every combination of folds fits them all.
TEST(DopplerFold, AnAmbiguousScanIsDecidedByASurePredictionOnly) {
  test::Random random(5);
  const std::vector<Vector3d> directions = {Vector3d(1.0, 1.0, 0.2), Vector3d(1.0, -1.0, 0.2),
                                            Vector3d(1.0, 0.0, -0.5)};
  for (int run = 0; run < 50; ++run) {
    const Vector3d v = random.normal_vector(2.0);
    DetectionList scan;
    scan.time = Time(run);
    for (int i = 0; i < 9; ++i) {
      RadarDetection raw;
      raw.point_S = 3.0 * directions[static_cast<std::size_t>(i % 3)];
      raw.range_rate = sim::fold(-raw.point_S.normalized().dot(v), kLimit);
      scan.items.push_back(make_detection(raw, folding_radar()));
    }
    const Vector3d off = 0.3 * random.direction();
    const EgoVelocity sure = estimate_folded(scan, velocity(v + off, 0.1));
    EXPECT_TRUE(sure.valid);
    EXPECT_EQ(sure.inliers, 9) << run;
    EXPECT_LT((sure.v_S - v).norm(), 1e-9) << run;
    const EgoVelocity vague = estimate_folded(scan, velocity(v + off, 1.0));
    EXPECT_EQ(wrong_folds(scan, vague, v), 0) << run;
  }
}

TEST(DopplerFold, APointThatCouldBeOnTwoFoldsIsLeftOut) {
  test::Random random(6);
  RadarOptions radar = folding_radar();
  radar.sigma_azimuth = 0.06;  // beyond 47 degrees 3 * 8 * 0.06 * tan(az) exceeds the limit
  const Vector3d v(8.0, 0.0, 0.0);
  const DetectionList scan = folded_scan(random, 60, v, radar);
  const EgoVelocity out = estimate_folded(scan, velocity(v, 0.05));
  int left_out = 0;
  for (std::size_t i = 0; i < scan.items.size(); ++i) {
    const bool open = 3.0 * std::sqrt(residual_variance(scan.items[i], v)) > 1.02 * kLimit;
    left_out += open ? 1 : 0;
    if (open) {
      EXPECT_FALSE(out.inlier[i]);
    }
  }
  EXPECT_GT(left_out, 5);
  EXPECT_GT(out.inliers, 30);
}

TEST(DopplerFold, WithoutAConsensusTheUncertaintyOfThePredictionCounts) {
  test::Random random(7);
  const Vector3d v(3.0, 0.5, -0.2);
  const DetectionList scan = folded_scan(random, 3, v);
  EXPECT_EQ(estimate_folded(scan, velocity(v, 0.1)).inliers, 3);
  EXPECT_EQ(estimate_folded(scan, velocity(v, 1.0)).inliers, 0);  // 3 sigma are two folds
}

TEST(DopplerFold, ObservationsCarryTheUnfoldedRates) {
  test::Random random(8);
  Options options;
  options.radar.max_doppler = kLimit;
  options.update.use_trails = options.update.use_landmarks = false;
  Estimate x;
  x.nav.v_WB = Vector3d(3.5, 1.0, 0.3);
  const DetectionList scan = folded_scan(random, 30, x.nav.v_WB);
  Observations seen;
  Frontend frontend(options);
  frontend.observe(scan, x, &seen);
  EXPECT_EQ(seen.ego_velocity.inliers, 30);
  for (std::size_t i = 0; i < scan.items.size(); ++i) {
    EXPECT_NEAR(seen.detection(i).range_rate, true_rate(scan.items[i], x.nav.v_WB), 0.5);
  }
  options.frontend.unwrap_doppler = false;
  Frontend as_published(options);
  as_published.observe(scan, x, &seen);
  EXPECT_EQ(seen.scan, &scan);
}

// The labels of the simulation: at 4 m/s no static point is refused for its fold, and none is used
// on a wrong one.
// Rates that are all too large by a scale fold before it is taken out, so the fold shrinks with
// them.
TEST(DopplerFold, TheFoldIsScaledWithTheRates) {
  test::Random random(9);
  constexpr double kScale = 1.05;
  Options options;
  options.radar.max_doppler = kLimit;
  options.update.use_trails = options.update.use_landmarks = false;
  Estimate x;
  x.nav.v_WB = Vector3d(3.5, 1.0, 0.3);
  x.doppler_scale = kScale - 1.0;
  RadarOptions radar = folding_radar();
  radar.sigma_azimuth = radar.sigma_elevation = 1e-4;
  DetectionList scan = folded_scan(random, 30, kScale * x.nav.v_WB, radar);  // as received
  for (Detection& d : scan.items) d.range_rate /= kScale;
  Observations seen;
  Frontend frontend(options);
  frontend.observe(scan, x, &seen, 0.01 * Matrix3d::Identity());
  EXPECT_GT(seen.ego_velocity.inliers, 27);
  int folded = 0;
  for (std::size_t i = 0; i < scan.items.size(); ++i) {
    if (!seen.is_static(i)) continue;
    // three sigma of 0.03 m/s; a fold of 3 m/s that is not scaled is off by 0.14
    EXPECT_NEAR(seen.detection(i).range_rate, true_rate(scan.items[i], x.nav.v_WB), 0.1);
    folded += seen.detection(i).range_rate != scan.items[i].range_rate ? 1 : 0;
  }
  EXPECT_GT(folded, 20);
}

TEST(DopplerFold, AggressiveFlight) {
  sim::Scenario s;
  ASSERT_TRUE(sim::scenario("aggressive", &s));
  s.seed = 3;
  s.path.length = 40.0;
  const sim::Flight flight = sim::simulate_flight(s);
  RadarOptions radar;
  radar.doppler_resolution = s.radar.doppler_resolution;
  const double limit = s.radar.max_doppler;
  EgoVelocityRansac ransac(FrontendOptions{}, limit);
  test::Random random(9);
  const RigidPose T_BS(s.radar.T_BS);
  int statics[2] = {0, 0};  // not folded, folded
  int used[2] = {0, 0};
  int wrong = 0;
  for (std::size_t k = 0; k < flight.scans.size(); ++k) {
    const auto point = flight.trajectory.at(flight.scans[k].time);
    const Vector3d v_B = point.nav.q_WB.conjugate() * point.nav.v_WB;
    const Vector3d v_S = T_BS.R.transpose() * (v_B + point.gyro_B.cross(T_BS.p));
    DetectionList list;
    filter_detections(flight.scans[k], radar, static_cast<int>(kMaxDetections), list);
    if (list.items.size() != flight.labels[k].size()) continue;  // indices would not agree
    EgoVelocity out;
    ransac.estimate(list, velocity(v_S + random.normal_vector(0.1), 0.1), &out);
    for (std::size_t i = 0; i < list.items.size(); ++i) {
      if (flight.labels[k][i].cause != sim::Cause::kStatic) continue;
      const double rate = true_rate(list.items[i], v_S);
      const int fold = std::abs(rate) > limit ? 1 : 0;
      ++statics[fold];
      used[fold] += out.inlier[i] ? 1 : 0;
      wrong += out.inlier[i] && std::abs(out.range_rate[i] - rate) > limit ? 1 : 0;
    }
  }
  ASSERT_GT(statics[1], 1000);
  // what is lost is lost to angle errors, which are wider than told for weak echoes
  EXPECT_GT(used[1], 0.93 * statics[1]);
  EXPECT_GT(used[0], 0.93 * statics[0]);
  EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace rio
