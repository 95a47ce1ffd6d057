// SPDX-License-Identifier: BSD-3-Clause
// Says, once, why a radar gives no scans, or none with the right times.
#pragma once

#include <cstdint>
#include <string>

#include "rio/ti/packet_reader.hpp"

namespace rio::live {

class ScanWatch {
 public:
  static constexpr Time kPatience = std::chrono::seconds(10);

  /// Call it some times a second.
  /// @param now real time
  /// @param times Session::times_problem()
  /// @return what to say: a certain cause at once, others after ten seconds without a scan, and
  /// that the scans are back; mostly empty
  std::string look(const ti::PacketReader& reader, Time now, const std::string& times = {});

 private:
  Time since_{0};  ///< without a scan
  std::uint64_t frames_ = 0;
  std::uint64_t bytes_ = 0;
  bool waits_ = false;   ///< since the first look
  bool timed_ = false;   ///< that times are wrong was said
  bool silent_ = false;  ///< that there is no scan was said
  ti::StreamState said_ = ti::StreamState::kSilent;
};

}  // namespace rio::live
