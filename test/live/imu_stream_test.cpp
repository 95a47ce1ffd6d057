// SPDX-License-Identifier: BSD-3-Clause
#include "live/imu_stream.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace rio::live::test {
namespace {

using Bytes = std::vector<std::uint8_t>;

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
      "#timestamp [ns],w_RS_S_x [rad s^-1]\n1700000000000000000,0.1,-2e-3,0,1,2.5,9.81\r\n"
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

}  // namespace
}  // namespace rio::live::test
