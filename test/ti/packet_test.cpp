// SPDX-License-Identifier: BSD-3-Clause
#include "rio/ti/packet.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "ti/reading.hpp"

namespace rio::ti::test {
namespace {

Frame only_frame(const WrittenPacket& packet) {
  Reading reading;
  reading.push(packet.bytes());
  EXPECT_EQ(reading.frames.size(), 1U);
  EXPECT_EQ(reading.counters().damaged, 0U);
  return reading.frames.empty() ? Frame{} : reading.frames.front();
}

/// How many frames a packet with other bytes at `at` gives.
std::size_t frames_with(Bytes bytes, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
  Reading reading;
  reading.push(bytes);
  EXPECT_EQ(reading.counters().damaged + reading.frames.size(), 1U);
  return reading.frames.size();
}

TEST(TiPacket, EveryFieldIsRead) {
  WrittenPacket packet = packet_of(0x01020304, {{0.5F, 3.0F, -0.75F, 1.25F, 153, 421}});
  packet.cycles = 0xFEDCBA98;
  packet.subframe = 2;
  const Frame frame = only_frame(packet);
  EXPECT_EQ(frame.version, 0x03060000U);
  EXPECT_EQ(frame.platform, 0xA1843U);
  EXPECT_EQ(frame.number, 0x01020304U);
  EXPECT_EQ(frame.cycles, 0xFEDCBA98U);
  EXPECT_EQ(frame.subframe, 2U);
  EXPECT_EQ(frame.bytes, packet.bytes().size());
  ASSERT_EQ(frame.scan.detections.size(), 1U);
  const RadarDetection& d = frame.scan.detections[0];
  EXPECT_EQ(d.point_S, Vector3d(3.0, -0.5, -0.75));  // half a metre to the right: y is left
  EXPECT_EQ(d.range_rate, 1.25);                     // both positive when receding
  EXPECT_DOUBLE_EQ(d.snr_db, 15.3);
  EXPECT_DOUBLE_EQ(d.noise_db, 42.1);
  EXPECT_EQ(d.sigma_range, 0.0);
}

TEST(TiPacket, NothingDetected) {
  EXPECT_TRUE(only_frame(packet_of(1, {})).scan.detections.empty());  // TLV 1 of length 0, no TLV 7
  EXPECT_TRUE(only_frame(WrittenPacket{}).scan.detections.empty());   // no TLV at all
}

TEST(TiPacket, WithoutSideInfoTheSnrIsZero) {
  WrittenPacket packet = packet_of(1, some_points(1, 3));
  packet.tlvs.pop_back();
  const Frame frame = only_frame(packet);
  ASSERT_EQ(frame.scan.detections.size(), 3U);
  EXPECT_EQ(frame.scan.detections[2].snr_db, 0.0);
}

TEST(TiPacket, TheHeaderOfXwr14xxHasNoSubframe) {
  WrittenPacket packet = packet_of(7, some_points(7, 5));
  packet.platform = 0xA1443;
  for (const bool with_subframe : {false, true}) {
    packet.with_subframe = with_subframe;
    EXPECT_TRUE(is_frame_of(only_frame(packet), 7, some_points(7, 5))) << with_subframe;
  }
}

TEST(TiPacket, PointsThatAreNotFiniteAreLeftOutAndCounted) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::vector<WrittenPoint> points = some_points(7, 9);
  points[0].x = kNan;
  points[2].y = kInfinity;
  points[4].z = -kInfinity;
  points[6].velocity = kNan;
  Reading reading;
  reading.push(packet_of(7, points).bytes());
  EXPECT_EQ(reading.counters().points_left_out, 4U);
  ASSERT_EQ(reading.frames.size(), 1U);
  EXPECT_TRUE(
      is_frame_of(reading.frames[0], 7, {points[1], points[3], points[5], points[7], points[8]}));
}

TEST(TiPacket, LengthsMustAgreeToTheByte) {
  const Bytes bytes = packet_of(7, some_points(7, 5)).bytes();  // 40, 8 + 80, 8 + 20 -> 160
  ASSERT_EQ(bytes.size(), 160U);
  EXPECT_EQ(frames_with(bytes, 12, 160), 1U);
  for (const std::uint32_t size : {0U, 39U, 40U, 128U, 159U, 161U, 224U, 65536U, 65568U, ~0U}) {
    EXPECT_EQ(frames_with(bytes, 12, size), 0U) << size;
  }
  for (const std::uint32_t tlvs : {0U, 1U, 3U, 1000U, ~0U}) {
    EXPECT_EQ(frames_with(bytes, 32, tlvs), 0U) << tlvs;
  }
  for (const std::uint32_t length : {0U, 16U, 64U, 79U, 84U, 96U, 1000U, 1600U, 0x7FFFFFFFU, ~0U}) {
    EXPECT_EQ(frames_with(bytes, 44, length), 0U) << length;
  }
  for (const std::uint32_t length : {4U, 16U, 21U, 24U, 1000U, ~0U - 7U, ~0U}) {
    EXPECT_EQ(frames_with(bytes, 132, length), 0U) << length;
  }
  EXPECT_EQ(frames_with(bytes, 128, 1), 0U);  // a second TLV 1
}

// What is wrong is noticed with the byte that says so: no wait for bytes that never come.
TEST(TiPacket, AWildLengthIsNoticedAtOnce) {
  Bytes bytes = packet_of(7, some_points(7, 5)).bytes();
  bytes[13] = 0x10;  // 4096 more
  for (std::size_t count = 0; count <= bytes.size(); ++count) {
    PacketWalk walk(65536);
    const PacketVerdict verdict = walk.advance(bytes.data(), count);
    EXPECT_EQ(verdict, count < 136 ? PacketVerdict::kMore : PacketVerdict::kDamaged) << count;
  }
}

}  // namespace
}  // namespace rio::ti::test
