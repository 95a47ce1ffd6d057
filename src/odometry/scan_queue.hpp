// SPDX-License-Identifier: BSD-3-Clause
// The queue of scans that have arrived and wait for the IMU.
#pragma once

#include <vector>

#include "rio/models/detection.hpp"

namespace rio {

/// Filtered scans that wait for the IMU or for other radars, oldest first. O(size) insertion.
class ScanQueue {
 public:
  /// @param detections capacity of each scan
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
  /// @param measured time of measurement, the order of the queue
  void insert(const DetectionList& scan, Time measured);
  void pop_front();

 private:
  std::vector<DetectionList> scans_;  ///< those beyond size_ keep their storage
  std::vector<Time> due_;             ///< time of measurement, by scan
  std::size_t size_ = 0;
};

}  // namespace rio
