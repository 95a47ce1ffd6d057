// SPDX-License-Identifier: BSD-3-Clause
#include "rio/checks/stamp_guard.hpp"

#include <algorithm>

namespace rio {

StampVerdict StampGuard::check(Time stamp) {
  if (!is_stamp(stamp)) return stamp < Time{0} ? StampVerdict::kOld : StampVerdict::kAhead;
  if (!newest_ || (stamp > *newest_ && stamp - std::max(seen_, *newest_) <= kSudden)) {
    seen_ = stamp;
    run_ = 0;
    return StampVerdict::kFollows;
  }
  if (run_ == 0 || stamp <= last_ || stamp - last_ > kSudden) {
    first_ = stamp;
    run_ = 0;
  }
  last_ = stamp;
  run_ = std::min(run_ + 1, kMany);
  const Time span = last_ - first_;
  const Time jump = first_ - *newest_;
  if (run_ == kMany && jump > Time{0} && jump <= max_pause_) {
    return jump <= kUsual || span >= kCertain ? StampVerdict::kFollows : StampVerdict::kAhead;
  }
  if (run_ == kMany && span >= kLasting) return StampVerdict::kRestarted;
  return stamp > *newest_ ? StampVerdict::kAhead : StampVerdict::kOld;
}

}  // namespace rio
