// SPDX-License-Identifier: BSD-3-Clause
// The packet that the demos of TI's mmWave radars write to the data UART, one a frame: of SDK 3.x
// (xWR14xx, 16xx, 18xx, 68xx), of the AWR2944 and of the xWRL6432. C++17.
//
// clang-format off
// Little-endian. Left TI's layout, right what becomes of it.
//
//   offset type   field           here
//    0     u16[4] magic word      02 01 04 03 06 05 08 07 on the wire
//    8     u32    version         Frame::version: major << 24 | minor << 16 | bugfix << 8 | build
//   12     u32    totalPacketLen  Frame::bytes: header, TLVs and padding up to a multiple of 32 or 64, or none
//   16     u32    platform        Frame::platform: 0xA1843, 0xA6843, 0xA1642, 0xA1443, 0xA2944, 0xA6432
//   20     u32    frameNumber     Frame::number: counts from power-on, also over sensorStop
//   24     u32    timeCpuCycles   Frame::cycles: when it was made; wraps (21.5 s at 200 MHz)
//   28     u32    numDetectedObj  of TLV 1 with SDK 3 and 4 it must be the number of the points
//   32     u32    numTLVs         how many follow
//   36     u32    subFrameNumber  Frame::subframe: 0 but for advanced frames, ~0 with 0xA6432; none with 0xA1443
//   40            TLVs            u32 type, u32 length of what follows, as many bytes
//                 padding         up to 31 bytes of any value
//
//   TLV 1, detected points, 16 bytes each           TLV 7, side info, 4 bytes each, same order
//    0  f32  x [m], right     point_S.y = -x         0  i16  snr [0.1 dB]    snr_db
//    4  f32  y [m], boresight point_S.x = y          2  i16  noise [0.1 dB]  noise_db
//    8  f32  z [m], up        point_S.z = z
//   12  f32  velocity [m/s]   range_rate, + = receding as here
//
//   TLV 301, compressed points (xWRL6432, `guiMonitor 2 ...`): f32 units of x, y and z [m], velocity [m/s],
//   SNR, noise [dB]; u16 points of major, u16 of minor motion; then 10 or 12 bytes each
//    0  i16[4] x, y, z, velocity                     8  u8 or i16  snr, then noise
//   TLV 1020, spherical points (people tracking): f32 units of elevation, azimuth [rad], velocity [m/s],
//   range [m], SNR [dB; above 100 a ratio of powers]; then 8 bytes each
//    0  i8  elevation, up     1  i8  azimuth, to the right   2  i16  velocity   4  u16  range   6  u16  snr
//   TLV 1000, the same without units, 16 bytes each: f32 range [m], azimuth, elevation [rad], velocity [m/s];
//   SNR and noise in TLV 7
//
//   Others (profiles 2 and 3, heat maps 4, 5 and 8, statistics 6, temperature 9, tracks) are skipped.
// clang-format on
//
// The points may be empty or absent (nothing detected), TLV 7 absent (nothing detected, or
// `guiMonitor` without it: SNR and noise are then 0); the order is free. There is no checksum: a
// packet is accepted if its lengths and counts agree to the byte; damage inside the numbers cannot
// be detected. Other packets are recognised and not read: of SDK 1 and 2 by their version, of the
// MRR and SRR demos by the size of their objects, of people counting and of the area scanner by
// their longer headers (u32 numTLVs at 32 or 36 with 44 bytes; with 48 and 52 u16 numTLVs at 44 and
// 48, and lengths that include the 8 bytes of type and length). Rows and sources: firmware.hpp.
#pragma once

#include <cstddef>
#include <cstdint>

#include "rio/ti/firmware.hpp"
#include "rio/types.hpp"

namespace rio::ti {

/// A decoded packet.
struct Frame {
  std::uint32_t version = 0;
  std::uint32_t platform = 0;
  std::uint32_t number = 0;
  std::uint32_t cycles = 0;
  std::uint32_t subframe = 0;
  std::uint32_t bytes = 0;  ///< of the packet
  Time first_arrival{0};    ///< of the piece that completed the magic word
  Time last_arrival{0};     ///< of the piece with the last byte
  /// In radar axes. The stamp is the arrival of the first byte until a FrameClock replaces it.
  RadarScan scan;
};

inline constexpr std::size_t kMagicSize = 8;
inline constexpr std::uint8_t kMagic[kMagicSize] = {2, 1, 4, 3, 6, 5, 8, 7};

/// State of a packet from its bytes so far.
enum class PacketVerdict : std::uint8_t {
  kMore,       ///< incomplete, valid so far
  kComplete,   ///< all lengths and counts agree and the last byte has arrived
  kDamaged,    ///< lengths contradict each other or the TLV type
  kOldSdk,     ///< of SDK 1 or 2
  kOtherDemo,  ///< all lengths agree, but its points are not read
};

/// Checks a packet while it arrives: each length as soon as it is available, before use. O(1) per
/// TLV.
class PacketWalk {
 public:
  /// @param max_packet longer packets are treated as damaged [bytes]
  explicit PacketWalk(std::size_t max_packet) : max_packet_(max_packet) {}

  /// @param packet its first `available` bytes, from the magic word on; at least as many as in the
  /// previous call
  PacketVerdict advance(const std::uint8_t* packet, std::size_t available);

  /// Of the packet [bytes]; 0 until the header has arrived.
  std::size_t size() const { return size_; }
  /// Of header and TLVs [bytes]; 0 until the header of the last TLV has arrived.
  std::size_t size_without_padding() const { return size_ > 0 && tlvs_left_ == 0 ? at_ : 0; }
  /// Row of firmware.hpp, after kComplete, kOldSdk or kOtherDemo; null if no points tell it.
  const Firmware* firmware() const { return firmware_; }
  /// The first TLV of an unknown type (above 9, none of 301 to 318), 0 if there is none.
  std::uint32_t unknown_tlv() const { return unknown_tlv_; }
  /// After kOtherDemo: the points are whole and of a demo that is read, but not as many as counted.
  bool miscounted() const { return miscounted_; }

  /// Fills all of the frame but the arrivals and the stamp; after kComplete. Allocates if the scan
  /// has no capacity for the points.
  /// @return number of points rejected because they are not finite
  std::size_t decode(const std::uint8_t* packet, Frame* frame) const;

 private:
  /// Position of the payload of a TLV.
  struct Part {
    std::size_t at = 0;
    std::size_t length = 0;
    std::uint32_t type = 0;  ///< 0: not found
  };

  PacketVerdict follow(const std::uint8_t* packet, std::size_t available);
  PacketVerdict read_header(const std::uint8_t* packet);
  bool read_tlv(const std::uint8_t* packet);
  bool is_padded() const;
  std::uint64_t points_by(const Firmware& row, const std::uint8_t* packet) const;
  bool agrees(const Firmware& row, const std::uint8_t* packet) const;
  bool has_other_count(const Firmware& row, const std::uint8_t* packet) const;
  PacketVerdict judge(const std::uint8_t* packet);

  std::size_t max_packet_;
  std::size_t layout_ = 0;  ///< of the header; the next one is tried after a contradiction
  std::size_t size_ = 0;
  std::size_t at_ = 0;  ///< the next TLV
  std::uint32_t tlvs_left_ = 0;
  std::uint32_t unknown_tlv_ = 0;
  bool has_subframe_ = true;
  bool miscounted_ = false;
  Part points_;
  Part side_;
  const Firmware* firmware_ = nullptr;
};

}  // namespace rio::ti
