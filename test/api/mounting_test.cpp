// SPDX-License-Identifier: BSD-3-Clause
// A radar whose mounting is unknown: found in flight, with either back-end.
#include "api/flying.hpp"
#include "rio/core/so3.hpp"
#include "support/measured.hpp"

namespace rio::test {
namespace {

using experiment::replay;
using experiment::Step;
using experiment::Trial;

class UnknownMounting : public IndoorTest<45> {
 protected:
  /// Nothing is known, not even the position of the radar.
  static Options unknown() {
    Options o = options();
    experiment::forget_mounting(o);
    return o;
  }
  static double error_of(const Trial& trial) {
    const Step& last = trial.steps.back();
    return (last.estimate.p_WB - last.truth.p_WB).norm();
  }
  static double turn_from_truth(const Odometry& odometry) {
    const Quaternion& truth = flight().scenario.radar.T_BS.rotation;
    return quaternion_log(truth.conjugate() * odometry.extrinsics().rotation).norm();
  }
};

TEST_P(UnknownMounting, EndsNearlyAsWithTheRightOne) {
  const auto right = Odometry::create(options());
  const auto none = Odometry::create(unknown());
  int searching = 0;
  int known = 0;
  HealthState worst = HealthState::kInitializing;
  const Trial with = replay(flight(), *right);
  const Trial without = replay(flight(), *none, [&](const UpdateReport& report) {
    if (report.mounting_unknown) {
      ++searching;
      EXPECT_EQ(known, 0) << "found, and lost again";
      EXPECT_EQ(report.health.state, HealthState::kInitializing);
      EXPECT_EQ(report.models[static_cast<std::size_t>(Model::kDoppler)].rows_used, 0);
    } else {
      ++known;
      if (known > 30) worst = std::max(worst, report.health.state);
    }
  });
  EXPECT_GT(searching, 30);
  EXPECT_LT(searching, 250);  // the standstill before take-off is a quarter of it
  EXPECT_EQ(worst, HealthState::kOk);
  EXPECT_LT(turn_from_truth(*none), 0.01);
  EXPECT_LT((none->extrinsics().translation - flight().scenario.radar.T_BS.translation).norm(),
            0.03);
  measured("final error, mounting known", error_of(with), "[m]");
  expect_below("final error, nothing known of it [m]", error_of(without), 0.3);
}

TEST_P(UnknownMounting, IsKeptThroughAStartFromAKnownStateButNotThroughAReset) {
  const auto odometry = Odometry::create(unknown());
  (void)replay(flight(), *odometry);
  const Quaternion found = odometry->extrinsics().rotation;
  ASSERT_EQ(odometry->reset(odometry->now(), odometry->covariance()), Status::kOk);
  EXPECT_LT(quaternion_log(found.conjugate() * odometry->extrinsics().rotation).norm(), 0.5);
  odometry->reset();
  EXPECT_EQ(quaternion_log(odometry->extrinsics().rotation).norm(), 0.0);
}

TEST_P(UnknownMounting, ARadarThatDoesNotMoveIsNotUsed) {
  const sim::Flight standing = sim::simulate_flight({.max_duration = 3.5});  // before take-off
  const auto odometry = Odometry::create(unknown());
  const Trial trial = replay(standing, *odometry);
  EXPECT_TRUE(odometry->report().mounting_unknown);
  EXPECT_GT(odometry->report().models[static_cast<std::size_t>(Model::kRest)].rows_used, 0);
  EXPECT_LT(error_of(trial), 0.05);
}

INSTANTIATE_TEST_SUITE_P(BackEnds, UnknownMounting, kBothBackEnds, back_end_name);

}  // namespace
}  // namespace rio::test
