// SPDX-License-Identifier: BSD-3-Clause
// What messages of ROS begin with.
#pragma once

#include "rio/bag/messages.hpp"

namespace rio::bag {

/// At the begin of a message; throws Damage for any other encoding than ROS 1 and CDR.
inline WireReader reader_of(Encoding encoding, Bytes message) {
  if (encoding == Encoding::kCdr) return WireReader::cdr(message);
  if (encoding == Encoding::kRos1) return WireReader(message);
  throw Damage(0, "neither ROS 1 nor CDR");
}

/// std_msgs/Header.
inline Header read_header(WireReader* reader) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  Header header;
  if (!reader->is_cdr()) header.sequence = reader->read<std::uint32_t>();
  // seconds: unsigned in ROS 1, signed in ROS 2; they differ beyond 2038 only
  const auto seconds = reader->read<std::uint32_t>();
  const auto nanoseconds = reader->read<std::uint32_t>();
  header.stamp = Time(std::int64_t{seconds} * kSecond + nanoseconds);
  header.frame_id = reader->text();
  return header;
}

}  // namespace rio::bag
