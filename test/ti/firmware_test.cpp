// SPDX-License-Identifier: BSD-3-Clause
// Packets of all firmware of the table: read, or named; and what else may come from a port.
#include "rio/ti/firmware.hpp"

#include <gtest/gtest.h>

#include <random>

#include "support/temp_dir.hpp"
#include "ti/reading.hpp"

namespace rio::ti::test {
namespace {

using rio::test::contains;
using Tlvs = std::vector<std::pair<std::uint32_t, Bytes>>;

/// Points on all grids but those of the angles.
std::vector<WrittenPoint> points_of(int count) {
  std::vector<WrittenPoint> points;
  for (int i = 0; i < count; ++i) {
    points.push_back({0.25F * static_cast<float>(i % 7 - 3), 2.0F + 0.125F * static_cast<float>(i),
                      0.25F * static_cast<float>(i % 5 - 2), 0.125F * static_cast<float>(i % 9 - 4),
                      static_cast<std::int16_t>(100 + 20 * i), 500});
  }
  return points;
}

WrittenPacket packet_with(std::uint32_t version, std::uint32_t platform, int points, Tlvs tlvs) {
  WrittenPacket packet;
  packet.version = version;
  packet.platform = platform;
  packet.number = 101;
  packet.objects = static_cast<std::uint32_t>(points);
  packet.tlvs = std::move(tlvs);
  return packet;
}
constexpr std::uint32_t kSdk36 = 0x03060000, kXwr68 = 0xA6843, kSdk55 = 0x05050002;

WrittenPacket low_power(int points, int side) {
  return packet_with(kSdk55, 0xA6432, points, {{301, compressed_tlv(points_of(points), side)}});
}
WrittenPacket tracking(int points) {
  return packet_with(kSdk36, kXwr68, points, {{1020, spherical_tlv(points_of(points))}});
}
WrittenPacket mrr(int points, int size) {
  return packet_with(0x03050001, 0xA1843, points, {{1, fixed_point_tlv(points_of(points), size)}});
}

/// Largest difference of a coordinate or the Doppler; huge if a point is missing.
double difference(const RadarScan& scan, const std::vector<WrittenPoint>& points) {
  if (scan.detections.size() != points.size()) return 1e9;
  double most = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const RadarDetection& d = scan.detections[i];
    const Vector3d p(points[i].y, -points[i].x, points[i].z);
    most = std::max(
        {most, (d.point_S - p).cwiseAbs().maxCoeff(), std::abs(d.range_rate - points[i].velocity)});
  }
  return most;
}

/// The one frame of a packet, with padding and without.
RadarScan scan_of(const WrittenPacket& packet) {
  Reading reading;
  reading.push(unpadded(packet));
  reading.push(packet.bytes());
  reading.flush();
  EXPECT_EQ(reading.counters().damaged + reading.counters().other_sdk, 0U);
  if (packet.objects > 0) {
    EXPECT_EQ(reading.reader.problem(), "");
  }
  if (reading.frames.size() != 2) {
    ADD_FAILURE() << reading.frames.size() << " frames";
    return {};
  }
  EXPECT_EQ(reading.frames[0].scan.detections.size(), reading.frames[1].scan.detections.size());
  EXPECT_EQ(reading.frames[1].version, packet.version);
  return reading.frames[1].scan;
}

/// Expects no frame of the packet; what the reader says.
std::string refused(const Bytes& packet) {
  Reading reading;
  reading.push(joined({packet, packet, packet}));
  reading.flush();
  EXPECT_EQ(reading.frames.size(), 0U);
  EXPECT_EQ(reading.counters().damaged + reading.counters().other_sdk, 3U);
  return reading.reader.problem();
}

TEST(TiFirmware, TheLayoutOfSdk3IsReadOfLaterOnes) {
  const auto points = points_of(19);
  for (const auto& [version, platform, subframe] :
       {std::tuple{0x04070201U, 0xA2944U, 0U}, std::tuple{0x04050000U, 0xA2944U, 0U},
        std::tuple{kSdk55, 0xA6432U, ~0U}, std::tuple{0x05030000U, 0xA1432U, ~0U},
        std::tuple{0x06000100U, 0xA6844U, 0U}, std::tuple{0x03000000U, 0xA6843U, 1U}}) {
    WrittenPacket packet = packet_with(version, platform, 19,
                                       {{7, side_tlv(points)},
                                        {2, Bytes(512, 1)},
                                        {306, Bytes(24, 2)},
                                        {1, points_tlv(points)},
                                        {9, Bytes(28, 3)},
                                        {4711, Bytes(5, 4)},
                                        {6, Bytes(24, 5)}});
    packet.subframe = subframe;
    const RadarScan scan = scan_of(packet);
    ASSERT_EQ(difference(scan, points), 0.0) << version;
    EXPECT_DOUBLE_EQ(scan.detections.back().snr_db, 46.0) << version;
  }
}

TEST(TiFirmware, CompressedPointsAreRead) {
  for (const int count : {0, 1, 19, 150}) {
    for (const int side : {1, 2}) {
      WrittenPacket packet = low_power(count, side);
      packet.tlvs.insert(packet.tlvs.begin(), {302, Bytes(64, 1)});
      packet.tlvs.emplace_back(306, Bytes(24, 2));
      const RadarScan scan = scan_of(packet);
      EXPECT_EQ(difference(scan, points_of(count)), 0.0) << count << " " << side;
      if (count != 19 || scan.detections.size() != 19) continue;
      EXPECT_DOUBLE_EQ(scan.detections[3].snr_db, 16.0);
      EXPECT_DOUBLE_EQ(scan.detections[3].noise_db, 50.0);
    }
  }
}

TEST(TiFirmware, SphericalPointsAreRead) {
  for (const int count : {1, 19, 150}) {
    WrittenPacket packet = tracking(count);
    packet.tlvs.emplace_back(1011, Bytes(static_cast<std::size_t>(count), 255));
    packet.tlvs.insert(packet.tlvs.begin(), {1010, Bytes(112, 1)});
    const RadarScan scan = scan_of(packet);
    // half a grid of 0.01 rad at 21 m, of two angles
    ASSERT_LT(difference(scan, points_of(count)), 0.0051 * 2 * (2 + 0.125 * count)) << count;
    EXPECT_NEAR(scan.detections[0].snr_db, 10.0, 0.021);
  }
  Bytes payload;
  for (const float value : {2.0F, 0.5F, -0.25F, 1.5F}) put_float(&payload, value);
  Bytes side;
  put(&side, 153, 2);
  put(&side, 421, 2);
  const RadarScan scan = scan_of(packet_with(kSdk36, kXwr68, 1, {{1000, payload}, {7, side}}));
  ASSERT_EQ(scan.detections.size(), 1U);
  const Vector3d wanted = 2.0 * Vector3d(std::cos(-0.25) * std::cos(0.5),
                                         -std::cos(-0.25) * std::sin(0.5), std::sin(-0.25));
  EXPECT_LT((scan.detections[0].point_S - wanted).norm(), 1e-12);
  EXPECT_EQ(scan.detections[0].range_rate, 1.5);
  EXPECT_DOUBLE_EQ(scan.detections[0].snr_db, 15.3);
  EXPECT_DOUBLE_EQ(scan.detections[0].noise_db, 42.1);
}

TEST(TiFirmware, CountsThatContradictAreNoPoints) {
  const auto points = points_of(8);
  for (WrittenPacket packet :
       {packet_with(kSdk36, kXwr68, 8, {{1, points_tlv(points)}, {7, side_tlv(points)}}),
        packet_with(0x04070201, 0xA2944, 8, {{1, points_tlv(points)}}), low_power(8, 1),
        low_power(8, 2), tracking(8)}) {
    for (const std::uint32_t objects : {0U, 7U, 9U, 16U, ~0U}) {
      packet.objects = objects;
      refused(packet.bytes());
      refused(unpadded(packet));
    }
  }
  for (const unsigned major : {0U, 6U, 8U}) {
    WrittenPacket packet = low_power(8, 1);
    packet.tlvs[0].second[16] = static_cast<std::uint8_t>(major);  // of 7, and one of minor motion
    refused(packet.bytes());
  }
  for (const float unit : {0.0F, -0.01F, 1e9F, std::numeric_limits<float>::quiet_NaN()}) {
    for (const WrittenPacket& packet : {low_power(8, 1), tracking(8)}) {
      for (std::size_t i = 0; i < 4; ++i) {
        WrittenPacket other = packet;
        std::memcpy(&other.tlvs[0].second[4 * i], &unit, sizeof unit);
        refused(other.bytes());
      }
    }
  }
}

TEST(TiFirmware, ObjectsOfMrrAreNoPoints) {
  for (int count = 0; count < 60; ++count) {
    for (const int size : {10, 14}) {
      WrittenPacket packet = mrr(count, size);
      packet.tlvs.emplace_back(2, Bytes(12, 1));
      packet.tlvs.emplace_back(3, Bytes(16, 2));
      EXPECT_PRED2(contains, refused(packet.bytes()), "TLV 1 of another demo: MRR")
          << count << " " << size;
      EXPECT_PRED2(contains, refused(unpadded(packet)), "out-of-box demo of SDK 3.x") << count;
    }
    if (count == 0) continue;
    for (const std::size_t size : {8U, 12U, 15U, 20U, 24U}) {  // of yet another demo
      const Bytes payload(size * static_cast<std::size_t>(count), 0x3E);
      const auto packet = packet_with(kSdk36, kXwr68, count, {{1, payload}});
      EXPECT_PRED2(contains, refused(packet.bytes()), "another demo") << count << " " << size;
    }
  }
}

TEST(TiFirmware, PeopleCountingWithALongerHeaderIsNamed) {
  for (const bool timestamp : {false, true}) {
    for (const std::uint32_t times : {0U, 1U, 2U, 3U, 100U, 4000U, 70000U}) {
      for (const int count : {0, 1, 19}) {
        WrittenPacket packet = packet_with(0x03050000, kXwr68, count, {{11, Bytes(4, 1)}});
        for (int tlvs = 0; tlvs < 3; ++tlvs) {
          const Bytes bytes = with_long_header(packet, timestamp, times);
          EXPECT_PRED2(contains, refused(bytes), timestamp ? "header of 52" : "header of 48")
              << times << " " << count << " " << tlvs;
          packet.tlvs.emplace_back(6 + tlvs, spherical_tlv(points_of(count)));
        }
      }
    }
  }
}

/// Whole packets by totalPacketLen, whatever stands in them.
TEST(TiFirmware, AnotherHeaderIsNotTakenForDamage) {
  for (const std::size_t header : {44U, 56U, 64U}) {
    Reading reading;
    for (std::uint32_t number = 1; number < 40; ++number) {
      Bytes bytes = packet_with(kSdk36, kXwr68, 5, {}).bytes();
      bytes.resize(40);
      bytes.resize(header, 0x77);
      bytes.resize(header + 8 * number, 0x11);
      bytes[12] = static_cast<std::uint8_t>(bytes.size());
      bytes[13] = static_cast<std::uint8_t>(bytes.size() >> 8);
      bytes[32] = 3;  // TLVs
      reading.push(bytes);
      EXPECT_EQ(reading.reader.state() == StreamState::kOtherDemo, number > 2) << number;
    }
    EXPECT_EQ(reading.frames.size(), 0U);
    EXPECT_PRED2(contains, reading.reader.problem(), "the header or the points of another demo");
  }
}

/// Packets that are not read and lose their last bytes, in two pieces.
TEST(TiFirmware, ThePiecesDoNotDecideWhatIsDamaged) {
  for (std::size_t missing = 0; missing < kMagicSize; ++missing) {
    Bytes bytes = mrr(3, 10).bytes();
    bytes.resize(bytes.size() - missing);
    bytes = joined({bytes, packet_of(2, some_points(2, 3)).bytes()});
    for (std::size_t split = 0; split <= bytes.size(); ++split) {
      Reading reading;
      reading.push_split(bytes, split);
      ASSERT_EQ(reading.counters().damaged, missing == 0 ? 0U : 1U) << missing << " " << split;
      ASSERT_EQ(reading.counters().other_sdk, missing == 0 ? 1U : 0U) << missing << " " << split;
      ASSERT_EQ(reading.numbers(), (std::vector<std::uint32_t>{2}));
    }
  }
}

/// Packets as a recorder writes them that drops the last bytes of each.
Bytes cut(std::uint32_t number, int points, std::size_t missing) {
  Bytes bytes = packet_of(number, some_points(number, points)).bytes();
  bytes.resize(bytes.size() - missing);
  return bytes;
}

TEST(TiFirmware, PacketsThatAllEndEarlyAreUsedWhereThatIsPadding) {
  for (std::size_t missing = 1; missing < kMagicSize; ++missing) {
    Reading reading;
    std::size_t padded = 0;
    for (std::uint32_t number = 1; number <= 45; ++number) {
      const int count = static_cast<int>(number % 9);
      reading.push(cut(number, count, missing));
      const std::size_t size = 48 + (count > 0 ? 8U : 0U) + 20U * static_cast<unsigned>(count);
      padded += number > 1 && (32 - size % 32) % 32 >= missing ? 1 : 0;
    }
    reading.flush();  // what was last is complete after a pause, too
    EXPECT_EQ(reading.counters().cut_short, 45U) << missing;
    EXPECT_EQ(reading.frames.size(), padded) << missing;
    for (const Frame& frame : reading.frames) {
      const int count = static_cast<int>(frame.number % 9);
      EXPECT_TRUE(is_frame_of(frame, frame.number, some_points(frame.number, count)));
    }
    EXPECT_EQ(reading.reader.state(), StreamState::kCutShort);
    const std::string early = missing == 1 ? "ends one byte early" : " bytes early";
    EXPECT_PRED2(contains, reading.reader.problem(), early);
  }
}

TEST(TiFirmware, APacketThatEndsEarlyAmongWholeOnesIsDamaged) {
  Reading reading;
  reading.push(joined({cut(1, 3, 1), cut(2, 3, 2), packet_of(3, some_points(3, 3)).bytes()}));
  EXPECT_EQ(reading.numbers(), (std::vector<std::uint32_t>{3}));
  for (std::uint32_t number = 4; number < 20; ++number) reading.push(cut(number, 3, 1));
  reading.flush();
  EXPECT_EQ(reading.frames.size(), 1U);
  EXPECT_EQ(reading.reader.state(), StreamState::kDamaged);
  EXPECT_PRED2(contains, reading.reader.problem(), "bytes are lost");
}

/// One byte of each is lost, anywhere behind the magic word: few end early by chance.
TEST(TiFirmware, LostBytesAreNoRecorderThatCutsPackets) {
  std::mt19937 random(3);
  Reading reading;
  for (std::uint32_t number = 1; number < 300; ++number) {
    Bytes bytes = packet_of(number, some_points(number, 10)).bytes();
    bytes.erase(bytes.begin() + 8 + static_cast<long>(random() % (bytes.size() - 8)));
    reading.push(bytes);
    if (number > 20) {
      ASSERT_EQ(reading.reader.state(), StreamState::kDamaged) << number;
    }
  }
  EXPECT_GT(reading.counters().cut_short, 20U);
  EXPECT_PRED2(contains, reading.reader.problem(), "bytes are lost");
}

TEST(TiFirmware, ManyDamagedPacketsAreAProblemAlsoAmongWholeOnes) {
  Reading reading;
  for (std::uint32_t number = 1; number <= 100; ++number) {
    reading.push(number % 5 == 0 ? packet_of(number, some_points(number, 3)).bytes()
                                 : cut(number, 3, 20));
  }
  EXPECT_EQ(reading.reader.problem().rfind("80 packets are damaged, 20 whole: bytes are lost", 0),
            0U)
      << reading.reader.problem();
  for (std::uint32_t number = 101; number <= 400; ++number) {
    reading.push(packet_of(number, some_points(number, 3)).bytes());
  }
  EXPECT_EQ(reading.reader.problem(), "");
}

TEST(TiFirmware, PacketsTooLongForTheBufferAreNamed) {
  Reading reading;
  for (std::uint32_t number = 1; number <= 3; ++number) {
    WrittenPacket packet = packet_of(number, points_of(9));
    packet.tlvs.emplace_back(4, Bytes(98304, 3));  // heat map of 256 bins and 12 antennas, twice
    packet.tlvs.emplace_back(5, Bytes(98304, 4));
    reading.push(packet.bytes());
    EXPECT_PRED2(contains, reading.reader.problem(), "packets of 196864 bytes") << number;
    EXPECT_PRED2(contains, reading.reader.problem(), "switch the heat maps off (guiMonitor)");
  }
  reading.push(Bytes(300000, 3));
  EXPECT_EQ(reading.reader.state(), StreamState::kSearching);
}

std::string times(int count, const std::string& text) {
  std::string all;
  for (int i = 0; i < count; ++i) all += text;
  return all;
}
std::string text_of(const WrittenPacket& packet) {
  const Bytes bytes = packet.bytes();
  return {bytes.begin(), bytes.end()};
}

TEST(TiFirmware, WhatGivesNoPointsIsNamedWithWhatToDo) {
  std::mt19937 random(4);
  std::string noise(3000, ' ');
  for (char& byte : noise) byte = static_cast<char>(random());
  const std::string rest(3000, '\x11');
  std::vector<WrittenPoint> infinite = some_points(1, 6);
  for (WrittenPoint& p : infinite) p.velocity = std::numeric_limits<float>::infinity();
  WrittenPacket old = packet_with(0, 0xA1642, 19, {{1, fixed_point_tlv(points_of(19), 12)}});
  std::vector<std::string> olds;
  for (const std::uint32_t version : {0x01000000U, 0x01020005U, 0x02010004U}) {
    old.version = version;
    for (const bool with_subframe : {true, false}) {
      old.with_subframe = with_subframe;
      olds.push_back(text_of(old));
    }
  }
  const std::string silent = text_of(packet_with(kSdk36, kXwr68, 0, {{6, Bytes(24, 1)}}));
  const std::string unknown =
      text_of(packet_with(kSdk36, kXwr68, 12, {{6, Bytes(24, 1)}, {3001, Bytes(96, 1)}}));
  struct Row {
    std::string bytes;
    StreamState state;
    std::vector<const char*> said;
  };
  std::vector<Row> rows = {
      {"", StreamState::kSilent, {"no byte yet"}},
      {"sensorStop\r\nDone\r\n\r\nmmwDemo:/>", StreamState::kText, {"CLI port"}},
      {noise,
       StreamState::kSearching,
       {"another baud rate", "921600", "3125000 for AWR2944", "1250000"}},
      {"\x1F\x8B\x08" + rest, StreamState::kSearching, {"(gzip): unpack it first"}},
      {"BZh9" + rest, StreamState::kSearching, {"(bzip2)"}},
      {"PK\x03\x04" + rest, StreamState::kSearching, {"(zip)"}},
      {"\x28\xB5\x2F\xFD" + rest, StreamState::kSearching, {"(zstd)"}},
      {"BZ" + rest, StreamState::kSearching, {"another baud rate"}},
      {times(40, "00000010: 0201 0403 0605 0807 0000 0603 a000 0000  ................\n"),
       StreamState::kText,
       {"give the bytes themselves"}},
      {silent, StreamState::kFrames, {"or guiMonitor does not send them"}},
      {silent + unknown, StreamState::kFrames, {"TLV 3001"}},
      {text_of(packet_of(1, infinite)), StreamState::kFrames, {"6 points, none of them finite"}},
  };
  for (const std::string& bytes : olds) {
    rows.push_back(
        {bytes, StreamState::kOldSdk, {"packets of SDK 1 or 2", "load a demo of SDK 3.x"}});
  }
  for (const Row& row : rows) {
    Reading reading;
    for (const char c : row.bytes) reading.push(Bytes(1, static_cast<std::uint8_t>(c)));
    EXPECT_EQ(reading.reader.state(), row.state) << row.said[0];
    EXPECT_EQ(reading.counters().points, 0U) << row.said[0];
    for (const char* part : row.said) EXPECT_PRED2(contains, reading.reader.problem(), part);
  }
  Reading damaged;
  for (int i = 0; i < 3000; ++i) damaged.push(cut(1, 40, 20));
  EXPECT_EQ(damaged.reader.state(), StreamState::kDamaged) << damaged.reader.problem();
}

}  // namespace
}  // namespace rio::ti::test
