// SPDX-License-Identifier: BSD-3-Clause
#include "rio/ti/packet.hpp"

#include <cstring>

namespace rio::ti {
namespace {

constexpr std::size_t kHeader = 40;
constexpr std::size_t kTlvHeader = 8;
constexpr std::size_t kPoint = 16;
constexpr std::size_t kSide = 4;
constexpr std::size_t kUnit = 32;  // the length of a packet is a multiple of it
constexpr std::uint32_t kSdk = 3;
constexpr std::uint32_t kXwr14 = 0xA1443;
enum Tlv : std::uint32_t { kDetectedPoints = 1, kSideInfo = 7 };

std::uint32_t u32(const std::uint8_t* b) {
  return static_cast<std::uint32_t>(b[0]) | static_cast<std::uint32_t>(b[1]) << 8 |
         static_cast<std::uint32_t>(b[2]) << 16 | static_cast<std::uint32_t>(b[3]) << 24;
}
int i16(const std::uint8_t* b) {
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(b[0] | b[1] << 8));
}
float f32(const std::uint8_t* b) {
  const std::uint32_t bits = u32(b);
  float value = 0.0F;
  static_assert(sizeof value == sizeof bits);
  std::memcpy(&value, &bits, sizeof value);
  return value;
}
/// Tests the exponent bits: no floating point exception for a signalling NaN, correct with
/// -ffast-math.
bool is_finite(const std::uint8_t* b) {
  constexpr std::uint32_t kExponent = 0x7F800000;
  return (u32(b) & kExponent) != kExponent;
}

/// A point of TLV 1 in radar axes; false if it is not finite.
bool read_point(const std::uint8_t* point, RadarDetection* detection) {
  for (int field = 0; field < 4; ++field) {
    if (!is_finite(point + 4 * field)) return false;
  }
  detection->point_S = {f32(point + 4), -f32(point), f32(point + 8)};
  detection->range_rate = f32(point + 12);
  return true;
}

}  // namespace

PacketVerdict PacketWalk::advance(const std::uint8_t* packet, std::size_t available) {
  if (size_ == 0) {
    if (available < kHeader) return PacketVerdict::kMore;
    const PacketVerdict verdict = read_header(packet);
    if (verdict != PacketVerdict::kMore) return verdict;
  }
  while (tlvs_left_ > 0) {
    if (size_ - at_ < kTlvHeader) return PacketVerdict::kDamaged;
    if (available < at_ + kTlvHeader) return PacketVerdict::kMore;
    if (!read_tlv(packet)) return PacketVerdict::kDamaged;
  }
  if (!lengths_agree()) return PacketVerdict::kDamaged;
  return available < size_ ? PacketVerdict::kMore : PacketVerdict::kComplete;
}

PacketVerdict PacketWalk::read_header(const std::uint8_t* packet) {
  const std::uint32_t size = u32(packet + 12);
  const std::uint32_t tlvs = u32(packet + 32);
  if (size < kHeader || size > max_packet_ || size % kUnit != 0) return PacketVerdict::kDamaged;
  if (tlvs > (size - kHeader) / kTlvHeader) return PacketVerdict::kDamaged;
  const std::uint32_t major = u32(packet + 8) >> 24;
  if (major != kSdk) return major < kSdk ? PacketVerdict::kOldSdk : PacketVerdict::kNewSdk;
  // no TLV has type 0, and no subframe of an xWR14xx another number
  has_subframe_ = u32(packet + 16) != kXwr14 || u32(packet + 36) == 0;
  size_ = size;
  tlvs_left_ = tlvs;
  at_ = has_subframe_ ? kHeader : kHeader - sizeof(std::uint32_t);
  return PacketVerdict::kMore;
}

/// Takes the complete header of the TLV at at_ and moves to the next.
bool PacketWalk::read_tlv(const std::uint8_t* packet) {
  const std::uint32_t type = u32(packet + at_);
  const std::uint32_t length = u32(packet + at_ + 4);
  at_ += kTlvHeader;
  if (length > size_ - at_) return false;
  if (type == kDetectedPoints || type == kSideInfo) {
    Part& part = type == kDetectedPoints ? points_ : side_;
    if (part.found || length % (type == kDetectedPoints ? kPoint : kSide) != 0) return false;
    part = {at_, length, true};
  }
  at_ += length;
  --tlvs_left_;
  return true;
}

/// For a packet whose TLVs were all read.
bool PacketWalk::lengths_agree() const {
  if (size_ - at_ >= kUnit) return false;
  return side_.length == 0 || side_.length / kSide == points_.length / kPoint;
}

std::size_t PacketWalk::decode(const std::uint8_t* packet, Frame* frame) const {
  frame->version = u32(packet + 8);
  frame->bytes = u32(packet + 12);
  frame->platform = u32(packet + 16);
  frame->number = u32(packet + 20);
  frame->cycles = u32(packet + 24);
  frame->subframe = has_subframe_ ? u32(packet + 36) : 0;
  std::vector<RadarDetection>& detections = frame->scan.detections;
  detections.clear();
  const std::size_t count = points_.length / kPoint;
  for (std::size_t i = 0; i < count; ++i) {
    RadarDetection detection;
    if (!read_point(packet + points_.at + i * kPoint, &detection)) continue;
    if (side_.length > 0) {
      const std::uint8_t* side = packet + side_.at + i * kSide;
      detection.snr_db = 0.1 * i16(side);
      detection.noise_db = 0.1 * i16(side + 2);
    }
    detections.push_back(detection);
  }
  return count - detections.size();
}

}  // namespace rio::ti
