// SPDX-License-Identifier: BSD-3-Clause
#include "live/scan_watch.hpp"

namespace rio::live {
namespace {

bool is_certain(ti::StreamState state) {
  using ti::StreamState;
  return state == StreamState::kOldSdk || state == StreamState::kNewSdk ||
         state == StreamState::kOtherDemo || state == StreamState::kCutShort;
}

}  // namespace

std::string ScanWatch::look(const ti::PacketReader& reader, Time now, const std::string& times) {
  const ti::PacketCounters& counters = reader.counters();
  const std::uint64_t frames = counters.points > 0 ? counters.frames : 0;
  if (!waits_ || frames != frames_) {
    const bool back = silent_;
    waits_ = true;
    silent_ = false;
    frames_ = frames;
    bytes_ = counters.bytes;
    since_ = now;
    if (back) return "scans again";
  }
  if (is_certain(reader.state()) && reader.state() != said_) {
    said_ = reader.state();
    return reader.problem();
  }
  if (!times.empty() && !timed_) {
    timed_ = true;
    return times;
  }
  if (silent_ || now - since_ < kPatience) return {};
  silent_ = true;
  const std::uint64_t bytes = counters.bytes - bytes_;
  const std::string seen = bytes == 0 ? "no byte came" : std::to_string(bytes) + " bytes came";
  const std::string problem = bytes == 0 ? "" : reader.problem();
  return "no scan for 10 s; " + seen + (problem.empty() ? "" : ": " + problem);
}

}  // namespace rio::live
