// SPDX-License-Identifier: BSD-3-Clause
// Packets as the simulated radar and the firmware of the table write them, points for them, and a
// reader with all that it has handed out.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "rio/sim/ti_packet.hpp"
#include "rio/ti/packet.hpp"
#include "rio/ti/packet_reader.hpp"

namespace rio::ti::test {

using sim::Bytes;
using sim::packet_of;
using sim::points_tlv;
using sim::put;
using sim::side_tlv;
using sim::WrittenPacket;
using sim::WrittenPoint;

/// Points that tell packets and places apart.
inline std::vector<WrittenPoint> some_points(std::uint32_t number, int count) {
  std::vector<WrittenPoint> points;
  for (int i = 0; i < count; ++i) {
    const auto n = static_cast<float>(number % 100000);
    points.push_back({n, 1.0F + static_cast<float>(i), -0.25F * static_cast<float>(i),
                      0.125F * static_cast<float>(i % 17 - 8), static_cast<std::int16_t>(60 + i),
                      static_cast<std::int16_t>(500 + i)});
  }
  return points;
}

inline WrittenPacket some_packet(std::uint32_t number, int points) {
  return packet_of(number, some_points(number, points));
}
/// Padding of it [bytes].
inline std::size_t padding_of(int points) {
  const std::size_t body = 48 + (points > 0 ? 8U : 0U) + 20U * static_cast<std::size_t>(points);
  return (32 - body % 32) % 32;
}

/// The packet with the first `count` bytes of a magic word as its last ones. They are padding if
/// there is as much of it (three points: 12 bytes).
inline Bytes ending_in_magic(Bytes packet, std::size_t count) {
  std::copy_n(kMagic, count, packet.end() - static_cast<long>(count));
  return packet;
}

inline void put_float(Bytes* bytes, float value) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  put(bytes, bits);
}
inline void put_number(Bytes* bytes, double value, int size) {
  put(bytes, static_cast<std::uint32_t>(std::lround(value)), size);
}

/// Payload of TLV 301 with SNR and noise of so many bytes; the last point is one of minor motion.
inline Bytes compressed_tlv(const std::vector<WrittenPoint>& points, int side = 1) {
  Bytes bytes;
  for (const float unit : {1 / 256.0F, 1 / 64.0F, 0.5F, 0.25F}) put_float(&bytes, unit);
  const std::size_t minor = points.empty() ? 0 : 1;
  put(&bytes, static_cast<std::uint32_t>(points.size() - minor), 2);
  put(&bytes, static_cast<std::uint32_t>(minor), 2);
  for (const WrittenPoint& p : points) {
    for (const float metres : {p.x, p.y, p.z}) put_number(&bytes, metres * 256, 2);
    put_number(&bytes, p.velocity * 64, 2);
    put_number(&bytes, 0.1 * p.snr / 0.5, side);
    put_number(&bytes, 0.1 * p.noise / 0.25, side);
  }
  return bytes;
}

/// Payload of TLV 1020 (of TLV 6 with a header of 48 bytes).
inline Bytes spherical_tlv(const std::vector<WrittenPoint>& points) {
  Bytes bytes;
  for (const float unit : {0.01F, 0.01F, 1 / 64.0F, 1 / 400.0F, 0.04F}) put_float(&bytes, unit);
  for (const WrittenPoint& p : points) {
    put_number(&bytes, std::atan2(p.z, std::hypot(p.x, p.y)) / 0.01, 1);
    put_number(&bytes, std::atan2(p.x, p.y) / 0.01, 1);
    put_number(&bytes, p.velocity * 64, 2);
    put_number(&bytes, 400.0 * std::hypot(p.x, p.y, p.z), 2);
    put_number(&bytes, 0.1 * p.snr / 0.04, 2);
  }
  return bytes;
}

/// Payload of TLV 1 of SDK 1 and 2 (12 bytes an object), of MRR (10, or 14 with SNR), of
/// SRR (8, no z).
inline Bytes fixed_point_tlv(const std::vector<WrittenPoint>& points, int size, int places = 7) {
  Bytes bytes;
  put(&bytes, static_cast<std::uint32_t>(points.size()), 2);
  put(&bytes, static_cast<std::uint32_t>(places), 2);
  for (const WrittenPoint& p : points) {
    if (size == 12) put(&bytes, 40, 2);  // range bin
    put_number(&bytes, std::ldexp(p.velocity, places), 2);
    put(&bytes, 1200, 2);  // peak
    for (const float metres : {p.x, p.y}) put_number(&bytes, std::ldexp(metres, places), 2);
    if (size != 8) put_number(&bytes, std::ldexp(p.z, places), 2);
    if (size == 14) put(&bytes, 0x00140015);  // SNR
  }
  return bytes;
}

/// The packet padded up to a multiple of `unit`.
inline Bytes padded(const WrittenPacket& packet, std::size_t unit) {
  Bytes bytes = packet.bytes();
  std::size_t size = packet.with_subframe ? 40 : 36;
  for (const auto& [type, payload] : packet.tlvs) size += 8 + payload.size();
  size = (size + unit - 1) / unit * unit;
  bytes.resize(size, 0x5A);
  for (std::size_t i = 0; i < 4; ++i) bytes[12 + i] = static_cast<std::uint8_t>(size >> (8 * i));
  return bytes;
}

inline Bytes unpadded(const WrittenPacket& packet) {
  return padded(packet, 1);
}

/// The same TLVs behind a header of 48 or 52 bytes (people counting), whose lengths count type and
/// length. @param times of processing and sending [us]
inline Bytes with_long_header(const WrittenPacket& packet, bool timestamp, std::uint32_t times) {
  Bytes tlvs;
  for (const auto& [type, payload] : packet.tlvs) {
    put(&tlvs, type);
    put(&tlvs, static_cast<std::uint32_t>(payload.size() + 8));
    tlvs.insert(tlvs.end(), payload.begin(), payload.end());
  }
  Bytes out(kMagic, kMagic + kMagicSize);
  const auto size = static_cast<std::uint32_t>((timestamp ? 52 : 48) + tlvs.size());
  put(&out, packet.version);
  if (!timestamp) put(&out, size);
  put(&out, packet.platform);
  if (timestamp) put(&out, packet.cycles);
  if (timestamp) put(&out, size);
  put(&out, packet.number);
  put(&out, packet.subframe);
  for (int i = 0; i < 4; ++i) put(&out, times);
  put(&out, static_cast<std::uint32_t>(packet.tlvs.size()), 2);
  put(&out, 0x6A42, 2);  // checksum
  out.insert(out.end(), tlvs.begin(), tlvs.end());
  return out;
}

inline Bytes joined(const std::vector<Bytes>& parts) {
  Bytes all;
  for (const Bytes& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

using Tlvs = std::vector<std::pair<std::uint32_t, Bytes>>;

/// Points on all grids but those of the angles.
inline std::vector<WrittenPoint> points_of(int count) {
  std::vector<WrittenPoint> points;
  for (int i = 0; i < count; ++i) {
    points.push_back({0.25F * static_cast<float>(i % 7 - 3), 2.0F + 0.125F * static_cast<float>(i),
                      0.25F * static_cast<float>(i % 5 - 2), 0.125F * static_cast<float>(i % 9 - 4),
                      static_cast<std::int16_t>(100 + 20 * i), 500});
  }
  return points;
}

inline WrittenPacket packet_with(std::uint32_t version, std::uint32_t platform, int points,
                                 Tlvs tlvs) {
  WrittenPacket packet;
  packet.version = version;
  packet.platform = platform;
  packet.number = 101;
  packet.objects = static_cast<std::uint32_t>(points);
  packet.tlvs = std::move(tlvs);
  return packet;
}
inline constexpr std::uint32_t kSdk36 = 0x03060000, kXwr68 = 0xA6843, kSdk55 = 0x05050002;

inline WrittenPacket low_power(int points, int side) {
  return packet_with(kSdk55, 0xA6432, points, {{301, compressed_tlv(points_of(points), side)}});
}
inline WrittenPacket tracking(int points) {
  return packet_with(kSdk36, kXwr68, points, {{1020, spherical_tlv(points_of(points))}});
}
inline WrittenPacket mrr(int points, int size) {
  return packet_with(0x03050001, 0xA1843, points, {{1, fixed_point_tlv(points_of(points), size)}});
}

struct Reading {
  PacketReader reader;
  std::vector<Frame> frames;

  explicit Reading(std::size_t max_packet = PacketReader::kMaxPacket) : reader(max_packet) {}

  void push(const std::uint8_t* bytes, std::size_t count, Time arrival = Time{0}) {
    reader.push(bytes, count, arrival, [this](const Frame& frame) { frames.push_back(frame); });
  }
  void push(const Bytes& bytes, Time arrival = Time{0}) {
    push(bytes.data(), bytes.size(), arrival);
  }
  /// In two pieces.
  void push_split(const Bytes& bytes, std::size_t first, Time arrival = Time{0}) {
    push(bytes.data(), first, arrival);
    push(bytes.data() + first, bytes.size() - first, arrival);
  }
  void flush() {
    reader.flush([this](const Frame& frame) { frames.push_back(frame); });
  }
  const PacketCounters& counters() const { return reader.counters(); }
  std::vector<std::uint32_t> numbers() const {
    std::vector<std::uint32_t> numbers;
    for (const Frame& frame : frames) numbers.push_back(frame.number);
    return numbers;
  }
};

/// The frame is the packet of these points, none left out.
inline bool is_frame_of(const Frame& frame, std::uint32_t number,
                        const std::vector<WrittenPoint>& points) {
  const auto same = [](const RadarDetection& d, const WrittenPoint& p) {
    return d.point_S == Vector3d(p.y, -p.x, p.z) && d.range_rate == p.velocity &&
           d.snr_db == 0.1 * p.snr && d.noise_db == 0.1 * p.noise;
  };
  return frame.number == number &&
         std::equal(frame.scan.detections.begin(), frame.scan.detections.end(), points.begin(),
                    points.end(), same);
}

}  // namespace rio::ti::test
