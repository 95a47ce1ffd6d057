// SPDX-License-Identifier: BSD-3-Clause
// Bytes of the data UART of a TI mmWave radar -> frames. C++17.
//
//   rio::ti::PacketReader reader;
//   reader.push(bytes, count, now, [&](rio::ti::Frame& frame) { scans.take(frame.scan); });
//
// A frame is handed out with its last byte, not with the next one. Whatever comes before, between
// and in place of packets: a packet of which every byte arrives is found. A magic word inside of a
// packet means that the rest of that packet was lost; after anything that contradicts itself the
// search goes on one byte after its magic word.
//
// A frame that ends as a magic word begins, in its last 1 to 7 bytes, may have lost as many bytes
// and be completed by the head of the next packet. It is held until the bytes behind it decide: if
// they complete the magic word it was damaged, and that is where the next packet begins. So it
// comes late, with the next packet or flush(): one in 256 if the last byte is random, and each that
// ends, without padding, in a noise of 51.2 to 76.7 dB. Its arrivals are its own. What no bytes can
// tell: a packet that lost bytes, and behind it one whose magic word is damaged, too; and whether
// the last bytes of one packet are missing or as many first ones of the next, where the bytes are
// the same either way.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "rio/ti/packet.hpp"

namespace rio::ti {

/// What came so far.
struct PacketCounters {
  std::uint64_t frames = 0;    ///< handed out
  std::uint64_t lost = 0;      ///< numbers missing between frames, of damaged packets too
  std::uint64_t restarts = 0;  ///< the numbers fell or leapt: the radar was switched off, or damage
  std::uint64_t damaged = 0;   ///< magic words without a packet that agrees with itself
  std::uint64_t other_sdk = 0;        ///< packets of SDK 1 or 2, or 4 and later
  std::uint64_t bytes_skipped = 0;    ///< belong to no frame
  std::uint64_t points_left_out = 0;  ///< not finite
};

/// What the newest bytes were.
enum class StreamState : std::uint8_t {
  kSilent,     ///< no byte yet
  kSearching,  ///< no packet in many bytes: another port, or another baud rate?
  kFrames,     ///< packets
  kOldSdk,     ///< packets of SDK 1 or 2, whose points are not read: load a demo of SDK 3.x
  kNewSdk,     ///< packets of SDK 4 or later, which are not read
};

/// The state in words, for a log.
const char* to_string(StreamState state);

/// Splits the bytes of one radar into frames. No allocation after construction; O(1) a byte.
class PacketReader {
 public:
  static constexpr std::size_t kMaxPacket = 65536;

  /// @param max_packet longest packet [bytes]; what claims to be longer is damaged
  explicit PacketReader(std::size_t max_packet = kMaxPacket);

  /// The next bytes, in a piece of any size.
  /// @param arrival  when the piece was read, on the clock of the IMU
  /// @param on_frame called as on_frame(Frame&) for each packet that is complete; the frame is the
  ///                 reader's and changes afterwards
  template <class OnFrame>
  void push(const std::uint8_t* bytes, std::size_t count, Time arrival, OnFrame&& on_frame) {
    while (count > 0) {
      const std::size_t stored = store(bytes, count);
      bytes += stored;
      count -= stored;
      while (Frame* frame = next(arrival)) on_frame(*frame);
    }
  }

  /// When the last byte of the frame came that is held, if one is.
  std::optional<Time> held_since() const;

  /// Hands out the frame that is held. To be called at the end of a stream, or when it has paused
  /// for longer than the bytes of a packet are apart (some milliseconds with USB): then the last
  /// ones were its own.
  template <class OnFrame>
  void flush(OnFrame&& on_frame) {
    if (held_) on_frame(*hand_out());
  }

  const PacketCounters& counters() const { return counters_; }
  StreamState state() const { return state_; }

  /// Forgets the bytes of a packet that has begun, as after the port was opened anew; keeps
  /// counting.
  void drop_pending();

 private:
  std::size_t store(const std::uint8_t* bytes, std::size_t count);
  Frame* next(Time arrival);
  bool find_packet(Time arrival);
  bool may_end_in_magic() const;
  Frame* hand_out();
  void give_up(PacketVerdict verdict);
  void skip_to(std::size_t index);
  void count_number(std::uint32_t number);

  std::size_t max_packet_;
  std::vector<std::uint8_t> buffer_;
  std::size_t begin_ = 0;      ///< of the packet, or where the search goes on
  std::size_t end_ = 0;        ///< of the bytes stored
  std::size_t unclaimed_ = 0;  ///< all before belong to a frame or were counted as skipped
  std::size_t searched_ = 0;   ///< no magic word begins before, but that of the packet
  bool in_packet_ = false;
  bool held_ = false;  ///< complete, but for what its last bytes are
  PacketWalk walk_;
  std::size_t fruitless_ = 0;       ///< bytes skipped since the last packet
  std::uint32_t frame_number_ = 0;  ///< of the last frame
  PacketCounters counters_;
  StreamState state_ = StreamState::kSilent;
  Frame frame_;
};

}  // namespace rio::ti
