// SPDX-License-Identifier: BSD-3-Clause
// What comes from the ports: samples of the IMU, its clock, and a watch over scans that do not
// come.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "live/host_clock.hpp"
#include "live/imu_stream.hpp"
#include "live/session.hpp"
#include "support/measured.hpp"
#include "ti/packets.hpp"

namespace rio::live::test {
namespace {

using ti::test::Bytes;

constexpr Time kOffset = std::chrono::hours(3);

TEST(ClockOffset, IsTheSmallestDelayInSpiteOfJitterAndDrift) {
  ClockOffset clock;
  std::mt19937 random(1);
  std::exponential_distribution<double> jitter(1.0 / 5e-3);
  Time worst{0};
  for (int i = 0; i < 200 * 120; ++i) {
    const Time stamp = i * Time(5'000'000);
    const Time truth = kOffset + stamp * 50 / 1'000'000;
    clock.add(stamp, stamp + truth + from_seconds(jitter(random)));
    if (i > 200 * 5) worst = std::max({worst, clock.offset() - truth, truth - clock.offset()});
  }
  rio::test::expect_below("offset of the clocks off by, ms", 1e3 * to_seconds(worst), 0.6);
}

TEST(ClockOffset, AnOddStampCountsNotAndAJumpSoon) {
  constexpr Time kHour = std::chrono::hours(1);
  ClockOffset clock;
  for (int i = 0; i < 100; ++i) clock.add(Time(i), Time(i) + kOffset);
  clock.add(Time(0) + kHour, kOffset);  // once
  EXPECT_EQ(clock.offset(), kOffset);
  for (int i = 0; i < 5; ++i) clock.add(Time(i), Time(i) + kOffset + kHour);
  EXPECT_EQ(clock.offset(), kOffset + kHour);
}

ImuSample sample_of(int i) {
  return {Time(1'700'000'000'000'000'000 + 5'000'000LL * i),
          {0.25 * i, -0.5, 0.125},
          {1.0, -2.0 * i, 9.8125}};  // exact as floats
}

Bytes bytes_of(int from, int to) {
  Bytes bytes;
  for (int i = from; i < to; ++i) {
    const auto frame = imu_frame(sample_of(i), static_cast<std::uint8_t>(i));
    bytes.insert(bytes.end(), frame.begin(), frame.end());
  }
  return bytes;
}

template <class Reader>
struct Reading {
  Reader reader;
  std::vector<ImuSample> samples;
  void push(const Bytes& bytes, std::size_t piece) {
    for (std::size_t at = 0; at < bytes.size(); at += piece) {
      reader.push(bytes.data() + at, std::min(piece, bytes.size() - at),
                  [this](const ImuSample& sample) { samples.push_back(sample); });
    }
  }
};

void expect_sample(const ImuSample& sample, int i) {
  EXPECT_EQ(sample.time, sample_of(i).time);
  EXPECT_EQ(sample.gyro_B, sample_of(i).gyro_B);
  EXPECT_EQ(sample.accel_B, sample_of(i).accel_B);
}

TEST(ImuFrames, AreReadAsWrittenInAnyPieces) {
  for (const std::size_t piece : {1U, 7U, 38U, 1000U}) {
    Reading<ImuFrameReader> reading;
    reading.push(bytes_of(0, 300), piece);
    ASSERT_EQ(reading.samples.size(), 300U);
    for (int i = 0; i < 300; ++i) expect_sample(reading.samples[static_cast<std::size_t>(i)], i);
    EXPECT_EQ(reading.reader.counters().lost, 0U);
    EXPECT_EQ(reading.reader.counters().damaged, 0U);
  }
}

TEST(ImuFrames, BytesOfTheLayout) {
  const auto frame = imu_frame({Time(0x0102030405060708), {1.0, 0.0, 0.0}, {0.0, 0.0, -2.0}}, 9);
  const Bytes begin = {'R', 'I', 1, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0, 0, 0x80, 0x3F};
  EXPECT_EQ(Bytes(frame.begin(), frame.begin() + 16), begin);
  EXPECT_EQ(Bytes(frame.begin() + 32, frame.begin() + 36), (Bytes{0, 0, 0, 0xC0}));
}

/// Every undamaged frame is found around damage at any place, of any kind.
TEST(ImuFrames, DamageCostsOnlyTheFrameItHits) {
  const Bytes good = bytes_of(0, 3);
  for (std::size_t at = kImuFrame; at < 2 * kImuFrame; ++at) {
    Bytes flipped = good;
    flipped[at] ^= 0x40;
    Bytes lost = good;
    lost.erase(lost.begin() + static_cast<std::ptrdiff_t>(at));
    for (const Bytes& bytes : {flipped, lost}) {
      Reading<ImuFrameReader> reading;
      reading.push(bytes, 11);
      ASSERT_EQ(reading.samples.size(), 2U) << at;
      expect_sample(reading.samples[0], 0);
      expect_sample(reading.samples[1], 2);
      EXPECT_EQ(reading.reader.counters().lost, 1U) << at;
    }
  }
}

TEST(ImuLines, OfARecordingAreRead) {
  const std::string text =
      "#timestamp [ns],w_RS_S_x [rad s^-1]\n1700000000000000000,+0.1,-2e-3,0,1,2.5,9.81\r\n"
      "what is this\n1700000000005000000, 0.2,0,0,0,0,9.8,\n5,1,2,3,4,5\n";
  for (const std::size_t piece : {1U, 1000U}) {
    Reading<ImuLineReader> reading;
    reading.push(Bytes(text.begin(), text.end()), piece);
    ASSERT_EQ(reading.samples.size(), 2U);
    EXPECT_EQ(reading.samples[0].time.count(), 1700000000000000000);
    EXPECT_EQ(reading.samples[0].gyro_B, Vector3d(0.1, -2e-3, 0.0));
    EXPECT_EQ(reading.samples[1].accel_B, Vector3d(0.0, 0.0, 9.8));
    EXPECT_EQ(reading.reader.counters().damaged, 2U);
  }
}

class Watched {
 public:
  void push(const Bytes& bytes) {
    reader_.push(bytes.data(), bytes.size(), Time{0}, [](const ti::Frame& /*frame*/) {});
  }
  void push_packet(std::uint32_t version = 0x03060000, int points = 5) {
    ti::test::WrittenPacket packet = ti::test::some_packet(number_, points);
    ++number_;
    packet.version = version;
    push(packet.bytes());
  }
  /// What is said in so many seconds, ten looks each.
  std::string wait(int seconds, const std::string& times = "") {
    std::string said;
    for (int i = 0; i < 10 * seconds; ++i) {
      now_ += std::chrono::milliseconds(100);
      const std::string message = watch_.look(reader_, now_, times);
      if (!message.empty()) said += message + "\n";
    }
    return said;
  }

 private:
  ti::PacketReader reader_;
  ScanWatch watch_;
  Time now_ = std::chrono::hours(1);
  std::uint32_t number_ = 0;
};

TEST(ScanWatch, SaysOnceAfterTenSecondsWhatWasSeen) {
  Watched radar;
  EXPECT_EQ(radar.wait(9), "");
  EXPECT_EQ(radar.wait(30),
            "no scan for 10 s; no byte yet: is it the data port (a TI radar has two), and was the "
            "radar configured (--radar-cfg, --cli)?\n");
  const std::string text = "mmwDemo:/>sensorStart\r\nDone\r\n";
  radar.push(Bytes(text.begin(), text.end()));
  EXPECT_EQ(radar.wait(30), "");
  radar.push_packet();
  EXPECT_EQ(radar.wait(9), "scans again\n");
  EXPECT_EQ(radar.wait(30), "no scan for 10 s; no byte came\n");
  radar.push_packet();
  EXPECT_EQ(radar.wait(5), "scans again\n");
  radar.push(Bytes(80000, 0xFE));
  const std::string said = radar.wait(30);
  EXPECT_EQ(said.rfind("no scan for 10 s; 80000 bytes came: bytes, but no packet", 0), 0U) << said;
}

TEST(ScanWatch, SaysNothingWhileScansCome) {
  Watched radar;
  for (int i = 0; i < 30; ++i) {
    radar.push_packet();
    EXPECT_EQ(radar.wait(1), "");
  }
}

TEST(ScanWatch, SaysThatPacketsHaveNoPointsAnyMore) {
  Watched radar;
  radar.push_packet();
  std::string said;
  for (int i = 0; i < 30; ++i) {
    radar.push_packet(0x03060000, 0);
    said += radar.wait(1);
  }
  EXPECT_EQ(said,
            "packets without points for 10 s: nothing is detected (clutter removal is on, or the "
            "thresholds are too high)\n");
}

TEST(ScanWatch, SaysOnceThatTimesAreWrong) {
  Watched radar;
  radar.push_packet();
  EXPECT_EQ(radar.wait(1, "frames come every 66.7 ms"), "frames come every 66.7 ms\n");
  EXPECT_EQ(radar.wait(1, "frames come every 66.8 ms"), "");
}

TEST(ScanWatch, SaysAnotherFirmwareByThreePacketsAndOnce) {
  Watched radar;
  for (int i = 0; i < 2; ++i) {
    radar.push_packet(0x02010004);
    EXPECT_EQ(radar.wait(1), "");
  }
  radar.push_packet(0x02010004);
  EXPECT_EQ(radar.wait(1), "packets of SDK 1 or 2, which are not read: load a demo of SDK 3.x\n");
  radar.push_packet(0x02010004);
  EXPECT_EQ(radar.wait(5), "");
  EXPECT_NE(radar.wait(5).find("no scan for 10 s"), std::string::npos);
}

}  // namespace
}  // namespace rio::live::test
