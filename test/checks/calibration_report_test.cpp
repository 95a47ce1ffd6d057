// SPDX-License-Identifier: BSD-3-Clause
// Which number of the state the report shows under which name, and the verdict on it.
#include "rio/checks/calibration_report.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>

#include "rio/core/so3.hpp"

namespace rio::test {
namespace {

constexpr double kPrior = 0.02;

TEST(CalibrationReport, VerdictFollowsFromTheSigmas) {
  constexpr double kLimit = kCalibrationLimit * kPrior;
  constexpr double kDoubt = kCalibrationDoubt * kPrior;
  const struct {
    double value;
    double sigma;
    double prior_sigma;
    Observability expected;
  } rows[] = {
      {0.0, 1.00 * kPrior, kPrior, Observability::kUnobserved},
      {0.0, 0.91 * kPrior, kPrior, Observability::kUnobserved},
      {0.0, 0.89 * kPrior, kPrior, Observability::kWeak},
      {0.0, 0.51 * kPrior, kPrior, Observability::kWeak},
      {0.0, 0.49 * kPrior, kPrior, Observability::kObserved},
      {0.0, 0.0, kPrior, Observability::kObserved},
      {0.0, 0.0, 0.0, Observability::kNotEstimated},
      {1.0, 0.0, 0.0, Observability::kNotEstimated},
      // the limit outweighs the sigma
      {kLimit, 0.1 * kPrior, kPrior, Observability::kAtLimit},
      {-kLimit, kPrior, kPrior, Observability::kAtLimit},
      {0.99 * kLimit, 0.1 * kPrior, kPrior, Observability::kDoubtful},
      // what is told beyond three sigmas
      {1.01 * kDoubt, 0.1 * kPrior, kPrior, Observability::kDoubtful},
      {-1.01 * kDoubt, 0.8 * kPrior, kPrior, Observability::kDoubtful},
      {0.99 * kDoubt, 0.1 * kPrior, kPrior, Observability::kObserved},
      {1.01 * kDoubt, kPrior, kPrior, Observability::kUnobserved},
  };
  for (const auto& row : rows) {
    EXPECT_EQ(observability(row.value, row.sigma, row.prior_sigma), row.expected)
        << row.value << " of sigma " << row.sigma;
  }
}

/// Every parameter estimated, with priors and corrections that differ.
class CalibrationOfAnEstimate : public testing::Test {
 protected:
  CalibrationOfAnEstimate() {
    options_.radar.T_BS.rotation = quaternion_exp(Vector3d(0.4, -0.7, 0.2));
    options_.radar.T_BS.translation = Vector3d(0.1, 0.2, -0.3);
    options_.calibration = {.rotation_sigma = 0.05,
                            .translation_sigma = 0.03,
                            .time_offset_sigma = 0.04,
                            .doppler_scale_sigma = 0.02};
  }
  /// A state estimate that has been corrected by `step` times 1, 2, ... in the parameters as laid
  /// out.
  StateEstimate corrected(double step) const {
    StateEstimate state_estimate(options_, 0);
    state_estimate.reset(NavState{}, BodyCovariance::Identity());
    Eigen::VectorXd dx = Eigen::VectorXd::Zero(state_estimate.layout().capacity());
    const int count = state_estimate.layout().clone(0) - body::kSize;
    for (int i = 0; i < count; ++i) dx[body::kSize + i] = step * (1.0 + i);
    state_estimate.correct(dx);
    return state_estimate;
  }
  std::array<CalibrationReport, kCalibrationCount> report(
      const StateEstimate& state_estimate) const {
    return calibration_report(state_estimate, options_);
  }

  Options options_;
};

constexpr std::array kPriors = {0.05, 0.05, 0.05, 0.03, 0.03, 0.03, 0.02, 0.04};

TEST_F(CalibrationOfAnEstimate, EveryParameterStandsUnderItsName) {
  StateEstimate state_estimate = corrected(1e-3);
  // sigma: a tenth of i + 1 times the prior
  for (int i = 0; i < static_cast<int>(kCalibrationCount); ++i) {
    const double sigma = 0.1 * (1.0 + i) * kPriors[static_cast<std::size_t>(i)];
    state_estimate.covariance().matrix()(body::kSize + i, body::kSize + i) = sigma * sigma;
  }
  const auto all = report(state_estimate);
  for (std::size_t i = 0; i < kCalibrationCount; ++i) {
    const double rank = 1.0 + static_cast<double>(i);
    EXPECT_NEAR(all[i].value, 1e-3 * rank, 1e-12) << i;
    EXPECT_NEAR(all[i].sigma, 0.1 * rank * kPriors[i], 1e-15) << i;
    EXPECT_EQ(all[i].prior_sigma, kPriors[i]) << i;
    const Observability expected = i < 4 ? Observability::kObserved : Observability::kWeak;
    if (i != 4) {  // half is the bound itself
      EXPECT_EQ(all[i].observability, expected) << i;
    }
  }
}

// What is configured of the radar's errors is where their estimates start and what they are counted
// from.
TEST_F(CalibrationOfAnEstimate, CountsFromTheConfiguredValue) {
  options_.radar.time_offset = -0.3;
  options_.radar.doppler_scale = 0.15;
  StateEstimate state_estimate = corrected(1e-3);
  EXPECT_NEAR(state_estimate.estimate().time_offset, -0.3 + 8e-3, 1e-12);
  EXPECT_NEAR(state_estimate.estimate().doppler_scale, 0.15 + 7e-3, 1e-12);
  const auto all = report(state_estimate);
  EXPECT_NEAR(all[static_cast<std::size_t>(Calibration::kTimeOffset)].value, 8e-3, 1e-12);
  EXPECT_NEAR(all[static_cast<std::size_t>(Calibration::kDopplerScale)].value, 7e-3, 1e-12);
}

TEST_F(CalibrationOfAnEstimate, EstimatesStopAtTheirLimit) {
  for (const double step : {10.0, -10.0}) {
    // of the rotation only one axis: turns of many radians about several do not add up
    StateEstimate state_estimate(options_, 0);
    state_estimate.reset(NavState{}, BodyCovariance::Identity());
    Eigen::VectorXd dx = Eigen::VectorXd::Constant(state_estimate.layout().capacity(), step);
    dx.segment<3>(state_estimate.layout().extrinsics()) = Vector3d(0.0, step / 10.0, 0.0);
    state_estimate.correct(dx);
    const auto all = report(state_estimate);
    for (std::size_t i = 1; i < kCalibrationCount; ++i) {
      if (i == 2) continue;
      EXPECT_NEAR(all[i].value, (step > 0.0 ? 1.0 : -1.0) * kCalibrationLimit * kPriors[i], 1e-12)
          << i;
      EXPECT_EQ(all[i].observability, Observability::kAtLimit) << i;
    }
  }
}

TEST_F(CalibrationOfAnEstimate, WhatHasNoPriorIsNotReported) {
  options_.calibration = {.rotation_sigma = 0.05,
                          .translation_sigma = 0.0,
                          .time_offset_sigma = 0.0,
                          .doppler_scale_sigma = 0.02};
  const auto all = report(corrected(1e-3));
  for (std::size_t i = 0; i < kCalibrationCount; ++i) {
    const bool estimated = i < 3 || i == static_cast<std::size_t>(Calibration::kDopplerScale);
    EXPECT_EQ(all[i].observability != Observability::kNotEstimated, estimated) << i;
    EXPECT_EQ(all[i].sigma > 0.0, estimated) << i;
    EXPECT_EQ(all[i].value != 0.0, estimated) << i;
  }
  options_.calibration = {0.0, 0.0, 0.0, 0.0, 0.0};
  for (const CalibrationReport& r : report(corrected(1e-3))) {
    EXPECT_EQ(r.observability, Observability::kNotEstimated);
  }
}

}  // namespace
}  // namespace rio::test
