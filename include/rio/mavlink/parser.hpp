// SPDX-License-Identifier: BSD-3-Clause
// Bytes from an autopilot -> messages, of MAVLink 1 and 2. C++17.
//
//   rio::mavlink::Parser parser;
//   parser.push(bytes, count, now, [&](const rio::mavlink::Packet& packet) {
//     rio::mavlink::HighresImu imu;
//     if (packet.read(&imu)) ...
//   });
//
// A packet is delivered with its last byte. Every magic byte may begin a frame, also inside another
// one: a frame whose bytes all arrive is found whatever is around it, and none is delayed by bytes
// that only look like the beginning of a longer one. Of two overlapping frames the one that ends
// first is used. Only the messages of messages.hpp are known; others cannot be checked, since the
// checksum needs their definition, and are skipped byte by byte. Signatures are skipped unchecked.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "rio/core/static_vector.hpp"
#include "rio/mavlink/frame.hpp"
#include "rio/types.hpp"

namespace rio::mavlink {

/// A message with a correct checksum.
struct Packet {
  Time arrival{0};  ///< of the piece with the last byte
  std::uint32_t id = 0;
  Address from;
  std::uint8_t sequence = 0;
  std::uint8_t version = 2;                         ///< of MAVLink
  std::array<std::uint8_t, kMaxPayload> payload{};  ///< zero-padded

  /// False, without changes, if it is another message.
  template <class Message>
  bool read(Message* message) const {
    if (id != Message::kId) return false;
    *message = decode<Message>(payload.data());
    return true;
  }
};

struct ParserCounters {
  std::uint64_t frames = 0;       ///< delivered
  std::uint64_t damaged = 0;      ///< headers of known messages whose checksum was wrong
  std::uint64_t bytes = 0;        ///< received
  std::uint64_t frame_bytes = 0;  ///< of the delivered frames
};

/// Splits the bytes of one link into messages. No allocation. Per byte one comparison for each
/// frame that may have begun, plus the checksums.
class Parser {
 public:
  /// Takes the next bytes, in a piece of any size.
  /// @param arrival   when the piece was read
  /// @param on_packet called as on_packet(const Packet&); the parser owns the packet and reuses it
  template <class OnPacket>
  void push(const std::uint8_t* bytes, std::size_t count, Time arrival, OnPacket&& on_packet) {
    for (std::size_t i = 0; i < count; ++i) {
      if (!take(bytes[i])) continue;
      packet_.arrival = arrival;
      on_packet(static_cast<const Packet&>(packet_));
    }
  }

  const ParserCounters& counters() const { return counters_; }

  /// Discards the bytes of an incomplete frame; keeps the counters.
  void drop_pending();

 private:
  /// Bytes that may be a frame.
  struct Candidate {
    std::size_t begin = 0;  ///< of the magic byte
    std::size_t end = 0;    ///< of the header, and once that is read of the frame
    bool is_read = false;   ///< the header
  };

  bool take(std::uint8_t byte);
  void make_room();
  bool read_header(Candidate* candidate) const;
  bool read_frame(const Candidate& candidate);

  std::array<std::uint8_t, 4 * kMaxFrame> buffer_{};
  std::size_t stored_ = 0;
  StaticVector<Candidate, kMaxFrame> candidates_;  ///< in order of their beginning
  Packet packet_;
  ParserCounters counters_;
};

}  // namespace rio::mavlink
