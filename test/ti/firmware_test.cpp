// SPDX-License-Identifier: BSD-3-Clause
// Packets of all firmware of the table: read, or named.
#include "rio/ti/firmware.hpp"

#include <gtest/gtest.h>

#include "support/temp_dir.hpp"
#include "ti/packets.hpp"

namespace rio::ti::test {
namespace {

using rio::test::contains;

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

/// The one frame of a packet, without padding and with that of 32 and of 64.
RadarScan scan_of(const WrittenPacket& packet) {
  Reading reading;
  reading.push(unpadded(packet));
  reading.push(packet.bytes());
  reading.push(padded(packet, 64));
  reading.flush();
  EXPECT_EQ(reading.counters().damaged + reading.counters().other_sdk, 0U);
  if (packet.objects > 0) {
    EXPECT_EQ(reading.reader.problem(), "");
  }
  if (reading.frames.size() != 3) {
    ADD_FAILURE() << reading.frames.size() << " frames";
    return {};
  }
  for (const Frame& frame : reading.frames) {
    EXPECT_EQ(frame.scan.detections.size(), reading.frames[1].scan.detections.size());
  }
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
                                        {0xFFFFFFFF, Bytes(5, 4)},
                                        {5, Bytes()},
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

/// People tracking counts none in its header, the xWRL6432 those of major motion, the xWRL6844 both
/// in one number. A length that is not one of whole points is none.
TEST(TiFirmware, NumDetectedObjOfOtherTlvsAndOfSdk5IsNotAsked) {
  const auto points = points_of(8);
  for (WrittenPacket packet :
       {packet_with(kSdk55, 0xA6432, 8, {{1, points_tlv(points)}, {7, side_tlv(points)}}),
        packet_with(kSdk55, 0xA6432, 8, {{1, points_tlv(points)}}), low_power(8, 1),
        low_power(8, 2), tracking(8), packet_with(kSdk36, kXwr68, 8, {{1000, points_tlv(points)}}),
        packet_with(kSdk55, 0xA6844, 8, {{1020, spherical_tlv(points)}})}) {
    for (const std::uint32_t objects : {0U, 5U, 9U, 0x30005U, ~0U}) {
      packet.objects = objects;
      EXPECT_EQ(scan_of(packet).detections.size(), 8U) << objects << " " << packet.tlvs[0].first;
      WrittenPacket other = packet;
      other.tlvs[0].second.pop_back();
      refused(other.bytes());
    }
    packet.tlvs[0].second.clear();
    packet.objects = 0;
    if (packet.tlvs.size() == 1) {
      EXPECT_EQ(scan_of(packet).detections.size(), 0U);
    }
  }
  refused(packet_with(kSdk55, 0xA6432, 7, {{1, points_tlv(points)}, {7, side_tlv(points_of(7))}})
              .bytes());
}

/// That of people tracking is a ratio in some firmware, and dB in other.
TEST(TiFirmware, AnSnrBeyondAllDecibelsIsARatio) {
  Bytes payload = spherical_tlv(points_of(1));
  const auto snr = [&payload](std::uint8_t low, std::uint8_t high) {
    payload[26] = low;
    payload[27] = high;
    const RadarScan scan = scan_of(packet_with(kSdk36, kXwr68, 1, {{1020, payload}}));
    return scan.detections.empty() ? 0.0 : scan.detections[0].snr_db;
  };
  EXPECT_NEAR(snr(0xFF, 0xFF), 34.2, 0.05);
  EXPECT_NEAR(snr(0x90, 0x01), 400 * 0.04, 1e-6);
}

TEST(TiFirmware, AHeaderOf44BytesIsNamed) {
  for (const bool minor : {false, true}) {  // numDetectedObjMinor before numTLVs (xWRL6844)
    for (int count = 1; count < 40; ++count) {
      const auto points = points_of(count);
      Bytes bytes = unpadded(packet_with(minor ? kSdk55 : kSdk36, minor ? 0xA6844 : kXwr68, count,
                                         {{1, points_tlv(points)}, {8, points_tlv(points)}}));
      const Bytes word = {static_cast<std::uint8_t>(count), 0, 0, 0};
      bytes.insert(bytes.begin() + (minor ? 32 : 40), word.begin(), word.end());
      bytes[12] = static_cast<std::uint8_t>(bytes.size());
      bytes[13] = static_cast<std::uint8_t>(bytes.size() >> 8);
      EXPECT_PRED2(contains, refused(bytes), minor ? "xWRL6844 people" : "area scanner") << count;
    }
  }
}

TEST(TiFirmware, CountsThatContradictAreNoPoints) {
  const auto points = points_of(8);
  for (WrittenPacket packet :
       {packet_with(kSdk36, kXwr68, 8, {{1, points_tlv(points)}, {7, side_tlv(points)}}),
        packet_with(0x04070201, 0xA2944, 8, {{1, points_tlv(points)}})}) {
    for (const std::uint32_t objects : {0U, 7U, 9U, 16U, ~0U}) {
      packet.objects = objects;
      EXPECT_PRED2(contains, refused(packet.bytes()), "contradicts the length") << objects;
      EXPECT_PRED2(contains, refused(unpadded(packet)), "contradicts the length") << objects;
    }
  }
  for (const unsigned major : {0U, 6U, 8U}) {
    WrittenPacket packet = low_power(8, 1);
    packet.tlvs[0].second[16] = static_cast<std::uint8_t>(major);  // of 7, and one of minor motion
    EXPECT_PRED2(contains, refused(packet.bytes()), "contradicts the length") << major;
  }
  for (const float unit : {0.0F, -0.01F, 1e9F, std::numeric_limits<float>::quiet_NaN()}) {
    for (const WrittenPacket& packet : {low_power(8, 1), tracking(8)}) {
      for (std::size_t i = 0; i < 4; ++i) {
        WrittenPacket other = packet;
        std::memcpy(&other.tlvs[0].second[4 * i], &unit, sizeof unit);
        EXPECT_PRED2(contains, refused(other.bytes()), "an unknown demo") << unit;
      }
    }
  }
}

TEST(TiFirmware, ObjectsOfMrrAreNoPoints) {
  for (int count = 0; count < 60; ++count) {
    for (const int size : {8, 10, 14}) {
      WrittenPacket packet = mrr(count, size);
      packet.tlvs.emplace_back(2, Bytes(12, 1));
      packet.tlvs.emplace_back(3, Bytes(16, 2));
      EXPECT_PRED2(contains, refused(packet.bytes()),
                   size == 8 && count > 0 ? "demo: SRR" : "TLV 1 of another demo: MRR")
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

}  // namespace
}  // namespace rio::ti::test
