// SPDX-License-Identifier: BSD-3-Clause
// Stage 2: which radars have a mounting that is not known yet, and the searches for them.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "rio/frontend/mounting_search.hpp"

namespace rio {

/// A search for each radar if their mounting is unknown, or none.
class Mountings {
 public:
  explicit Mountings(const Options& options) {
    if (!MountingSearch::is_unknown(options.calibration)) return;
    for (std::size_t r = 0; r < options.radars(); ++r) searches_.emplace_back(options.seen_by(r));
  }

  /// No Doppler and no point of this radar means anything in the body frame yet.
  bool is_unknown(std::size_t radar) const { return !searches_.empty() && !found_[radar]; }
  /// What was found; empty for a radar that is unknown, or was known from the start.
  const std::optional<Mounting>& found(std::size_t radar) const { return found_[radar]; }

  /// Takes a scan of a radar that is unknown, as MountingSearch::add. True once it was found.
  /// @param gap the IMU has paused since the last scan
  bool add(const DetectionList& scan, const Estimate& x, const BodyCovariance& P, bool gap) {
    MountingSearch& search = searches_[scan.radar];
    if (gap) search.restart_drift();
    found_[scan.radar] = search.add(scan, x, P);
    if (!found_[scan.radar]) return false;
    restart_drifts();  // the caller corrects the motion
    return true;
  }

  /// The velocity of the IMU is about to be corrected, or was.
  void restart_drifts() {
    for (MountingSearch& search : searches_) search.restart_drift();
  }
  /// The radars may have been mounted anew: those that were found are sought again.
  void forget() {
    for (MountingSearch& search : searches_) search.reset();
    found_.fill(std::nullopt);
  }

 private:
  std::vector<MountingSearch> searches_;
  std::array<std::optional<Mounting>, kMaxRadars> found_;
};

}  // namespace rio
