// SPDX-License-Identifier: BSD-3-Clause
#include "rio/ti/packet.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>

namespace rio::ti {
namespace {

constexpr std::size_t kTlvHeader = 8;
constexpr std::size_t kSide = 4;
constexpr std::size_t kLongestUnit = 64;  // of padding; the length is a multiple of the unit
constexpr std::uint32_t kXwr14 = 0xA1443;
constexpr std::uint32_t kLowPowerSdk = 5;  // and later
constexpr double kMostDb = 100.0;          // of an echo: more is a ratio of powers
constexpr std::uint32_t kPlatforms = 0xA;  // their upper half
enum Tlv : std::uint32_t { kPoints = 1, kSideInfo = 7, kLastOfDemo = 9 };
constexpr std::uint32_t kFirstOfLowPower = 301, kLastOfLowPower = 318;  // of its demo

/// Positions in a header [bytes].
struct Layout {
  std::size_t header;
  std::size_t length_at;
  std::size_t platform_at;
  std::size_t tlvs_at;
  std::size_t own;  ///< of type and length in the length of a TLV; if there are, numTLVs is u16
};
constexpr Layout kLayouts[] = {{40, 12, 16, 32, 0},  // of the demos that are read
                               {48, 12, 16, 44, kTlvHeader},
                               {52, 20, 12, 48, kTlvHeader},
                               {44, 12, 16, 32, 0},
                               {44, 12, 16, 36, 0}};
constexpr std::size_t kLayoutCount = sizeof kLayouts / sizeof *kLayouts;

std::uint32_t u16(const std::uint8_t* b) {
  return b[0] | static_cast<std::uint32_t>(b[1]) << 8;
}
std::uint32_t u32(const std::uint8_t* b) {
  return static_cast<std::uint32_t>(b[0]) | static_cast<std::uint32_t>(b[1]) << 8 |
         static_cast<std::uint32_t>(b[2]) << 16 | static_cast<std::uint32_t>(b[3]) << 24;
}
int i16(const std::uint8_t* b) {
  return static_cast<std::int16_t>(u16(b));
}
double f32(const std::uint8_t* b) {
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

bool are_finite(const std::uint8_t* b, int count) {
  for (int i = 0; i < count; ++i) {
    if (!is_finite(b + 4 * i)) return false;
  }
  return true;
}

/// Whether the units in front of the points are some.
bool are_units(const std::uint8_t* b, int count) {
  for (int i = 0; i < count; ++i) {
    if (!is_finite(b + 4 * i) || !(f32(b + 4 * i) > 0.0 && f32(b + 4 * i) <= 1.0)) return false;
  }
  return true;
}

Vector3d from_sphere(double range, double azimuth, double elevation) {
  const double level = range * std::cos(elevation);
  return {level * std::cos(azimuth), -level * std::sin(azimuth), range * std::sin(elevation)};
}

/// Whether SNR and noise of the points are in TLV 7.
bool has_side_info(PointForm form) {
  return form == PointForm::kCartesian || form == PointForm::kSpherical;
}

/// In radar axes; false if it is not finite.
/// @param head payload of the TLV
bool read_point(const Firmware& row, const std::uint8_t* head, const std::uint8_t* p,
                RadarDetection* d) {
  switch (row.form) {
    case PointForm::kCartesian:
      if (!are_finite(p, 4)) return false;
      d->point_S = {f32(p + 4), -f32(p), f32(p + 8)};
      d->range_rate = f32(p + 12);
      return true;
    case PointForm::kCartesianUnits: {
      const double metre = f32(head);
      const bool wide = row.point == 12;
      d->point_S = {metre * i16(p + 2), -metre * i16(p), metre * i16(p + 4)};
      d->range_rate = f32(head + 4) * i16(p + 6);
      d->snr_db = f32(head + 8) * (wide ? i16(p + 8) : p[8]);
      d->noise_db = f32(head + 12) * (wide ? i16(p + 10) : p[9]);
      return true;
    }
    case PointForm::kSpherical:
      if (!are_finite(p, 4)) return false;
      d->point_S = from_sphere(f32(p), f32(p + 4), f32(p + 8));
      d->range_rate = f32(p + 12);
      return true;
    case PointForm::kSphericalUnits: {
      const double elevation = f32(head) * static_cast<std::int8_t>(p[0]);
      const double azimuth = f32(head + 4) * static_cast<std::int8_t>(p[1]);
      d->point_S = from_sphere(f32(head + 12) * u16(p + 4), azimuth, elevation);
      d->range_rate = f32(head + 8) * i16(p + 2);
      d->snr_db = f32(head + 16) * u16(p + 6);
      if (d->snr_db > kMostDb) d->snr_db = 10.0 * std::log10(d->snr_db);
      return true;
    }
    case PointForm::kNotRead:
      break;
  }
  return false;
}

}  // namespace

PacketVerdict PacketWalk::advance(const std::uint8_t* packet, std::size_t available) {
  while (layout_ < kLayoutCount) {
    const PacketVerdict verdict = follow(packet, available);
    if (verdict != PacketVerdict::kDamaged) return verdict;
    const std::size_t next = layout_ + 1;
    *this = PacketWalk(max_packet_);
    layout_ = next;
  }
  return PacketVerdict::kDamaged;
}

/// By one layout of the header.
PacketVerdict PacketWalk::follow(const std::uint8_t* packet, std::size_t available) {
  if (size_ == 0) {
    if (available < kLayouts[layout_].header) return PacketVerdict::kMore;
    const PacketVerdict verdict = read_header(packet);
    if (verdict != PacketVerdict::kMore) return verdict;
  }
  while (tlvs_left_ > 0) {
    if (size_ - at_ < kTlvHeader) return PacketVerdict::kDamaged;
    if (available < at_ + kTlvHeader) return PacketVerdict::kMore;
    if (!read_tlv(packet)) return PacketVerdict::kDamaged;
  }
  if (!is_padded()) return PacketVerdict::kDamaged;
  return available < size_ ? PacketVerdict::kMore : judge(packet);
}

PacketVerdict PacketWalk::read_header(const std::uint8_t* packet) {
  const Layout& layout = kLayouts[layout_];
  const std::uint32_t size = u32(packet + layout.length_at);
  const std::uint32_t tlvs =
      layout.own == 0 ? u32(packet + layout.tlvs_at) : u16(packet + layout.tlvs_at);
  if (size < layout.header || size > max_packet_) return PacketVerdict::kDamaged;
  if (tlvs > (size - layout.header) / kTlvHeader) return PacketVerdict::kDamaged;
  if (layout_ == 0 && u32(packet + 8) >> 24 <= kOldDemos.last_sdk) {
    firmware_ = &kOldDemos;
    return PacketVerdict::kOldSdk;
  }
  if (layout_ > 0 && (tlvs == 0 || u32(packet + layout.platform_at) >> 16 != kPlatforms)) {
    return PacketVerdict::kDamaged;
  }
  // no TLV has type 0, and no subframe of an xWR14xx another number
  has_subframe_ = layout_ > 0 || u32(packet + 16) != kXwr14 || u32(packet + 36) == 0;
  size_ = size;
  tlvs_left_ = tlvs;
  at_ = has_subframe_ ? layout.header : layout.header - sizeof(std::uint32_t);
  return PacketVerdict::kMore;
}

/// Takes the complete header of the TLV at at_ and moves to the next.
bool PacketWalk::read_tlv(const std::uint8_t* packet) {
  const std::uint32_t type = u32(packet + at_);
  const std::size_t own = kLayouts[layout_].own;
  const std::size_t length = u32(packet + at_ + 4);
  at_ += kTlvHeader;
  if (length < own || length - own > size_ - at_) return false;
  const bool has_points = std::any_of(
      std::begin(kFirmware), std::end(kFirmware),
      [type](const Firmware& row) { return row.tlv == type && row.form != PointForm::kNotRead; });
  if (has_points || type == kSideInfo) {
    Part& part = has_points ? points_ : side_;
    if (part.type == type || (!has_points && length % kSide != 0)) return false;
    if (part.type == 0) part = {at_, length - own, type};
  } else if (unknown_tlv_ == 0 && type > kLastOfDemo &&
             (type < kFirstOfLowPower || type > kLastOfLowPower)) {
    unknown_tlv_ = type;
  }
  at_ += length - own;
  --tlvs_left_;
  return true;
}

/// For a packet whose TLVs were all read: up to a multiple of a power of two.
bool PacketWalk::is_padded() const {
  const std::size_t unit = std::min(kLongestUnit, size_ & (~size_ + 1));
  return size_ - at_ < (kLayouts[layout_].own == 0 ? unit : 1);
}

/// The points in the packet, if it is of the row.
std::uint64_t PacketWalk::points_by(const Firmware& row, const std::uint8_t* packet) const {
  if (row.tlv == kPoints && row.first_sdk < kLowPowerSdk) return u32(packet + 28);
  return points_.length < row.head ? 0 : (points_.length - row.head) / row.point;
}

/// Whether the head and the counts of the points are those of the row, for a packet of a demo.
bool PacketWalk::agrees(const Firmware& row, const std::uint8_t* packet) const {
  const std::uint64_t points = points_by(row, packet);  // no overflow where size_t has 32 bits
  const std::uint8_t* payload = packet + points_.at;
  if (row.tlv != points_.type) return false;
  if (points_.length == 0 && points == 0) return true;
  if (points_.length != row.head + points * row.point) return false;
  if (row.form == PointForm::kNotRead || points == 0) return true;
  switch (row.form) {
    case PointForm::kCartesianUnits:
      return are_units(payload, 4) && u16(payload + 16) + u16(payload + 18) == points;
    case PointForm::kSphericalUnits:
      return are_units(payload, 5);
    default:  // u16 number and u16 binary places of objects; as x a number below 1e-38
      return u16(payload) == 0 || u16(payload + 2) > 15;
  }
}

/// Whether only the count of the points is not that of the row.
bool PacketWalk::has_other_count(const Firmware& row, const std::uint8_t* packet) const {
  const bool in_units = row.form == PointForm::kCartesianUnits;
  if (row.tlv != points_.type || !(in_units || row.form == PointForm::kCartesian)) return false;
  if (points_.length <= row.head || (points_.length - row.head) % row.point != 0) return false;
  return !in_units || are_units(packet + points_.at, 4);
}

/// A packet whose lengths agree: its firmware, and whether its counts do.
PacketVerdict PacketWalk::judge(const std::uint8_t* packet) {
  if (layout_ == 0 && points_.type == 0) {
    return side_.length == 0 ? PacketVerdict::kComplete : PacketVerdict::kDamaged;
  }
  const std::uint32_t sdk = u32(packet + 8) >> 24;
  const auto is_of = [&](const Firmware& row) {
    return row.header == kLayouts[layout_].header && sdk >= row.first_sdk && sdk <= row.last_sdk;
  };
  const auto fits = [&](const Firmware& row) {
    return is_of(row) && (layout_ > 0 || row.point == 0 || agrees(row, packet));
  };
  firmware_ = std::find_if(std::begin(kFirmware), std::end(kFirmware), fits);
  miscounted_ = firmware_ == &kUnknownDemo &&
                std::any_of(std::begin(kFirmware), std::end(kFirmware), [&](const Firmware& row) {
                  return is_of(row) && has_other_count(row, packet);
                });
  if (firmware_->form == PointForm::kNotRead) return PacketVerdict::kOtherDemo;
  const bool contradicts = has_side_info(firmware_->form) && side_.length > 0 &&
                           side_.length / kSide != points_by(*firmware_, packet);
  return contradicts ? PacketVerdict::kDamaged : PacketVerdict::kComplete;
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
  if (firmware_ == nullptr) return 0;
  const std::uint8_t* payload = packet + points_.at;
  const auto count = static_cast<std::size_t>(points_by(*firmware_, packet));
  for (std::size_t i = 0; i < count; ++i) {
    RadarDetection detection;
    const std::uint8_t* point = payload + firmware_->head + i * firmware_->point;
    if (!read_point(*firmware_, payload, point, &detection)) continue;
    if (has_side_info(firmware_->form) && side_.length > 0) {
      const std::uint8_t* side = packet + side_.at + i * kSide;
      detection.snr_db = 0.1 * i16(side);
      detection.noise_db = 0.1 * i16(side + 2);
    }
    detections.push_back(detection);
  }
  return count - detections.size();
}

}  // namespace rio::ti
