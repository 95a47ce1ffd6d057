// SPDX-License-Identifier: BSD-3-Clause
// Stages 2 and 6: trails (feature tracks): the detections of one point in consecutive scans.
//
// A trail begins with an unmatched static detection, is extended by each match and ends at its
// first miss. It keeps at most N elements, one per scan of its radar and without gaps, so every
// element has its clone. Reference: Michalczyk et al. 2023, II-B and Fig. 2.
#pragma once

#include <cstddef>
#include <vector>

#include "rio/models/detection.hpp"
#include "rio/state/estimate.hpp"

namespace rio {

/// One past detection of a trail.
struct TrailElement {
  ScanId scan = 0;  ///< the clone of this scan is the pose it was seen from
  Detection detection;
};

/// Detections of one point in consecutive scans, newest last.
struct Trail {
  StaticVector<TrailElement, kMaxClones> elements;
  int matches = 0;  ///< consecutive matches since its first element
  /// Sum over the matches of the Doppler residual in sigmas: for a static point a random walk, for
  /// a mover it grows from scan to scan.
  double doppler_sum = 0.0;

  const TrailElement& newest() const { return elements.back(); }

  void append(const TrailElement& element, std::size_t max_length) {
    if (elements.size() == max_length) elements.erase(0);
    elements.push_back(element);
  }
};

/// All current trails; storage for one per detection, allocated once.
class TrailSet {
 public:
  TrailSet(int max_trails, int max_length)
      : trails_(static_cast<std::size_t>(max_trails)),
        max_length_(static_cast<std::size_t>(max_length)) {}

  std::size_t size() const { return size_; }
  const Trail& operator[](std::size_t i) const { return trails_[i]; }
  void clear() { size_ = 0; }

  /// @param doppler_residual of the new element, in sigmas
  void extend(std::size_t i, const TrailElement& element, double doppler_residual = 0.0) {
    trails_[i].append(element, max_length_);
    trails_[i].doppler_sum += doppler_residual;
    ++trails_[i].matches;
  }
  /// Begins a trail; ignored when the storage is full.
  void create(const TrailElement& element) {
    if (size_ == trails_.size()) return;
    Trail& trail = trails_[size_++];
    trail.elements.clear();
    trail.matches = 0;
    trail.doppler_sum = 0.0;
    trail.append(element, max_length_);
  }
  /// Keeps the trails for which keep(i) holds, in order.
  template <class Keep>
  void retain(const Keep& keep) {
    std::size_t n = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      if (!keep(i)) continue;
      if (n != i) std::swap(trails_[n], trails_[i]);
      ++n;
    }
    size_ = n;
  }

 private:
  std::vector<Trail> trails_;
  std::size_t max_length_;
  std::size_t size_ = 0;
};

}  // namespace rio
