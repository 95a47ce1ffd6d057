// SPDX-License-Identifier: BSD-3-Clause
// The motion at which the calibration is linearised: it follows the body, not the noise of the IMU.
#include "rio/propagate/steady_motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "rio/core/so3.hpp"
#include "rio/sim/random.hpp"
#include "support/random_state.hpp"

namespace rio::test {
namespace {

constexpr double kMemory = 0.05;  // m of (E2) [s]

/// The motion after a step of no time: the smoothed acceleration, if noise does not explain it.
Vector3d acceleration(SteadyMotionFilter filter, double density) {
  filter.advance(NavState{}, NavState{}, Vector3d::Zero(), 0.0, density, 0.0, 0.0);
  return filter.motion().accel_W;
}

// A low-pass of second order with a memory of 0.05 s: 1 - (1 + t / m) exp(-t / m) of a step.
TEST(SteadyMotion, TheAccelerationFollowsAStepWithinItsMemory) {
  for (const double dt : {1e-3, 0.25e-3}) {
    SteadyMotionFilter filter;
    double t = 0.0;
    while (t < 0.3) {
      filter.add(dt * Vector3d(2.0, -1.0, 0.5), dt);
      t += dt;
      const double expected = 1.0 - (1.0 + t / kMemory) * std::exp(-t / kMemory);
      const Vector3d a = acceleration(filter, 0.0);
      EXPECT_NEAR(a.x(), 2.0 * expected, 15.0 * dt) << t;  // of first order in dt
      EXPECT_NEAR(a.y() / a.x(), -0.5, 1e-9);
    }
  }
}

// A start in motion: the scans that determine the velocity move it by metres per second, which is
// no noise to be smoothed; once it is known, and a scan later, it is smoothed.
TEST(SteadyMotion, UnknownVelocityIsFollowedAtOnce) {
  NavState nav;
  SteadyMotionFilter filter;
  const auto follows = [&](double v, double variance) {
    nav.v_WB.x() = v;
    filter.advance(nav, nav, Vector3d::Zero(), 0.1, 0.0, 0.0, variance);
    return std::abs(filter.motion().v_B.x() - v) < 1e-9;
  };
  EXPECT_TRUE(follows(3.0, 9.0));
  EXPECT_TRUE(follows(-1.0, 0.26));  // the scan before has corrected it
  EXPECT_TRUE(follows(2.0, 0.01));   // that of this correction
  EXPECT_FALSE(follows(2.5, 0.01));
  EXPECT_NEAR(filter.motion().v_B.x(), 2.0 + 0.5 * 0.1 / 1.1, 1e-9);  // (E3)
  EXPECT_FALSE(follows(3.5, 0.24));
}

/// A body whose velocity is predicted with white noise and corrected exactly by scans at 10 Hz.
class Flight {
 public:
  static constexpr double kPeriod = 0.1;
  static constexpr int kSamples = 20;  // of the IMU in a period

  explicit Flight(double density, double rate_variance = 0.0)
      : density_(density), rate_variance_(rate_variance) {}

  /// A period at this acceleration and rate; afterwards the prediction is to be corrected.
  void fly(const Vector3d& accel_W, const Vector3d& rate_B) {
    constexpr double kStep = kPeriod / kSamples;
    const NavState before = state_;
    NavState after = before;
    for (int i = 0; i < kSamples; ++i) {
      const Vector3d noise = std::sqrt(density_ * kStep) * random_.normal3();
      const Vector3d change = kStep * accel_W + noise;
      after.v_WB += change;
      filter_.add(change, kStep);
    }
    after.q_WB = before.q_WB * quaternion_exp(kPeriod * rate_B);
    const Vector3d measured = rate_B + std::sqrt(rate_variance_) * random_.normal3();
    filter_.advance(before, after, measured, kPeriod, density_, rate_variance_, 0.0);
    v_W_ += kPeriod * accel_W;
    state_ = after;
  }
  void correct() { state_.v_WB = v_W_; }
  void start(const Vector3d& v_B) {
    v_W_ = state_.q_WB * v_B;
    correct();
    filter_.reset(v_B);
  }
  const SteadyMotion& steady() const { return filter_.motion(); }
  Vector3d v_B() const { return state_.q_WB.conjugate() * v_W_; }

 private:
  double density_;
  double rate_variance_;
  sim::Random random_{1, 1};
  NavState state_;
  Vector3d v_W_ = Vector3d::Zero();
  SteadyMotionFilter filter_;
};

// The delay of two low-passes is 2 m; what it makes in velocity then decays with T.
TEST(SteadyMotion, FollowsTheAccelerationOfABodyWithAGoodImu) {
  const Vector3d accel_W(2.0, -1.0, 0.5);
  const Vector3d rate_B(0.2, -0.4, 0.5);
  Flight flight(1e-5, 1e-6);
  flight.start({1.0, 0.0, 0.0});
  for (int i = 0; i < 100; ++i) {
    const double sign = i < 20 || i >= 60 ? 0.0 : (i < 40 ? 1.0 : -1.0);
    flight.fly(sign * accel_W, i < 50 ? rate_B : Vector3d(-rate_B));
    EXPECT_LT((flight.steady().v_B - flight.v_B()).norm(), 2.0 * 2.0 * kMemory * accel_W.norm())
        << i;
    EXPECT_LT((flight.steady().rate_B - (i < 50 ? rate_B : Vector3d(-rate_B))).norm(), 0.01) << i;
    flight.correct();
  }
  EXPECT_LT((flight.steady().v_B - flight.v_B()).norm(), 0.1);
}

// The acceleration of a turn, 3 m/s^2, is hidden by the noise of the accelerometer.
TEST(SteadyMotion, TheVelocityOfAVehicleThatVibratesTurnsWithTheBody) {
  const Vector3d v_B(3.0, 0.0, 0.0);
  const Vector3d rate_B(0.3, 0.2, 1.0);
  Flight flight(1.0);
  flight.start(v_B);
  Quaternion q_WB = Quaternion::Identity();
  for (int i = 0; i < 50; ++i) {
    const Quaternion next = q_WB * quaternion_exp(Flight::kPeriod * rate_B);
    flight.fly((next * v_B - q_WB * v_B) / Flight::kPeriod, rate_B);
    flight.correct();
    q_WB = next;
    EXPECT_LT((flight.steady().v_B - v_B).norm(), 1e-9) << i;
  }
}

// A good one sees that there is none.
TEST(SteadyMotion, TheVelocityOfABodyThatOnlyTurnsStaysInTheWorld) {
  Flight flight(1e-5);
  flight.start({3.0, 0.0, 0.0});
  for (int i = 0; i < 50; ++i) {
    flight.fly(Vector3d::Zero(), {0.3, 0.2, 1.0});
    flight.correct();
    EXPECT_LT((flight.steady().v_B - flight.v_B()).norm(), 0.01) << i;
  }
  EXPECT_GT((flight.v_B() - Vector3d(3.0, 0.0, 0.0)).norm(), 1.0);
}

TEST(SteadyMotion, DoesNotFollowTheNoiseOfSingleScans) {
  constexpr double kRateSigma = 0.1;
  Flight flight(1.0, kRateSigma * kRateSigma);
  const Vector3d v_B(2.0, 0.0, 0.0);
  flight.start(v_B);
  double velocity = 0.0;
  double rate = 0.0;
  constexpr int kScans = 2000;
  for (int i = 0; i < kScans; ++i) {
    flight.fly(Vector3d::Zero(), Vector3d::Zero());
    velocity += (flight.steady().v_B - v_B).squaredNorm() / (3.0 * kScans);
    rate += flight.steady().rate_B.squaredNorm() / (3.0 * kScans);
    flight.correct();
  }
  EXPECT_LT(std::sqrt(velocity), 1e-3 * std::sqrt(Flight::kPeriod));
  constexpr double kPull = Flight::kPeriod / (1.0 + Flight::kPeriod);  // of the mean of T
  EXPECT_LT(std::sqrt(rate), 1.1 * std::sqrt(kPull / (2.0 - kPull)) * kRateSigma);
}

}  // namespace
}  // namespace rio::test
