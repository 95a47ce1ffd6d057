// SPDX-License-Identifier: BSD-3-Clause
// What may come from a port instead of whole packets: named, with what to do.
#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <string>
#include <vector>

#include "support/temp_dir.hpp"
#include "ti/packets.hpp"

namespace rio::ti::test {
namespace {

using rio::test::contains;

/// Packets that are not read and lose their last bytes, in two pieces.
TEST(TiProblem, ThePiecesDoNotDecideWhatIsDamaged) {
  for (std::size_t missing = 0; missing < kMagicSize; ++missing) {
    Bytes bytes = mrr(3, 10).bytes();
    bytes.resize(bytes.size() - missing);
    bytes = joined({bytes, some_packet(2, 3).bytes()});
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
  Bytes bytes = some_packet(number, points).bytes();
  bytes.resize(bytes.size() - missing);
  return bytes;
}

TEST(TiProblem, PacketsThatAllEndEarlyAreUsedWhereThatIsPadding) {
  for (std::size_t missing = 1; missing < kMagicSize; ++missing) {
    Reading reading;
    std::size_t padded = 0;
    for (std::uint32_t number = 1; number <= 45; ++number) {
      const int count = static_cast<int>(number % 9);
      reading.push(cut(number, count, missing));
      padded += number > 1 && padding_of(count) >= missing ? 1 : 0;
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

TEST(TiProblem, APacketThatEndsEarlyAmongWholeOnesIsDamaged) {
  Reading reading;
  reading.push(joined({cut(1, 3, 1), cut(2, 3, 2), some_packet(3, 3).bytes()}));
  EXPECT_EQ(reading.numbers(), (std::vector<std::uint32_t>{3}));
  for (std::uint32_t number = 4; number < 20; ++number) reading.push(cut(number, 3, 1));
  reading.flush();
  EXPECT_EQ(reading.frames.size(), 1U);
  EXPECT_EQ(reading.reader.state(), StreamState::kDamaged);
  EXPECT_PRED2(contains, reading.reader.problem(),
               "16 packets are damaged, 1 whole: bytes are lost");
}

/// A whole one among packets that all end early, the first or a later one.
TEST(TiProblem, OneWholePacketDoesNotHideThatAllOthersEndEarly) {
  for (const std::uint32_t whole : {1U, 20U}) {
    Reading reading;
    for (std::uint32_t number = 1; number <= 60; ++number) {
      reading.push(number == whole ? some_packet(number, 3).bytes() : cut(number, 3, 1));
    }
    EXPECT_EQ(reading.reader.state(), StreamState::kCutShort) << whole;
    EXPECT_PRED2(contains, reading.reader.problem(), "ends one byte early");
    EXPECT_GT(reading.frames.size(), 15U) << whole;
    EXPECT_TRUE(is_frame_of(reading.frames.back(), 59, some_points(59, 3)));
  }
}

/// One byte of each is lost, anywhere behind the magic word: few end early by chance.
TEST(TiProblem, LostBytesAreNoRecorderThatCutsPackets) {
  std::mt19937 random(3);
  Reading reading;
  for (std::uint32_t number = 1; number < 300; ++number) {
    Bytes bytes = some_packet(number, 10).bytes();
    bytes.erase(bytes.begin() + 8 + static_cast<long>(random() % (bytes.size() - 8)));
    reading.push(bytes);
    if (number > 20) {
      ASSERT_EQ(reading.reader.state(), StreamState::kDamaged) << number;
    }
  }
  EXPECT_GT(reading.counters().cut_short, 20U);
  EXPECT_PRED2(contains, reading.reader.problem(), "bytes are lost");
}

TEST(TiProblem, ManyDamagedPacketsAreAProblemAlsoAmongWholeOnes) {
  Reading reading;
  for (std::uint32_t number = 1; number <= 100; ++number) {
    reading.push(number % 5 == 0 ? some_packet(number, 3).bytes() : cut(number, 3, 20));
  }
  EXPECT_TRUE(
      reading.reader.problem().starts_with("80 packets are damaged, 20 whole: bytes are lost"))
      << reading.reader.problem();
  for (std::uint32_t number = 101; number <= 400; ++number) {
    reading.push(some_packet(number, 3).bytes());
  }
  EXPECT_EQ(reading.reader.problem(), "");
}

TEST(TiProblem, PacketsTooLongForTheBufferAreNamed) {
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

/// As by a text encoding, which doubles some bytes.
TEST(TiProblem, ADamagedLengthIsNoHeatMap) {
  Reading reading;
  for (std::uint32_t number = 1; number <= 45; ++number) {
    Bytes bytes = some_packet(number, 20).bytes();
    bytes.insert(bytes.begin() + 12, 0x3C);  // the length has another byte before it
    reading.push(bytes);
  }
  EXPECT_EQ(reading.reader.state(), StreamState::kDamaged);
  EXPECT_PRED2(contains, reading.reader.problem(), "bytes are lost or changed on the way");
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

TEST(TiProblem, WhatGivesNoPointsIsNamedWithWhatToDo) {
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
    const char* said;
    std::vector<const char*> more{};
  };
  using enum StreamState;
  std::vector<Row> rows = {
      {"", kSilent,
       "no byte yet: is it the data port (a TI radar has two), and was the radar configured"},
      {"sensorStop\r\nDone\r\n\r\nmmwDemo:/>", kText, "CLI port"},
      {noise, kSearching, "another baud rate", {"921600", "3125000 for AWR2944", "1250000"}},
      {"\x1F\x8B\x08" + rest, kSearching, "(gzip): unpack it first"},
      {"BZh9" + rest, kSearching, "(bzip2)"},
      {"PK\x03\x04" + rest, kSearching, "(zip)"},
      {"\x28\xB5\x2F\xFD" + rest, kSearching, "(zstd)"},
      {"BZ" + rest, kSearching, "another baud rate"},
      {times(40, "00000010: 0201 0403 0605 0807 0000 0603 a000 0000  ................\n"), kText,
       "give the bytes themselves"},
      {times(30, std::string("RI\1") + std::string(35, '\x90')), kSearching,
       "samples of an IMU: give the data port of the radar; --imu and --radar may be exchanged"},
      {times(30, std::string("\xFD\x3E\0\0\x07\1\1\x69\0\0", 10) + std::string(64, '\x90')),
       kSearching,
       "MAVLink of an autopilot: give the data port of the radar; --imu and --radar may"},
      {times(30, "\xFE\x3E\x07\1\1\x69" + std::string(64, '\x90')), kSearching,
       "MAVLink of an autopilot: give the data port of the radar; --imu and --radar may"},
      {times(30, "\xB5\x62\x01\x07" + std::string(96, '\x90')), kSearching,
       "UBX of a GNSS receiver"},
      {times(30, "$GNGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47\r\n"), kText,
       "lines of a GNSS receiver or IMU (NMEA)"},
      {times(30, "1700000002500000000,-0.0135,0.0051,1e-4,-0.002,-0.011,9.994\n"), kText,
       "numbers in text, as of an IMU: give the data port of the radar; --imu and --radar may"},
      {times(30, "\\x02\\x01\\x04\\x03\\x06\\x05\\x08\\x07"), kText,
       "a dump in text (of Python): give the bytes themselves"},
      {times(60, "profileCfg 0 77 10 7 50 0 0 23.4 1 128 3200 0 0 30\r\nDone\r\nmmwDemo:/>"), kText,
       "this is the CLI port"},
      {times(30, "Starting kernel ...\r\n"), kText, "or that of another device"},
      {times(30, "$VNIMU,-01.05,+00.60,+00.36,-00.39,-00.02,-09.95,-00.00,+00.02,+00.01*65\r\n"),
       kText, "lines of a GNSS receiver or IMU"},
      {times(30, text_of(some_packet(1, 3)).substr(1)), kSearching, "begins some bytes late"},
      {times(30, text_of(some_packet(1, 3)).substr(4)), kSearching, "recorder or splitter"},
      {times(30, text_of(some_packet(1, 3)).substr(5)), kSearching, "another baud rate"},
      {silent, kFrames, "or guiMonitor does not send them (-1 1 ...)"},
      {text_of(packet_with(kSdk55, 0xA6432, 0, {{306, Bytes(24, 1)}})), kFrames,
       "nothing is detected, or guiMonitor does not send them (2 ...)"},
      {text_of(low_power(0, 1)), kFrames, "points: nothing is detected (clutter removal"},
      {text_of(packet_of(1, {})), kFrames, "points: nothing is detected (clutter removal"},
      {silent + unknown, kFrames, "TLV 3001 (an extension of TI's Radar Toolbox): set guiMonitor"},
      {text_of(packet_with(kSdk36, kXwr68, 0, {{1010, Bytes(112, 1)}})), kFrames,
       "TLV 1010 (tracked targets, of people tracking): nothing is detected"},
      {text_of(packet_with(kSdk55, 0xA6432, 0, {{1040, Bytes(136, 1)}})), kFrames,
       "TLV 1040 (vital signs): send the points, as TLV 1 or 301, with guiMonitor 1 ... or 2 ..."},
      {text_of(packet_of(1, infinite)), kFrames, "6 points, none of them finite"},
  };
  WrittenPacket contradicting = some_packet(1, 3);
  contradicting.version = 0x05040000;
  contradicting.tlvs[0].second.pop_back();
  rows.push_back({text_of(contradicting),
                  kNewSdk,
                  "packets of SDK 4 or later",
                  {"load the out-of-box demo of its SDK"}});
  for (const std::string& bytes : olds) {
    rows.push_back({bytes, kOldSdk, "packets of SDK 1 or 2", {"load a demo of SDK 3.x"}});
  }
  for (const Row& row : rows) {
    Reading reading;
    for (const char c : row.bytes) reading.push(Bytes(1, static_cast<std::uint8_t>(c)));
    EXPECT_EQ(reading.reader.state(), row.state) << row.said;
    EXPECT_EQ(reading.counters().points, 0U) << row.said;
    EXPECT_PRED2(contains, reading.reader.problem(), row.said);
    for (const char* part : row.more) EXPECT_PRED2(contains, reading.reader.problem(), part);
  }
  Reading damaged;
  for (int i = 0; i < 3000; ++i) damaged.push(cut(1, 40, 20));
  EXPECT_EQ(damaged.reader.state(), StreamState::kDamaged) << damaged.reader.problem();
}

}  // namespace
}  // namespace rio::ti::test
