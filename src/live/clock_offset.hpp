// SPDX-License-Identifier: BSD-3-Clause
// The clock of this machine against that of a sensor.
//
// Samples only ever arrive late: offset = arrival - stamp is the true one plus the time on the way,
// and the smallest of the last seconds is the nearest to the truth. The samples keep their own
// stamps; what is stamped by arrival on this machine, as the frames of a radar, is moved onto them.
#pragma once

#include "rio/types.hpp"

namespace rio::live {

class ClockOffset {
 public:
  /// Once a sample. Five in a row that are off by more than a second start it anew: a clock has
  /// jumped.
  void add(Time stamp, Time arrival);

  bool known() const { return known_; }
  /// This machine's clock minus the sensor's: the smallest of the last five to ten seconds.
  Time offset() const { return before_ < now_ ? before_ : now_; }

 private:
  void start(Time offset, Time arrival);

  bool known_ = false;
  int odd_ = 0;     ///< in a row
  Time begin_{0};   ///< of the present five seconds
  Time now_{0};     ///< smallest in them
  Time before_{0};  ///< smallest in the five seconds before
};

}  // namespace rio::live
