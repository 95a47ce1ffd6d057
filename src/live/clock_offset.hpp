// SPDX-License-Identifier: BSD-3-Clause
// The clock of this machine relative to that of a sensor.
//
// Samples can only be late: offset = arrival - stamp is the true one plus the delay, and the
// smallest of the last seconds is nearest to the truth. The samples keep their own stamps; stamps
// of arrival on this machine, as of radar frames, are converted to the sensor's clock.
#pragma once

#include "rio/types.hpp"

namespace rio::live {

class ClockOffset {
 public:
  /// Call once per sample. Five in a row that are off by more than a second restart it: a clock has
  /// jumped.
  void add(Time stamp, Time arrival);

  bool known() const { return known_; }
  /// This machine's clock minus the sensor's: the smallest offset of the last five to ten seconds.
  Time offset() const { return before_ < now_ ? before_ : now_; }

 private:
  void start(Time offset, Time arrival);

  bool known_ = false;
  int odd_ = 0;     ///< in a row
  Time begin_{0};   ///< of the current five seconds
  Time now_{0};     ///< smallest in them
  Time before_{0};  ///< smallest in the five seconds before
};

}  // namespace rio::live
