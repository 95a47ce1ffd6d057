// SPDX-License-Identifier: BSD-3-Clause
// The rows of Dopplers, at rest and in motion, and of trails, on a scan made by hand.
#include <gtest/gtest.h>

#include "rio/update/scan_rows.hpp"
#include "support/random_state.hpp"
#include "support/scan_case.hpp"

namespace rio {
namespace {

using DopplerRowsTest = test::ScanCase;
using test::inflation;
using test::kSpeed;

// Nothing but rounding, of a point across the flight: its rate changes by v^2 / r.
class RoundedDopplerTest : public DopplerRowsTest {
 protected:
  static constexpr double kGrid = 0.5;
  static constexpr double kTurning = kSpeed * kSpeed / 4.0;

  RoundedDopplerTest() {
    options_.radar.noise_distance = 1e-3;
    options_.radar.doppler_resolution = kGrid;
    see_across(0.0);
  }
  void see_across(double sigma_doppler) {
    options_.radar.sigma_doppler = sigma_doppler;
    scan_.items.clear();
    see({0.0, 4.0, 0.0});
  }
  static double expected(double distance, double cells) {
    return repetition_factor(distance + 0.15 * 6.0 * cells, 0.15);
  }
};

TEST_F(RoundedDopplerTest, RepeatsUntilItChangesByCells) {
  const auto factor = [&](double distance, const Vector3d& accel_W, double duration) {
    ScanRows rows(options_);
    StateEstimate b = state_estimate();
    build(rows, b);
    b.estimate().distance_travelled = distance;
    b.estimate().steady.accel_W = accel_W;
    b.estimate().nav.time += from_seconds(duration);
    build(rows, b);
    return inflation(rows, 0);
  };
  const Vector3d none = Vector3d::Zero();
  EXPECT_NEAR(factor(0.1, none, 0.1), expected(0.1, kTurning * 0.1 / kGrid), 1e-9);
  EXPECT_NEAR(factor(0.2, none, 0.05), expected(0.2, kTurning * 0.05 / kGrid), 1e-9);
  // an acceleration towards the point makes up for the turn, and one away adds to it
  EXPECT_NEAR(factor(0.1, {0.0, kTurning, 0.0}, 0.1), expected(0.1, 0.0), 1e-9);
  EXPECT_NEAR(factor(0.1, {0.0, -kTurning, 0.0}, 0.1), expected(0.1, kTurning * 0.2 / kGrid), 1e-9);
  EXPECT_NEAR(factor(-1.0, none, 0.0), expected(0.0, 0.0), 1e-9);
  // half of the variance is no rounding and new after a millimetre
  see_across(kGrid / std::sqrt(12.0));
  EXPECT_NEAR(factor(0.1, {0.0, kTurning, 0.0}, 0.1), 0.5 + 0.5 * expected(0.1, 0.0), 1e-9);
}

// The first scan after a reset has none before it: a second is what a Doppler may have changed in.
TEST_F(RoundedDopplerTest, ResetForgetsTheScanBefore) {
  ScanRows rows(options_);
  StateEstimate b = state_estimate();
  b.estimate().distance_travelled = 0.05;
  const auto factor = [&] {
    build(rows, b);
    return inflation(rows, 0);
  };
  const double first = factor();
  EXPECT_NEAR(first, expected(0.05, kTurning / kGrid), 1e-9);
  EXPECT_NEAR(factor(), expected(0.0, 0.0), 1e-9);
  rows.reset();
  EXPECT_EQ(factor(), first);
}

// What a Doppler tells along its direction: that of the expected direction.
TEST_F(DopplerRowsTest, DopplersUseExpectedDirections) {
  options_.update.doppler_directions = DopplerDirections::kCorrected;
  const StateEstimate b = state_estimate();
  detection(0).range_rate += 0.05;
  const RowBatch& batch = build(b);
  const Vector3d v(kSpeed, 0.0, 0.0);
  DopplerModel::Measurement z = DopplerModel::measurement(detection(0), Vector3d::Zero());
  z.predicted_var = z.direction_S.dot(b.radar_velocity_covariance() * z.direction_S);
  const auto at_u = DopplerModel::expected_direction(z, z.direction_S, v);
  const double length = 1.0 + 0.5 * z.direction_cov.trace();  // (E5) of the model
  const auto u = DopplerModel::expected_direction(z, length * z.direction_S, v);
  const LinearRow& row = batch.rows()[0];
  EXPECT_EQ(row.segments[1].column, body::kVelocity);
  EXPECT_LT((Vector3d(row.h[6], row.h[7], row.h[8]) + u.u_S).norm(), 1e-9);
  EXPECT_GT(std::abs(at_u.variance_factor - 1.0), 1e-3);
  EXPECT_NEAR(row.variance, at_u.variance_factor * u.variance, 1e-12);
}

// The innovation variance of a Doppler, taken from the velocity's covariance, is that of its row.
TEST_F(DopplerRowsTest, TheGateOfADopplerHoldsItsRow) {
  options_.calibration = {0.05, 0.03, 0.02, 0.02};
  options_.radar.T_BS.rotation = Quaternion(0.9, 0.1, -0.3, 0.2).normalized();
  options_.radar.T_BS.translation = Vector3d(0.1, -0.2, 0.3);
  for (const DopplerDirections directions :
       {DopplerDirections::kExact, DopplerDirections::kNoisy, DopplerDirections::kCorrected}) {
    options_.update.doppler_directions = directions;
    StateEstimate b = state_estimate();
    b.estimate().steady.v_B += Vector3d(0.3, -0.2, 0.1);
    test::Random random(3);
    const Eigen::Index n = b.covariance().matrix().rows();
    ASSERT_GT(n, 15 + 6 + 2);
    const Eigen::MatrixXd A =
        Eigen::MatrixXd::NullaryExpr(n, n, [&random] { return random.normal(0.05); });
    b.covariance().matrix() += A * A.transpose();
    const RowBatch& batch = build(b);
    ASSERT_EQ(measured<DopplerModel>().size(), scan_.items.size());
    for (std::size_t i = 0; i < scan_.items.size(); ++i) {
      const LinearRow& row = batch.rows()[i];
      const double variance = row.variance / inflation(*rows_, i);
      const double expected = b.covariance().product(row, row) + variance;
      const double sigma = report_.records[i].sigma;
      EXPECT_NEAR(sigma * sigma, expected, 1e-12 * expected) << i;
    }
  }
}

TEST_F(DopplerRowsTest, AtRestOnlyLandmarksOfHereAreMeasured) {
  match_landmark(0, 0);
  match_landmark(1, 1);
  StateEstimate b = state_estimate(2);
  b.estimate().distance_travelled = 3.0;
  b.estimate().landmarks[0].distance_born = 2.45;
  b.estimate().landmarks[1].distance_born = 2.55;
  seen_.rest = RestModel::Measurement{Vector3d::Zero(), 10.0, 0.01};
  const RowBatch& batch = build(b);
  EXPECT_EQ(measured<RestModel>().size(), 1U);
  EXPECT_EQ(batch.blocks()[0].count, 6U);
  EXPECT_EQ(sums(Model::kRest).rows_used, 6);
  EXPECT_EQ(sums(Model::kLandmarkPoint).rows_used, 4);
  EXPECT_TRUE(rows_->was_used(0));  // not measured, but alive
  EXPECT_TRUE(rows_->was_used(1));
  const auto& points = measured<LandmarkPointModel>();
  ASSERT_EQ(points.size(), 1U);
  EXPECT_EQ(points[0].landmark, 1U);
  EXPECT_EQ(sums(Model::kDoppler).rows_used, 2);
}

/// Trails of two past detections each, of scans 0 and 1, by a radar that has not moved since.
class TrailRowsTest : public test::ScanCase {
 protected:
  TrailRowsTest() {
    options_.update.use_doppler = options_.update.use_landmarks = false;
    options_.update.use_trails = true;
    options_.update.sigma_trail_distance = 0.1;
    for (std::size_t i = 0; i < 3; ++i) {
      trails_.create({0, detection(i)});
      trails_.extend(i, {1, detection(i)});
      seen_.matches.trails.push_back({i, i});
    }
  }
  StateEstimate state_estimate(int clones = 2) const {
    StateEstimate b = ScanCase::state_estimate();
    for (int i = 0; i < clones; ++i) b.clone(static_cast<ScanId>(i));
    return b;
  }
};

TEST_F(TrailRowsTest, EveryPastDetectionIsARowWithAVerdict) {
  detection(1).range += 10.0;
  const RowBatch& batch = build(state_estimate());
  EXPECT_EQ(batch.blocks().size(), 4U);
  EXPECT_EQ(sums(Model::kTrailDistance).rows_used, 4);
  EXPECT_EQ(sums(Model::kTrailDistance).rows_gated, 2);
  const auto& distances = measured<TrailDistanceModel>();
  ASSERT_EQ(distances.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(distances[i].z.range, detection(i < 2 ? 0 : 2).range);
    EXPECT_EQ(distances[i].past, i % 2);
    EXPECT_NEAR(batch.rows()[i].variance, 0.01, 1e-12);
  }
}

TEST_F(TrailRowsTest, WhatHasNoCloneGivesNoRow) {
  EXPECT_EQ(build(state_estimate(1)).rows().size(), 3U);
  EXPECT_EQ(build(state_estimate(0)).rows().size(), 0U);
  options_.update.use_trails = false;
  EXPECT_EQ(build(state_estimate()).rows().size(), 0U);
}

}  // namespace
}  // namespace rio
