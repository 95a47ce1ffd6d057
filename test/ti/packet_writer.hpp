// SPDX-License-Identifier: BSD-3-Clause
// Packets as the simulated radar writes them, and points for them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
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

inline Bytes joined(const std::vector<Bytes>& parts) {
  Bytes all;
  for (const Bytes& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace rio::ti::test
