// SPDX-License-Identifier: BSD-3-Clause
// What is wrong with the bytes of a port, and what to do.
#include <algorithm>
#include <cstring>
#include <iterator>
#include <string_view>

#include "rio/ti/packet_reader.hpp"

namespace rio::ti {
namespace {

constexpr std::uint64_t kManyDamaged = 4;  // one damaged packet to so many whole ones
constexpr std::string_view kEndOfMagic = "\6\5\x08\7";
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

constexpr const char* kDataPort = "give the data port of the radar";
constexpr const char* kExchange =
    "give the data port of the radar; --imu and --radar may be exchanged";
constexpr const char* kNotRead = "not read; send its samples as csv lines or MAVLink";
constexpr OtherDevice kNumbers = {"numbers in text, as of an IMU", kExchange,
                                  "--imu-format csv, in the columns of data/INTEGRATION.md, with "
                                  "commas, the stamp a whole number "
                                  "of ns"};

/// Each recognised by bytes that come again and again; '?' is any byte.
using namespace std::string_view_literals;
constexpr const char* kAutopilot = "MAVLink of an autopilot";
constexpr const char* kAsMavlink = "--imu-format mavlink or mavlink-raw";
constexpr struct {
  std::string_view bytes;
  OtherDevice device;
} kOthers[] = {
    {"RI\1"sv, {"samples of an IMU", kExchange, "--imu-format binary"}},
    {"\xFD?\0\0?\1\1"sv, {kAutopilot, kExchange, kAsMavlink}},
    {"\xFE??\1\1"sv, {kAutopilot, kExchange, kAsMavlink}},
    {"\xB5\x62"sv, {"UBX of a GNSS receiver", kDataPort, kNotRead}},
    {"$?????,"sv, {"lines of a GNSS receiver or IMU (NMEA)", kDataPort, kNotRead}},
    {"\xFA\xFF\x36"sv, {"data of an Xsens IMU", kDataPort, kNotRead}},
    {"\\x??\\x??\\x"sv,
     {"a dump in text (of Python)", "give the bytes themselves", "give the bytes themselves"}},
};

bool begins_with(std::string_view text, std::string_view pattern) {
  const auto fits = [](char any, char byte) { return any == '?' || any == byte; };
  return text.size() >= pattern.size() &&
         std::equal(pattern.begin(), pattern.end(), text.begin(), fits);
}

/// Whether the text has it again and again.
/// @param apart two of them, at most [bytes]
bool repeats(std::string_view text, std::string_view pattern, std::size_t apart = 1024) {
  std::size_t count = 0;
  for (std::size_t at = text.find(pattern[0]); at != text.npos;
       at = text.find(pattern[0], at + 1)) {
    count += begins_with(text.substr(at), pattern) ? 1 : 0;
  }
  return count > 2 + text.size() / apart;
}

/// What is in a TLV that holds no points, in other demos than the out-of-box one.
struct OtherTlv {
  std::uint32_t first;
  std::uint32_t last;
  const char* what;
};
constexpr OtherTlv kOtherTlvs[] = {
    {1001, 1001, "heart rate"},
    {1010, 1012, "tracked targets, of people tracking"},
    {1021, 1021, "presence, of people tracking"},
    {1030, 1031, "occupied zones or the kind of surface"},
    {1040, 1041, "vital signs"},
    {1050, 1051, "gestures"},
    {3000, 3999, "an extension of TI's Radar Toolbox"},
};

/// @param has_tlv the packets have one for points
/// @param unknown type of another TLV, or 0
std::string why_no_points(bool has_tlv, std::uint32_t unknown, std::uint32_t sdk) {
  if (has_tlv) {
    return ": nothing is detected (clutter removal is on, or the thresholds are too high)";
  }
  if (unknown == 0) {
    return std::string(": nothing is detected, or guiMonitor does not send them (") +
           (sdk < 5 ? "-1 1 ...)" : "2 ...)");
  }
  const auto* const other = std::find_if(
      std::begin(kOtherTlvs), std::end(kOtherTlvs),
      [unknown](const OtherTlv& tlv) { return unknown >= tlv.first && unknown <= tlv.last; });
  const std::string what =
      other == std::end(kOtherTlvs) ? "" : std::string(" (") + other->what + ")";
  if (sdk >= 5) {
    return ", but with TLV " + std::to_string(unknown) + what +
           ": send the points, as TLV 1 or 301, with guiMonitor 1 ... or 2 ..., or load the "
           "out-of-box demo (mmwave_demo) of its SDK";
  }
  const bool tracks = unknown > 1001 && unknown < 3000;  // these demos send TLV 1020 with them
  return ", but with TLV " + std::to_string(unknown) + what +
         (tracks ? ": nothing is detected (static clutter removal is on, or the scene is limited), "
                   "or load the out-of-box demo"
                 : ": set guiMonitor to send the points, or load the out-of-box demo");
}

/// The usual baud rates of the firmware.
std::string bauds() {
  int baud = kDemo.baud;
  std::string text = std::to_string(baud);
  for (const Firmware& row : kFirmware) {
    if (row.baud == baud || row.baud == kDemo.baud) continue;
    baud = row.baud;
    text += "; " + std::to_string(baud) + " for " + row.name;
  }
  return text;
}

}  // namespace

const OtherDevice* PacketReader::other_device() const {
  const std::string_view text = newest();
  if (text.empty()) return nullptr;
  for (const auto& other : kOthers) {
    if (repeats(text, other.bytes)) return &other.device;
  }
  const auto share = [text](std::string_view set) {
    const auto is_in = [set](char c) { return set.find(c) != std::string_view::npos; };
    return static_cast<double>(std::count_if(text.begin(), text.end(), is_in)) /
           static_cast<double>(text.size());
  };
  return share("0123456789+-.,;eE \t\r\n") > 0.95 && share(",;") > 0.02 ? &kNumbers : nullptr;
}

std::string_view PacketReader::newest() const {
  return {reinterpret_cast<const char*>(buffer_.data()),
          std::min<std::uint64_t>(counters_.bytes, buffer_.size())};
}

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
  if (state_ == StreamState::kText || state_ == StreamState::kSearching) {
    const OtherDevice* other = other_device();
    if (other != nullptr)
      return std::string("no packets, but ") + other->what + ": " + other->at_radar;
  }
  std::string damaged = std::to_string(counters_.damaged) + " packets are damaged, " +
                        std::to_string(counters_.frames) + " whole: " + kOnTheWay;
  switch (state_) {
    case StreamState::kFrames:
      if (counters_.points > 0 && kManyDamaged * counters_.damaged <= counters_.frames) return {};
      if (counters_.points > 0) return damaged;
      if (counters_.points_left_out > 0) {
        return text + " with " + std::to_string(counters_.points_left_out) +
               " points, none of them finite: load the out-of-box demo";
      }
      return text + " without points" +
             why_no_points(firmware_ != nullptr, unknown_tlv_, frame_.version >> 24);
    case StreamState::kSilent:
      return text +
             ": is it the data port (a TI radar has two), and was the radar configured "
             "(--radar-cfg, --cli)?";
    case StreamState::kText:
      if (20 * dumped_ > 19 * fruitless_) {
        return "no packets, but a dump in text (hexdump, xxd): give the bytes themselves";
      }
      return text +
             (newest().find(":/>") == std::string_view::npos ? ", or that of another device" : "");
    case StreamState::kSearching:
      if (const char* kind = compression(head_.data())) {
        return std::string("no packets, but a compressed file (") + kind + "): unpack it first";
      }
      if (counters_.frames == 0 && repeats(newest(), kEndOfMagic, kMaxPacket)) {
        return "each packet begins some bytes late: recorder or splitter";
      }
      return text + " (" + bauds() + ")";
    case StreamState::kDamaged:
      // a damaged length tells of more bytes than come
      if (too_long_ == 0 || 2 * counters_.bytes < too_long_ * counters_.damaged) {
        return counters_.frames > 0 ? damaged : text + ": " + kOnTheWay;
      }
      return "packets of " + std::to_string(too_long_) + " bytes, longer than the " +
             std::to_string(max_packet_) + " that are read: switch the heat maps off (guiMonitor)";
    case StreamState::kNewSdk:
    case StreamState::kOtherDemo:
      if (miscounted_) {
        return "packets, but numDetectedObj (or a count in TLV 301) contradicts the length of the "
               "points: changed on the way, or another demo";
      }
      if (firmware_->header != kDemo.header) text = "magic words, but the header of another demo";
      if (firmware_->tlv == kDemo.tlv) text = "packets, but TLV 1 of another demo";
      return text + ": " + firmware_->name + "; " +
             (state_ == StreamState::kNewSdk ? "load the out-of-box demo of its SDK"
                                             : firmware_->advice);
    case StreamState::kCutShort:
      return "each packet ends " +
             (missing_ == 1 ? std::string("one byte") : std::to_string(missing_) + " bytes") +
             " early: recorder or splitter; points are used where that is padding";
    default:
      return text;
  }
}

}  // namespace rio::ti
