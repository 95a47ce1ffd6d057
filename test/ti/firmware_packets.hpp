// SPDX-License-Identifier: BSD-3-Clause
// Packets of the firmware of the table.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "ti/packet_writer.hpp"

namespace rio::ti::test {

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

}  // namespace rio::ti::test
