// SPDX-License-Identifier: BSD-3-Clause
// What a check remembers of its verdicts: the same for velocity, tilt and heading.
#pragma once

#include <optional>

#include "rio/types.hpp"

namespace rio {

/// Each scan either supports a part of the estimate, contradicts it, or tells nothing of it.
class CheckRecord {
 public:
  /// The scan at `now` supports it, or it is replaced or starts over, which counts as supported.
  /// Returns what a check then finds: nothing.
  std::nullopt_t agree(Time now) {
    agreed_ = since_ = now;
    return std::nullopt;
  }
  /// The scan at `now` tells nothing: a contradiction ends without support. Same.
  std::nullopt_t abstain(Time now) {
    since_ = now;
    return std::nullopt;
  }

  /// When it was last supported.
  Time agreed() const { return agreed_; }
  /// For how long the scans up to `now` have contradicted it [s].
  double contradicted(Time now) const { return to_seconds(now - since_); }
  /// They have done so for `patience`.
  bool lasts(Time now, Time patience) const { return now - since_ >= patience; }

 private:
  Time agreed_{0};
  Time since_{0};
};

}  // namespace rio
