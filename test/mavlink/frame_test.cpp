// SPDX-License-Identifier: BSD-3-Clause
// Frames byte by byte: checksum, layout, truncation; and back again. The bytes of node-mavlink of
// npm (found through NODE_PATH) for the same fields, where it is installed.
#include <gtest/gtest.h>

#include <bit>
#include <cstdlib>
#include <fstream>
#include <string>

#include "mavlink/random_messages.hpp"
#include "rio/mavlink/frame.hpp"
#include "support/temp_dir.hpp"

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

bool runs(const std::string& command) {
  return std::system((command + " >/dev/null 2>&1").c_str()) == 0;
}

/// A number as the referee takes it: of a float, the integer of its bits.
template <class Number>
std::string number_text(const Number& number) {
  if constexpr (std::is_same_v<Number, float>) {
    return std::to_string(std::bit_cast<std::uint32_t>(number));
  } else {
    return std::to_string(number);
  }
}

/// Random messages as lines for the referee, as our frames, and as payloads.
class Messages {
 public:
  template <class Message>
  void add(const char* name, int version = 2) {
    const Message message = random_message<Message>(&random_);
    lines_ += std::string(name) + " " + std::to_string(version) + " " +
              std::to_string(writer_.sequence()) + " 17 197";
    for_each_number(message, [this](const auto& n) { lines_ += " " + number_text(n); });
    lines_ += "\n";
    append(&frames_, frame_of(message, &writer_));
    const auto payload = payload_of(message);
    const auto size = version == 1 ? Message::kBasicSize : Message::kSize;
    payloads_.emplace_back(payload.begin(), payload.begin() + static_cast<long>(size));
  }

  /// Of the referee.
  Bytes frames() const {
    const rio::test::TempDir dir;
    const std::string in = dir.path() / "messages";
    const std::string out = dir.path() / "frames";
    std::ofstream(in) << lines_;
    EXPECT_TRUE(runs("node " RIO_SOURCE_DIR "/test/mavlink/referee.cjs " + in + " " + out));
    const std::string text = rio::test::text_of(out);
    return {text.begin(), text.end()};
  }
  const Bytes& ours() const { return frames_; }
  const std::vector<Bytes>& payloads() const { return payloads_; }

 private:
  sim::Random random_{99};
  Writer writer_{{17, 197}};
  std::string lines_;
  Bytes frames_;
  std::vector<Bytes> payloads_;
};

bool no_referee() {
  return !runs("node -e 'require(\"node-mavlink\")'");
}

TEST(MavlinkReferee, TheSameBytesForAThousandMessages) {
  if (no_referee()) GTEST_SKIP() << "skipped: needs node and node-mavlink in NODE_PATH";
  Messages messages;
  for (int i = 0; i < 500; ++i) messages.add<OdometryMessage>("ODOMETRY");
  for (int i = 0; i < 250; ++i) messages.add<Heartbeat>("HEARTBEAT");
  for (int i = 0; i < 250; ++i) messages.add<Timesync>("TIMESYNC");
  for (int i = 0; i < 100; ++i) messages.add<HighresImu>("HIGHRES_IMU");
  const Bytes theirs = messages.frames();
  ASSERT_EQ(theirs.size(), messages.ours().size());
  EXPECT_TRUE(theirs == messages.ours());
}

TEST(MavlinkReferee, ItsFramesOfBothVersionsAreRead) {
  if (no_referee()) GTEST_SKIP() << "skipped: needs node and node-mavlink in NODE_PATH";
  Messages messages;
  for (int i = 0; i < 200; ++i) {
    messages.add<HighresImu>("HIGHRES_IMU");
    messages.add<RawImu>("RAW_IMU");
    messages.add<ScaledImu>("SCALED_IMU");
    messages.add<Timesync>("TIMESYNC");
    messages.add<Heartbeat>("HEARTBEAT", i % 2 + 1);
  }
  Parser parser;
  const std::vector<Packet> packets = parse(&parser, messages.frames(), 13);
  ASSERT_EQ(packets.size(), messages.payloads().size());
  for (std::size_t i = 0; i < packets.size(); ++i) {
    const Bytes& expected = messages.payloads()[i];
    EXPECT_TRUE(std::equal(expected.begin(), expected.end(), packets[i].payload.begin())) << i;
    EXPECT_EQ(packets[i].sequence, i % 256);
  }
  EXPECT_EQ(parser.counters().damaged, 0U);
}

}  // namespace
}  // namespace rio::mavlink::test
