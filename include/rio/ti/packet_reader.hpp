// SPDX-License-Identifier: BSD-3-Clause
// Bytes of the data UART of a TI mmWave radar -> frames. C++17.
//
//   rio::ti::PacketReader reader;
//   reader.push(bytes, count, now, [&](rio::ti::Frame& frame) { scans.take(frame.scan); });
//
// A frame is delivered with its last byte, not with the next frame. A packet whose bytes all arrive
// is found whatever is around it. A magic word inside a packet means that the rest of that packet
// was lost. After a contradiction the search continues one byte after the magic word.
//
// If the last 1 to 7 bytes of a frame are the start of a magic word, the frame may have lost as
// many bytes and end with the head of the next packet. It is held until the following bytes decide:
// if they complete the magic word, the frame was damaged and the next packet begins there. Such a
// frame is delivered late, with the next packet or flush(): one in 256 if the last byte is random,
// and each that ends, without padding, in a noise of 51.2 to 76.7 dB. Its arrival times are
// unchanged. Two cases cannot be detected: a packet that lost bytes before one whose magic word is
// damaged, too; and whether the last bytes of one packet are missing or the first ones of the next,
// where the bytes are the same either way.
//
// If most packets end the same 1 to 7 bytes early (a recorder or a splitter that drops them) and no
// whole one has come, or 20 damaged ones since, a packet whose missing bytes are padding is
// delivered as well, with the next packet or flush().
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "rio/ti/packet.hpp"

namespace rio::ti {

/// Counters of the stream.
struct PacketCounters {
  std::uint64_t frames = 0;     ///< delivered
  std::uint64_t lost = 0;       ///< missing frame numbers, also of damaged packets
  std::uint64_t restarts = 0;   ///< the frame number fell or jumped: power cycle, or damage
  std::uint64_t damaged = 0;    ///< magic words without a consistent packet
  std::uint64_t other_sdk = 0;  ///< packets of SDK 1 or 2, or of another demo
  std::uint64_t cut_short = 0;  ///< packets without their last bytes, while no whole ones arrive
  std::uint64_t bytes = 0;      ///< received
  std::uint64_t bytes_skipped = 0;    ///< outside all frames
  std::uint64_t points = 0;           ///< delivered
  std::uint64_t points_left_out = 0;  ///< not finite
};

/// Kind of the newest bytes.
enum class StreamState : std::uint8_t {
  kSilent,     ///< no byte yet
  kSearching,  ///< no packet in many bytes: another port, or another baud rate?
  kFrames,     ///< packets
  kOldSdk,     ///< packets of SDK 1 or 2, whose points are not read: load a demo of SDK 3.x
  kNewSdk,     ///< packets of SDK 4 or later whose points are not read
  kOtherDemo,  ///< packets of SDK 3.x, or with another header, whose points are not read
  kText,       ///< text: the CLI port?
  kDamaged,    ///< magic words, but no whole packet
  kCutShort,   ///< packets that end early
};

/// The state in words, for a log. PacketReader::problem() says more.
const char* to_string(StreamState state);

/// A device that sends no packets, and what to do where its bytes come from a port.
struct OtherDevice {
  const char* what;
  const char* at_radar;  ///< from the port of a radar
  const char* at_imu;    ///< from that of the IMU
};

/// Splits the bytes of one radar into frames. No allocation after construction; O(1) per byte.
class PacketReader {
 public:
  static constexpr std::size_t kMaxPacket = 65536;

  /// @param max_packet longest packet [bytes]; a longer one is damaged
  explicit PacketReader(std::size_t max_packet = kMaxPacket);

  /// Takes the next bytes, in a piece of any size.
  /// @param arrival  when the piece was read, on the clock of the IMU
  /// @param on_frame called as on_frame(Frame&) for each complete packet; the reader owns the frame
  /// and reuses it
  template <class OnFrame>
  void push(const std::uint8_t* bytes, std::size_t count, Time arrival, OnFrame&& on_frame) {
    while (count > 0) {
      const std::size_t stored = store(bytes, count);
      bytes += stored;
      count -= stored;
      while (Frame* frame = next(arrival)) on_frame(*frame);
    }
  }

  /// Arrival of the last byte of the held frame, if any.
  std::optional<Time> held_since() const;

  /// Delivers the held frame. Call it at the end of a stream, or when it has paused for longer than
  /// the gap between bytes of a packet (some milliseconds with USB): then the last bytes belong to
  /// the frame.
  template <class OnFrame>
  void flush(OnFrame&& on_frame) {
    if (!held_) return;
    if (Frame* frame = end_held()) on_frame(*frame);
  }

  const PacketCounters& counters() const { return counters_; }
  StreamState state() const { return state_; }
  /// Firmware of the newest packet with points; null if there is none.
  const Firmware* firmware() const { return firmware_; }
  /// Why there are no points, or many packets are damaged, and what to do; empty if neither.
  /// Allocates.
  std::string problem() const;
  /// Whose bytes the newest ones are, if they are no packets; null if that is not known.
  const OtherDevice* other_device() const;

  /// Discards the bytes of an incomplete packet, for example after the port was reopened; keeps the
  /// counters.
  void drop_pending();

 private:
  std::string_view newest() const;
  std::size_t store(const std::uint8_t* bytes, std::size_t count);
  Frame* next(Time arrival);
  bool find_packet(Time arrival);
  bool may_end_in_magic() const;
  Frame* end_held();
  Frame* hand_out(std::size_t size);
  bool is_cut_short(std::size_t size) const;
  Frame* end_early(std::size_t size);
  void give_up(PacketVerdict verdict);
  void take_state_of_other(PacketVerdict verdict);
  void leave_packet();
  bool finds_nothing() const;
  void skip_to(std::size_t index);
  void count_number(std::uint32_t number);

  std::size_t max_packet_;
  std::vector<std::uint8_t> buffer_;
  std::size_t begin_ = 0;      ///< of the packet, or of the search
  std::size_t end_ = 0;        ///< of the bytes stored
  std::size_t unclaimed_ = 0;  ///< all before belong to a frame or are counted as skipped
  std::size_t searched_ = 0;   ///< no magic word begins before this, except that of the packet
  bool in_packet_ = false;
  bool held_ = false;  ///< complete, except for the ambiguous last bytes, or those always missing
  bool complete_ = false;  ///< the last byte has come
  bool whole_ = false;     ///< the same of some packet lately
  PacketWalk walk_;
  std::size_t missing_ = 0;        ///< bytes that the packets are short of
  std::size_t fruitless_ = 0;      ///< bytes skipped since the last magic word
  std::size_t printable_ = 0;      ///< of them, as in a text
  std::size_t dumped_ = 0;         ///< same, as in a dump in text
  int fruitless_run_ = 0;          ///< packets since the last frame
  std::size_t expected_ = 0;       ///< where the next magic word is, if totalPacketLen is right
  int expected_run_ = 0;           ///< magic words found there, since the last frame
  std::size_t too_long_ = 0;       ///< of the newest packet, if longer than the longest [bytes]
  std::uint32_t unknown_tlv_ = 0;  ///< of the last frame without points
  bool miscounted_ = false;        ///< the newest packet of another demo
  const Firmware* firmware_ = nullptr;
  std::uint32_t frame_number_ = 0;  ///< of the last frame
  PacketCounters counters_;
  std::array<std::uint8_t, 4> head_{};  ///< the first bytes of all
  StreamState state_ = StreamState::kSilent;
  Frame frame_;
};

}  // namespace rio::ti
