// SPDX-License-Identifier: BSD-3-Clause
// The queue of scans that have arrived and wait for the IMU.
#pragma once

#include <algorithm>
#include <vector>

#include "rio/models/detection.hpp"

namespace rio {

/// Filtered scans that wait for the IMU or for other radars, oldest first. O(size) insertion.
class ScanQueue {
 public:
  /// @param detections capacity of each scan
  ScanQueue(std::size_t capacity, int detections) {
    for (std::size_t i = 0; i < capacity; ++i)
      scans_.push_back({DetectionList(detections), Time{0}});
  }

  bool empty() const { return size_ == 0; }
  bool full() const { return size_ == scans_.size(); }
  std::size_t size() const { return size_; }
  void clear() { size_ = 0; }
  const DetectionList& front() const { return scans_[0].scan; }
  bool contains(Time time, std::size_t radar) const {
    return std::any_of(scans_.begin(), end(), [&](const Waiting& other) {
      return other.scan.time == time && other.scan.radar == radar;
    });
  }
  /// @param measured time of measurement, the order of the queue
  void insert(const DetectionList& scan, Time measured) {
    Waiting& last = scans_[size_];
    last.scan = scan;
    last.measured = measured;
    const auto before = [](const Waiting& a, const Waiting& b) {  // equal times: by radar
      return a.measured < b.measured || (a.measured == b.measured && a.scan.radar < b.scan.radar);
    };
    std::rotate(std::upper_bound(scans_.begin(), end(), last, before), end(), end() + 1);
    ++size_;
  }
  void pop_front() {
    std::rotate(scans_.begin(), scans_.begin() + 1, end());
    --size_;
  }

 private:
  struct Waiting {
    DetectionList scan;
    Time measured{0};
  };

  std::vector<Waiting>::iterator end() {
    return scans_.begin() + static_cast<std::ptrdiff_t>(size_);
  }
  std::vector<Waiting>::const_iterator end() const {
    return scans_.begin() + static_cast<std::ptrdiff_t>(size_);
  }

  std::vector<Waiting> scans_;  ///< those beyond size_ keep their storage
  std::size_t size_ = 0;
};

}  // namespace rio
