// SPDX-License-Identifier: BSD-3-Clause
// What an autopilot is told, and when nothing.
#include "rio/mavlink/odometry.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "rio/core/so3.hpp"
#include "rio/mavlink/axes.hpp"
#include "support/measured.hpp"

namespace rio::mavlink::test {
namespace {

Health good_health() {
  Health health;
  health.state = health.position = health.velocity = health.heading = HealthState::kOk;
  health.quality = 90;
  health.reset_counter = 3;
  return health;
}

/// Heading 90 deg to the left, flying forward at 2 m/s and climbing at 1 m/s.
NavState some_state() {
  return {.time = Time(12'345'678'901),
          .q_WB = quaternion_exp({0, 0, std::numbers::pi / 2}),
          .p_WB = {1, 2, 3},
          .v_WB = {0, 2, 1},
          .gyro_bias = {0.01, 0.02, 0.03}};
}

BodyCovariance some_covariance() {
  BodyCovariance P = BodyCovariance::Zero();
  for (int i = 0; i < body::kSize; ++i) P(i, i) = 1e-4 * (i + 1);
  return P;
}

std::optional<OdometryMessage> message_of(const Health& health, Content content = Content::kAll,
                                          const std::optional<Vector3d>& gyro_B = std::nullopt) {
  return odometry_message(some_state(), some_covariance(), health, gyro_B, 0.01, content);
}

TEST(MavlinkOdometry, EveryFieldOfAFlight) {
  const auto message = odometry_message(some_state(), some_covariance(), good_health(),
                                        Vector3d(0.11, 0.22, 0.33), 0.05);
  ASSERT_TRUE(message);
  EXPECT_EQ(message->time_usec, 12'345'678U);
  EXPECT_EQ(message->frame_id, 20);
  EXPECT_EQ(message->child_frame_id, 12);
  EXPECT_EQ(message->estimator_type, 3);
  EXPECT_EQ(message->reset_counter, 3);
  EXPECT_EQ(message->quality, 90);
  EXPECT_EQ(message->position, (std::array<float, 3>{1, -2, -3}));
  // to the left is against the sense of z down
  EXPECT_FLOAT_EQ(message->q[0], std::sqrt(0.5F));
  EXPECT_FLOAT_EQ(message->q[3], -std::sqrt(0.5F));
  EXPECT_NEAR(message->velocity[0], 2.0, 1e-6);
  EXPECT_NEAR(message->velocity[1], 0.0, 1e-6);
  EXPECT_NEAR(message->velocity[2], -1.0, 1e-6);
  EXPECT_NEAR(message->rates[0], 0.1, 1e-6);
  EXPECT_NEAR(message->rates[1], -0.2, 1e-6);
  EXPECT_NEAR(message->rates[2], -0.3, 1e-6);
  EXPECT_FLOAT_EQ(message->pose_covariance[0], 4e-4F);   // x
  EXPECT_FLOAT_EQ(message->pose_covariance[11], 6e-4F);  // z
  EXPECT_FLOAT_EQ(message->pose_covariance[20], 3e-4F);  // heading
  // x of the body is y of the world; the heading turns (2, 0) by 2 m/s a radian
  EXPECT_NEAR(message->velocity_covariance[0], 8e-4 + 2e-4, 1e-9);
  EXPECT_NEAR(message->velocity_covariance[6], 7e-4 + 1e-4 + 4 * 3e-4, 1e-9);
  EXPECT_FLOAT_EQ(message->velocity_covariance[20], 12e-4F + 25e-4F);
}

TEST(MavlinkOdometry, WithoutAGyroSampleTheRatesAreUnknown) {
  const auto message = message_of(good_health());
  ASSERT_TRUE(message);
  for (const float rate : message->rates) EXPECT_TRUE(std::isnan(rate));
  std::size_t at = 0;
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) {
      EXPECT_EQ(std::isnan(message->velocity_covariance[at++]), column >= 3);
    }
  }
  EXPECT_TRUE(std::isfinite(message->velocity[0]) && std::isfinite(message->position[0]));
}

TEST(MavlinkOdometry, VelocityOnlyTellsNoPose) {
  const auto message = message_of(good_health(), Content::kVelocity, Vector3d::Zero());
  ASSERT_TRUE(message);
  for (const float value : message->position) EXPECT_TRUE(std::isnan(value));
  for (const float value : message->q) EXPECT_TRUE(std::isnan(value));
  for (const float value : message->pose_covariance) EXPECT_TRUE(std::isnan(value));
  for (const float value : message->velocity) EXPECT_TRUE(std::isfinite(value));
  for (const float value : message->rates) EXPECT_TRUE(std::isfinite(value));
  for (const float value : message->velocity_covariance) EXPECT_TRUE(std::isfinite(value));
}

TEST(MavlinkOdometry, NothingOfWhatHealthCallsLost) {
  for (const HealthState state : {HealthState::kInitializing, HealthState::kLost}) {
    Health health = good_health();
    health.state = health.position = state;
    EXPECT_FALSE(message_of(health));
    EXPECT_TRUE(message_of(health, Content::kVelocity));
    EXPECT_EQ(message_of(health, Content::kAllOrVelocity).has_value(), state == HealthState::kLost);
    health.velocity = state;
    EXPECT_FALSE(message_of(health, Content::kVelocity));
    EXPECT_FALSE(message_of(health, Content::kAllOrVelocity));
  }
  for (const HealthState state : {HealthState::kDegraded, HealthState::kDeadReckoning}) {
    Health health = good_health();
    health.state = health.position = health.velocity = state;
    health.quality = 0;
    const auto message = message_of(health);
    ASSERT_TRUE(message);
    EXPECT_EQ(message->quality, 1);  // 0 would be "unknown"
  }
}

TEST(MavlinkOdometry, TheVelocityGoesOnWithoutALostPose) {
  Health health = good_health();
  EXPECT_TRUE(std::isfinite(message_of(health, Content::kAllOrVelocity)->position[0]));
  health.state = health.heading = HealthState::kLost;
  EXPECT_TRUE(std::isnan(message_of(health, Content::kAllOrVelocity)->position[0]));
}

TEST(MavlinkOdometry, NothingThatIsNoNumber) {
  const double nan = std::nan("");
  const auto sent = [](const NavState& state, const BodyCovariance& P, const Vector3d& gyro) {
    return odometry_message(state, P, good_health(), gyro).has_value();
  };
  const NavState good = some_state();
  const BodyCovariance P = some_covariance();
  const Vector3d zero = Vector3d::Zero();
  ASSERT_TRUE(sent(good, P, zero));
  for (const double odd : {nan, HUGE_VAL, 1e300}) {
    NavState state = good;
    state.p_WB.y() = odd;
    EXPECT_FALSE(sent(state, P, zero));
    state = good;
    state.v_WB.z() = odd;
    EXPECT_FALSE(sent(state, P, zero));
    BodyCovariance bad = P;
    bad(3, 7) = odd;
    EXPECT_FALSE(sent(good, bad, zero));
    EXPECT_FALSE(sent(good, P, {0, odd, 0}));
  }
  NavState early = good;
  early.time = Time(-1);
  EXPECT_FALSE(sent(early, P, zero));
}

TEST(MavlinkOdometry, TheHeartbeatTellsTheHealth) {
  Health health = good_health();
  EXPECT_EQ(heartbeat(health).system_status, 4);
  health.state = HealthState::kDegraded;
  EXPECT_EQ(heartbeat(health).system_status, 5);
  health.state = HealthState::kDeadReckoning;
  EXPECT_EQ(heartbeat(health).system_status, 5);
  health.state = HealthState::kLost;
  EXPECT_EQ(heartbeat(health).system_status, 8);
  EXPECT_EQ(heartbeat(health, Content::kVelocity).system_status, 4);
  EXPECT_EQ(heartbeat(health, Content::kAllOrVelocity).system_status, 5);
  health.velocity = HealthState::kLost;
  EXPECT_EQ(heartbeat(health, Content::kAllOrVelocity).system_status, 8);
  EXPECT_EQ(heartbeat(Health{}).system_status, 2);
  EXPECT_EQ(heartbeat(health).type, 18);
  EXPECT_EQ(heartbeat(health).autopilot, 8);
}

TEST(MavlinkOdometry, TheRateIsLimited) {
  RateLimiter limiter(30.0);
  std::vector<Time> sent;
  for (int i = 0; i < 2000; ++i) {  // 200 Hz for ten seconds
    const Time stamp = std::chrono::milliseconds(5 * i);
    if (limiter.due(stamp)) sent.push_back(stamp);
  }
  EXPECT_EQ(sent.size(), 300U);
  for (std::size_t i = 30; i < sent.size(); ++i) {
    EXPECT_GE(sent[i] - sent[i - 30], std::chrono::milliseconds(995));
  }
}

TEST(MavlinkOdometry, ASlowOrRestartedClockIsFollowed) {
  RateLimiter limiter(10.0);
  int sent = 0;
  for (int i = 0; i < 20; ++i) sent += limiter.due(std::chrono::milliseconds(250 * i)) ? 1 : 0;
  EXPECT_EQ(sent, 20);  // slower than the limit
  EXPECT_FALSE(limiter.due(std::chrono::milliseconds(4800)));
  EXPECT_TRUE(limiter.due(std::chrono::milliseconds(10)));  // fell back
  EXPECT_FALSE(limiter.due(std::chrono::milliseconds(100)));
  EXPECT_TRUE(limiter.due(std::chrono::milliseconds(110)));
}

}  // namespace
}  // namespace rio::mavlink::test
