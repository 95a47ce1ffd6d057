// SPDX-License-Identifier: BSD-3-Clause
#include "live/mavlink_link.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "live/live_flight.hpp"

namespace rio::live::test {
namespace {

using mavlink::Heartbeat;
using mavlink::OdometryMessage;
using mavlink::Timesync;

/// The autopilot's end of the link.
struct Autopilot {
  mavlink::Parser parser;
  std::vector<OdometryMessage> odometry;
  std::vector<Heartbeat> heartbeats;
  std::vector<Timesync> timesyncs;

  MavlinkLink::Send hear() {
    return [this](const std::uint8_t* bytes, std::size_t count) {
      parser.push(bytes, count, Time{0}, [this](const mavlink::Packet& packet) { take(packet); });
      return true;
    };
  }
  void take(const mavlink::Packet& packet) {
    EXPECT_EQ(packet.from.component, 197);
    OdometryMessage message;
    Heartbeat heartbeat;
    Timesync timesync;
    if (packet.read(&message)) odometry.push_back(message);
    if (packet.read(&heartbeat)) heartbeats.push_back(heartbeat);
    if (packet.read(&timesync)) timesyncs.push_back(timesync);
  }
};

/// The autopilot, or another, sends a message.
template <class Message>
void say(const Message& message, Time arrival, MavlinkLink* link, const MavlinkLink::OnImu& on_imu,
         const mavlink::Address& from = {1, 1}) {
  mavlink::Writer writer(from);
  std::uint8_t frame[mavlink::kMaxFrame];
  link->receive(frame, writer.write(message, frame, sizeof frame), arrival, on_imu);
}

/// A flight whose estimates go to an autopilot.
struct LinkedFlight {
  Autopilot autopilot;
  MavlinkLink link{{.rate = 30.0}, autopilot.hear()};
  Session session{setup(), {&link}};
};

TEST(MavlinkLink, TellsTheEstimateInTheClockOfThisMachine) {
  LinkedFlight linked;
  auto& [autopilot, link, session] = linked;
  fly({}, &session);
  ASSERT_EQ(link.sent(), autopilot.odometry.size());
  const double seconds = to_seconds(flight().imu.back().time - flight().imu.front().time);
  EXPECT_NEAR(static_cast<double>(link.sent()) / (seconds - 1.5), 30.0, 1.0);
  const OdometryMessage& last = autopilot.odometry.back();
  const NavState& now = session.odometry().now();
  const auto stamp = std::chrono::microseconds(last.time_usec);
  EXPECT_LT(now.time + kHostAhead - stamp, std::chrono::milliseconds(40));
  EXPECT_GT(now.time + kHostAhead - stamp, std::chrono::milliseconds(-1));
  EXPECT_NEAR(last.position[0], now.p_WB.x(), 0.1);
  EXPECT_NEAR(last.position[1], -now.p_WB.y(), 0.1);
  EXPECT_NEAR(last.position[2], -now.p_WB.z(), 0.1);
  EXPECT_GT(last.quality, 50);
}

TEST(MavlinkLink, NothingBeforeTheStartAndAHeartbeatASecond) {
  LinkedFlight linked;
  auto& [autopilot, link, session] = linked;
  Time now{0};
  for (int i = 0; i < 200; ++i) {
    session.imu(flight().imu[static_cast<std::size_t>(i)], now);
    now += std::chrono::milliseconds(5);
    link.tick(session, now);
  }
  EXPECT_TRUE(autopilot.odometry.empty());
  ASSERT_EQ(autopilot.heartbeats.size(), 1U);
  EXPECT_EQ(autopilot.heartbeats.back().system_status, 2);  // MAV_STATE_CALIBRATING
  for (int i = 0; i < 30; ++i) link.tick(session, now += std::chrono::milliseconds(100));
  ASSERT_GE(autopilot.heartbeats.size(), 3U);
  EXPECT_EQ(autopilot.heartbeats.back().system_status, 8);  // the IMU is silent: do not fly by it
}

TEST(MavlinkLink, AnswersTheClockAndTakesTheImu) {
  Autopilot autopilot;
  MavlinkLink link({.rate = 0.0, .asks_clock = true}, autopilot.hear());
  Timesync question;
  question.ts1 = 77;
  say(question, Time(5000), &link, [](const ImuSample&) { FAIL(); });
  ASSERT_EQ(autopilot.timesyncs.size(), 1U);
  EXPECT_EQ(autopilot.timesyncs[0].tc1, 5000);
  EXPECT_EQ(autopilot.timesyncs[0].ts1, 77);

  mavlink::HighresImu imu;
  imu.time_usec = 1000;
  imu.accel = {0.0F, 0.0F, -9.75F};
  imu.gyro = {0.5F, 0.25F, 0.125F};
  imu.fields_updated = 0x3F;
  std::vector<ImuSample> samples;
  const auto keep = [&](const ImuSample& sample) { samples.push_back(sample); };
  say(imu, Time(6000), &link, keep);
  imu.id = 1;  // another IMU of the same autopilot
  say(imu, Time(6000), &link, keep);
  ASSERT_EQ(samples.size(), 1U);
  EXPECT_EQ(samples[0].accel_B, Vector3d(0.0, 0.0, 9.75));
  EXPECT_EQ(samples[0].gyro_B, Vector3d(0.5, -0.25, -0.125));
}

TEST(MavlinkLink, FindsTheClockOfTheAutopilot) {
  Autopilot autopilot;
  MavlinkLink link({.rate = 0.0, .asks_clock = true}, autopilot.hear());
  const Session session(setup(), {});
  EXPECT_FALSE(link.host_offset());
  const Time now = std::chrono::hours(2);
  link.tick(session, now);
  ASSERT_EQ(autopilot.timesyncs.size(), 1U);
  Timesync answer = autopilot.timesyncs[0];
  answer.tc1 = 1'000'000'000;  // a second since boot
  say(answer, now, &link, [](const ImuSample&) {});
  ASSERT_TRUE(link.host_offset());
  EXPECT_EQ(*link.host_offset(), now - std::chrono::seconds(1));
  EXPECT_TRUE(autopilot.heartbeats.empty());
}

/// As with another vehicle, with MAVROS, which answers too, or with a line that echoes.
TEST(MavlinkLink, TakesImuAndClockOfTheVehicleAlone) {
  Autopilot autopilot;
  MavlinkLink link({.rate = 0.0, .system = 2, .asks_clock = true}, autopilot.hear());
  const Session session(setup(), {});
  mavlink::HighresImu imu;
  imu.fields_updated = 0x3F;
  Time now = std::chrono::hours(2);
  std::vector<Time> samples;
  const auto keep = [&](const ImuSample& sample) { samples.push_back(sample.time); };
  const std::uint8_t senders[] = {1, 2, 3, 1, 2};
  for (const std::uint8_t system : senders) {
    imu.time_usec += 5000;
    say(imu, now, &link, keep, {system, 1});
  }
  const std::vector<Time> of_first_and_vehicle = {
      std::chrono::milliseconds(5), std::chrono::milliseconds(10), std::chrono::milliseconds(25)};
  EXPECT_EQ(samples, of_first_and_vehicle);
  link.tick(session, now);
  Timesync answer = autopilot.timesyncs.at(0);
  answer.tc1 = now.count();
  for (const mavlink::Address from : {mavlink::Address{2, 191}, {2, 197}, {1, 1}}) {
    say(answer, now, &link, keep, from);
    EXPECT_FALSE(link.host_offset());
  }
  say(answer, now, &link, keep, {2, 1});
  EXPECT_TRUE(link.host_offset());
}

}  // namespace
}  // namespace rio::live::test
