// SPDX-License-Identifier: BSD-3-Clause
// What is wrong with the bytes of a port, and what to do.
#include <cstring>
#include <iterator>

#include "rio/ti/packet_reader.hpp"

namespace rio::ti {
namespace {

constexpr std::uint64_t kManyDamaged = 4;  // one damaged packet to so many whole ones
constexpr const char* kOnTheWay =
    "bytes are lost or changed on the way (cable, recorder, a port that is not raw)";

/// What compressed it, by the first four bytes; null if nothing has.
const char* compression(const std::uint8_t* head) {
  static constexpr struct {
    const char* magic;
    const char* name;
  } kKinds[] = {
      {"\x1F\x8B", "gzip"}, {"BZh", "bzip2"}, {"PK\x03\x04", "zip"}, {"\x28\xB5\x2F\xFD", "zstd"}};
  for (const auto& kind : kKinds) {
    if (std::memcmp(head, kind.magic, std::strlen(kind.magic)) == 0) return kind.name;
  }
  return nullptr;
}

}  // namespace

const char* to_string(StreamState state) {
  static constexpr const char* kTexts[] = {
      "no byte yet",
      "bytes, but no packet: another port, or another baud rate",
      "packets",
      "packets of SDK 1 or 2, which are not read: load a demo of SDK 3.x",
      "packets of SDK 4 or later whose points are not read",
      "magic words, but the header or the points of another demo",
      "no packets, but text: this is the CLI port",
      "magic words, but no whole packet",
      "each packet ends early: recorder or splitter"};
  static_assert(std::size(kTexts) == static_cast<std::size_t>(StreamState::kCutShort) + 1);
  const auto i = static_cast<std::size_t>(state);
  return i < std::size(kTexts) ? kTexts[i] : "unknown";
}

std::string PacketReader::problem() const {
  std::string text = to_string(state_);
  switch (state_) {
    case StreamState::kFrames:
      if (counters_.points > 0 && kManyDamaged * counters_.damaged <= counters_.frames) return {};
      if (counters_.points > 0) {
        return std::to_string(counters_.damaged) + " packets are damaged, " +
               std::to_string(counters_.frames) + " whole: " + kOnTheWay;
      }
      if (counters_.points_left_out > 0) {
        return text + " with " + std::to_string(counters_.points_left_out) +
               " points, none of them finite: load the out-of-box demo";
      }
      if (unknown_tlv_ == 0)
        return text +
               " without points: nothing is detected, or guiMonitor does not send them (-1 1 ...)";
      return text + " without points, but with TLV " + std::to_string(unknown_tlv_) +
             ": set guiMonitor to send the points, or load the out-of-box demo";
    case StreamState::kText:
      return 20 * dumped_ > 19 * fruitless_
                 ? "no packets, but a dump in text (hexdump, xxd): give the bytes themselves"
                 : text;
    case StreamState::kSearching: {
      if (const char* kind = compression(head_.data())) {
        return std::string("no packets, but a compressed file (") + kind + "): unpack it first";
      }
      int baud = kDemo.baud;
      text += " (" + std::to_string(baud);
      for (const Firmware& row : kFirmware) {
        if (row.baud == baud || row.baud == kDemo.baud) continue;
        baud = row.baud;
        text += "; " + std::to_string(baud) + " for " + row.name;
      }
      return text + ")";
    }
    case StreamState::kDamaged:
      if (too_long_ == 0) return text + ": " + kOnTheWay;
      return "packets of " + std::to_string(too_long_) + " bytes, longer than the " +
             std::to_string(max_packet_) + " that are read: switch the heat maps off (guiMonitor)";
    case StreamState::kNewSdk:
    case StreamState::kOtherDemo:
      if (firmware_->header != kDemo.header) text = "magic words, but the header of another demo";
      if (firmware_->tlv == kDemo.tlv) text = "packets, but TLV 1 of another demo";
      return text + ": " + firmware_->name + "; " + firmware_->advice;
    case StreamState::kCutShort:
      return "each packet ends " +
             (missing_ == 1 ? std::string("one byte") : std::to_string(missing_) + " bytes") +
             " early: recorder or splitter; points are used where that is padding";
    default:
      return text;
  }
}

}  // namespace rio::ti
