// SPDX-License-Identifier: BSD-3-Clause
// The motion at which the calibration is linearised: it follows the body, not the noise of the IMU,
// and noise then tells nothing about the mounting.
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
  filter.advance(NavState{}, NavState{}, Vector3d::Zero(), 0.0, density, 0.0);
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

TEST(SteadyMotion, TheAccelerationIsWithoutTheVibrationOfRotors) {
  SteadyMotionFilter filter;
  double largest = 0.0;
  for (int i = 0; i < 1000; ++i) {
    filter.add(1e-3 * 10.0 * std::sin(2.0 * M_PI * 100.0 * i * 1e-3) * Vector3d::UnitX(), 1e-3);
    if (i > 500) largest = std::max(largest, acceleration(filter, 0.0).norm());
  }
  EXPECT_LT(largest, 10.0 / std::pow(2.0 * M_PI * 100.0 * 0.05, 2) * 1.2);
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
  EXPECT_NEAR(filter.motion().v_B.x(), 2.0 + 0.5 * 0.1 / 2.1, 1e-9);  // (E3)
  EXPECT_FALSE(follows(3.5, 0.24));
}

/// A body whose velocity is predicted with white noise and corrected exactly by scans at 10 Hz.
class Flight {
 public:
  static constexpr double kPeriod = 0.1;
  static constexpr int kSamples = 20;  // of the IMU in a period

  explicit Flight(double density, double rate_variance = 0.0, std::uint64_t seed = 1)
      : density_(density), rate_variance_(rate_variance), random_(seed, 1) {}

  /// A period at this acceleration and rate; afterwards predicted() is to be corrected.
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
    filter_.advance(before, after, measured, kPeriod, density_, rate_variance_);
    v_W_ += kPeriod * accel_W;
    state_ = after;
  }
  const NavState& predicted() const { return state_; }
  void correct(const Vector3d& v_W) { state_.v_WB = v_W; }
  void correct() { correct(v_W_); }
  void start(const Vector3d& v_B) {
    v_W_ = state_.q_WB * v_B;
    correct();
    filter_.reset(v_B);
  }
  const SteadyMotion& steady() const { return filter_.motion(); }
  Vector3d v_B() const { return state_.q_WB.conjugate() * v_W_; }
  sim::Random& random() { return random_; }

 private:
  double density_;
  double rate_variance_;
  sim::Random random_;
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

TEST(SteadyMotion, TurnsWithTheBody) {
  Flight flight(1.0);
  flight.start({3.0, 0.0, 0.0});
  for (int i = 0; i < 50; ++i) {
    flight.fly(Vector3d::Zero(), {0.3, 0.2, 1.0});
    flight.correct();
  }
  EXPECT_GT((flight.v_B() - Vector3d(3.0, 0.0, 0.0)).norm(), 1.0);
  EXPECT_LT((flight.steady().v_B - flight.v_B()).norm(), 1e-9);
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
  // the mean of T: sqrt(pull / (2 - pull)) of a sample
  EXPECT_LT(std::sqrt(rate), 0.2 * kRateSigma);
}

/// Velocity of a body and rotation of its radar from the velocity that the radar measures.
class MountingFilter {
 public:
  static constexpr double kPrior = 0.05;  // [rad]
  static constexpr double kNoise = 0.02;  // of the measured velocity [m/s]
  static constexpr double kDensity = 1.0;
  static constexpr int kScans = 1000;

  MountingFilter() {
    P_.diagonal().head<3>().setConstant(1e-4);
    P_.diagonal().tail<3>().setConstant(kPrior * kPrior);
  }
  /// A thousand scans at constant velocity.
  void run(bool steady, std::uint64_t seed) {
    Flight flight(kDensity, 0.0, seed);
    const Vector3d v(2.0, 0.0, 0.0);
    flight.start(v);
    const Vector3d mounting = kPrior * flight.random().normal3();
    for (int i = 0; i < kScans; ++i) {
      flight.fly(Vector3d::Zero(), Vector3d::Zero());
      P_.diagonal().head<3>().array() += kDensity * Flight::kPeriod;
      const Vector3d predicted = flight.predicted().v_WB;
      Eigen::Matrix<double, 3, 6> H;
      H << Matrix3d::Identity(), skew(steady ? flight.steady().v_B : predicted);
      const Vector3d z = v + v.cross(mounting) + kNoise * flight.random().normal3();
      const Vector3d r = z - predicted - predicted.cross(rotation_);
      const Eigen::Matrix<double, 6, 3> PHt = P_ * H.transpose();
      const Matrix3d S = H * PHt + kNoise * kNoise * Matrix3d::Identity();
      const Eigen::Matrix<double, 6, 3> K = PHt * S.inverse();
      const Eigen::Matrix<double, 6, 1> dx = K * r;
      P_ -= K * PHt.transpose();
      P_ = 0.5 * (P_ + P_.transpose().eval());
      rotation_ += dx.tail<3>();
      flight.correct(predicted + dx.head<3>());
    }
    error_ = rotation_ - mounting;
  }
  /// About the axis of pitch.
  double sigma() const { return std::sqrt(P_(4, 4)); }
  double error() const { return error_.y(); }

 private:
  Eigen::Matrix<double, 6, 6> P_ = Eigen::Matrix<double, 6, 6>::Zero();
  Vector3d rotation_ = Vector3d::Zero();
  Vector3d error_ = Vector3d::Zero();
};

// (E1). Linearised at the prediction, noise tells the pitch to 0.9 deg, which it is not known to:
// four per scan, because dv is the difference of the noise of two predictions.
TEST(SteadyMotion, NoiseTellsNothingAboutTheMounting) {
  constexpr int kSeeds = 20;
  const auto information = [](double sigma) {
    const double prior = MountingFilter::kPrior;
    return (1.0 / (sigma * sigma) - 1.0 / (prior * prior)) / MountingFilter::kScans;
  };
  double claimed = 0.0;
  double steady_claimed = 0.0;
  double nees = 0.0;
  double steady_nees = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    MountingFilter exact;
    exact.run(false, seed);
    claimed += information(exact.sigma()) / kSeeds;
    nees += std::pow(exact.error() / exact.sigma(), 2) / kSeeds;
    MountingFilter steady;
    steady.run(true, seed);
    steady_claimed += information(steady.sigma()) / kSeeds;
    steady_nees += std::pow(steady.error() / steady.sigma(), 2) / kSeeds;
    EXPECT_LT(std::abs(steady.error()), 3.0 * steady.sigma()) << seed;
    EXPECT_GT(steady.sigma(), 0.95 * MountingFilter::kPrior) << seed;
  }
  EXPECT_NEAR(claimed, 4.0, 0.2);
  EXPECT_LT(steady_claimed, 0.2);
  EXPECT_GT(nees, 3.0);
  EXPECT_LT(steady_nees, 1.9);  // 20 seeds: three sigmas
}

}  // namespace
}  // namespace rio::test
