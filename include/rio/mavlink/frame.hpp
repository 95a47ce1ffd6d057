// SPDX-License-Identifier: BSD-3-Clause
// MAVLink frames: the layout, the checksum, and the writer of version 2. C++17.
//
// Version 2, little-endian; version 1 is read only (parser.hpp).
//
//   v2  v1  field
//    0   0  magic 0xFD; version 1: 0xFE
//    1   1  length of the payload
//    2   -  incompatibility flags: 1 = a signature of 13 bytes follows the checksum
//    3   -  compatibility flags
//    4   2  sequence: counts the frames of the sender
//    5   3  system
//    6   4  component
//    7   5  message: 3 bytes; version 1: 1 byte
//   10   6  payload; in version 2 without the zeros at its end, but for its first byte
//           checksum: CRC-16/MCRF4XX of all but the magic, then of the CRC_EXTRA of the message
//
// Source: "Packet Serialization", "Message Signing" of the MAVLink guide.
#pragma once

#include <cstddef>
#include <cstdint>

#include "rio/mavlink/messages.hpp"

namespace rio::mavlink {

inline constexpr std::uint8_t kMagicV1 = 0xFE;
inline constexpr std::uint8_t kMagicV2 = 0xFD;
inline constexpr std::uint8_t kFlagSigned = 0x01;
inline constexpr std::size_t kHeaderV1 = 6;
inline constexpr std::size_t kHeaderV2 = 10;
inline constexpr std::size_t kChecksum = 2;
inline constexpr std::size_t kSignature = 13;
inline constexpr std::size_t kMaxPayload = 255;
inline constexpr std::size_t kMaxFrame = kHeaderV2 + kMaxPayload + kChecksum + kSignature;

/// CRC-16/MCRF4XX: polynomial 0x1021 reflected, from 0xFFFF. "123456789" gives 0x6F91.
class Crc16 {
 public:
  void add(const std::uint8_t* bytes, std::size_t count);
  std::uint16_t value() const { return value_; }

 private:
  std::uint16_t value_ = 0xFFFF;
};

/// Sender: a system (the vehicle) and a component of it.
struct Address {
  std::uint8_t system = 1;
  std::uint8_t component = 197;  ///< MAV_COMP_ID_VISUAL_INERTIAL_ODOMETRY

  friend bool operator==(const Address& a, const Address& b) {
    return a.system == b.system && a.component == b.component;
  }
};

/// Frames the messages of one sender. No allocation.
class Writer {
 public:
  explicit Writer(Address from = {}) : from_(from) {}

  /// Writes the frame of a message of messages.hpp; kMaxFrame bytes are enough for any.
  /// @return bytes written; 0 if the buffer is too small, and then the sequence does not advance
  template <class Message>
  std::size_t write(const Message& message, std::uint8_t* buffer, std::size_t size) {
    std::uint8_t payload[Message::kSize];
    encode(message, payload);
    return frame(Message::kId, Message::kCrcExtra, payload, Message::kSize, buffer, size);
  }

  /// Of the next frame.
  std::uint8_t sequence() const { return sequence_; }

 private:
  std::size_t frame(std::uint32_t id, std::uint8_t crc_extra, const std::uint8_t* payload,
                    std::size_t length, std::uint8_t* buffer, std::size_t size);

  Address from_;
  std::uint8_t sequence_ = 0;
};

}  // namespace rio::mavlink
