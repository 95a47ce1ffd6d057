// SPDX-License-Identifier: BSD-3-Clause
#include "rio/update/landmark_policy.hpp"

#include <algorithm>
#include <array>

namespace rio {

std::size_t stalest_landmark(const Estimate& x) {
  std::size_t stalest = 0;
  for (std::size_t i = 1; i < x.landmarks.size(); ++i) {
    if (x.landmarks[i].last_seen < x.landmarks[stalest].last_seen) stalest = i;
  }
  return stalest;
}

std::size_t landmark_room(const Estimate& x, const Observations& seen, const Options& options) {
  const Time recently = from_seconds(std::min(kLandmarkInView, options.frontend.landmark_timeout));
  std::array<bool, kMaxLandmarks> in_view{};
  for (const Match& m : seen.matches.landmarks) in_view[m.target] = true;
  for (std::size_t i = 0; i < x.landmarks.size(); ++i) {
    in_view[i] = in_view[i] || x.nav.time - x.landmarks[i].last_seen < recently;
  }
  return static_cast<std::size_t>(options.update.max_landmarks -
                                  std::count(in_view.begin(), in_view.end(), true));
}

}  // namespace rio
