// SPDX-License-Identifier: BSD-3-Clause
#include "rio/ti/packet_reader.hpp"

#include <algorithm>
#include <cstring>

namespace rio::ti {
namespace {

constexpr std::size_t kSmallestPacket = 64;
constexpr std::size_t kPointSize = 8;       // the smallest
constexpr std::size_t kFewBytes = 16;       // too few to tell a text
constexpr int kManyFruitless = 10;          // in a row, not by chance
constexpr int kNoneWhole = 20;              // in a row: how a whole one before ended tells nothing
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

/// As in the output of hexdump and xxd.
bool is_of_dump(std::uint8_t byte) {
  return (byte >= '0' && byte <= '9') || (byte >= 'a' && byte <= 'f') ||
         (byte >= 'A' && byte <= 'F') || (byte != 0 && std::strchr(" \t\r\n.:|", byte) != nullptr);
}

bool is_printable(std::uint8_t byte) {
  return (byte >= ' ' && byte <= '~') || (byte >= '\t' && byte <= '\r');
}

}  // namespace

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
  in_packet_ = held_ = complete_ = false;
}

/// @return number of bytes stored; at least one
std::size_t PacketReader::store(const std::uint8_t* bytes, std::size_t count) {
  if (state_ == StreamState::kSilent) state_ = StreamState::kSearching;
  if (end_ == buffer_.size()) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    searched_ -= begin_;
    unclaimed_ -= begin_;  // next() leaves it at begin_ or later
    expected_ -= std::min(expected_, begin_);
    begin_ = 0;
  }
  const std::size_t stored = std::min(count, buffer_.size() - end_);
  if (counters_.bytes < head_.size()) {
    const std::size_t known = static_cast<std::size_t>(counters_.bytes);
    std::copy_n(bytes, std::min(stored, head_.size() - known), head_.begin() + known);
  }
  std::memcpy(buffer_.data() + end_, bytes, stored);
  end_ += stored;
  counters_.bytes += stored;
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
    const bool whole = begin_ + walk_.size() <= magic;
    const bool agrees = verdict == PacketVerdict::kComplete || verdict == PacketVerdict::kOtherDemo;
    if (agrees && whole) {
      if (!complete_) frame_.last_arrival = arrival;
      complete_ = true;
      held_ = !cut && may_end_in_magic();
      if (held_) return nullptr;
      if (verdict == PacketVerdict::kComplete) return hand_out(walk_.size());
      give_up(verdict);
      continue;
    }
    if (verdict == PacketVerdict::kMore && !cut) {
      frame_.last_arrival = arrival;
      held_ = counters_.cut_short > 0 && walk_.size_without_padding() > 0 &&
              begin_ + walk_.size() <= buffer_.size() && is_cut_short(end_ - begin_);
      return nullptr;
    }
    if (verdict == PacketVerdict::kComplete && is_cut_short(magic - begin_)) {
      if (Frame* frame = end_early(magic - begin_)) return frame;
      continue;
    }
    const bool is_old = verdict == PacketVerdict::kOldSdk;
    give_up(is_old ? verdict : PacketVerdict::kDamaged);
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

/// Whether a packet of so many bytes lacks as many as all before, and no whole one came lately.
bool PacketReader::is_cut_short(std::size_t size) const {
  if (whole_ || size >= walk_.size() || walk_.size() - size >= kMagicSize) return false;
  return missing_ == 0 || missing_ == walk_.size() - size;
}

/// A packet whose last bytes will not come.
/// @return null if more than padding is missing, or if it is the first, or most packets are damaged
/// in other ways
Frame* PacketReader::end_early(std::size_t size) {
  ++counters_.cut_short;
  missing_ = walk_.size() - size;
  const bool most = counters_.cut_short > counters_.damaged;
  state_ = most ? StreamState::kCutShort : StreamState::kDamaged;
  if (walk_.size_without_padding() <= size && counters_.cut_short > counters_.damaged + 1) {
    return hand_out(size);
  }
  leave_packet();
  return nullptr;
}

/// What was held has its end. Of a packet that ends early the missing bytes are whatever stands in
/// the buffer.
Frame* PacketReader::end_held() {
  const PacketVerdict verdict = walk_.advance(buffer_.data() + begin_, walk_.size());
  if (verdict == PacketVerdict::kComplete) {
    return complete_ ? hand_out(walk_.size()) : end_early(end_ - begin_);
  }
  give_up(complete_ ? verdict : PacketVerdict::kDamaged);
  return nullptr;
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
  if (expected_ > 0 && found == expected_) ++expected_run_;
  walk_ = PacketWalk(max_packet_);
  fruitless_ = printable_ = dumped_ = 0;
  frame_.first_arrival = arrival;
  in_packet_ = true;
  return true;
}

/// The packet has all its bytes. Its last ones are kept, since they may be the start of a magic
/// word after all: flush() may have come too early.
Frame* PacketReader::hand_out(std::size_t size) {
  counters_.points_left_out += walk_.decode(buffer_.data() + begin_, &frame_);
  counters_.points += frame_.scan.detections.size();
  frame_.scan.time = frame_.first_arrival;
  count_number(frame_.number);
  if (walk_.firmware() != nullptr) firmware_ = walk_.firmware();
  unknown_tlv_ = walk_.firmware() == nullptr ? walk_.unknown_tlv() : 0;
  unclaimed_ = begin_ + size;
  begin_ = searched_;
  in_packet_ = held_ = complete_ = false;
  fruitless_run_ = expected_run_ = 0;
  too_long_ = 0;
  whole_ = whole_ || size == walk_.size();
  state_ = whole_ ? StreamState::kFrames : StreamState::kCutShort;
  return &frame_;
}

/// No packet that is read.
void PacketReader::give_up(PacketVerdict verdict) {
  const bool frames_came = state_ == StreamState::kFrames || state_ == StreamState::kCutShort;
  const bool many = ++fruitless_run_ >= kManyFruitless;
  if (fruitless_run_ == kNoneWhole) {
    whole_ = false;
    missing_ = 0;
  }
  if (verdict == PacketVerdict::kDamaged) {
    ++counters_.damaged;
    if (many || finds_nothing()) state_ = StreamState::kDamaged;
    const bool whole = expected_run_ > 1 && 2 * expected_run_ >= fruitless_run_;
    if (whole && !frames_came) take_state_of_other(verdict);
    const std::uint8_t* length = buffer_.data() + begin_ + 12;
    if (begin_ + 16 <= end_) {
      const std::size_t low = length[0] | length[1] * std::size_t{256};
      const std::size_t size = low | length[2] * std::size_t{1U << 16};
      expected_ = begin_ + low;
      too_long_ = size > max_packet_ && length[3] == 0 ? size : 0;
    }
  } else {
    ++counters_.other_sdk;
    if (many || !frames_came) take_state_of_other(verdict);
  }
  leave_packet();
}

void PacketReader::take_state_of_other(PacketVerdict verdict) {
  firmware_ = walk_.firmware() == nullptr ? &kUnknownDemo : walk_.firmware();
  miscounted_ = walk_.miscounted();
  const bool is_new = firmware_->header == 40 && buffer_[begin_ + 11] > kDemo.last_sdk;
  state_ = verdict == PacketVerdict::kOldSdk ? StreamState::kOldSdk
           : is_new                          ? StreamState::kNewSdk
                                             : StreamState::kOtherDemo;
}

/// The search continues one byte after its beginning.
void PacketReader::leave_packet() {
  ++begin_;
  in_packet_ = held_ = complete_ = false;
}

bool PacketReader::finds_nothing() const {
  return state_ == StreamState::kSearching || state_ == StreamState::kText;
}

/// Counts the bytes before `index` that belong to no frame as skipped.
void PacketReader::skip_to(std::size_t index) {
  if (index <= unclaimed_) return;
  counters_.bytes_skipped += index - unclaimed_;
  fruitless_ += index - unclaimed_;
  for (; unclaimed_ < index; ++unclaimed_) {
    printable_ += is_printable(buffer_[unclaimed_]) ? 1 : 0;
    dumped_ += is_of_dump(buffer_[unclaimed_]) ? 1 : 0;
  }
  if (fruitless_ <= max_packet_ + too_long_ && !finds_nothing()) return;
  const bool is_text = fruitless_ >= kFewBytes && 20 * printable_ > 19 * fruitless_;
  state_ = is_text ? StreamState::kText : StreamState::kSearching;
}

void PacketReader::count_number(std::uint32_t number) {
  const std::uint32_t step = number - frame_number_;
  if (counters_.frames > 0 && step > kMostLost) ++counters_.restarts;
  if (counters_.frames > 0 && step > 1 && step <= kMostLost) counters_.lost += step - 1;
  frame_number_ = number;
  ++counters_.frames;
}

}  // namespace rio::ti
