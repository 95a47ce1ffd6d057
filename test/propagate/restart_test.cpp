// SPDX-License-Identifier: BSD-3-Clause
// After the tilt was lost: it is found again from the specific force, heading and position stay.
#include "rio/propagate/restart.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "rio/core/so3.hpp"
#include "support/constants.hpp"

namespace rio {
namespace {

constexpr Time kSample = std::chrono::milliseconds(5);

class RestartTest : public testing::Test {
 protected:
  RestartTest() {
    truth_.time = Time(5'000'000'000);
    truth_.q_WB =
        quaternion_exp(Vector3d(0.0, 0.0, 0.7)) * quaternion_exp(Vector3d(0.3, -0.2, 0.0));
    truth_.p_WB = Vector3d(1.0, 2.0, 3.0);
    truth_.v_WB = Vector3d(0.5, 0.0, 0.0);
    believed_ = truth_;
    // turned about a level axis: of the heading nothing is lost
    believed_.q_WB = quaternion_exp(Vector3d(0.9, 0.4, 0.0)) * truth_.q_WB;
    P_.setIdentity();
    P_ *= 0.01;
    P_.block<3, 3>(body::kAttitude, body::kAttitude) *= 100.0;
  }

  /// Samples of a body that turns about its own z, until there is a state.
  std::optional<Alignment> feed(double seconds, double force = test::kGravity) {
    const Vector3d rate(0.0, 0.0, 0.4);
    for (const Time end = truth_.time + from_seconds(seconds); truth_.time < end;) {
      truth_.time += kSample;
      truth_.q_WB = truth_.q_WB * quaternion_exp(to_seconds(kSample) * rate);
      const Vector3d up_B = truth_.q_WB.conjugate() * Vector3d::UnitZ();
      if (auto found = restart_.add({truth_.time, rate, force * up_B}, pause_)) return found;
      pause_ = false;
    }
    return std::nullopt;
  }

  /// The state after a second and a half at g.
  Alignment find() {
    const auto found = feed(1.6);
    EXPECT_TRUE(found);
    return found.value_or(Alignment{});
  }

  static AttitudeVariance variance_of(const Alignment& found) {
    return attitude_variance(found.state.q_WB,
                             found.covariance.block<3, 3>(body::kAttitude, body::kAttitude));
  }
  static double sigma_of(const Alignment& found, int column) {
    return std::sqrt(found.covariance(column, column));
  }

  Restart restart_{StartOptions{}, ImuOptions{}};
  NavState truth_;
  NavState believed_;
  BodyCovariance P_;
  bool pause_ = false;
};

TEST_F(RestartTest, FindsTheTiltAndKeepsHeadingAndPosition) {
  EXPECT_FALSE(restart_.active());
  restart_.begin(believed_, P_, false, truth_.time);
  EXPECT_TRUE(restart_.active());
  const Alignment found = find();
  EXPECT_FALSE(restart_.active());
  EXPECT_EQ(found.state.time, truth_.time);
  const Vector3d error = quaternion_log(truth_.q_WB * found.state.q_WB.conjugate());
  EXPECT_LT(error.head<2>().norm(), 0.01);
  // what a turn of 56 deg about a level axis leaves of the heading
  EXPECT_LT(std::abs(error.z()), 0.25);
  EXPECT_EQ(found.state.p_WB, believed_.p_WB);
  EXPECT_GT(variance_of(found).heading, 1.0);  // as uncertain as it was
  EXPECT_LT(variance_of(found).tilt, 0.35 * 0.35);
  // 1.5 s at half a metre a second and what is gained
  EXPECT_NEAR(sigma_of(found, body::kPosition), std::hypot(0.1, 1.5 * 1.5), 0.01);
  EXPECT_NEAR(sigma_of(found, body::kVelocity), 5.0, 1e-9);
}

// Half a minute may have passed in it: what was extrapolated tells nothing.
TEST_F(RestartTest, AfterAPauseItBeginsFromTheEstimateBefore) {
  NavState before = believed_;
  before.time = truth_.time - std::chrono::seconds(30);
  restart_.pause(before, 0.01 * BodyCovariance::Identity(), truth_.time);
  believed_.p_WB += Vector3d(500.0, 0.0, -900.0);
  restart_.passed(truth_.time - kSample);
  restart_.begin(believed_, 1e6 * P_, false, truth_.time);
  const Alignment found = find();
  EXPECT_EQ(found.state.p_WB, before.p_WB);
  EXPECT_NEAR(sigma_of(found, body::kPosition), 31.5 * 1.5, 0.5);
  EXPECT_GT(variance_of(found).heading, 1.8 * 1.8);
}

TEST_F(RestartTest, AShortPauseThatWasBridgedIsForgotten) {
  NavState before = believed_;
  before.p_WB.setZero();
  restart_.pause(before, P_, truth_.time);
  restart_.passed(truth_.time);
  restart_.begin(believed_, P_, false, truth_.time);
  EXPECT_EQ(find().state.p_WB, believed_.p_WB);
}

TEST_F(RestartTest, APauseBeginsTheSumAnew) {
  restart_.begin(believed_, P_, false, truth_.time);
  EXPECT_FALSE(feed(1.0));
  pause_ = true;
  EXPECT_FALSE(feed(1.0));
  EXPECT_TRUE(feed(0.6));
}

// In free fall, or with a dead accelerometer, there is no tilt to be found.
TEST_F(RestartTest, WaitsForGravity) {
  restart_.begin(believed_, P_, false, truth_.time);
  EXPECT_FALSE(feed(4.0, 0.3 * test::kGravity));
  EXPECT_TRUE(restart_.active());
  EXPECT_TRUE(feed(3.2));
}

TEST_F(RestartTest, OfAnEstimateThatHasRunAwayNothingIsBelieved) {
  believed_.v_WB = Vector3d(60.0, 0.0, 0.0);
  restart_.begin(believed_, P_, true, truth_.time);
  const Alignment found = find();
  EXPECT_GT(variance_of(found).heading, 1.8 * 1.8);
  EXPECT_GT(sigma_of(found, body::kPosition), 120.0);
}

}  // namespace
}  // namespace rio
