// SPDX-License-Identifier: BSD-3-Clause
// The stamps of all scans, taken or not, as a witness of the clock that they share with the IMU.
#pragma once

#include <chrono>

#include "rio/checks/stamp_guard.hpp"
#include "rio/types.hpp"

namespace rio {

class StampRun {
 public:
  /// @param step longest distance of two stamps that follow each other
  explicit StampRun(Time step) : step_(step) {}

  /// Stamps for which is_stamp() is false are passed over.
  void add(Time stamp) {
    if (!is_stamp(stamp)) return;
    if (!begun_ || std::chrono::abs(stamp - last_) >= step_) first_ = stamp;
    last_ = stamp;
    begun_ = true;
  }
  /// The stamps have gone on without a jump from `before` to `after`: between them lies a pause.
  bool goes_through(Time before, Time after) const {
    return begun_ && first_ < before + step_ && before < last_ &&
           std::chrono::abs(after - last_) < step_;
  }

 private:
  Time step_;
  bool begun_ = false;
  Time first_{0};  ///< since the last jump
  Time last_{0};
};

}  // namespace rio
