// SPDX-License-Identifier: BSD-3-Clause
// The offset of two clocks over a link that delays, and jumps. The IMU of an autopilot at rest
// reads +g upwards here, whatever the message.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "rio/mavlink/imu.hpp"
#include "rio/mavlink/timesync.hpp"
#include "rio/sim/random.hpp"
#include "support/measured.hpp"

namespace rio::mavlink::test {
namespace {

/// The other side, its clock ahead by an offset that drifts, behind a link that delays each way by
/// half a millisecond and an exponential jitter.
struct Link {
  sim::Random random{1};
  Time offset = std::chrono::hours(5);
  double drift = 20e-6;
  double jitter = 5e-3;
  Time now{std::chrono::seconds(100)};

  Time offset_at(Time t) const { return offset + from_seconds(drift * to_seconds(t)); }
  Time way() { return from_seconds(0.5e-3 - jitter * std::log(1.0 - random.uniform())); }

  bool exchange(TimesyncClient* client) {
    Timesync question = client->ask(now);
    now += way();
    question.tc1 = (now + offset_at(now)).count();
    now += way();
    return client->take(question, now);
  }
};

TEST(MavlinkTimesync, TheOffsetIsWithinItsBounds) {
  Link link;
  TimesyncClient client;
  EXPECT_FALSE(client.known());
  double worst = 0.0;
  double worst_bound = 0.0;
  for (int i = 0; i < 600; ++i) {
    EXPECT_TRUE(link.exchange(&client));
    const double off = std::abs(to_seconds(client.offset() - link.offset_at(link.now)));
    EXPECT_LE(off, to_seconds(client.bound(link.now)) + 1e-8) << i;
    if (i > 30) worst = std::max(worst, off);
    if (i > 30) worst_bound = std::max(worst_bound, to_seconds(client.bound(link.now)));
    link.now += std::chrono::milliseconds(500);
  }
  EXPECT_TRUE(client.known());
  EXPECT_EQ(client.restarts(), 0);
  rio::test::expect_below("jitter 5 ms each way: worst error, ms", 1e3 * worst, 2.0);
  rio::test::expect_below("its bound, ms", 1e3 * worst_bound, 4.0);
}

TEST(MavlinkTimesync, ARebootOfTheOtherSideIsNoticed) {
  Link link;
  TimesyncClient client;
  for (int i = 0; i < 40; ++i) link.exchange(&client);
  link.offset = -std::chrono::seconds(90);
  int refused = 0;
  while (!link.exchange(&client)) ++refused;
  EXPECT_EQ(refused, 2);
  EXPECT_EQ(client.restarts(), 1);
  const double off = to_seconds(client.offset() - link.offset_at(link.now));
  EXPECT_LE(std::abs(off), to_seconds(client.bound(link.now)) + 1e-8);
}

TEST(MavlinkTimesync, OnlyAnswersToQuestionsCount) {
  TimesyncClient client;
  const Time now = std::chrono::seconds(10);
  Timesync answer = client.ask(now);
  EXPECT_EQ(answer.tc1, 0);
  EXPECT_FALSE(client.take(answer, now));  // the question itself
  answer.tc1 = 5;
  EXPECT_FALSE(client.take(answer, now - Time(1)));                      // before it was asked
  EXPECT_FALSE(client.take(answer, now + std::chrono::seconds(2)));      // too late
  EXPECT_TRUE(client.take(answer, now + std::chrono::milliseconds(2)));  // tc1 at 10.001 s
  EXPECT_EQ(client.offset(), Time(5) - now - std::chrono::milliseconds(1));
  EXPECT_FALSE(client.take(answer, now + std::chrono::milliseconds(2)));  // again
  answer.ts1 += 1;
  EXPECT_FALSE(client.take(answer, now + std::chrono::milliseconds(2)));  // asked by another
  for (const std::int64_t odd : {INT64_MAX, INT64_MIN}) {
    answer = client.ask(now);
    answer.tc1 = odd;
    EXPECT_FALSE(client.take(answer, now));
    answer.tc1 = 5;
    answer.ts1 = odd;
    EXPECT_FALSE(client.take(answer, now));
  }
}

TEST(MavlinkTimesync, QuestionsAreAnswered) {
  Timesync question;
  question.ts1 = 1234;
  const auto answer = timesync_answer(question, {1, 1}, std::chrono::seconds(3));
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->ts1, 1234);
  EXPECT_EQ(answer->tc1, 3'000'000'000);
  EXPECT_EQ(answer->target_system, 1);
  EXPECT_EQ(answer->target_component, 1);
  EXPECT_FALSE(timesync_answer(*answer, {1, 1}, Time{0}));
}

HighresImu some_highres() {
  HighresImu message;
  message.time_usec = 1'000'001;
  message.accel = {0.5F, 0.25F, -9.75F};
  message.gyro = {0.125F, 0.5F, -0.25F};
  message.fields_updated = 0x3F;
  return message;
}

TEST(MavlinkImu, HighresIsInSiUnits) {
  const auto sample = imu_sample(some_highres());
  ASSERT_TRUE(sample);
  EXPECT_EQ(sample->time, Time(1'000'001'000));
  EXPECT_EQ(sample->accel_B, Vector3d(0.5, -0.25, 9.75));
  EXPECT_EQ(sample->gyro_B, Vector3d(0.125, -0.5, 0.25));
}

TEST(MavlinkImu, OldAndOddValuesAreNoSample) {
  for (int bit = 0; bit < 6; ++bit) {
    HighresImu message = some_highres();
    message.fields_updated = static_cast<std::uint16_t>(0xFFFF ^ (1 << bit));
    EXPECT_FALSE(imu_sample(message)) << bit;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    HighresImu message = some_highres();
    message.accel[i] = kUnknown;
    EXPECT_FALSE(imu_sample(message));
    message = some_highres();
    message.gyro[i] = std::numeric_limits<float>::infinity();
    EXPECT_FALSE(imu_sample(message));
  }
}

TEST(MavlinkImu, ScaledIsInThousandths) {
  const ScaledImu message{
      .time_boot_ms = 4'294'967'295U, .accel = {100, 200, -1000}, .gyro = {1, -2, 3000}};
  const ImuSample sample = imu_sample(message);
  EXPECT_EQ(sample.time, std::chrono::milliseconds(4'294'967'295));
  EXPECT_LT((sample.accel_B - Vector3d(0.980665, -1.96133, 9.80665)).norm(), 1e-12);
  EXPECT_LT((sample.gyro_B - Vector3d(0.001, 0.002, -3.0)).norm(), 1e-12);
}

TEST(MavlinkImu, RawIsInWhatTheSenderSays) {
  RawImu message;
  message.time_usec = std::numeric_limits<std::uint64_t>::max();
  message.accel = {0, 0, -1000};
  message.gyro = {-32768, 0, 500};
  EXPECT_LT((imu_sample(message).accel_B - Vector3d(0, 0, 9.80665)).norm(), 1e-12);
  EXPECT_NEAR(imu_sample(message).gyro_B.z(), -0.5, 1e-12);
  EXPECT_GT(imu_sample(message).time, Time{0});
  const ImuSample other = imu_sample(message, {9.81 / 2048.0, 0.01});
  EXPECT_NEAR(other.accel_B.z(), 9.81 * 1000 / 2048, 1e-12);
  EXPECT_NEAR(other.gyro_B.x(), -327.68, 1e-12);
}

}  // namespace
}  // namespace rio::mavlink::test
