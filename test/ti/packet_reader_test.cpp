// SPDX-License-Identifier: BSD-3-Clause
#include "rio/ti/packet_reader.hpp"

#include <gtest/gtest.h>

#include "rio/testing/allocation_guard.hpp"
#include "ti/packets.hpp"

namespace rio::ti::test {
namespace {

using std::chrono::milliseconds;

Bytes packet(std::uint32_t number, int points = 3) {
  return some_packet(number, points).bytes();
}
Bytes without(Bytes bytes, std::size_t at, std::size_t count) {
  const auto begin = bytes.begin() + static_cast<long>(at);
  bytes.erase(begin, begin + static_cast<long>(count));
  return bytes;
}
using Numbers = std::vector<std::uint32_t>;

TEST(PacketReader, AFrameComesWithItsLastByte) {
  for (const int points : {0, 1, 3, 5, 40}) {
    const Bytes bytes = packet(1, points);
    Reading reading;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      EXPECT_TRUE(reading.frames.empty()) << points << " at " << i;
      reading.push(&bytes[i], 1, milliseconds(i));
    }
    ASSERT_EQ(reading.frames.size(), 1U) << points;
    EXPECT_EQ(reading.frames[0].first_arrival, milliseconds(7));
    EXPECT_EQ(reading.frames[0].last_arrival, milliseconds(bytes.size() - 1));
  }
}

TEST(PacketReader, GarbageBetweenPackets) {
  const std::vector<Bytes> garbage = {
      {0},
      {2},
      {2, 1, 4, 3},
      {2, 1, 4, 3, 6, 5, 8},
      {2, 2, 1, 2, 1, 4, 2, 1, 4, 3, 2},
      Bytes(100, 2),
      Bytes(200000, 7),
      {2, 1, 4, 3, 6, 5, 8, 7},
      joined({{2, 1, 4, 3, 6, 5, 8, 7}, Bytes(31, 0)}),
      joined({{2, 1, 4, 3, 6, 5, 8, 7}, Bytes(32, 0)}),
  };
  for (const Bytes& some : garbage) {
    Reading reading;
    reading.push(joined({some, packet(1), some, packet(2), packet(3), some, some, packet(4)}));
    EXPECT_EQ(reading.numbers(), (Numbers{1, 2, 3, 4})) << some.size();
    EXPECT_EQ(reading.counters().bytes_skipped, 4 * some.size());
    EXPECT_EQ(reading.counters().damaged,
              some.size() >= 8 && some[7] == 7 && some[0] == 2 ? 4U : 0U);
  }
}

// The head of the next packet would complete it, to the byte.
TEST(PacketReader, LastBytesThatWereLostAreNotThoseOfTheNextPacket) {
  for (std::size_t lost = 1; lost < kMagicSize; ++lost) {
    const Bytes whole = packet(2, 2);
    for (std::size_t at = whole.size() - lost; at >= kMagicSize; at -= 3) {
      const Bytes cut = without(whole, at, lost);
      const Bytes bytes = joined({packet(1), cut, packet(3), packet(4)});
      for (std::size_t split = packet(1).size(); split < bytes.size(); ++split) {
        Reading reading;
        reading.push_split(bytes, split);
        ASSERT_EQ(reading.numbers(), (Numbers{1, 3, 4})) << lost << " at " << at << ", " << split;
        ASSERT_EQ(reading.counters().damaged, 1U) << lost << " at " << at << ", " << split;
        ASSERT_EQ(reading.counters().bytes_skipped, cut.size()) << lost << " at " << at;
      }
    }
  }
}

TEST(PacketReader, AFrameThatEndsAsAMagicWordBeginsWaitsForTheByteThatDecides) {
  for (std::size_t tail = 1; tail < kMagicSize; ++tail) {
    const Bytes first = ending_in_magic(packet(1), tail);
    const Bytes bytes = joined({first, ending_in_magic(packet(2, 40), tail)});
    for (std::size_t split = 1; split < bytes.size(); ++split) {
      Reading reading;
      reading.push(bytes.data(), split, milliseconds(10));
      ASSERT_EQ(reading.frames.size(), split > first.size() ? 1U : 0U) << tail << " " << split;
      EXPECT_EQ(reading.reader.held_since().has_value(), split == first.size());
      reading.push(bytes.data() + split, bytes.size() - split, milliseconds(20));
      ASSERT_EQ(reading.frames.size(), 1U) << tail << " " << split;
      EXPECT_TRUE(is_frame_of(reading.frames[0], 1, some_points(1, 3)));
      EXPECT_EQ(reading.frames[0].first_arrival, milliseconds(split < kMagicSize ? 20 : 10));
      EXPECT_EQ(reading.frames[0].last_arrival, milliseconds(split < first.size() ? 20 : 10));
      EXPECT_EQ(reading.reader.held_since(), milliseconds(20));
      const Bytes garbage(3, kMagic[tail] == 8 ? 9 : 8);
      reading.push(garbage, milliseconds(30));
      ASSERT_EQ(reading.numbers(), (Numbers{1, 2})) << tail << " " << split;
      EXPECT_EQ(reading.frames[1].last_arrival, milliseconds(20));
      EXPECT_EQ(reading.counters().damaged + reading.counters().lost, 0U);
    }
  }
}

TEST(PacketReader, AHeldFrameIsHandedOutWhenTheStreamPauses) {
  for (std::size_t tail = 1; tail < kMagicSize; ++tail) {
    Reading reading;
    reading.push(ending_in_magic(packet(1), tail), milliseconds(10));
    EXPECT_TRUE(reading.frames.empty());
    reading.flush();
    reading.flush();
    ASSERT_EQ(reading.numbers(), (Numbers{1})) << tail;
    EXPECT_EQ(reading.frames[0].last_arrival, milliseconds(10));
    EXPECT_FALSE(reading.reader.held_since().has_value());
    reading.push(packet(2), milliseconds(60));
    reading.flush();
    EXPECT_EQ(reading.numbers(), (Numbers{1, 2})) << tail;
    EXPECT_EQ(reading.counters().bytes_skipped + reading.counters().damaged, 0U);
  }
}

// Flushed too early: the next packet is found all the same.
TEST(PacketReader, TheMagicWordIsFoundAlsoWhereItCompletedAFrame) {
  Bytes cut = packet(1);
  cut.resize(cut.size() - 3);
  Reading reading;
  reading.push(joined({cut, Bytes(kMagic, kMagic + 3)}));
  reading.flush();
  const Bytes next = packet(2);
  reading.push({next.begin() + 3, next.end()});
  EXPECT_EQ(reading.numbers(), (Numbers{1, 2}));
}

TEST(PacketReader, MissingNumbersAreCounted) {
  Reading reading;
  for (const std::uint32_t number : {5U, 6U, 6U, 9U, 10U, 10050U, 3U, 4U}) {
    reading.push(packet(number));
  }
  EXPECT_EQ(reading.counters().frames, 8U);
  EXPECT_EQ(reading.counters().lost, 2U);
  EXPECT_EQ(reading.counters().restarts, 2U);
  reading.push(packet(0xFFFFFFFE));
  reading.push(packet(1));
  EXPECT_EQ(reading.counters().lost, 4U);
}

TEST(PacketReader, ItSearchesAgainWhenThePacketsEnd) {
  Reading reading;
  EXPECT_EQ(reading.reader.state(), StreamState::kSilent);
  reading.push(packet(7));
  EXPECT_EQ(reading.reader.state(), StreamState::kFrames);
  reading.push(Bytes(70000, 0));
  EXPECT_EQ(reading.reader.state(), StreamState::kSearching);
}

TEST(PacketReader, ThePacketsMayBeAsLongAsSaid) {
  const int most = 3270;  // 40 + 8 + 16 N + 8 + 4 N <= 65536
  Reading reading;
  for (std::uint32_t number = 1; number < 6; ++number) reading.push(packet(number, most));
  EXPECT_EQ(reading.frames.size(), 5U);
  EXPECT_EQ(reading.frames.back().bytes, 65472U);
  reading.push(packet(6, most + 10));
  EXPECT_EQ(reading.frames.size(), 5U);
  Reading small(1024);
  small.push(joined({packet(1, 48), packet(2, 49), packet(3, 48)}));  // 1024, 1056
  EXPECT_EQ(small.numbers(), (Numbers{1, 3}));
}

TEST(PacketReader, WhatIsPendingCanBeDropped) {
  const Bytes bytes = packet(1);
  Reading reading;
  reading.push(bytes.data(), 50);
  reading.reader.drop_pending();
  EXPECT_EQ(reading.counters().bytes_skipped, 50U);
  reading.push(ending_in_magic(bytes, 2));
  reading.reader.drop_pending();
  reading.flush();
  EXPECT_TRUE(reading.frames.empty());
  reading.push(joined({{bytes.begin() + 50, bytes.end()}, packet(2)}));
  EXPECT_EQ(reading.numbers(), (Numbers{2}));
}

TEST(PacketReader, AllocatesNothing) {
  if (!rio::test::AllocationGuard::kWorks) GTEST_SKIP() << "not counted under a sanitizer";
  const Bytes bytes =
      joined({packet(1, 3270), Bytes(5000, 2), packet(2), Bytes(3, 2), packet(4, 1000)});
  PacketReader reader;
  std::size_t points = 0;
  const rio::test::AllocationGuard guard;
  for (std::size_t at = 0; at < bytes.size(); at += 64) {
    reader.push(bytes.data() + at, std::min<std::size_t>(64, bytes.size() - at), Time{0},
                [&](const Frame& frame) { points += frame.scan.detections.size(); });
  }
  reader.drop_pending();
  EXPECT_EQ(guard.count(), 0);
  EXPECT_EQ(points, 4273U);
}

}  // namespace
}  // namespace rio::ti::test
