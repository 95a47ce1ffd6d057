// SPDX-License-Identifier: BSD-3-Clause
// A recording through the research API, for a back-end that observes the real one. Equals Odometry
// for a radar without latency and an estimator with static alignment.
#pragma once

#include <optional>
#include <vector>

#include "rio/checks/imu_guard.hpp"
#include "rio/models/detection.hpp"
#include "rio/pipeline.hpp"
#include "rio/propagate/static_alignment.hpp"

namespace rio::experiment {

template <class BackEnd>
class PipelineDrive {
 public:
  /// `options` must be valid.
  explicit PipelineDrive(const Options& options)
      : options_(options),
        pipeline_(options),
        imu_(options.timing, options.imu),
        guard_(options.imu),
        aligner_(options.start, options.imu) {}

  BackEnd& backend() { return pipeline_.backend(); }
  const Pipeline<BackEnd>& pipeline() const { return pipeline_; }

  /// @param due due(i, now): scan i has arrived
  /// @param before before(i, filtered): called before a scan is processed
  /// @param after after(i, status): called after that
  template <class Due, class Before, class After>
  void run(const std::vector<ImuSample>& imu, const std::vector<RadarScan>& scans, const Due& due,
           const Before& before, const After& after) {
    std::size_t next = 0;
    for (const ImuSample& sample : imu) {
      if (!take(sample)) continue;
      for (; next < scans.size() && due(next, sample.time) &&
             pipeline_.measured_at(scans[next].time) <= sample.time;
           ++next) {
        if (!alignment_) continue;
        filter_detections(scans[next], options_.radar, options_.frontend.max_detections, filtered_);
        before(next, filtered_);
        const Status status = pipeline_.process(filtered_, imu_);
        imu_.forget_before(pipeline_.estimate().nav.time);
        after(next, status);
      }
      if (!alignment_) align(sample);
    }
  }

 private:
  /// False for a sample that is late or faulty.
  bool take(const ImuSample& sample) {
    if (!sample.gyro_B.allFinite() || !sample.accel_B.allFinite()) return false;
    if (!imu_.empty() && sample.time <= imu_.newest().time) return false;
    if (guard_.check(sample) != ImuFault::kNone) return false;
    if (alignment_ && imu_.full()) {  // the radar is silent
      (void)pipeline_.propagate(imu_[1].time, imu_);
      imu_.forget_before(pipeline_.estimate().nav.time);
    }
    imu_.push_back(sample);
    return true;
  }

  void align(const ImuSample& sample) {
    (void)aligner_.add(sample, &alignment_);
    if (!alignment_) return;
    pipeline_.reset(*alignment_);
    imu_.forget_before(alignment_->state.time);
  }

  Options options_;
  Pipeline<BackEnd> pipeline_;
  ImuBuffer imu_;
  ImuGuard guard_;
  StaticAligner aligner_;
  std::optional<Alignment> alignment_;
  DetectionList filtered_;
};

}  // namespace rio::experiment
