// SPDX-License-Identifier: BSD-3-Clause
// The life cycle of the checks on a back-end that only keeps a state: what each replaces, when, and
// what that makes void.
#include "rio/checks/checks.hpp"

#include <gtest/gtest.h>

#include "support/seen_vehicle.hpp"

namespace rio {
namespace {

using std::chrono::milliseconds;

/// Fulfils the contract with nothing but a state estimate.
class StateOnly {
 public:
  explicit StateOnly(const Options& options) : state_estimate_(options, 0) {}

  const Estimate& estimate() const { return state_estimate_.estimate(); }
  const StateEstimate& state_estimate() const { return state_estimate_; }
  void reset(const NavState& nav, const BodyCovariance& P0) { state_estimate_.reset(nav, P0); }
  void select_radar(std::size_t r) { state_estimate_.select_radar(r); }
  Status propagate(Time to, const ImuBuffer& imu, bool* gap) {
    return state_estimate_.propagate(to, imu, gap);
  }
  Time anchor(Time /*measured*/) const { return estimate().nav.time; }
  template <class Change>
  void replace(const Change& change, Invalidates also, UpdateReport* report) {
    replaced.push_back(also);
    if (also == Invalidates::kLandmarks) drop_landmarks(report);
    change(&state_estimate_);
  }
  /// As an update.
  template <class Change>
  void correct(const Change& change) {
    change(&state_estimate_);
  }
  void drop_landmarks(UpdateReport* /*report*/) { ++dropped; }
  Status update(const Observations& /*seen*/, const ScanRows& /*rows*/) { return Status::kOk; }
  void maintain_landmarks(const Observations&, const ScanRows&, const Promotions&, UpdateReport*) {}
  void clone(ScanId /*scan*/) {}

  std::vector<Invalidates> replaced;
  int dropped = 0;

 private:
  StateEstimate state_estimate_;
};

class ChecksTest : public testing::Test {
 protected:
  /// @param wrong_W error of the velocity in the state [m/s]
  void begin(const Vector3d& wrong_W, bool unconfirmed, double tilt_sigma = 0.002,
             const Vector3d& gyro_bias = Vector3d::Zero()) {
    vehicle_.emplace(options_, Vector3d(0.4, -0.3, 0.1), &random_);
    vehicle_->truth.time = Time(1'000'000'000);
    backend_.emplace(options_);
    report_ = UpdateReport{};
    checks_.emplace(options_, &*backend_, &report_);
    NavState start = vehicle_->truth;
    start.v_WB += wrong_W;
    start.gyro_bias = gyro_bias;
    BodyCovariance P = 1e-4 * BodyCovariance::Identity();
    P.diagonal().segment<3>(body::kAttitude).setConstant(tilt_sigma * tilt_sigma);
    backend_->reset(start, P);
    checks_->reset(start.time, unconfirmed);
  }
  /// One scan later.
  bool velocity_replaced() {
    const Time last = vehicle_->truth.time;
    vehicle_->advance();
    bool gap = false;
    EXPECT_EQ(backend_->propagate(vehicle_->truth.time, vehicle_->imu(), &gap), Status::kOk);
    checks_->carry(last, vehicle_->imu(), gap);
    return checks_->check_velocity(
        vehicle_->scan(12), backend_->state_estimate().radar_velocity_covariance(), last, false);
  }

  /// Scans until the velocity is replaced, 40 if it is not.
  int scans_to_replacement() {
    int scans = 0;
    while (scans < 40 && !velocity_replaced()) ++scans;
    return scans;
  }
  /// Whether a check widens the state within 200 updates that each move `at` a little along an
  /// axis, by far more in sum than its variance lets expect.
  bool widened_by_corrections(int at, const Vector3d& axis_W) {
    for (int i = 0; i < 200; ++i) {
      vehicle_->advance();
      bool gap = false;
      EXPECT_EQ(backend_->propagate(vehicle_->truth.time, vehicle_->imu(), &gap), Status::kOk);
      const auto set_variance = [&](double variance) {
        backend_->correct([&](StateEstimate* state) {
          state->covariance().matrix().block<3, 3>(at, at) = variance * Matrix3d::Identity();
        });
      };
      set_variance(1e-6);
      checks_->predicted();
      set_variance(0.99e-6);
      backend_->correct([&](StateEstimate* state) {
        NavState& x = state->estimate().nav;
        if (at == body::kVelocity) {
          x.v_WB += 0.01 * axis_W;
        } else {
          x.gyro_bias += x.q_WB.conjugate() * Vector3d(0.01 * axis_W);
        }
      });
      if (at == body::kVelocity ? checks_->check_biases() : checks_->check_heading()) return true;
    }
    return false;
  }
  double variance(int at) const { return backend_->state_estimate().covariance().body()(at, at); }

  test::Random random_{3};
  Options options_;
  std::optional<test::SeenVehicle> vehicle_;
  std::optional<StateOnly> backend_;
  UpdateReport report_;
  std::optional<Checks<StateOnly>> checks_;
};

TEST_F(ChecksTest, WrongVelocityIsReplacedOnceAndTakesTheLandmarksAlong) {
  begin(Vector3d(2.0, -1.0, 0.5), false);
  ASSERT_LT(scans_to_replacement(), 40);
  EXPECT_TRUE(report_.velocity_reset);
  EXPECT_EQ(backend_->replaced, std::vector<Invalidates>{Invalidates::kLandmarks});
  EXPECT_EQ(backend_->dropped, 1);
  EXPECT_LT((backend_->estimate().nav.v_WB - vehicle_->truth.v_WB).norm(), 0.3);
  EXPECT_EQ(scans_to_replacement(), 40) << "it is right now";
  EXPECT_EQ(report_.velocity_contradicted, 0.0);
}

// The bias of an alignment in motion goes, unless the Dopplers have confirmed the start.
TEST_F(ChecksTest, UnconfirmedAlignmentGoesWithItsVelocity) {
  begin(Vector3d(2.0, -1.0, 0.5), true, 0.002, Vector3d(0.01, 0.0, 0.0));
  const double before = variance(body::kGyroBias);
  ASSERT_LT(scans_to_replacement(), 40);
  EXPECT_EQ(backend_->replaced,
            (std::vector<Invalidates>{Invalidates::kNothing, Invalidates::kLandmarks}));
  EXPECT_LT(backend_->estimate().nav.gyro_bias.norm(), 1e-4);  // but for what the velocity tells
  EXPECT_GT(variance(body::kGyroBias),
            before + 0.9 * options_.start.sigma_gyro_bias * options_.start.sigma_gyro_bias);
}

TEST_F(ChecksTest, LandmarksGoAfterASilenceAGapOrWithTheTilt) {
  begin(Vector3d::Zero(), false);
  const Time start = vehicle_->truth.time;
  EXPECT_FALSE(checks_->check_landmarks(start + milliseconds(900), false));
  EXPECT_FALSE(checks_->check_landmarks(start + milliseconds(900), true));  // nor did it turn
  EXPECT_TRUE(checks_->check_landmarks(start + milliseconds(1100), false));
  checks_->saw_static_set(start + milliseconds(1100));
  EXPECT_FALSE(checks_->check_landmarks(start + milliseconds(1900), false));
  EXPECT_EQ(backend_->dropped, 1);
  begin(Vector3d::Zero(), false, 0.2);
  EXPECT_TRUE(checks_->check_landmarks(start + milliseconds(10), false));
}

TEST_F(ChecksTest, TiltIsLostWhereItIsNoLongerLinear) {
  begin(Vector3d::Zero(), false, 0.1);
  EXPECT_FALSE(checks_->tilt_is_lost());
  begin(Vector3d::Zero(), false, 0.4);
  EXPECT_TRUE(checks_->tilt_is_lost());
}

TEST_F(ChecksTest, PositionIsWidenedAfterADoubtfulTime) {
  begin(Vector3d::Zero(), false);
  HealthMonitor health;
  health.reset(vehicle_->truth.time);
  UpdateReport gated;
  gated.models[static_cast<std::size_t>(Model::kDoppler)].rows_gated = 40;
  health.observe(gated, backend_->estimate(), backend_->state_estimate().covariance().body());
  ASSERT_GT(health.unusual_gated_share(), 0.5);
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(checks_->check_position(health, 0.1));
  health.reset(vehicle_->truth.time);
  const double before = variance(body::kPosition);
  EXPECT_TRUE(checks_->check_position(health, 0.1));
  EXPECT_GT(report_.position_reopened, 0.5);
  EXPECT_NEAR(variance(body::kPosition) - before,
              report_.position_reopened * report_.position_reopened, 1e-12);
  EXPECT_EQ(backend_->replaced, std::vector<Invalidates>{Invalidates::kLandmarks});
}

// The velocity in all axes, the gyro bias about the vertical: gravity sees the others.
TEST_F(ChecksTest, WhatTheUpdatesCorrectForLongIsWidened) {
  const Vector3d up_W = Vector3d::UnitZ();
  for (const Vector3d& axis : {Vector3d(Vector3d::UnitX()), Vector3d(-Vector3d::UnitY()), up_W}) {
    begin(Vector3d::Zero(), false);
    const double bias = variance(body::kAccelBias);
    EXPECT_TRUE(widened_by_corrections(body::kVelocity, axis));
    EXPECT_TRUE(report_.velocity_reset);
    EXPECT_NEAR(variance(body::kAccelBias) - bias,
                options_.start.sigma_accel_bias * options_.start.sigma_accel_bias, 1e-5);
    EXPECT_EQ(backend_->replaced, std::vector<Invalidates>{Invalidates::kLandmarks});
  }

  begin(Vector3d::Zero(), false);
  EXPECT_FALSE(widened_by_corrections(body::kGyroBias, Vector3d::UnitX()));
  EXPECT_TRUE(widened_by_corrections(body::kGyroBias, up_W));
  EXPECT_TRUE(report_.attitude_reset);
}

TEST_F(ChecksTest, SwitchedOffTheyReplaceNothing) {
  options_.checks = {false, false, false, false, false, false, false};
  begin(Vector3d(2.0, -1.0, 0.5), true, 0.4);
  EXPECT_EQ(scans_to_replacement(), 40);
  EXPECT_FALSE(checks_->tilt_is_lost());
  EXPECT_FALSE(widened_by_corrections(body::kVelocity, Vector3d::UnitZ()));
  EXPECT_FALSE(widened_by_corrections(body::kGyroBias, Vector3d::UnitZ()));
  EXPECT_TRUE(backend_->replaced.empty());
}

}  // namespace
}  // namespace rio
