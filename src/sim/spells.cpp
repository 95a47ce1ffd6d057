// SPDX-License-Identifier: BSD-3-Clause
#include "rio/sim/spells.hpp"

namespace rio::sim {

bool Spells::contain(double seconds, double total) const {
  for (int k = 1; k <= count; ++k) {
    const double since = seconds - total * k / (count + 1) + 0.5 * duration;
    if (since >= 0.0 && since < duration) return true;
  }
  return false;
}

}  // namespace rio::sim
