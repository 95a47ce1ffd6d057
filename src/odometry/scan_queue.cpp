// SPDX-License-Identifier: BSD-3-Clause
#include "scan_queue.hpp"

#include <utility>

namespace rio {

bool ScanQueue::contains(Time time, std::size_t radar) const {
  for (std::size_t i = 0; i < size_; ++i) {
    if (scans_[i].time == time && scans_[i].radar == radar) return true;
  }
  return false;
}

void ScanQueue::insert(const DetectionList& scan, Time measured) {
  std::size_t i = size_++;
  const auto follows = [&](std::size_t k) {  // equal times are ordered by radar
    return due_[k] > measured || (due_[k] == measured && scans_[k].radar > scan.radar);
  };
  for (; i > 0 && follows(i - 1); --i) {
    std::swap(scans_[i], scans_[i - 1]);
    due_[i] = due_[i - 1];
  }
  scans_[i] = scan;
  due_[i] = measured;
}

void ScanQueue::pop_front() {
  for (std::size_t i = 1; i < size_; ++i) {
    std::swap(scans_[i - 1], scans_[i]);
    due_[i - 1] = due_[i];
  }
  --size_;
}

}  // namespace rio
