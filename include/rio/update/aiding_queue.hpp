// SPDX-License-Identifier: BSD-3-Clause
// Measurements of other sensors that wait for the scan, or the moment, they are used with.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "rio/update/aiding.hpp"

namespace rio {

/// In the order of their time. No allocation after construction.
class AidingQueue {
 public:
  AidingQueue() {
    waiting_.reserve(kMaxWaiting);
    taken_.reserve(kMaxAiding);
  }

  void clear() {
    waiting_.clear();
    taken_.clear();
  }

  /// In any order of time. False if too many wait.
  bool add(const AidingMeasurement& measurement) {
    if (waiting_.size() == kMaxWaiting) return false;
    const auto at = std::upper_bound(
        waiting_.begin(), waiting_.end(), measurement.time(),
        [](Time time, const AidingMeasurement& other) { return time < other.time(); });
    waiting_.insert(at, measurement);
    return true;
  }

  /// Time of the oldest.
  std::optional<Time> next() const {
    if (waiting_.empty()) return {};
    return waiting_.front().time();
  }

  /// If more than one update takes were measured up to `time`: the time of the last it takes.
  std::optional<Time> full_batch(Time time) const {
    if (waiting_.size() <= kMaxAiding || waiting_[kMaxAiding].time() > time) return {};
    return waiting_[kMaxAiding - 1].time();
  }

  /// Moves the oldest measured up to `time`, kMaxAiding at most, to taken().
  /// @param x state of the update
  /// @param anchor anchor(time): time of the window state that keeps a measurement
  template <class Anchor>
  void take(Time time, const NavState& x, const ImuBuffer& imu, const Anchor& anchor) {
    taken_.clear();
    for (const AidingMeasurement& z : waiting_) {
      if (z.time() > time || taken_.size() == kMaxAiding) break;
      const Time kept = anchor(z.time());
      const ImuIncrements to_now = imu_increments(z.time(), x.time, x, imu);
      taken_.push_back(
          {z, to_now, kept, kept == x.time ? to_now : imu_increments(z.time(), kept, x, imu)});
    }
    waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(taken_.size()));
  }

  /// Takes out of the current update those for which hold(observation) is true; returns how many.
  template <class Hold>
  int hold_back(const Hold& hold) {
    return static_cast<int>(std::erase_if(taken_, hold));
  }

  /// Adds the velocity of the scan, measured at the time of the update, if there is room.
  void take_ego_velocity(const AidingMeasurement& z) {
    if (taken_.size() == kMaxAiding) return;
    taken_.push_back({z, {}, z.time(), {}, Model::kEgoVelocity});
  }

  /// Those of the current update; the address stays valid.
  const std::vector<AidingObservation>& taken() const { return taken_; }

 private:
  static constexpr std::size_t kMaxWaiting = 256;  // a second of a fast sensor

  std::vector<AidingMeasurement> waiting_;  ///< oldest first
  std::vector<AidingObservation> taken_;
};

}  // namespace rio
