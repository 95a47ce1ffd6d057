// SPDX-License-Identifier: BSD-3-Clause
// What makes which part of the estimate degraded, dead reckoning or lost, and how it heals.
#include "rio/checks/health_monitor.hpp"

#include <gtest/gtest.h>

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
  const Health& after(Time duration) {
    fly(duration);
    return health();
  }
  const Health& after_silence(Time duration) {
    monitor_.wait(x_.nav.time + duration, Time{0}, x_, P_);
    return health();
  }

  const Health& health() const { return monitor_.health(); }
  bool because(HealthReason reason) const { return health().because(reason); }
  ModelReport& of(Model model) { return scan_.models[static_cast<std::size_t>(model)]; }
  CalibrationReport& of(Calibration parameter) {
    return scan_.calibration[static_cast<std::size_t>(parameter)];
  }

  HealthMonitor monitor_;
  UpdateReport scan_;
  Estimate x_;
  BodyCovariance P_;
};

TEST_F(HealthMonitorTest, BeginsWithTheFirstScanThatTellsAVelocity) {
  EXPECT_EQ(health().state, HealthState::kInitializing);
  scan_.models[0].rows_used = 1;
  scan_.models[0].nis = 1.0;
  EXPECT_EQ(after(2 * kPeriod).state, HealthState::kInitializing);
  scan_.models[0].rows_used = 18;
  scan_.mounting_unknown = true;
  EXPECT_EQ(after(seconds(1)).state, HealthState::kInitializing);
  scan_.mounting_unknown = false;
  EXPECT_EQ(after(kPeriod).state, HealthState::kOk);
  EXPECT_EQ(after(seconds(2)).state, HealthState::kOk);
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

TEST_F(HealthMonitorTest, SilenceIsDeadReckoningOfPositionAndVelocity) {
  fly(seconds(3));
  EXPECT_EQ(after_silence(milliseconds(900)).state, HealthState::kOk);
  EXPECT_EQ(after_silence(milliseconds(1100)).state, HealthState::kDeadReckoning);
  EXPECT_EQ(health().position, HealthState::kDeadReckoning);
  EXPECT_EQ(health().velocity, HealthState::kDeadReckoning);
  EXPECT_EQ(health().heading, HealthState::kOk);
  EXPECT_TRUE(because(HealthReason::kRadarSilent));
  EXPECT_EQ(after(seconds(2)).state, HealthState::kOk);
}

// Nor do scans of which nothing is used, or what other sensors measure, tell more than silence.
TEST_F(HealthMonitorTest, WithoutTheRadarItNeitherBeginsNorStaysOk) {
  const UpdateReport scan = scan_;
  UpdateReport height;
  height.models[static_cast<std::size_t>(Model::kAiding)].rows_used = 5;
  for (const UpdateReport& other : {UpdateReport{}, height}) {
    monitor_.reset(x_.nav.time);
    scan_ = other;
    EXPECT_EQ(after(seconds(1)).state, HealthState::kInitializing);
    scan_ = scan;
    EXPECT_EQ(after(seconds(3)).state, HealthState::kOk);
    scan_ = other;
    EXPECT_EQ(after(milliseconds(1200)).state, HealthState::kDeadReckoning);
  }
}

// The others go on: it is told, and no doubt of the estimate.
TEST_F(HealthMonitorTest, OneOfSeveralRadarsIsSilent) {
  monitor_ = HealthMonitor(3);
  monitor_.reset(Time{0});
  for (int i = 0; i < 60; ++i) {
    scan_.radar = i < 20 ? static_cast<std::size_t>(i % 3) : static_cast<std::size_t>(i % 2);
    fly(kPeriod);
    EXPECT_EQ(because(HealthReason::kOneRadarSilent), i >= 37) << i;
  }
  EXPECT_EQ(health().state, HealthState::kOk);
  EXPECT_GT(health().quality, 75);
  scan_.radar = 2;
  EXPECT_FALSE(after(kPeriod).because(HealthReason::kOneRadarSilent));
  monitor_.reset(x_.nav.time);
  EXPECT_FALSE(because(HealthReason::kOneRadarSilent));
}

TEST_F(HealthMonitorTest, OutliersAndGatedMeasurementsDegrade) {
  fly(seconds(3));
  scan_.static_detections = 2;
  EXPECT_EQ(after(seconds(3)).state, HealthState::kDegraded);
  EXPECT_TRUE(because(HealthReason::kOutliers));
  scan_.static_detections = 18;
  scan_.models[0].rows_gated = 18;
  EXPECT_FALSE(after(seconds(5)).because(HealthReason::kOutliers));
  EXPECT_TRUE(because(HealthReason::kGated));
  EXPECT_NEAR(monitor_.unusual_gated_share(), 0.5, 0.01);
  scan_.models[0].rows_gated = 0;
  scan_.models[0].nis = 60.0;
  EXPECT_FALSE(after(seconds(5)).because(HealthReason::kGated));
  EXPECT_EQ(monitor_.unusual_gated_share(), 0.0);
  EXPECT_TRUE(because(HealthReason::kInnovations));
  EXPECT_EQ(health().heading, HealthState::kOk);
}

TEST_F(HealthMonitorTest, GatesThatRejectForLongLoseTheEstimate) {
  fly(seconds(3));
  scan_.models[0].rows_gated = 18;
  EXPECT_EQ(after(seconds(8)).state, HealthState::kDegraded);
  EXPECT_EQ(after(seconds(4)).state, HealthState::kLost);
  EXPECT_EQ(health().heading, HealthState::kOk);
  scan_.models[0].rows_gated = 0;
  EXPECT_EQ(after(seconds(2)).state, HealthState::kOk);
}

TEST_F(HealthMonitorTest, OtherSensorsContradictWhenGatedOrBeyondTheirNoise) {
  ModelReport& aiding = of(Model::kAiding);
  aiding.rows_used = 1;
  aiding.nis = 1.0;
  EXPECT_FALSE(after(seconds(3)).because(HealthReason::kAiding));
  aiding.nis = 3.0;  // none is gated, but their noise is not what it is said to be
  EXPECT_TRUE(after(seconds(30)).because(HealthReason::kAiding));
  EXPECT_EQ(health().state, HealthState::kDegraded);
  aiding.nis = 1.0;
  EXPECT_FALSE(after(seconds(40)).because(HealthReason::kAiding));
  aiding.rows_gated = 1;  // every second one
  EXPECT_TRUE(after(seconds(30)).because(HealthReason::kAiding));
}

// A contradiction degrades at once, and loses the estimate when it lasts.
TEST_F(HealthMonitorTest, ContradictionLosesInTheEnd) {
  fly(seconds(3));
  scan_.velocity_contradicted = 0.6;
  EXPECT_EQ(after(kPeriod).velocity, HealthState::kDegraded);
  scan_.velocity_contradicted = 2.1;
  EXPECT_EQ(after(kPeriod).velocity, HealthState::kLost);
  EXPECT_EQ(health().heading, HealthState::kOk);
  scan_.velocity_contradicted = 0.0;
  scan_.tilt_contradicted = 0.8;
  EXPECT_EQ(after(kPeriod).heading, HealthState::kDegraded);
  EXPECT_TRUE(because(HealthReason::kTiltContradicted));
}

TEST_F(HealthMonitorTest, StepsAreCountedAndForgotten) {
  fly(seconds(3));
  const int before = health().reset_counter;
  scan_.attitude_reset = true;
  EXPECT_EQ(after(kPeriod).reset_counter, before + 1);
  EXPECT_EQ(health().state, HealthState::kDegraded);
  EXPECT_EQ(after(3 * kPeriod).state, HealthState::kLost);  // again and again: nothing holds
  scan_.attitude_reset = false;
  EXPECT_EQ(after(seconds(10)).state, HealthState::kOk);
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
  EXPECT_TRUE(because(HealthReason::kUncertainTilt));
  EXPECT_FALSE(because(HealthReason::kUncertainHeading));
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
  EXPECT_EQ(after_silence(milliseconds(10)).state, HealthState::kOk);
  monitor_.add_gap(milliseconds(400));
  EXPECT_EQ(after_silence(milliseconds(10)).heading, HealthState::kDegraded);
  EXPECT_EQ(after(seconds(2)).state, HealthState::kOk);
  monitor_.add_gap(milliseconds(350));  // has passed when it is told
  (void)after_silence(milliseconds(350));
  EXPECT_TRUE(because(HealthReason::kImuGaps));
  EXPECT_EQ(after(seconds(2)).state, HealthState::kOk);
  monitor_.wait(x_.nav.time, milliseconds(1100), x_, P_);  // scans arrive, samples do not
  EXPECT_TRUE(because(HealthReason::kImuGaps));
  EXPECT_EQ(health().heading, HealthState::kDegraded);
  monitor_.wait(x_.nav.time, milliseconds(1300), x_, P_);
  EXPECT_EQ(health().heading, HealthState::kLost);
}

TEST_F(HealthMonitorTest, AClockThatWasChanged) {
  CalibrationReport& offset = of(Calibration::kTimeOffset);
  offset = {0.0, 0.03, 0.03, Observability::kUnobserved};
  fly(seconds(3));
  // found: within the sigma of before
  offset = {0.02, 0.002, 0.03, Observability::kObserved};
  EXPECT_EQ(after(seconds(12)).state, HealthState::kOk);
  offset.value = 0.029;  // 4.5 sigmas
  EXPECT_EQ(after(kPeriod).state, HealthState::kOk);
  offset.value = 0.031;
  EXPECT_TRUE(after(kPeriod).because(HealthReason::kCalibration));
  EXPECT_EQ(health().position, HealthState::kDegraded);
  EXPECT_EQ(health().heading, HealthState::kOk);
  scan_.radar = 1;  // another radar does not take it back
  offset.value = 0.0;
  EXPECT_TRUE(after(seconds(5)).because(HealthReason::kCalibration));
  scan_.radar = 0;
  offset.value = 0.031;
  EXPECT_EQ(after(seconds(12)).state, HealthState::kOk);
}

TEST_F(HealthMonitorTest, TheRest) {
  fly(seconds(3));
  CalibrationReport& scale = of(Calibration::kDopplerScale);
  scale = {0.04, 0.002, 0.01, Observability::kDoubtful};
  EXPECT_EQ(after(kPeriod).state, HealthState::kOk);
  EXPECT_LT(health().quality, 65);
  scale = {0.05, 0.002, 0.01, Observability::kAtLimit};
  EXPECT_TRUE(after(kPeriod).because(HealthReason::kCalibration));
  scale = {};
  scan_.status = Status::kNumerical;
  EXPECT_TRUE(after(kPeriod).because(HealthReason::kNumerical));
  scan_.status = Status::kOk;
  x_.nav.v_WB.x() = 31.0;
  EXPECT_TRUE(after(kPeriod).because(HealthReason::kTooFast));
}

}  // namespace
}  // namespace rio::test
