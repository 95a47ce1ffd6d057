// SPDX-License-Identifier: BSD-3-Clause
// Messages with random fields, of any bits but for the NaN, which is the one.
#pragma once

#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include "rio/mavlink/frame.hpp"
#include "rio/mavlink/parser.hpp"
#include "rio/sim/random.hpp"

namespace rio::mavlink::test {

using Bytes = std::vector<std::uint8_t>;

template <class Message>
Message random_message(sim::Random* random) {
  Message message;
  for_each_number(message, [random](auto& value) {
    std::uint64_t bits = static_cast<std::uint64_t>(random->next()) << 32 | random->next();
    if (random->next() % 8 == 0) bits = 0;
    std::memcpy(&value, &bits, sizeof value);
    if constexpr (std::is_floating_point_v<std::decay_t<decltype(value)>>) {
      if (std::isnan(value) || random->next() % 16 == 0) value = kUnknown;
    }
  });
  return message;
}

/// The payload without any truncation: equal if and only if all fields are, NaN with NaN.
template <class Message>
std::array<std::uint8_t, Message::kSize> payload_of(const Message& message) {
  std::array<std::uint8_t, Message::kSize> payload{};
  encode(message, payload.data());
  return payload;
}

template <class Message>
Bytes frame_of(const Message& message, Writer* writer) {
  Bytes bytes(kMaxFrame);
  bytes.resize(writer->write(message, bytes.data(), bytes.size()));
  return bytes;
}

inline void append(Bytes* to, const Bytes& bytes) {
  to->insert(to->end(), bytes.begin(), bytes.end());
}

/// All packets in the bytes, in pieces of `piece` bytes.
inline std::vector<Packet> parse(Parser* parser, const Bytes& bytes, std::size_t piece = 1000) {
  std::vector<Packet> packets;
  for (std::size_t at = 0; at < bytes.size(); at += piece) {
    parser->push(bytes.data() + at, std::min(piece, bytes.size() - at), Time(static_cast<long>(at)),
                 [&](const Packet& packet) { packets.push_back(packet); });
  }
  return packets;
}

}  // namespace rio::mavlink::test
