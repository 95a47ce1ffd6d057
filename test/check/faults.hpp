// SPDX-License-Identifier: BSD-3-Clause
// Faults of recordings, injected into good ones, and the expected findings of `rio check`.
#pragma once

#include <functional>
#include <numbers>
#include <vector>

#include "check/finding.hpp"
#include "rio/io/dataset.hpp"
#include "rio/types.hpp"

namespace rio::check {

using MakeFault = std::function<void(io::Dataset*)>;

/// A fault, and the expected finding.
struct Fault {
  const char* name;
  const char* meaning;
  MakeFault make;
  const char* subject;
  const char* text;       ///< part of the sentence
  const char* change;     ///< part of the proposed change
  const char* also = "";  ///< another subject that may report it
};

/// All faults; the expected findings are those for a bag.
const std::vector<Fault>& faults();

inline constexpr double kHalfTurn = std::numbers::pi;

/// Changes all detections of the first radar.
template <typename Change>
void each_detection(io::Dataset* dataset, const Change& change) {
  for (RadarScan& scan : dataset->scans) {
    for (RadarDetection& detection : scan.detections) change(detection);
  }
}
/// Changes all samples of the IMU.
template <typename Change>
void each_sample(io::Dataset* dataset, const Change& change) {
  for (ImuSample& sample : dataset->imu) change(sample);
}
/// The same as faults.
inline MakeFault of_detections(const std::function<void(RadarDetection&)>& change) {
  return [=](io::Dataset* dataset) { each_detection(dataset, change); };
}
inline MakeFault of_samples(const std::function<void(ImuSample&)>& change) {
  return [=](io::Dataset* dataset) { each_sample(dataset, change); };
}
/// Rates and forces in other axes.
inline MakeFault in_axes(const std::function<Vector3d(const Vector3d&)>& axes) {
  return of_samples([=](ImuSample& s) { s = {s.time, axes(s.gyro_B), axes(s.accel_B)}; });
}
/// The stamps of the first radar become later [s].
inline void delay_scans(io::Dataset* dataset, double seconds) {
  for (RadarScan& scan : dataset->scans) scan.time += from_seconds(seconds);
}

/// @param phi rotation vector in axes of the body, or of the radar [rad]
void turn_mounting(io::Dataset* dataset, const Vector3d& phi, bool in_body);

/// The finding that names the fault correctly and is not ok; else null.
const Finding* naming(const Findings& findings, const Fault& fault);

}  // namespace rio::check
