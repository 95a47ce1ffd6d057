// SPDX-License-Identifier: BSD-3-Clause
// The packet that the demos of TI's mmWave SDK 3.x (xWR14xx, 16xx, 18xx, 68xx) write to the data
// UART, one a frame. C++17.
//
// clang-format off
// Little-endian. Left TI's layout, right what becomes of it.
//
//   offset type   field           here
//    0     u16[4] magic word      02 01 04 03 06 05 08 07 on the wire
//    8     u32    version         Frame::version: major << 24 | minor << 16 | bugfix << 8 | build
//   12     u32    totalPacketLen  Frame::bytes: header, TLVs and padding up to a multiple of 32
//   16     u32    platform        Frame::platform: 0xA1843, 0xA6843, 0xA1642, 0xA1443
//   20     u32    frameNumber     Frame::number: counts from power-on, also over sensorStop
//   24     u32    timeCpuCycles   Frame::cycles: when it was made; wraps (21.5 s at 200 MHz)
//   28     u32    numDetectedObj  not trusted: the length of TLV 1 says it
//   32     u32    numTLVs         how many follow
//   36     u32    subFrameNumber  Frame::subframe: 0 but for advanced frames; none with 0xA1443
//   40            TLVs            u32 type, u32 length of what follows, as many bytes
//                 padding         up to 31 bytes of any value
//
//   TLV 1, detected points, 16 bytes each           TLV 7, side info, 4 bytes each, same order
//    0  f32  x [m], right     point_S.y = -x         0  i16  snr [0.1 dB]    snr_db
//    4  f32  y [m], boresight point_S.x = y          2  i16  noise [0.1 dB]  noise_db
//    8  f32  z [m], up        point_S.z = z
//   12  f32  velocity [m/s]   range_rate, + = receding as here
//
//   Others (profiles 2 and 3, heat maps 4, 5 and 8, statistics 6, temperature 9) are skipped.
// clang-format on
//
// TLV 1 may be empty or absent (nothing detected), TLV 7 absent (nothing detected, or `guiMonitor`
// without it: SNR and noise are then 0); the order is free. There is no checksum: a packet is
// accepted if its lengths agree to the byte; damage inside the numbers cannot be detected. The
// points of SDK 1 and 2 have another format, and so have the packets of the xWRL6432 and xWRL6844
// (SDK 5 and 6): these are recognised by their version and not read.
//
// Source: mmw_output.h and dpif_pointcloud.h of the SDK, "Understanding UART Data Output Format" of
// TI's Radar Toolbox.
#pragma once

#include <cstddef>
#include <cstdint>

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
  kMore,      ///< incomplete, valid so far
  kComplete,  ///< all lengths agree and the last byte has arrived
  kDamaged,   ///< lengths contradict each other or the TLV type
  kOldSdk,    ///< of SDK 1 or 2
  kNewSdk,    ///< of SDK 4 or later
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

  /// Fills all of the frame but the arrivals and the stamp; after kComplete. Allocates if the scan
  /// has no capacity for the points.
  /// @return number of points rejected because they are not finite
  std::size_t decode(const std::uint8_t* packet, Frame* frame) const;

 private:
  /// Position of the payload of a TLV.
  struct Part {
    std::size_t at = 0;
    std::size_t length = 0;
    bool found = false;
  };

  PacketVerdict read_header(const std::uint8_t* packet);
  bool read_tlv(const std::uint8_t* packet);
  bool lengths_agree() const;

  std::size_t max_packet_;
  std::size_t size_ = 0;
  std::size_t at_ = 0;  ///< the next TLV
  std::uint32_t tlvs_left_ = 0;
  bool has_subframe_ = true;
  Part points_;
  Part side_;
};

}  // namespace rio::ti
