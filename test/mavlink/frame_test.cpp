// SPDX-License-Identifier: BSD-3-Clause
// Frames byte by byte: checksum, layout, truncation; and back again.
#include "rio/mavlink/frame.hpp"

#include <gtest/gtest.h>

#include "mavlink/random_messages.hpp"

namespace rio::mavlink::test {
namespace {

std::uint16_t crc_of(const char* text) {
  Crc16 crc;
  crc.add(reinterpret_cast<const std::uint8_t*>(text), std::strlen(text));
  return crc.value();
}

/// The published check value, and some from the definition, bit by bit from the other side: the
/// register of CRC-16/CCITT with bits in the order they are sent.
TEST(MavlinkFrame, ChecksumOfKnownTexts) {
  EXPECT_EQ(crc_of("123456789"), 0x6F91);
  EXPECT_EQ(crc_of(""), 0xFFFF);
  for (const char* text : {"a", "radar", "The checksum of a longer text."}) {
    unsigned remainder = 0xFFFF;
    for (const char* c = text; *c != 0; ++c) {
      for (int bit = 0; bit < 8; ++bit) {
        const unsigned top = remainder >> 15 ^ (static_cast<unsigned>(*c) >> bit & 1U);
        remainder = (remainder << 1 & 0xFFFF) ^ (top != 0 ? 0x1021U : 0U);
      }
    }
    unsigned reversed = 0;
    for (int bit = 0; bit < 16; ++bit) reversed |= (remainder >> bit & 1U) << (15 - bit);
    EXPECT_EQ(crc_of(text), reversed) << text;
  }
}

TEST(MavlinkFrame, EveryByteOfAHeartbeat) {
  Writer writer({42, 197});
  Heartbeat heartbeat;
  heartbeat.custom_mode = 0x04030201;
  heartbeat.system_status = 4;
  writer.write(Heartbeat{}, std::array<std::uint8_t, 21>{}.data(), 21);
  const Bytes bytes = frame_of(heartbeat, &writer);
  const Bytes expected = {0xFD, 9, 0, 0, 1, 42, 197, 0, 0, 0, 1, 2, 3, 4, 18, 8, 0, 4, 3};
  ASSERT_EQ(bytes.size(), expected.size() + 2);
  EXPECT_EQ(Bytes(bytes.begin(), bytes.end() - 2), expected);
  Crc16 crc;
  crc.add(expected.data() + 1, expected.size() - 1);
  const std::uint8_t extra = 50;
  crc.add(&extra, 1);
  EXPECT_EQ(bytes[19] | bytes[20] << 8, crc.value());
}

TEST(MavlinkFrame, ZerosAtTheEndAreLeftOutButForTheFirstByte) {
  Writer writer;
  Timesync message;
  EXPECT_EQ(frame_of(message, &writer)[1], 1);
  message.tc1 = 1;
  EXPECT_EQ(frame_of(message, &writer)[1], 1);
  message.tc1 = 256;
  EXPECT_EQ(frame_of(message, &writer)[1], 2);
  message.ts1 = -1;
  EXPECT_EQ(frame_of(message, &writer)[1], 16);
  message.target_component = 1;
  EXPECT_EQ(frame_of(message, &writer)[1], 18);
}

TEST(MavlinkFrame, TheLengthsAreThoseOfTheDefinition) {
  sim::Random random(1);
  EXPECT_EQ(payload_of(random_message<OdometryMessage>(&random)).size(), 233U);
  OdometryMessage odometry;
  odometry.frame_id = 20;
  odometry.child_frame_id = 12;
  odometry.quality = -1;
  const auto payload = payload_of(odometry);
  EXPECT_EQ(payload[228], 20);
  EXPECT_EQ(payload[229], 12);
  EXPECT_EQ(payload[232], 255);
  HighresImu highres;
  highres.id = 7;
  EXPECT_EQ(payload_of(highres)[62], 7);
  RawImu raw;
  raw.temperature = 0x0201;
  EXPECT_EQ(payload_of(raw)[27], 1);
  EXPECT_EQ(payload_of(raw)[28], 2);
  ScaledImu scaled;
  scaled.temperature = -1;
  EXPECT_EQ(payload_of(scaled)[23], 255);
}

TEST(MavlinkFrame, NothingIsWrittenWithoutRoom) {
  Writer writer;
  OdometryMessage message;
  message.quality = 50;
  Bytes bytes(10 + 233 + 2, 0xAA);
  EXPECT_EQ(writer.write(message, bytes.data(), bytes.size() - 1), 0U);
  EXPECT_EQ(bytes, Bytes(bytes.size(), 0xAA));
  EXPECT_EQ(writer.sequence(), 0);
  EXPECT_EQ(writer.write(message, bytes.data(), bytes.size()), bytes.size());
  EXPECT_EQ(writer.sequence(), 1);
}

template <class Message>
void expect_round_trip() {
  sim::Random random(Message::kId + 1);
  Writer writer({3, 4});
  Parser parser;
  for (int i = 0; i < 300; ++i) {
    const Message sent = random_message<Message>(&random);
    const std::vector<Packet> packets = parse(&parser, frame_of(sent, &writer));
    ASSERT_EQ(packets.size(), 1U);
    Message received;
    ASSERT_TRUE(packets[0].read(&received));
    EXPECT_EQ(payload_of(sent), payload_of(received));
    EXPECT_EQ(packets[0].sequence, i % 256);
    EXPECT_EQ(packets[0].from.system, 3);
    EXPECT_EQ(packets[0].from.component, 4);
  }
}

TEST(MavlinkFrame, WhatIsWrittenIsRead) {
  expect_round_trip<Heartbeat>();
  expect_round_trip<Timesync>();
  expect_round_trip<OdometryMessage>();
  expect_round_trip<HighresImu>();
  expect_round_trip<RawImu>();
  expect_round_trip<ScaledImu>();
}

}  // namespace
}  // namespace rio::mavlink::test
