// SPDX-License-Identifier: BSD-3-Clause
// Scans between their arrival and the moment the IMU reaches them.
#pragma once

#include <vector>

#include "rio/models/detection.hpp"

namespace rio {

/// Filtered scans that wait for the IMU or for other radars, oldest first. Few, so insertion
/// shifts.
class ScanQueue {
 public:
  /// @param detections room for so many in each scan
  ScanQueue(std::size_t capacity, int detections) : due_(capacity) {
    scans_.reserve(capacity);
    for (std::size_t i = 0; i < capacity; ++i) scans_.emplace_back(detections);
  }

  bool empty() const { return size_ == 0; }
  bool full() const { return size_ == scans_.size(); }
  std::size_t size() const { return size_; }
  void clear() { size_ = 0; }
  const DetectionList& front() const { return scans_[0]; }
  bool contains(Time time, std::size_t radar) const;
  /// @param measured by which they are ordered
  void insert(const DetectionList& scan, Time measured);
  void pop_front();

 private:
  std::vector<DetectionList> scans_;  ///< the room of those beyond size_ is kept
  std::vector<Time> due_;
  std::size_t size_ = 0;
};

}  // namespace rio
