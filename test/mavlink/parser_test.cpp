// SPDX-License-Identifier: BSD-3-Clause
// Whatever is around a frame, it is found; nothing else is.
#include "rio/mavlink/parser.hpp"

#include <gtest/gtest.h>

#include <chrono>

#include "mavlink/random_messages.hpp"
#include "rio/testing/allocation_guard.hpp"
#include "support/measured.hpp"

namespace rio::mavlink::test {
namespace {

Bytes some_frame(sim::Random* random, Writer* writer) {
  switch (random->next() % 4) {
    case 0:
      return frame_of(random_message<Heartbeat>(random), writer);
    case 1:
      return frame_of(random_message<Timesync>(random), writer);
    case 2:
      return frame_of(random_message<HighresImu>(random), writer);
    default:
      return frame_of(random_message<OdometryMessage>(random), writer);
  }
}

/// A quarter of it magic bytes.
Bytes noise(sim::Random* random, std::size_t count) {
  Bytes bytes(count);
  for (std::uint8_t& b : bytes) {
    b = static_cast<std::uint8_t>(random->next());
    if (random->next() % 4 == 0) b = random->next() % 2 == 0 ? kMagicV1 : kMagicV2;
  }
  return bytes;
}

/// Appends the checksum of a frame.
void close(Bytes* frame, std::uint8_t crc_extra) {
  Crc16 crc;
  crc.add(frame->data() + 1, frame->size() - 1);
  crc.add(&crc_extra, 1);
  frame->push_back(static_cast<std::uint8_t>(crc.value()));
  frame->push_back(static_cast<std::uint8_t>(crc.value() >> 8));
}

/// Version 1 of a frame of version 2.
Bytes as_version_1(const Bytes& v2, std::size_t basic_size, std::uint8_t crc_extra) {
  Bytes bytes = {kMagicV1, static_cast<std::uint8_t>(basic_size), v2[4], v2[5], v2[6], v2[7]};
  Bytes payload(v2.begin() + 10, v2.end() - 2);
  payload.resize(basic_size);
  append(&bytes, payload);
  close(&bytes, crc_extra);
  return bytes;
}

TEST(MavlinkParser, ThePiecesDoNotMatter) {
  sim::Random random(1);
  Writer writer;
  Bytes bytes;
  for (int i = 0; i < 60; ++i) {
    append(&bytes, noise(&random, random.next() % 60));
    append(&bytes, some_frame(&random, &writer));
  }
  for (const std::size_t piece : {1U, 2U, 7U, 100U, 5000U}) {
    Parser parser;
    const std::vector<Packet> packets = parse(&parser, bytes, piece);
    ASSERT_EQ(packets.size(), 60U) << piece;
    for (std::size_t i = 0; i < 60; ++i) EXPECT_EQ(packets[i].sequence, i);
    EXPECT_EQ(parser.counters().frames, 60U);
    EXPECT_EQ(parser.counters().bytes, bytes.size());
  }
}

TEST(MavlinkParser, AFrameComesWithItsLastByte) {
  Writer writer;
  Bytes bytes = {kMagicV2, 233, 0, 0, 0, 1, 1, 0x4B, 1, 0};  // a long frame that never comes
  append(&bytes, frame_of(Heartbeat{}, &writer));
  Parser parser;
  const std::vector<Packet> packets = parse(&parser, bytes, 1);
  ASSERT_EQ(packets.size(), 1U);
  EXPECT_EQ(packets[0].arrival, Time(static_cast<long>(bytes.size()) - 1));
}

TEST(MavlinkParser, ADamagedFrameCostsNoOther) {
  sim::Random random(2);
  for (int n = 0; n < 400; ++n) {
    Writer writer;
    Bytes bytes = some_frame(&random, &writer);
    Bytes damaged = some_frame(&random, &writer);
    const std::size_t at = random.next() % damaged.size();
    damaged[at] = static_cast<std::uint8_t>(damaged[at] ^ (1U << random.next() % 8));
    append(&bytes, damaged);
    append(&bytes, some_frame(&random, &writer));
    append(&bytes, some_frame(&random, &writer));
    Parser parser;
    const std::vector<Packet> packets = parse(&parser, bytes, 64);
    ASSERT_EQ(packets.size(), 3U) << n;
    EXPECT_EQ(packets[0].sequence, 0);
    EXPECT_EQ(packets[1].sequence, 2);
    EXPECT_EQ(packets[2].sequence, 3);
  }
}

TEST(MavlinkParser, VersionOneHasNoExtensions) {
  Writer writer({9, 1});
  ScaledImu imu;
  imu.time_boot_ms = 77;
  imu.mag[2] = -5;
  const Bytes v2 = frame_of(imu, &writer);
  Parser parser;
  const std::vector<Packet> packets = parse(&parser, as_version_1(v2, 22, 170));
  ASSERT_EQ(packets.size(), 1U);
  EXPECT_EQ(packets[0].version, 1);
  EXPECT_EQ(packets[0].from.system, 9);
  ScaledImu received;
  ASSERT_TRUE(packets[0].read(&received));
  EXPECT_EQ(payload_of(imu), payload_of(received));
  EXPECT_TRUE(parse(&parser, as_version_1(v2, 24, 170)).empty());  // not its length
  EXPECT_TRUE(parse(&parser, as_version_1(v2, 22, 171)).empty());  // another definition
}

TEST(MavlinkParser, SignedAndLongerFramesAreRead) {
  Writer writer;
  Bytes bytes = frame_of(Heartbeat{}, &writer);
  bytes.resize(bytes.size() - 2);
  bytes[1] = 12;  // a later version of the message with three bytes more
  bytes[2] = kFlagSigned;
  append(&bytes, {5, 6, 7});
  close(&bytes, Heartbeat::kCrcExtra);
  Parser parser;
  EXPECT_TRUE(parse(&parser, bytes).empty());
  EXPECT_EQ(parse(&parser, Bytes(kSignature, 1)).size(), 1U);
  bytes[2] = 2;  // a flag that changes who knows what
  bytes.resize(bytes.size() - 2);
  close(&bytes, Heartbeat::kCrcExtra);
  append(&bytes, Bytes(kSignature, 1));
  EXPECT_TRUE(parse(&parser, bytes).empty());
}

TEST(MavlinkParser, OtherMessagesArePassedOver) {
  Writer writer;
  Bytes bytes = frame_of(Heartbeat{}, &writer);
  Bytes other = bytes;
  other[7] = 1;  // SYS_STATUS
  Bytes all = other;
  append(&all, bytes);
  append(&all, other);
  Parser parser;
  const std::vector<Packet> packets = parse(&parser, all);
  ASSERT_EQ(packets.size(), 1U);
  Timesync timesync;
  timesync.tc1 = 5;
  EXPECT_FALSE(packets[0].read(&timesync));
  EXPECT_EQ(timesync.tc1, 5);
}

TEST(MavlinkParser, OfNoiseHardlyAnythingComes) {
  sim::Random random(3);
  Parser parser;
  const Bytes bytes = noise(&random, 2'000'000);
  const auto begin = std::chrono::steady_clock::now();
  const std::size_t frames = parse(&parser, bytes).size();
  const double seconds = to_seconds(std::chrono::steady_clock::now() - begin);
  rio::test::measured("worst stream, MB/s", 2.0 / seconds, "a UART has 0.1");
  // each wrong checksum is right by chance in one of 65536
  EXPECT_LE(static_cast<double>(frames),
            5.0 + 3.0 * static_cast<double>(parser.counters().damaged) / 65536.0);
}

TEST(MavlinkParser, WhatIsPendingCanBeDropped) {
  Writer writer;
  const Bytes bytes = frame_of(Heartbeat{}, &writer);
  Parser parser;
  parse(&parser, Bytes(bytes.begin(), bytes.begin() + 12));
  parser.drop_pending();
  EXPECT_TRUE(parse(&parser, Bytes(bytes.begin() + 12, bytes.end())).empty());
  EXPECT_EQ(parse(&parser, bytes).size(), 1U);
}

TEST(MavlinkParser, AllocatesNothing) {
  if (!rio::test::AllocationGuard::kWorks) GTEST_SKIP() << "a sanitizer owns malloc";
  sim::Random random(4);
  Writer writer;
  Bytes bytes;
  for (int i = 0; i < 50; ++i) append(&bytes, some_frame(&random, &writer));
  const OdometryMessage message = random_message<OdometryMessage>(&random);
  std::array<std::uint8_t, kMaxFrame> buffer;
  const rio::test::AllocationGuard guard;
  Parser parser;
  int count = 0;
  parser.push(bytes.data(), bytes.size(), Time{0}, [&](const Packet&) { ++count; });
  EXPECT_GT(writer.write(message, buffer.data(), buffer.size()), 200U);
  EXPECT_EQ(guard.count(), 0);
  EXPECT_EQ(count, 50);
}

}  // namespace
}  // namespace rio::mavlink::test
