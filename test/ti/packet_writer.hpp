// SPDX-License-Identifier: BSD-3-Clause
// Packets of the SDK's demos, written field by field from the documented layout; shares nothing
// with the reader.
#pragma once

#include <bit>
#include <cstdint>
#include <utility>
#include <vector>

namespace rio::ti::test {

using Bytes = std::vector<std::uint8_t>;

struct WrittenPoint {
  float x = 0.0F, y = 0.0F, z = 0.0F, velocity = 0.0F;  // axes of the chip
  std::int16_t snr = 0, noise = 0;                      // [0.1 dB]
};

inline void put(Bytes* bytes, std::uint32_t value, int size = 4) {
  for (int i = 0; i < size; ++i) bytes->push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

inline Bytes points_tlv(const std::vector<WrittenPoint>& points) {
  Bytes bytes;
  for (const WrittenPoint& p : points) {
    for (const float value : {p.x, p.y, p.z, p.velocity}) {
      put(&bytes, std::bit_cast<std::uint32_t>(value));
    }
  }
  return bytes;
}
inline Bytes side_tlv(const std::vector<WrittenPoint>& points) {
  Bytes bytes;
  for (const WrittenPoint& p : points) {
    put(&bytes, static_cast<std::uint16_t>(p.snr), 2);
    put(&bytes, static_cast<std::uint16_t>(p.noise), 2);
  }
  return bytes;
}

struct WrittenPacket {
  std::uint32_t version = 0x03060000, platform = 0xA1843, number = 1, cycles = 0, subframe = 0;
  std::uint32_t objects = 0;
  std::vector<std::pair<std::uint32_t, Bytes>> tlvs;
  bool with_subframe = true;

  Bytes bytes() const {
    Bytes out;
    for (const std::uint32_t word : {0x0102U, 0x0304U, 0x0506U, 0x0708U}) put(&out, word, 2);
    std::uint32_t size = with_subframe ? 40 : 36;
    for (const auto& [type, payload] : tlvs) size += 8 + static_cast<std::uint32_t>(payload.size());
    size = (size + 31) / 32 * 32;
    const auto count = static_cast<std::uint32_t>(tlvs.size());
    for (const std::uint32_t field : {version, size, platform, number, cycles, objects, count}) {
      put(&out, field);
    }
    if (with_subframe) put(&out, subframe);
    for (const auto& [type, payload] : tlvs) {
      put(&out, type);
      put(&out, static_cast<std::uint32_t>(payload.size()));
      out.insert(out.end(), payload.begin(), payload.end());
    }
    while (out.size() < size) out.push_back(0xA5);  // of any value
    return out;
  }
};

/// What the demo sends with `guiMonitor -1 1 0 0 0 0 0`.
inline WrittenPacket packet_of(std::uint32_t number, const std::vector<WrittenPoint>& points) {
  WrittenPacket packet;
  packet.number = number;
  packet.objects = static_cast<std::uint32_t>(points.size());
  packet.tlvs.emplace_back(1, points_tlv(points));
  if (!points.empty()) packet.tlvs.emplace_back(7, side_tlv(points));
  return packet;
}

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

inline Bytes joined(const std::vector<Bytes>& parts) {
  Bytes all;
  for (const Bytes& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace rio::ti::test
