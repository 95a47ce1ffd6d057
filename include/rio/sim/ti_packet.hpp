// SPDX-License-Identifier: BSD-3-Clause
// Packets as the demos of TI's mmWave SDK 3.x send them, from points: a simulated radar. The layout
// of ti/packet.hpp is implemented independently here: no code is shared with the reader.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "rio/types.hpp"

namespace rio::sim {

using Bytes = std::vector<std::uint8_t>;

/// A point as the chip sends it, x right, y boresight, z up.
struct WrittenPoint {
  float x = 0.0F, y = 0.0F, z = 0.0F, velocity = 0.0F;  ///< [m], [m/s]
  std::int16_t snr = 0, noise = 0;                      ///< [0.1 dB]
};

/// A detection rounded to the packet format; its own sigmas are not sent.
WrittenPoint written(const RadarDetection& detection);

/// Appends the lowest bytes of a value, little-endian.
void put(Bytes* bytes, std::uint32_t value, int size = 4);

/// Payload of TLV 1.
Bytes points_tlv(const std::vector<WrittenPoint>& points);
/// Payload of TLV 7.
Bytes side_tlv(const std::vector<WrittenPoint>& points);

struct WrittenPacket {
  std::uint32_t version = 0x03060000, platform = 0xA1843, number = 1, cycles = 0, subframe = 0;
  std::uint32_t objects = 0;
  std::vector<std::pair<std::uint32_t, Bytes>> tlvs;  ///< type, payload
  bool with_subframe = true;

  Bytes bytes() const;
};

/// The packet that the demo sends with `guiMonitor -1 1 0 0 0 0 0`.
WrittenPacket packet_of(std::uint32_t number, const std::vector<WrittenPoint>& points);
/// The same for a scan; its stamp is not sent.
WrittenPacket packet_of_scan(std::uint32_t number, const RadarScan& scan);

}  // namespace rio::sim
