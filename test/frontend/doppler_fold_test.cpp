// SPDX-License-Identifier: BSD-3-Clause
// Folded range rates: the arithmetic, the consensus in spite of them, and what is left out.
#include "rio/frontend/doppler_fold.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "frontend/static_scan.hpp"
#include "rio/frontend/frontend.hpp"
#include "rio/sim/radar_model.hpp"

namespace rio {
namespace {

constexpr double kLimit = 1.5;  // [m/s]

double true_rate(const Detection& d, const Vector3d& v_S) {
  return -d.direction_S.dot(v_S);
}

/// Static points with noisy and folded range rates.
DetectionList folded_scan(test::Random& random, int count, const Vector3d& v_S,
                          const RadarOptions& radar = test::exact_angles()) {
  std::vector<RadarDetection> raw = test::static_points(random, count, v_S, 0.03);
  for (RadarDetection& d : raw) d.range_rate = sim::fold(d.range_rate, kLimit);
  return test::list_of(raw, radar, Time(static_cast<Time::rep>(random.index(1'000'000'000))));
}

EgoVelocity estimate_folded(const DetectionList& scan, const RadarVelocity& predicted) {
  EgoVelocity out;
  EgoVelocityRansac(FrontendOptions{}, kLimit).estimate(scan, predicted, &out);
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

int folded_points(const DetectionList& scan, const Vector3d& v_S) {
  int folded = 0;
  for (const Detection& d : scan.items) folded += std::abs(true_rate(d, v_S)) > kLimit ? 1 : 0;
  return folded;
}

void expect_recovered(const EgoVelocity& out, const DetectionList& scan, const Vector3d& v_S) {
  EXPECT_TRUE(out.valid);
  EXPECT_EQ(out.inliers, 30);
  EXPECT_EQ(wrong_folds(scan, out, v_S), 0);
  EXPECT_LT((out.v_S - v_S).norm(), 0.2);  // 0.03 over 30 points, elevation is narrow
}

TEST(DopplerFold, TheTrueFoldIsRecovered) {
  struct Row {
    const char* prediction;
    Vector3d mean_v_S;  ///< [m/s]
    double spread;      ///< of the velocity about it, in any direction [m/s]
    double error;       ///< of the prediction, same
    double sigma;       ///< claimed of it, an axis
    int folded;         ///< points at least, of 3000
  };
  for (const Row& row : {
           Row{"is good", Vector3d::Zero(), 6.0, 0.17, 0.1, 1500},
           // hardly a triple is free of folds
           Row{"of a start at speed knows nothing", {4.0, 0.0, 0.0}, 0.5, 3.0, 2.0, 2500},
           // unfolding towards it would lock its folds
           Row{"is wrong", Vector3d::Zero(), 0.7, 2.8, 0.05, 0},
       }) {
    SCOPED_TRACE(row.prediction);
    test::Random random(2);
    int folded = 0;
    for (int run = 0; run < 100; ++run) {
      const Vector3d v = row.mean_v_S + row.spread * random.direction();
      const Vector3d predicted = v + row.error * random.direction();
      const DetectionList scan = folded_scan(random, 30, v);
      expect_recovered(estimate_folded(scan, velocity(predicted, row.sigma)), scan, v);
      folded += folded_points(scan, v);
    }
    EXPECT_GE(folded, row.folded);  // else the test would show nothing
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
      const Vector3d point_S = 3.0 * directions[static_cast<std::size_t>(i % 3)];
      const double rate = sim::fold(-point_S.normalized().dot(v), kLimit);
      scan.items.push_back(make_detection({point_S, rate}, test::exact_angles()));
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
  RadarOptions radar = test::exact_angles();
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

// Rates that are all too large by a scale fold before it is taken out, so the fold shrinks with
// them.
TEST(DopplerFold, ObservationsCarryTheUnfoldedRatesAtAnyScale) {
  Options options;
  options.radar.max_doppler = kLimit;
  options.update.use_trails = options.update.use_landmarks = false;
  Estimate x;
  x.nav.v_WB = Vector3d(3.5, 1.0, 0.3);
  for (const double scale : {1.0, 1.05}) {
    test::Random random(9);
    x.doppler_scale = scale - 1.0;
    DetectionList scan = folded_scan(random, 30, scale * x.nav.v_WB);  // as received
    for (Detection& d : scan.items) d.range_rate /= scale;
    Observations seen;
    Frontend frontend(options);  // the unfolded detections are its own
    frontend.observe(scan, x, &seen, 0.01 * Matrix3d::Identity());
    EXPECT_EQ(seen.ego_velocity.inliers, 30) << scale;
    int folded = 0;
    for (std::size_t i = 0; i < scan.items.size(); ++i) {
      // three sigma of 0.03 m/s; a fold of 3 m/s that is not scaled is off by 0.14
      EXPECT_NEAR(seen.detection(i).range_rate, true_rate(scan.items[i], x.nav.v_WB), 0.1) << scale;
      folded += seen.detection(i).range_rate != scan.items[i].range_rate ? 1 : 0;
    }
    EXPECT_GT(folded, 20) << scale;
    options.frontend.unwrap_doppler = false;
    Frontend(options).observe(scan, x, &seen);
    EXPECT_EQ(seen.scan, &scan);  // as received
    options.frontend.unwrap_doppler = true;
  }
}

}  // namespace
}  // namespace rio
