// SPDX-License-Identifier: BSD-3-Clause
#include "scan_intake.hpp"

#include "rio/checks/stamp_guard.hpp"

namespace rio {

ScanIntake::ScanIntake(const Options& options)
    : options_(options),
      stamps_(from_seconds(options.timing.max_ahead)),
      history_(options.radars(), options.timing.scan_wait),
      queue_(static_cast<std::size_t>(options.timing.scan_queue) * options.radars(),
             options.frontend.max_detections),
      accepted_(options.frontend.max_detections) {}

Time ScanIntake::corrected(Time stamp, std::size_t radar, const ImuBuffer& imu) {
  const Time out = clocks_[radar].corrected(stamp, newest_of(imu));
  stamps_.add(out);
  return out;
}

Status ScanIntake::accept(const RadarScan& scan, const Arrival& arrival, Time estimate,
                          const ImuBuffer& imu, Counters* counters) {
  const auto [radar, stamp, measured] = arrival;
  if (history_.is_last(stamp, radar) || queue_.contains(stamp, radar)) {
    ++counters->scans_duplicate;
    return Status::kDuplicate;
  }
  if (is_late(arrival, estimate)) {
    ++counters->scans_late;
    return Status::kLate;
  }
  if (is_ahead(stamp, estimate, imu)) {
    ++counters->scans_ahead;
    return Status::kAhead;
  }
  filter_detections(scan, options_.radar_of(radar), options_.frontend.max_detections, accepted_);
  accepted_.time = stamp;
  accepted_.radar = radar;
  counters->detections_non_finite += static_cast<std::uint64_t>(accepted_.non_finite);
  if (accepted_.received > 0 && accepted_.non_finite == accepted_.received) {
    ++counters->scans_non_finite;
    return Status::kNonFinite;
  }
  const bool next = queue_.empty() || options_.radars() == 1;
  const bool waits = !next || !is_ready(measured, radar, imu);
  if (waits && queue_.full()) {
    ++counters->scans_overflow;
    return Status::kQueueFull;
  }
  if (history_.is_repeated(accepted_)) {
    ++counters->scans_duplicate;
    return Status::kDuplicate;
  }
  history_.take(radar, measured, newest_of(imu));
  if (!waits) return Status::kOk;
  queue_.insert(accepted_, measured);
  return Status::kWaiting;
}

bool ScanIntake::is_late(const Arrival& arrival, Time estimate) const {
  if (!is_stamp(arrival.stamp)) return arrival.stamp < Time{0};
  if (history_.follows_last(arrival.stamp, arrival.radar, estimate)) return false;
  return arrival.measured < estimate;
}

bool ScanIntake::is_ahead(Time stamp, Time estimate, const ImuBuffer& imu) const {
  const Time newest = imu.empty() ? estimate : imu.newest().time;
  return !is_stamp(stamp) || stamp - newest > from_seconds(options_.timing.max_ahead);
}

void ScanIntake::forget(const ImuBuffer& imu) {
  queue_.clear();
  history_.forget(newest_of(imu));
}

void ScanIntake::reset_clocks() {
  for (ScanClock& clock : clocks_) clock.reset();
}

}  // namespace rio
