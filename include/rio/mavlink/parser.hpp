// SPDX-License-Identifier: BSD-3-Clause
// Bytes from an autopilot -> messages, of MAVLink 1 and 2. C++17.
//
//   rio::mavlink::Parser parser;
//   parser.push(bytes, count, now, [&](const rio::mavlink::Packet& packet) {
//     rio::mavlink::HighresImu imu;
//     if (packet.read(&imu)) ...
//   });
//
// A frame comes with its last byte. Every magic byte may begin one, also inside of another: a frame
// of which every byte arrives is found, whatever is around it, and none is delayed by what only
// looks like the beginning of a longer one. Of two that overlap the one that ends first counts.
// Only the messages of messages.hpp are known; others cannot be checked, since the checksum needs
// their definition, and are passed over byte by byte. Signatures are passed over unchecked.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "rio/core/static_vector.hpp"
#include "rio/mavlink/frame.hpp"
#include "rio/types.hpp"

namespace rio::mavlink {

/// A message whose checksum is right.
struct Packet {
  Time arrival{0};  ///< of the piece with the last byte
  std::uint32_t id = 0;
  Address from;
  std::uint8_t sequence = 0;
  std::uint8_t version = 2;                         ///< of MAVLink
  std::array<std::uint8_t, kMaxPayload> payload{};  ///< zeros where it was shorter

  /// False, and nothing changes, if it is another message.
  template <class Message>
  bool read(Message* message) const {
    if (id != Message::kId) return false;
    *message = decode<Message>(payload.data());
    return true;
  }
};

struct ParserCounters {
  std::uint64_t frames = 0;       ///< handed out
  std::uint64_t damaged = 0;      ///< headers of known messages whose checksum was wrong
  std::uint64_t bytes = 0;        ///< received
  std::uint64_t frame_bytes = 0;  ///< of the frames handed out
};

/// Splits the bytes of one link into messages. No allocation. O(1) a byte but for the checksums.
class Parser {
 public:
  /// The next bytes, in a piece of any size.
  /// @param arrival   when the piece was read
  /// @param on_packet called as on_packet(const Packet&); the packet is the parser's and changes
  ///                  afterwards
  template <class OnPacket>
  void push(const std::uint8_t* bytes, std::size_t count, Time arrival, OnPacket&& on_packet) {
    for (std::size_t i = 0; i < count; ++i) {
      if (!take(bytes[i])) continue;
      packet_.arrival = arrival;
      on_packet(static_cast<const Packet&>(packet_));
    }
  }

  const ParserCounters& counters() const { return counters_; }

  /// Forgets the bytes of a frame that has begun; keeps counting.
  void drop_pending();

 private:
  /// Bytes that may be a frame.
  struct Candidate {
    std::size_t begin = 0;  ///< of the magic byte
    std::size_t look = 0;   ///< when so many bytes are stored, there is something to judge
    std::size_t end = 0;    ///< of the frame; 0 until its header was read
  };

  bool take(std::uint8_t byte);
  void make_room();
  bool judge();
  bool read_header(Candidate* candidate) const;
  bool read_frame(const Candidate& candidate);
  void plan();

  std::array<std::uint8_t, 4 * kMaxFrame> buffer_{};
  std::size_t stored_ = 0;
  std::size_t look_ = 0;                           ///< the first look of a candidate; 0: none
  StaticVector<Candidate, kMaxFrame> candidates_;  ///< by their beginning
  Packet packet_;
  ParserCounters counters_;
};

}  // namespace rio::mavlink
