// SPDX-License-Identifier: BSD-3-Clause
// Packets field by field; and long streams of them: what was not damaged is read, whatever is
// beside it, and fast.
#include <gtest/gtest.h>

#include <chrono>
#include <limits>
#include <random>

#include "rio/testing/allocation_guard.hpp"
#include "rio/ti/packet.hpp"
#include "support/measured.hpp"
#include "ti/packets.hpp"

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
  WrittenPacket packet = some_packet(1, 3);
  packet.tlvs.pop_back();
  const Frame frame = only_frame(packet);
  ASSERT_EQ(frame.scan.detections.size(), 3U);
  EXPECT_EQ(frame.scan.detections[2].snr_db, 0.0);
}

TEST(TiPacket, TheHeaderOfXwr14xxHasNoSubframe) {
  WrittenPacket packet = some_packet(7, 5);
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
  const Bytes bytes = some_packet(7, 5).bytes();  // 40, 8 + 80, 8 + 20 -> 160
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
  Bytes bytes = some_packet(7, 5).bytes();
  bytes[13] = 0x10;  // 4096 more
  for (std::size_t count = 0; count <= bytes.size(); ++count) {
    PacketWalk walk(65536);
    const PacketVerdict verdict = walk.advance(bytes.data(), count);
    EXPECT_EQ(verdict, count < 136 ? PacketVerdict::kMore : PacketVerdict::kDamaged) << count;
  }
}

using rio::test::measured;

class Cable {
 public:
  std::size_t below(std::size_t limit) { return random_() % limit; }

  Bytes noise(std::size_t count) {
    Bytes bytes(count);
    for (std::uint8_t& b : bytes) {
      b = static_cast<std::uint8_t>(below(4) == 0 ? kMagic[below(8)] : below(256));
    }
    return bytes;
  }

  /// Hands the bytes out in pieces of any size.
  template <class Push>
  void send(const Bytes& bytes, const Push& push) {
    for (std::size_t at = 0; at < bytes.size();) {
      const std::size_t piece = std::min(bytes.size() - at, 1 + below(200));
      push(bytes.data() + at, piece);
      at += piece;
    }
  }

  /// A packet with something wrong with it.
  Bytes damaged(Bytes bytes) {
    for (std::size_t n = 1 + below(3); n > 0; --n) damage(&bytes);
    return bytes;
  }

 private:
  void damage(Bytes* bytes) {
    if (bytes->size() < 48) return;
    const std::size_t at = below(bytes->size());
    const std::size_t count = std::min(bytes->size() - at, 1 + below(40));
    const auto from = bytes->begin() + static_cast<long>(at);
    const Bytes some = noise(count);
    switch (below(6)) {
      case 0:
        *from = static_cast<std::uint8_t>(*from ^ (1U << below(8)));
        break;
      case 1:  // a field of the header
        (*bytes)[8 + below(40)] = static_cast<std::uint8_t>(below(256));
        break;
      case 2:  // lost
        bytes->erase(from, from + static_cast<long>(count));
        break;
      case 3:  // the rest is lost
        bytes->resize(at);
        break;
      case 4:
        bytes->insert(from, some.begin(), some.end());
        break;
      default:
        std::copy(some.begin(), some.end(), from);
    }
  }

  std::mt19937 random_{7};
};

TEST(PacketStream, EveryUndamagedPacketIsRecovered) {
  constexpr std::uint32_t kPackets = 200000;
  Cable cable;
  PacketReader reader;
  std::vector<std::pair<std::uint32_t, int>> sent;  // number, points
  std::size_t recovered = 0;
  const auto on_frame = [&](const Frame& frame) {
    if (recovered == sent.size()) return;
    const auto [number, points] = sent[recovered];
    recovered += is_frame_of(frame, number, some_points(number, points)) ? 1 : 0;
  };
  for (std::uint32_t number = 1; number <= kPackets; ++number) {
    const int points = static_cast<int>(cable.below(12));
    Bytes bytes = some_packet(number, points).bytes();
    if (cable.below(3) == 0) {
      bytes = cable.damaged(bytes);
    } else {
      sent.emplace_back(number, points);
    }
    if (cable.below(8) == 0) bytes = joined({cable.noise(cable.below(60)), bytes});
    cable.send(bytes, [&](const std::uint8_t* piece, std::size_t size) {
      reader.push(piece, size, Time{0}, on_frame);
    });
    ASSERT_EQ(recovered, sent.size()) << "with its last byte, " << number;
  }
  const std::size_t damaged = kPackets - sent.size();
  measured("undamaged packets recovered [%]",
           100.0 * static_cast<double>(recovered) / static_cast<double>(sent.size()), "100");
  measured("damaged packets among them", static_cast<double>(damaged), "60000");
  EXPECT_GT(damaged, 60000U);
  EXPECT_GT(reader.counters().damaged, damaged / 2);
}

// A line that loses bytes, anywhere but in magic words, often few of them and near the end; packets
// of which many end as magic words begin.
TEST(PacketStream, NoFrameHasBytesOfAnother) {
  constexpr std::uint32_t kPackets = 300000;
  Cable cable;
  Reading reading;
  std::vector<std::pair<std::uint32_t, int>> sent;  // number, points
  std::size_t cut = 0, in_time = 0;
  for (std::uint32_t number = 1; number <= kPackets; ++number) {
    const int points = static_cast<int>(cable.below(12));
    Bytes bytes = some_packet(number, points).bytes();
    bytes = ending_in_magic(bytes, std::min(padding_of(points), cable.below(8)));
    if (cable.below(3) == 0) {
      const std::size_t most = cable.below(2) == 0 ? 7 : bytes.size() - kMagicSize;
      const std::size_t lost = 1 + cable.below(most);
      const std::size_t last = bytes.size() - lost;
      const std::size_t at = cable.below(2) == 0 ? last : 8 + cable.below(last - 7);
      const auto from = bytes.begin() + static_cast<long>(at);
      bytes.erase(from, from + static_cast<long>(lost));
      ++cut;
    } else {
      sent.emplace_back(number, points);
    }
    cable.send(bytes,
               [&](const std::uint8_t* piece, std::size_t size) { reading.push(piece, size); });
    in_time += reading.frames.size() == sent.size() ? 1 : 0;
  }
  reading.flush();
  ASSERT_EQ(reading.frames.size(), sent.size());
  for (std::size_t i = 0; i < sent.size(); ++i) {
    const auto [number, points] = sent[i];
    ASSERT_TRUE(is_frame_of(reading.frames[i], number, some_points(number, points))) << number;
  }
  measured("packets that lost bytes, of 300000", static_cast<double>(cut), "none handed out");
  measured("frames that waited for the next packet", static_cast<double>(kPackets - in_time), "");
  EXPECT_EQ(reading.counters().damaged, cut);
  EXPECT_GT(kPackets - in_time, kPackets / 4);
}

TEST(PacketStream, Throughput) {
  Bytes bytes;
  std::mt19937 random(3);
  std::uniform_real_distribution<float> metres(-10.0F, 10.0F);
  for (std::uint32_t number = 1; bytes.size() < 4000000; ++number) {
    std::vector<WrittenPoint> points = some_points(number, 43);
    for (WrittenPoint& p : points)
      p = {metres(random), metres(random), metres(random), 0.5F, 99, 9};
    const Bytes packet = packet_of(number, points).bytes();
    bytes.insert(bytes.end(), packet.begin(), packet.end());
  }
  PacketReader reader;
  std::uint64_t points = 0;
  const auto begin = std::chrono::steady_clock::now();
  for (int round = 0; round < 10; ++round) {
    for (std::size_t at = 0; at < bytes.size(); at += 4096) {
      reader.push(bytes.data() + at, std::min<std::size_t>(4096, bytes.size() - at), Time{0},
                  [&](const Frame& frame) { points += frame.scan.detections.size(); });
    }
  }
  const double elapsed = to_seconds(std::chrono::steady_clock::now() - begin);
  EXPECT_EQ(points, 43 * reader.counters().frames);
  EXPECT_EQ(reader.counters().bytes_skipped, 0U);
  const double rate = 1e-6 * 10.0 * static_cast<double>(bytes.size()) / elapsed;
  measured("bytes read [MB/s], the UART gives 0.09", rate, "above 100 in Release, 20 here");
  if (rio::test::AllocationGuard::kWorks) {  // no sanitizer
    EXPECT_GT(rate, 20.0);
  }
}

}  // namespace
}  // namespace rio::ti::test
