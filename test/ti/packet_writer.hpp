// SPDX-License-Identifier: BSD-3-Clause
// Packets as the simulated radar writes them, and points for them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "rio/sim/ti_packet.hpp"
#include "rio/ti/packet.hpp"

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

}  // namespace rio::ti::test
