// SPDX-License-Identifier: BSD-3-Clause
// Stages 3 and 4 on a scan made by hand: who gives which rows, what the gate does with them, and
// by what their variance is multiplied.
#include "rio/update/scan_rows.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "support/random_state.hpp"
#include "support/scan_case.hpp"

namespace rio {
namespace {

constexpr double kMinute = 1.0 - 1e-6;  // just inside

TEST(Gate, IsTheQuantileOfEveryNumberOfRows) {
  const Gate gate(0.99);
  EXPECT_NEAR(gate.threshold(1), 6.6349, 1e-4);
  EXPECT_NEAR(gate.threshold(3), 11.3449, 1e-4);
  for (std::size_t dof = 1; dof <= Gate::kMaxDof; ++dof) {
    EXPECT_NEAR(chi2_cdf(gate.threshold(dof), static_cast<double>(dof)), 0.99, 1e-9) << dof;
  }
}

using ScanRowsTest = test::ScanCase;

using test::inflation;
using test::kSpeed;
using test::kVelocityVar;

constexpr double kFirstLooks = 10.0;  // factor of the variance of directions at first

/// Variance of the Doppler of a match at kSpeed: a neighbour's is that of another direction.
double doubtful_doppler(const Detection& d, double right) {
  const Vector3d v(kSpeed, 0.0, 0.0);
  const double across =
      std::pow(d.sigma_azimuth_S.dot(v), 2) + std::pow(d.sigma_elevation_S.dot(v), 2);
  return d.sigma_doppler * d.sigma_doppler + mismatch_variance(right, across);
}

TEST_F(ScanRowsTest, ALandmarksMatchIsOneBlockAndTellsNoFurtherDoppler) {
  match_landmark(1, 1);
  const RowBatch& batch = build(state_estimate(2));
  ASSERT_EQ(batch.blocks().size(), 3U);  // the landmark first
  EXPECT_EQ(batch.blocks()[0].count, 4U);
  const auto& points = measured<LandmarkPointModel>();
  ASSERT_EQ(points.size(), 1U);
  EXPECT_EQ(points[0].landmark, 1U);
  ASSERT_TRUE(points[0].doppler.has_value());
  EXPECT_EQ(points[0].doppler->range_rate, detection(1).range_rate);
  const auto& dopplers = measured<DopplerModel>();
  ASSERT_EQ(dopplers.size(), 2U);
  EXPECT_EQ(dopplers[0].z.range_rate, detection(0).range_rate);
  EXPECT_EQ(dopplers[1].z.range_rate, detection(2).range_rate);
  EXPECT_FALSE(rows_->was_used(0));
  EXPECT_TRUE(rows_->was_used(1));
  EXPECT_EQ(sums(Model::kLandmarkPoint).rows_used, 4);
  EXPECT_EQ(sums(Model::kDoppler).rows_used, 2);
  EXPECT_EQ(report_.records.size(), 3U);
  options_.update.use_doppler = false;
  build(state_estimate(2));
  EXPECT_EQ(sums(Model::kLandmarkPoint).rows_used, 3);
  EXPECT_EQ(sums(Model::kDoppler).rows_used, 0);
  EXPECT_FALSE(measured<LandmarkPointModel>()[0].doppler.has_value());
}

// A landmark just born is as uncertain across the line of sight as its detection was.
TEST_F(ScanRowsTest, ALandmarksRangeIsExpectedLongerThanThatOfItsMean) {
  match_landmark(1, 1);
  const RowBatch& batch = build(state_estimate(2));
  const Detection& d = detection(1);
  const double az = d.sigma_azimuth_S.squaredNorm();
  const double el = d.sigma_elevation_S.squaredNorm();
  const double mean = 0.5 * d.range * (az + el);
  const double variance = 0.5 * d.range * d.range * (az * az + el * el);
  const double noise = d.sigma_range * d.sigma_range;
  const LinearRow& range = batch.rows()[batch.blocks()[0].first];
  EXPECT_NEAR(range.residual, -mean / d.sigma_range, 1e-4);
  EXPECT_NEAR(range.variance, 1.0 + variance / noise, 1e-4);
  EXPECT_EQ(report_.records[0].innovation, range.residual);
  EXPECT_NEAR(report_.records[0].sigma, std::sqrt(2.0 + variance / noise), 1e-3);
  const auto& z = measured<LandmarkPointModel>()[0].z;  // the window's
  EXPECT_NEAR(z.range, d.range - mean, 1e-5);
  EXPECT_NEAR(z.sigma_range, std::sqrt(noise + variance), 1e-6);
}

// An error that all elevations share has no terms of second order, also where the landmark, born
// with it, is nearer now and seen at another elevation than it was born with.
TEST_F(ScanRowsTest, TheErrorCommonToElevationsLeavesTheRange) {
  const Vector3d half_way(2.0, 0.5, 0.25);
  see(half_way);
  match_landmark(0, scan_.items.size() - 1);
  const auto range_row = [&] {
    StateEstimate b = state_estimate(1);
    b.estimate().nav.p_WB = half_way;
    return build(b).rows()[0];
  };
  const LinearRow without = range_row();
  EXPECT_LT(without.residual, -0.1);
  options_.calibration.elevation_sigma = 0.1;
  EXPECT_NEAR(range_row().residual, without.residual, 1e-9);
  EXPECT_NEAR(range_row().variance, without.variance, 1e-9);
}

TEST_F(ScanRowsTest, APlaceOrADistanceLeavesTheDopplerToTheDetection) {
  for (const auto& [measurement, model, count] :
       {std::tuple{LandmarkMeasurement::kPosition, Model::kLandmarkPosition, 3},
        std::tuple{LandmarkMeasurement::kDistance, Model::kLandmarkDistance, 1}}) {
    options_.update.landmark_measurement = measurement;
    seen_.matches.landmarks.clear();
    match_landmark(0, 0);
    build(state_estimate(1));
    EXPECT_EQ(sums(model).rows_used, count);
    EXPECT_EQ(sums(Model::kDoppler).rows_used, 3);
  }
}

TEST_F(ScanRowsTest, WhatIsNotStaticTellsNothing) {
  const StateEstimate b = state_estimate();
  seen_.moves[1] = true;
  EXPECT_EQ(build(b).rows().size(), 2U);
  options_.update.use_doppler = false;
  EXPECT_TRUE(build(b).rows().empty());
}

// S = sigma_D^2 + u^T P_v u; a residual of the gate's root times its sigma is the bound.
TEST_F(ScanRowsTest, TheGateHoldsTheInnovationAgainstItsCovariance) {
  const double sigma = std::hypot(options_.radar.sigma_doppler, std::sqrt(kVelocityVar + 1e-8));
  const double bound = std::sqrt(Gate(options_.update.gate_probability).threshold(1)) * sigma;
  const double rate = detection(0).range_rate;
  for (const double share : {kMinute, -kMinute, 2.0 - kMinute, kMinute - 2.0}) {
    detection(0).range_rate = rate + share * bound;
    StateEstimate b = state_estimate();  // of a body that does not turn, known exactly
    b.covariance().matrix().diagonal().head<6>().setZero();
    b.covariance().matrix().diagonal().tail<6>().setZero();
    build(b);
    const bool inside = std::abs(share) < 1.0;
    const InnovationRecord& record = report_.records[0];
    EXPECT_EQ(record.result, inside ? GateResult::kUsed : GateResult::kGated) << share;
    EXPECT_NEAR(record.innovation, share * bound, 1e-9);
    EXPECT_NEAR(record.sigma, sigma, 1e-7);
    EXPECT_NEAR(record.nis / record.gate, share * share, 1e-6);
    EXPECT_EQ(rows_->measurements().size(), inside ? 3U : 2U);
    EXPECT_EQ(sums(Model::kDoppler).rows_gated, inside ? 0 : 1);
    EXPECT_NEAR(sums(Model::kDoppler).nis, inside ? record.nis : 0.0, 1e-9);
  }
}

// It is dropped as a whole, and the detection tells its Doppler after all.
TEST_F(ScanRowsTest, AGatedMatchGivesNoRows) {
  for (const bool published : {false, true}) {
    options_.update.landmark_measurement =
        published ? LandmarkMeasurement::kDistance : LandmarkMeasurement::kPoint;
    seen_.matches.landmarks.clear();
    match_landmark(0, 2);  // metres away
    EXPECT_EQ(build(state_estimate(1)).rows().size(), 3U);
    EXPECT_EQ(rows_->measurements().size(), 3U);
    EXPECT_EQ(sums(Model::kDoppler).rows_used, 3);
    EXPECT_EQ(report_.records[0].result, GateResult::kGated);
    EXPECT_EQ(rows_->was_used(0), published);  // by its match alone it stays alive
  }
}

TEST_F(ScanRowsTest, ALandmarkAtTheRadarIsOutOfDomain) {
  match_landmark(0, 0);
  StateEstimate b = state_estimate(1);
  b.estimate().landmarks[0].p_W.setZero();
  EXPECT_EQ(build(b).rows().size(), 3U);
  EXPECT_EQ(sums(Model::kLandmarkPoint).rows_out_of_domain, 1);
  EXPECT_EQ(report_.records[0].result, GateResult::kOutOfDomain);
  EXPECT_FALSE(rows_->was_used(0));
}

// Landmarks: by the distance travelled since they were seen and the trust in matches; after the
// gate.
TEST_F(ScanRowsTest, RepetitionAndDoubtMultiplyTheVariance) {
  match_landmark(0, 0);
  StateEstimate b = state_estimate(1);
  b.estimate().distance_travelled = 7.0;
  b.estimate().landmarks[0].distance_seen = 6.99;
  const double range_variance = build(b).rows()[0].variance;  // with that of second order
  EXPECT_EQ(measured<LandmarkPointModel>()[0].weight, 1.0);
  const double nis = report_.records[0].nis;
  options_.radar.noise_distance = 0.02;
  options_.update.match_trust = 0.7;
  const RowBatch& batch = build(b);
  const double expected = repetition_factor(0.01, 0.02) * mismatch_factor(0.7);
  EXPECT_NEAR(1.0 / measured<LandmarkPointModel>()[0].weight, expected, 1e-9);
  EXPECT_NEAR(batch.rows()[0].variance, expected * range_variance, 1e-9);
  for (std::size_t i = 1; i < 3; ++i) {  // whitened
    EXPECT_NEAR(batch.rows()[i].variance, expected, 1e-9);
  }
  EXPECT_EQ(report_.records[0].nis, nis);
  const double doppler = doubtful_doppler(detection(0), 0.7);
  EXPECT_NEAR(batch.rows()[3].variance, expected * doppler, 1e-12);
  const auto& z = measured<LandmarkPointModel>()[0].doppler;  // the window's
  EXPECT_NEAR(z->sigma_doppler, std::sqrt(doppler), 1e-12);
}

// After the gate, the directions alone, in the row and in the window's measurement; not from the
// same place.
TEST_F(ScanRowsTest, TheCorrelationOfLooksMultipliesTheVarianceOfDirections) {
  options_.radar.noise_distance = 0.02;
  match_landmark(0, 0);
  StateEstimate b = state_estimate(1);
  b.estimate().landmarks[0].p_W += Vector3d(0.0, 0.3, -0.2);
  ScanRows rows(options_);
  LookCorrelation expected;
  LandmarkState::Looks looks;
  const auto look = [&](double moved) {
    b.estimate().distance_travelled += moved;
    const RowBatch& batch = build(rows, b);
    ASSERT_EQ(batch.blocks()[0].count, 4U);
    Eigen::Vector2d nu;
    for (int i = 0; i < 2; ++i) {
      const LinearRow& row = batch.rows()[1 + static_cast<std::size_t>(i)];
      nu[i] = row.residual / std::sqrt(b.covariance().product(row, row) + 1.0);
    }
    EXPECT_GT(nu.norm(), 1.0);
    if (moved > 0.1) expected.add(nu, &looks);
    const double f = moved > 0.1 ? expected.factor() : 1.0;
    const auto& m = rows.measurements().of<LandmarkPointModel>()[0];
    EXPECT_NEAR(m.weight * batch.rows()[1].variance, f, 1e-9) << moved;
    EXPECT_NEAR(m.weight * batch.rows()[2].variance, f, 1e-9) << moved;
    EXPECT_NEAR(m.z.sigma_azimuth_S.norm(), std::sqrt(f) * detection(0).sigma_azimuth_S.norm(),
                1e-9);
    EXPECT_NEAR(m.z.sigma_elevation_S.norm(), std::sqrt(f) * detection(0).sigma_elevation_S.norm(),
                1e-9);
    EXPECT_LT((rows.looks(0).innovation - looks.innovation).norm(), 1e-9);
    EXPECT_LT((rows.looks(0).squares - looks.squares).norm(), 1e-9);
    if (moved > 0.1) {
      looks.elevation_walk = expected.elevation_walk(detection(0).sigma_elevation_S.norm());
    }
    EXPECT_NEAR(rows.looks(0).elevation_walk, looks.elevation_walk, 1e-12);
    b.estimate().landmarks[0].looks = rows.looks(0);
    b.estimate().landmarks[0].distance_seen = b.estimate().distance_travelled;
  };
  look(0.01);
  const double range = rows.measurements().of<LandmarkPointModel>()[0].z.sigma_range;
  const double nis = report_.records[0].nis;
  look(1.0);
  look(2.0);
  EXPECT_EQ(rows.measurements().of<LandmarkPointModel>()[0].z.sigma_range, range);
  EXPECT_EQ(report_.records[0].nis, nis);
  EXPECT_LT(expected.factor(), kFirstLooks);
  EXPECT_GT(expected.factor(), 1.0);
  EXPECT_GT(looks.elevation_walk, 0.0);
  rows.reset();
  expected = LookCorrelation{};
  look(1.0);
}

// As if independent of that in the other Dopplers.
TEST_F(ScanRowsTest, TheDopplerOfALandmarkHasTheNoiseOfTheGyroSample) {
  options_.radar.T_BS.translation = Vector3d(0.1, -0.2, 0.3);
  match_landmark(0, 0);
  StateEstimate b = state_estimate(1);
  b.estimate().gyro_variance = 0.04;
  build(b);
  const Detection& d = detection(0);
  const double expected = d.sigma_doppler * d.sigma_doppler +
                          0.04 * options_.radar.T_BS.translation.cross(d.direction_S).squaredNorm();
  const auto& z = measured<LandmarkPointModel>()[0].doppler;
  EXPECT_NEAR(z->sigma_doppler * z->sigma_doppler, expected, 1e-9);
}

// What it has shown before stays its own, whichever landmark had its number in the last scan.
TEST_F(ScanRowsTest, AMatchAtRestIsNoLook) {
  match_landmark(0, 0);
  StateEstimate b = state_estimate(1);
  b.estimate().distance_travelled = 10.0;
  b.estimate().landmarks[0].looks.elevation_walk = 0.25;
  seen_.rest = RestModel::Measurement{};
  build(b);
  EXPECT_TRUE(measured<LandmarkPointModel>().empty());
  EXPECT_TRUE(rows_->was_used(0));
  EXPECT_EQ(rows_->looks(0).elevation_walk, 0.25);
}

TEST_F(ScanRowsTest, ADoubtfulMatchHasTheVelocityOfTheScanNotThePredictedOne) {
  options_.update.match_trust = 0.7;
  match_landmark(0, 0);
  StateEstimate b = state_estimate(1);
  b.estimate().nav.v_WB.x() += 0.3;
  seen_.ego_velocity.v_S = Vector3d(kSpeed, 0.0, 0.0);
  seen_.ego_velocity.covariance = Matrix3d(1e-9 * Matrix3d::Identity());
  build(b);
  const double doppler = doubtful_doppler(detection(0), 0.7);
  const auto& z = measured<LandmarkPointModel>()[0].doppler;
  EXPECT_NEAR(z->sigma_doppler, std::sqrt(doppler), 1e-6);
}

}  // namespace
}  // namespace rio
