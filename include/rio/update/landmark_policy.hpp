// SPDX-License-Identifier: BSD-3-Clause
// Stage 6: which landmarks are removed and which detections become landmarks, for every back-end.
//
// A landmark is kept while its matches pass the gate, and some seconds longer. Its value is the
// link to the pose it was first seen from; a new one is linked to the current pose only. So when
// there are too many, landmarks in view are kept and the one unseen for longest, the least likely
// to be seen again, is replaced.
#pragma once

#include "rio/frontend/frontend.hpp"
#include "rio/options.hpp"
#include "rio/report.hpp"
#include "rio/state/estimate.hpp"
#include "rio/update/scan_rows.hpp"

namespace rio {

/// Index of the landmark unseen for longest.
std::size_t stalest_landmark(const Estimate& x);

/// Number of new landmarks that can be taken: those not in view may be replaced.
std::size_t landmark_room(const Estimate& x, const Observations& seen, const Options& options);

/// @param x last_seen, distance_seen and looks of its landmarks are updated
/// @param remove remove(index): the last landmark takes the place of that one
/// @param needed needed(index): a landmark that has been missed for too long retires instead of
///        leaving
/// @param add add(detection): appends a landmark
template <class Remove, class Needed, class Add>
void maintain_landmarks(const Observations& seen, const ScanRows& rows,
                        const Promotions& promotions, const Options& options, Estimate* x,
                        UpdateReport* report, const Remove& remove, const Needed& needed,
                        const Add& add) {
  const Time now = x->nav.time;
  for (const Match& m : seen.matches.landmarks) {
    if (!rows.was_used(m.target)) continue;
    x->landmarks[m.target].last_seen = now;
    x->landmarks[m.target].distance_seen = x->distance_travelled;
    x->landmarks[m.target].looks = rows.looks(m.target);
  }
  const auto leave = [&](std::size_t i) {
    remove(i);
    ++report->landmarks_removed;
  };
  const Time timeout = from_seconds(options.frontend.landmark_timeout);
  for (std::size_t i = x->landmarks.size(); i-- > 0;) {
    if (now - x->landmarks[i].last_seen <= timeout) continue;
    x->landmarks[i].retired = needed(i);
    if (!x->landmarks[i].retired) leave(i);
  }
  for (const Detection& d : promotions.births) {
    if (static_cast<int>(x->landmarks.size()) == options.update.max_landmarks) {
      leave(stalest_landmark(*x));
    }
    add(d);
    ++report->landmarks_added;
  }
}

}  // namespace rio
