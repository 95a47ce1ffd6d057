// SPDX-License-Identifier: BSD-3-Clause
// Spells of a disturbance, spread evenly over a flight.
#pragma once

namespace rio::sim {

/// `count` spells of equal duration; the k-th of n is centred at k/(n + 1) of the flight.
struct Spells {
  int count = 0;
  double duration = 0.0;  ///< of each [s]

  /// Whether `seconds` after the start of a flight of `total` seconds is inside one.
  bool contain(double seconds, double total) const {
    for (int k = 1; k <= count; ++k) {
      const double since = seconds - total * k / (count + 1) + 0.5 * duration;
      if (since >= 0.0 && since < duration) return true;
    }
    return false;
  }
};

}  // namespace rio::sim
