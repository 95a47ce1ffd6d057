// SPDX-License-Identifier: BSD-3-Clause
// What makes which part of the estimate degraded, dead reckoning or lost, and how it heals.
#include "rio/checks/health_monitor.hpp"

#include <gtest/gtest.h>

#include <utility>

namespace rio::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Time kPeriod = milliseconds(100);

class HealthMonitorTest : public testing::Test {
 protected:
  HealthMonitorTest() {
    P_.setIdentity();
    P_ *= 1e-4;
    scan_.detections_kept = 20;
    scan_.static_detections = 18;
    scan_.models[0].rows_used = 18;
    scan_.models[0].nis = 18.0;
    monitor_.reset(Time{0});
  }

  /// Scans as they stand for a while.
  void fly(Time duration) {
    for (const Time end = x_.nav.time + duration; x_.nav.time < end;) {
      x_.nav.time += kPeriod;
      monitor_.observe(scan_, x_, P_);
    }
  }
  void be_silent(Time duration) { monitor_.wait(x_.nav.time + duration, Time{0}, x_, P_); }

  const Health& health() const { return monitor_.health(); }

  HealthMonitor monitor_;
  UpdateReport scan_;
  Estimate x_;
  BodyCovariance P_;
};

TEST_F(HealthMonitorTest, BeginsWithTheFirstScanThatTellsAVelocity) {
  EXPECT_EQ(health().state, HealthState::kInitializing);
  scan_.models[0].rows_used = 1;
  scan_.models[0].nis = 1.0;
  fly(2 * kPeriod);
  EXPECT_EQ(health().state, HealthState::kInitializing);
  scan_.models[0].rows_used = 18;
  fly(kPeriod);
  EXPECT_EQ(health().state, HealthState::kOk);
  fly(seconds(2));
  EXPECT_EQ(health().state, HealthState::kOk);
  EXPECT_GT(health().quality, 75);
}

// A restart whose first scans have yet to determine it is no loss, a later one is.
TEST_F(HealthMonitorTest, AStartWithAnUnknownTiltBeginsWhenItIsKnown) {
  const auto tilt = [this](double sigma) {
    P_.diagonal().segment<2>(body::kAttitude).setConstant(0.5 * sigma * sigma);
    fly(kPeriod);
    return health().state;
  };
  EXPECT_EQ(tilt(0.25), HealthState::kInitializing);
  EXPECT_EQ(tilt(0.15), HealthState::kDegraded);
  EXPECT_EQ(tilt(0.02), HealthState::kOk);
  EXPECT_EQ(tilt(0.25), HealthState::kLost);
}

TEST_F(HealthMonitorTest, WithoutAMountingItHasNotBegun) {
  scan_.mounting_unknown = true;
  fly(seconds(1));
  EXPECT_EQ(health().state, HealthState::kInitializing);
  scan_.mounting_unknown = false;
  fly(seconds(1));
  EXPECT_EQ(health().state, HealthState::kOk);
}

TEST_F(HealthMonitorTest, SilenceIsDeadReckoningOfPositionAndVelocity) {
  fly(seconds(3));
  be_silent(milliseconds(900));
  EXPECT_EQ(health().state, HealthState::kOk);
  be_silent(milliseconds(1100));
  EXPECT_EQ(health().state, HealthState::kDeadReckoning);
  EXPECT_EQ(health().position, HealthState::kDeadReckoning);
  EXPECT_EQ(health().velocity, HealthState::kDeadReckoning);
  EXPECT_EQ(health().heading, HealthState::kOk);
  EXPECT_TRUE(health().because(HealthReason::kRadarSilent));
  fly(seconds(2));
  EXPECT_EQ(health().state, HealthState::kOk);
}

// Scans of which nothing is used tell no more than silence.
TEST_F(HealthMonitorTest, EmptyScansAreSilence) {
  fly(seconds(3));
  scan_ = UpdateReport{};
  fly(milliseconds(1200));
  EXPECT_EQ(health().state, HealthState::kDeadReckoning);
}

// What other sensors measure does not replace the radar.
TEST_F(HealthMonitorTest, OtherSensorsDoNotHideASilence) {
  UpdateReport height;
  height.models[static_cast<std::size_t>(Model::kAiding)].rows_used = 5;
  const UpdateReport scan = std::exchange(scan_, height);
  fly(seconds(1));
  EXPECT_EQ(health().state, HealthState::kInitializing);
  scan_ = scan;
  fly(seconds(3));
  EXPECT_EQ(health().state, HealthState::kOk);
  scan_ = height;
  fly(milliseconds(1200));
  EXPECT_EQ(health().state, HealthState::kDeadReckoning);
}

TEST_F(HealthMonitorTest, OutliersAndGatedMeasurementsDegrade) {
  fly(seconds(3));
  scan_.static_detections = 2;
  fly(seconds(3));
  EXPECT_EQ(health().state, HealthState::kDegraded);
  EXPECT_TRUE(health().because(HealthReason::kOutliers));
  scan_.static_detections = 18;
  scan_.models[0].rows_gated = 18;
  fly(seconds(5));
  EXPECT_FALSE(health().because(HealthReason::kOutliers));
  EXPECT_TRUE(health().because(HealthReason::kGated));
  EXPECT_NEAR(monitor_.unusual_gated_share(), 0.5, 0.01);
  scan_.models[0].rows_gated = 0;
  scan_.models[0].nis = 60.0;
  fly(seconds(5));
  EXPECT_FALSE(health().because(HealthReason::kGated));
  EXPECT_EQ(monitor_.unusual_gated_share(), 0.0);
  EXPECT_TRUE(health().because(HealthReason::kInnovations));
  EXPECT_EQ(health().heading, HealthState::kOk);
}

TEST_F(HealthMonitorTest, OtherSensorsContradictWhenGatedOrBeyondTheirNoise) {
  ModelReport& aiding = scan_.models[static_cast<std::size_t>(Model::kAiding)];
  aiding.rows_used = 1;
  aiding.nis = 1.0;
  fly(seconds(3));
  EXPECT_FALSE(health().because(HealthReason::kAiding));
  aiding.nis = 3.0;  // none is gated, but their noise is not what it is said to be
  fly(seconds(30));
  EXPECT_TRUE(health().because(HealthReason::kAiding));
  EXPECT_EQ(health().state, HealthState::kDegraded);
  aiding.nis = 1.0;
  fly(seconds(40));
  EXPECT_FALSE(health().because(HealthReason::kAiding));
  aiding.rows_gated = 1;  // every second one
  fly(seconds(30));
  EXPECT_TRUE(health().because(HealthReason::kAiding));
}

// A contradiction degrades at once, and loses the estimate when it lasts.
TEST_F(HealthMonitorTest, ContradictionLosesInTheEnd) {
  fly(seconds(3));
  scan_.velocity_contradicted = 0.6;
  fly(kPeriod);
  EXPECT_EQ(health().velocity, HealthState::kDegraded);
  scan_.velocity_contradicted = 2.1;
  fly(kPeriod);
  EXPECT_EQ(health().velocity, HealthState::kLost);
  EXPECT_EQ(health().heading, HealthState::kOk);
  scan_.velocity_contradicted = 0.0;
  scan_.tilt_contradicted = 0.8;
  fly(kPeriod);
  EXPECT_EQ(health().heading, HealthState::kDegraded);
  EXPECT_TRUE(health().because(HealthReason::kTiltContradicted));
}

TEST_F(HealthMonitorTest, StepsAreCountedAndForgotten) {
  fly(seconds(3));
  const int before = health().reset_counter;
  scan_.attitude_reset = true;
  fly(kPeriod);
  EXPECT_EQ(health().reset_counter, before + 1);
  EXPECT_EQ(health().state, HealthState::kDegraded);
  fly(3 * kPeriod);  // again and again: nothing holds
  EXPECT_EQ(health().state, HealthState::kLost);
  scan_.attitude_reset = false;
  fly(seconds(10));
  EXPECT_EQ(health().state, HealthState::kOk);
  monitor_.reset(x_.nav.time);
  EXPECT_EQ(health().reset_counter, before + 5);
  EXPECT_EQ(health().state, HealthState::kInitializing);
}

TEST_F(HealthMonitorTest, EachSigmaHasItsPart) {
  fly(seconds(3));
  const auto with_sigma = [&](const Vector3d& axis, int block, double sigma) {
    const BodyCovariance before = P_;
    P_.block<3, 3>(block, block) += sigma * sigma * axis * axis.transpose();
    fly(kPeriod);
    P_ = before;
  };
  with_sigma(Vector3d::UnitZ(), body::kAttitude, 0.2);
  EXPECT_EQ(health().heading, HealthState::kDegraded);
  EXPECT_EQ(health().velocity, HealthState::kOk);
  with_sigma(Vector3d::UnitX(), body::kAttitude, 0.1);
  EXPECT_TRUE(health().because(HealthReason::kUncertainTilt));
  EXPECT_FALSE(health().because(HealthReason::kUncertainHeading));
  with_sigma(Vector3d::UnitX(), body::kVelocity, 0.6);
  EXPECT_EQ(health().velocity, HealthState::kDegraded);
  EXPECT_EQ(health().heading, HealthState::kOk);
  with_sigma(Vector3d::UnitX(), body::kVelocity, 2.1);
  EXPECT_EQ(health().velocity, HealthState::kLost);
  with_sigma(Vector3d::UnitY(), body::kPosition, 1.1);
  EXPECT_EQ(health().position, HealthState::kDegraded);
  EXPECT_EQ(health().velocity, HealthState::kOk);
  x_.distance_travelled = 100.0;  // a metre is little after a long way
  with_sigma(Vector3d::UnitY(), body::kPosition, 1.1);
  EXPECT_EQ(health().position, HealthState::kOk);
}

TEST_F(HealthMonitorTest, PausesOfTheImu) {
  fly(seconds(3));
  monitor_.add_gap(milliseconds(100));
  be_silent(milliseconds(10));
  EXPECT_EQ(health().state, HealthState::kOk);
  monitor_.add_gap(milliseconds(400));
  be_silent(milliseconds(10));
  EXPECT_EQ(health().heading, HealthState::kDegraded);
  fly(seconds(2));
  EXPECT_EQ(health().state, HealthState::kOk);
  monitor_.wait(x_.nav.time, milliseconds(1500), x_, P_);  // scans arrive, samples do not
  EXPECT_TRUE(health().because(HealthReason::kImuGaps));
}

TEST_F(HealthMonitorTest, AClockThatWasChanged) {
  CalibrationReport& offset = scan_.calibration[static_cast<std::size_t>(Calibration::kTimeOffset)];
  offset = {0.0, 0.03, 0.03, Observability::kUnobserved};
  fly(seconds(3));
  // found: within the sigma of before
  offset = {0.02, 0.002, 0.03, Observability::kObserved};
  fly(seconds(12));
  EXPECT_EQ(health().state, HealthState::kOk);
  offset.value = 0.029;  // 4.5 sigmas
  fly(kPeriod);
  EXPECT_EQ(health().state, HealthState::kOk);
  offset.value = 0.031;
  fly(kPeriod);
  EXPECT_TRUE(health().because(HealthReason::kCalibration));
  EXPECT_EQ(health().position, HealthState::kDegraded);
  EXPECT_EQ(health().heading, HealthState::kOk);
  scan_.radar = 1;  // another radar does not take it back
  offset.value = 0.0;
  fly(seconds(5));
  EXPECT_TRUE(health().because(HealthReason::kCalibration));
  scan_.radar = 0;
  offset.value = 0.031;
  fly(seconds(12));
  EXPECT_EQ(health().state, HealthState::kOk);
}

TEST_F(HealthMonitorTest, TheRest) {
  fly(seconds(3));
  CalibrationReport& scale =
      scan_.calibration[static_cast<std::size_t>(Calibration::kDopplerScale)];
  scale = {0.04, 0.002, 0.01, Observability::kDoubtful};
  fly(kPeriod);
  EXPECT_EQ(health().state, HealthState::kOk);
  EXPECT_LT(health().quality, 65);
  scale = {0.05, 0.002, 0.01, Observability::kAtLimit};
  fly(kPeriod);
  EXPECT_TRUE(health().because(HealthReason::kCalibration));
  scale = {};
  scan_.status = Status::kNumerical;
  fly(kPeriod);
  EXPECT_TRUE(health().because(HealthReason::kNumerical));
  scan_.status = Status::kOk;
  x_.nav.v_WB.x() = 31.0;
  fly(kPeriod);
  EXPECT_TRUE(health().because(HealthReason::kTooFast));
}

}  // namespace
}  // namespace rio::test
