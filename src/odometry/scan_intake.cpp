// SPDX-License-Identifier: BSD-3-Clause
#include "scan_intake.hpp"

#include <algorithm>
#include <utility>

namespace rio {

void ScanHistory::forget(std::optional<Time> now) {
  for (OfRadar& own : of_) {
    own.last.reset();
    own.newest.reset();
    own.heard = now;
  }
}

void ScanHistory::forget_fingerprints() {
  for (OfRadar& own : of_) own.fingerprint = 0;
}

bool ScanHistory::is_repeated(const DetectionList& scan) {
  OfRadar& own = of_[scan.radar];
  const std::uint64_t before = std::exchange(own.fingerprint, fingerprint(scan));
  return own.fingerprint != 0 && own.fingerprint == before;
}

bool ScanHistory::is_ready(Time measured, std::size_t radar, Time now) const {
  constexpr Time kTogether = std::chrono::milliseconds(2);  // errors of the time offsets
  if (measured > now) return false;
  if (now - measured >= wait_) return true;
  for (std::size_t r = 0; r < radars_; ++r) {
    const OfRadar& other = of_[r];
    const bool heard = other.heard && now - *other.heard < kSilent;
    if (r != radar && heard && !(other.newest >= measured - kTogether)) return false;
  }
  return true;
}

void ScanHistory::take(std::size_t radar, Time measured, std::optional<Time> now) {
  OfRadar& own = of_[radar];
  own.newest = std::max(own.newest.value_or(measured), measured);
  if (now) own.heard = now;
}

void ScanHistory::process(Time stamp, std::size_t radar, Time estimate) {
  of_[radar].last = stamp;
  last_radar_ = radar;
  last_estimate_ = estimate;
}

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
    return refuse(counters->scans_duplicate, Status::kDuplicate);
  }
  if (is_late(arrival, estimate)) return refuse(counters->scans_late, Status::kLate);
  if (is_ahead(stamp, estimate, imu)) return refuse(counters->scans_ahead, Status::kAhead);
  filter_detections(scan, options_.radar_of(radar), options_.frontend.max_detections, accepted_);
  accepted_.time = stamp;
  accepted_.radar = radar;
  counters->detections_non_finite += static_cast<std::uint64_t>(accepted_.non_finite);
  if (accepted_.received > 0 && accepted_.non_finite == accepted_.received) {
    return refuse(counters->scans_non_finite, Status::kNonFinite);
  }
  const bool next = queue_.empty() || options_.radars() == 1;
  const bool waits = !next || !is_ready(measured, radar, imu);
  if (waits && queue_.full()) return refuse(counters->scans_overflow, Status::kQueueFull);
  if (history_.is_repeated(accepted_)) return refuse(counters->scans_duplicate, Status::kDuplicate);
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

void ScanIntake::imu_jumped(Time by) {
  for (ScanClock& clock : clocks_) clock.imu_jumped(by);
}

}  // namespace rio
