// SPDX-License-Identifier: BSD-3-Clause
#include "rio/sim/ti_packet.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace rio::sim {

namespace {

std::int16_t tenths(double db) {
  return static_cast<std::int16_t>(std::clamp(std::round(10.0 * db), -32768.0, 32767.0));
}

}  // namespace

WrittenPoint written(const RadarDetection& detection) {
  const Vector3d& p = detection.point_S;
  return {static_cast<float>(-p.y()), static_cast<float>(p.x()),
          static_cast<float>(p.z()),  static_cast<float>(detection.range_rate),
          tenths(detection.snr_db),   tenths(detection.noise_db)};
}

void put(Bytes* bytes, std::uint32_t value, int size) {
  for (int i = 0; i < size; ++i) bytes->push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

Bytes points_tlv(const std::vector<WrittenPoint>& points) {
  Bytes bytes;
  for (const WrittenPoint& p : points) {
    for (const float value : {p.x, p.y, p.z, p.velocity}) {
      put(&bytes, std::bit_cast<std::uint32_t>(value));
    }
  }
  return bytes;
}

Bytes side_tlv(const std::vector<WrittenPoint>& points) {
  Bytes bytes;
  for (const WrittenPoint& p : points) {
    put(&bytes, static_cast<std::uint16_t>(p.snr), 2);
    put(&bytes, static_cast<std::uint16_t>(p.noise), 2);
  }
  return bytes;
}

Bytes WrittenPacket::bytes() const {
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

WrittenPacket packet_of(std::uint32_t number, const std::vector<WrittenPoint>& points) {
  WrittenPacket packet;
  packet.number = number;
  packet.objects = static_cast<std::uint32_t>(points.size());
  packet.tlvs.emplace_back(1, points_tlv(points));
  if (!points.empty()) packet.tlvs.emplace_back(7, side_tlv(points));
  return packet;
}

WrittenPacket packet_of_scan(std::uint32_t number, const RadarScan& scan) {
  std::vector<WrittenPoint> points;
  for (const RadarDetection& detection : scan.detections) points.push_back(written(detection));
  return packet_of(number, points);
}

}  // namespace rio::sim
