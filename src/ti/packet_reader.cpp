// SPDX-License-Identifier: BSD-3-Clause
#include "rio/ti/packet_reader.hpp"

#include <algorithm>
#include <cstring>

namespace rio::ti {
namespace {

constexpr std::size_t kSmallestPacket = 64;
constexpr std::size_t kPointSize = 16;
constexpr std::uint32_t kMostLost = 10000;  // frames in a row; a larger jump is not a loss

/// The first magic word that begins in [from, to - 7), or to.
std::size_t find_magic(const std::uint8_t* bytes, std::size_t from, std::size_t to) {
  while (from + kMagicSize <= to) {
    const void* found = std::memchr(bytes + from, kMagic[0], to - from - (kMagicSize - 1));
    if (found == nullptr) return to;
    from = static_cast<std::size_t>(static_cast<const std::uint8_t*>(found) - bytes);
    if (std::memcmp(bytes + from, kMagic, kMagicSize) == 0) return from;
    ++from;
  }
  return to;
}

}  // namespace

const char* to_string(StreamState state) {
  switch (state) {
    case StreamState::kSilent:
      return "no byte yet";
    case StreamState::kSearching:
      return "bytes, but no packet: another port, or another baud rate";
    case StreamState::kFrames:
      return "packets of SDK 3.x";
    case StreamState::kOldSdk:
      return "packets of SDK 1 or 2, which are not read: load a demo of SDK 3.x";
    case StreamState::kNewSdk:
      return "packets of SDK 4 or later, which are not read";
  }
  return "unknown";
}

// Twice the packet: a move to the front never copies more than was read since the last one.
PacketReader::PacketReader(std::size_t max_packet)
    : max_packet_(std::max(max_packet, kSmallestPacket)),
      buffer_(2 * max_packet_),
      walk_(max_packet_) {
  frame_.scan.detections.reserve(max_packet_ / kPointSize);
}

void PacketReader::drop_pending() {
  skip_to(end_);
  begin_ = end_ = unclaimed_ = searched_ = 0;
  in_packet_ = held_ = false;
}

/// @return number of bytes stored; at least one
std::size_t PacketReader::store(const std::uint8_t* bytes, std::size_t count) {
  if (state_ == StreamState::kSilent) state_ = StreamState::kSearching;
  if (end_ == buffer_.size()) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    searched_ -= begin_;
    unclaimed_ -= begin_;  // next() leaves it at begin_ or later
    begin_ = 0;
  }
  const std::size_t stored = std::min(count, buffer_.size() - end_);
  std::memcpy(buffer_.data() + end_, bytes, stored);
  end_ += stored;
  return stored;
}

/// The next complete frame, or null when the bytes are used up.
Frame* PacketReader::next(Time arrival) {
  while (in_packet_ || find_packet(arrival)) {
    const std::size_t magic = find_magic(buffer_.data(), searched_, end_);
    const bool cut = magic < end_;
    // searched before the magic word was complete, so that the result does not depend on the pieces
    const std::size_t end = cut ? magic + kMagicSize - 1 : end_;
    searched_ = cut ? magic : std::max(searched_, end_ - (kMagicSize - 1));
    const PacketVerdict verdict = walk_.advance(buffer_.data() + begin_, end - begin_);
    if (verdict == PacketVerdict::kComplete && begin_ + walk_.size() <= magic) {
      if (!held_) frame_.last_arrival = arrival;
      held_ = !cut && may_end_in_magic();
      return held_ ? nullptr : hand_out();
    }
    if (verdict == PacketVerdict::kMore && !cut) return nullptr;
    const bool wrong = verdict == PacketVerdict::kMore || verdict == PacketVerdict::kComplete;
    give_up(wrong ? PacketVerdict::kDamaged : verdict);
  }
  return nullptr;
}

/// Whether a magic word may begin in the last bytes of the complete packet and end behind them,
/// from the bytes received so far.
bool PacketReader::may_end_in_magic() const {
  const std::size_t packet_end = begin_ + walk_.size();
  for (std::size_t at = packet_end - (kMagicSize - 1); at < packet_end; ++at) {
    const std::size_t there = std::min(end_ - at, kMagicSize);
    if (std::memcmp(buffer_.data() + at, kMagic, there) == 0) return true;
  }
  return false;
}

std::optional<Time> PacketReader::held_since() const {
  return held_ ? std::optional<Time>(frame_.last_arrival) : std::nullopt;
}

bool PacketReader::find_packet(Time arrival) {
  const std::size_t found = find_magic(buffer_.data(), std::max(begin_, searched_), end_);
  if (found == end_) {  // the last bytes may be the beginning of one
    begin_ = std::max(begin_, end_ - std::min(end_, kMagicSize - 1));
    searched_ = begin_;
    skip_to(begin_);
    return false;
  }
  begin_ = found;
  searched_ = found + 1;
  skip_to(found);
  walk_ = PacketWalk(max_packet_);
  frame_.first_arrival = arrival;
  in_packet_ = true;
  return true;
}

/// The packet is complete. Its last bytes are kept, since they may be the start of a magic word
/// after all: flush() may have come too early.
Frame* PacketReader::hand_out() {
  counters_.points_left_out += walk_.decode(buffer_.data() + begin_, &frame_);
  frame_.scan.time = frame_.first_arrival;
  count_number(frame_.number);
  unclaimed_ = begin_ + walk_.size();
  begin_ = searched_;
  in_packet_ = held_ = false;
  fruitless_ = 0;
  state_ = StreamState::kFrames;
  return &frame_;
}

/// Not a packet of SDK 3; the search continues one byte after it.
void PacketReader::give_up(PacketVerdict verdict) {
  if (verdict == PacketVerdict::kDamaged) {
    ++counters_.damaged;
  } else {
    ++counters_.other_sdk;
    fruitless_ = 0;
    state_ = verdict == PacketVerdict::kOldSdk ? StreamState::kOldSdk : StreamState::kNewSdk;
  }
  ++begin_;
  in_packet_ = held_ = false;
}

/// Counts the bytes before `index` that belong to no frame as skipped.
void PacketReader::skip_to(std::size_t index) {
  if (index <= unclaimed_) return;
  counters_.bytes_skipped += index - unclaimed_;
  fruitless_ += index - unclaimed_;
  unclaimed_ = index;
  if (fruitless_ > max_packet_) state_ = StreamState::kSearching;
}

void PacketReader::count_number(std::uint32_t number) {
  const std::uint32_t step = number - frame_number_;
  if (counters_.frames > 0 && step > kMostLost) ++counters_.restarts;
  if (counters_.frames > 0 && step > 1 && step <= kMostLost) counters_.lost += step - 1;
  frame_number_ = number;
  ++counters_.frames;
}

}  // namespace rio::ti
