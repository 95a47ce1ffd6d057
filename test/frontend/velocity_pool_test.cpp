// SPDX-License-Identifier: BSD-3-Clause
#include "rio/frontend/velocity_pool.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "rio/propagate/strapdown.hpp"
#include "support/random_state.hpp"

namespace rio {
namespace {

using std::chrono::milliseconds;

// A vehicle that turns and accelerates as its IMU says, seen by a radar in scans of a few points.
class PoolTest : public testing::Test {
 protected:
  PoolTest() {
    options_.radar.max_doppler = kLimit;
    options_.radar.T_BS.translation = Vector3d(0.1, 0.05, -0.1);
    restart();
  }

  void restart() {
    pool_.emplace(options_);
    imu_.emplace(TimingOptions{}, options_.imu);
    truth_ = NavState{};
    truth_.q_WB = random_.rotation();
    truth_.v_WB = v_;
    imu_->push_back(sample());
    pool_->reset(truth_.time);
  }

  /// One scan later. The estimate is the truth, but for its velocity. `points` of the world and
  /// `others` that move by `u_W` in it.
  std::optional<VelocityOpinion> step(const Vector3d& wrong_W, double sigma, int points,
                                      int others = 0, const Vector3d& u_W = Vector3d::Zero()) {
    const Time last = truth_.time;
    for (int i = 0; i < 10; ++i) {
      const NavState before = truth_;
      const ImuSample s = sample();
      integrate(s.gyro_B, s.accel_B, 0.0066, options_.imu.gravity, truth_);
      truth_.time = before.time + std::chrono::microseconds(6600);
      imu_->push_back({truth_.time, s.gyro_B, s.accel_B});
    }
    Estimate x;
    x.nav = truth_;
    x.nav.v_WB += wrong_W;
    x.T_BS = options_.radar.T_BS;
    x.gyro_B = imu_->newest().gyro_B;
    DetectionList scan;
    scan.time = truth_.time;
    const Matrix3d R = truth_.q_WB.toRotationMatrix();
    const Vector3d turn = x.gyro_B.cross(x.T_BS.translation);
    for (int i = 0; i < points + others; ++i) {
      const double az = random_.uniform(-1.0, 1.0);
      const double el = random_.uniform(-0.6, 0.6);
      RadarDetection raw;
      raw.point_S =
          3.0 * Vector3d(std::cos(el) * std::cos(az), std::cos(el) * std::sin(az), std::sin(el));
      Vector3d v_B = R.transpose() * truth_.v_WB + turn;
      if (i >= points) v_B -= R.transpose() * u_W;
      const double rate = -raw.point_S.normalized().dot(v_B) + random_.normal(0.03);
      raw.range_rate = DopplerFold(kLimit).wrap(rate);
      scan.items.push_back(make_detection(raw, options_.radar));
    }
    return pool_->observe(scan, x, sigma, 0.002, last, *imu_, false);
  }

  /// Scans until there is a verdict, at most `count`; the seconds that took, negative if none came.
  double seconds_to_verdict(const Vector3d& wrong_W, double sigma, int points, int count = 30) {
    for (int i = 1; i <= count; ++i) {
      const auto other = step(wrong_W, sigma, points);
      if (!other) continue;
      const Vector3d e = other->v_B - truth_.q_WB.conjugate() * truth_.v_WB;
      EXPECT_LT(e.norm(), 0.4);
      EXPECT_LT(e.dot(other->covariance.inverse() * e), 20.0);
      return i * 0.066;
    }
    return -1.0;
  }

  static constexpr double kLimit = 2.6;  // [m/s]

  test::Random random_{11};
  Options options_;
  std::optional<VelocityPool> pool_;
  std::optional<ImuBuffer> imu_;
  NavState truth_;
  Vector3d v_{0.4, -0.3, 0.1};
  Vector3d rate_{0.1, -0.2, 0.3};       ///< [rad/s]
  Vector3d acceleration_{0.3, 0.2, 0};  ///< [m/s^2]

 private:
  ImuSample sample() const {
    const Vector3d f_W = acceleration_ + Vector3d(0.0, 0.0, options_.imu.gravity);
    return {truth_.time, rate_, truth_.q_WB.conjugate() * f_W};
  }
};

TEST_F(PoolTest, FindsTheVelocityInASecondWithAFewPointsAScan) {
  for (const int points : {3, 4, 6, 20}) {
    for (const double wrong : {2.0, 10.0}) {
      for (const double sigma : {0.05, 3.0}) {
        restart();
        const Vector3d error = wrong * random_.direction();
        const double time = seconds_to_verdict(error, sigma, points);
        // an error that the covariance admits, in a fold of its own, is for the update
        if (DopplerFold(kLimit).is_unique(sigma * sigma) && wrong < 3.0 * sigma) continue;
        EXPECT_GT(time, 0.0) << points << " points, " << wrong << " m/s wrong, sigma " << sigma;
        EXPECT_LT(time, 1.0) << points << " points, " << wrong << " m/s wrong, sigma " << sigma;
      }
    }
  }
}

TEST_F(PoolTest, ARightVelocityIsNeverContradicted) {
  for (const int points : {1, 3, 6, 20}) {
    restart();
    for (int i = 0; i < 300; ++i) {
      if (i % 30 == 0) {  // back and forth
        acceleration_ = random_.normal_vector(0.3) - 0.5 * truth_.v_WB;
        rate_ = random_.normal_vector(0.3);
      }
      EXPECT_FALSE(step(random_.normal_vector(0.05), 0.1, points)) << points << " " << i;
    }
    if (points >= 3) {
      EXPECT_GT(pool_->agreed(), truth_.time - milliseconds(500)) << points;
    }
  }
}

// A person in front of a standing radar gives most of a few points. Their velocity is no other one
// of the radar's: it was proven right, and they do not stay.
TEST_F(PoolTest, APersonWhoFillsTheViewForSecondsIsNoVelocity) {
  v_.setZero();
  rate_.setZero();
  acceleration_.setZero();
  restart();
  for (int i = 0; i < 45; ++i) EXPECT_FALSE(step(Vector3d::Zero(), 0.05, 6));
  for (int i = 0; i < 45; ++i) {
    EXPECT_FALSE(step(Vector3d::Zero(), 0.05, 1, 5, Vector3d(1.0, 0.5, 0.0))) << i;
  }
  for (int i = 0; i < 45; ++i) EXPECT_FALSE(step(Vector3d::Zero(), 0.05, 6));
}

// Of five points a scan three move, each in another direction.
TEST_F(PoolTest, OutliersAreNoVerdict) {
  for (int i = 0; i < 150; ++i) {
    EXPECT_FALSE(step(Vector3d::Zero(), 0.05, 2)) << i;
    for (int k = 0; k < 3; ++k) {
      EXPECT_FALSE(step(Vector3d::Zero(), 0.05, 0, 1, random_.normal_vector(2.0))) << i;
    }
  }
}

TEST_F(PoolTest, CanBeSwitchedOff) {
  options_.frontend.velocity_recovery = false;
  restart();
  EXPECT_LT(seconds_to_verdict(Vector3d(2.0, 1.0, 0.0), 0.05, 6), 0.0);
}

}  // namespace
}  // namespace rio
