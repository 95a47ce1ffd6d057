// SPDX-License-Identifier: BSD-3-Clause
#include "rio/mavlink/parser.hpp"

#include <algorithm>
#include <cstring>

namespace rio::mavlink {
namespace {

/// A frame header of either version.
struct Header {
  std::size_t size = 0;  ///< of the header
  std::size_t length = 0;
  std::uint8_t flags = 0;
  std::uint8_t sequence = 0;
  Address from;
  std::uint32_t id = 0;
};

Header header_of(const std::uint8_t* frame) {
  if (frame[0] == kMagicV1) {
    return {kHeaderV1, frame[1], 0, frame[2], {frame[3], frame[4]}, frame[5]};
  }
  const std::uint32_t id = frame[7] | static_cast<std::uint32_t>(frame[8]) << 8 |
                           static_cast<std::uint32_t>(frame[9]) << 16;
  return {kHeaderV2, frame[1], frame[2], frame[4], {frame[5], frame[6]}, id};
}

}  // namespace

void Parser::drop_pending() {
  candidates_.clear();
  stored_ = 0;
}

/// @return true if a packet is complete; the other candidates are discarded then
bool Parser::take(std::uint8_t byte) {
  ++counters_.bytes;
  if (stored_ == buffer_.size()) make_room();
  const std::size_t begin = stored_++;
  buffer_[begin] = byte;
  if (byte == kMagicV1) candidates_.push_back({begin, begin + kHeaderV1});
  if (byte == kMagicV2) candidates_.push_back({begin, begin + kHeaderV2});
  for (std::size_t i = 0; i < candidates_.size();) {
    Candidate& candidate = candidates_[i];
    if (candidate.end != stored_ || (!candidate.is_read && read_header(&candidate))) {
      ++i;
    } else if (candidate.is_read && read_frame(candidate)) {
      drop_pending();
      return true;
    } else {
      candidates_.erase(i);
    }
  }
  return false;
}

/// No candidate is longer than kMaxFrame, so three quarters of the buffer become free.
void Parser::make_room() {
  const std::size_t first = candidates_.empty() ? stored_ : candidates_[0].begin;
  std::memmove(buffer_.data(), buffer_.data() + first, stored_ - first);
  stored_ -= first;
  for (Candidate& candidate : candidates_) {
    candidate.begin -= first;
    candidate.end -= first;
  }
}

/// @return true if it may be a frame: of a known message
bool Parser::read_header(Candidate* candidate) const {
  const std::uint8_t* frame = buffer_.data() + candidate->begin;
  const Header header = header_of(frame);
  const MessageKind* kind = find_message(header.id);
  if (kind == nullptr || header.length == 0 || (header.flags & ~kFlagSigned) != 0) return false;
  if (frame[0] == kMagicV1 && header.length != kind->basic_size) return false;
  const std::size_t signature = header.flags != 0 ? kSignature : 0;
  candidate->end = candidate->begin + header.size + header.length + kChecksum + signature;
  candidate->is_read = true;
  return true;
}

/// Fills the packet except its arrival if the checksum is right.
bool Parser::read_frame(const Candidate& candidate) {
  const std::uint8_t* frame = buffer_.data() + candidate.begin;
  const Header header = header_of(frame);
  Crc16 crc;
  crc.add(frame + 1, header.size - 1 + header.length);
  crc.add(&find_message(header.id)->crc_extra, 1);
  const std::uint8_t* checksum = frame + header.size + header.length;
  if (crc.value() != (checksum[0] | checksum[1] << 8)) {
    ++counters_.damaged;
    return false;
  }
  packet_.id = header.id;
  packet_.from = header.from;
  packet_.sequence = header.sequence;
  packet_.version = frame[0] == kMagicV1 ? 1 : 2;
  const std::uint8_t* payload = frame + header.size;
  std::copy_n(payload, header.length, packet_.payload.begin());
  std::fill(packet_.payload.begin() + static_cast<std::ptrdiff_t>(header.length),
            packet_.payload.end(), std::uint8_t{0});
  ++counters_.frames;
  counters_.frame_bytes += candidate.end - candidate.begin;
  return true;
}

}  // namespace rio::mavlink
