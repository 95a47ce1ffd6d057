// SPDX-License-Identifier: BSD-3-Clause
// Faults of recordings, injected into good ones, and the expected findings of `rio check`.
#pragma once

#include <functional>
#include <vector>

#include "check/finding.hpp"
#include "rio/io/dataset.hpp"
#include "rio/types.hpp"

namespace rio::check {

/// A fault, and the expected finding.
struct Fault {
  const char* name;
  const char* meaning;
  std::function<void(io::Dataset*)> make;
  const char* subject;
  const char* text;       ///< part of the sentence
  const char* change;     ///< part of the proposed change
  const char* also = "";  ///< another subject that may report it
};

/// All faults; the expected findings are those for a bag.
const std::vector<Fault>& faults();

/// Changes all detections of the first radar.
template <typename Change>
void each_detection(io::Dataset* dataset, Change&& change) {
  for (RadarScan& scan : dataset->scans) {
    for (RadarDetection& detection : scan.detections) change(&detection);
  }
}
/// Its stamps become later [s].
inline void delay_scans(io::Dataset* dataset, double seconds) {
  for (RadarScan& scan : dataset->scans) scan.time += from_seconds(seconds);
}

/// @param phi rotation vector in axes of the body, or of the radar [rad]
void turn_mounting(io::Dataset* dataset, const Vector3d& phi, bool in_body);

/// The finding that names the fault correctly and is not ok; else null.
const Finding* naming(const Findings& findings, const Fault& fault);

}  // namespace rio::check
