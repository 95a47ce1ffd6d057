// SPDX-License-Identifier: BSD-3-Clause
// Which scans are taken, and when: the checks of Odometry::add_scan, and the scans that wait for
// samples of the IMU or for scans of other radars.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "rio/checks/stamp_guard.hpp"
#include "rio/models/detection.hpp"
#include "rio/options.hpp"
#include "rio/propagate/imu_buffer.hpp"
#include "rio/rio.hpp"
#include "rio/state/estimate.hpp"
#include "scan_clock.hpp"

namespace rio {

/// The stamps of all scans, taken or not, as a witness of the clock that they share with the IMU.
class StampRun {
 public:
  /// @param step longest distance of two stamps that follow each other
  explicit StampRun(Time step) : step_(step) {}

  /// Stamps for which is_stamp() is false are passed over.
  void add(Time stamp) {
    if (!is_stamp(stamp)) return;
    if (!begun_ || std::chrono::abs(stamp - last_) >= step_) first_ = at_imu_ = stamp;
    last_ = stamp;
    begun_ = true;
  }
  /// The stamps have gone on without a jump from `before` to `after`: between them lies a pause.
  bool goes_through(Time before, Time after) const {
    return begun_ && first_ < before + step_ && before < last_ &&
           std::chrono::abs(after - last_) < step_;
  }

  /// A sample of the IMU has arrived.
  void hear_imu() { at_imu_ = last_; }
  /// How far the stamps have gone on beyond `newest`, that of the IMU, since its last sample.
  Time since_imu(Time newest) const { return last_ - std::max(newest, at_imu_); }

 private:
  Time step_;
  bool begun_ = false;
  Time first_{0};  ///< since the last jump
  Time last_{0};
  Time at_imu_{0};  ///< last_ when the newest sample of the IMU arrived
};

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

/// What each radar has sent so far: which scan is new, and which may be processed because no
/// earlier one of another radar can still arrive.
class ScanHistory {
 public:
  /// @param wait longest time that a scan is held back for an earlier one of another radar [s]
  ScanHistory(std::size_t radars, double wait) : radars_(radars), wait_(from_seconds(wait)) {}

  /// Starts over, but keeps the fingerprints of the last scans.
  /// @param now newest sample of the IMU, if there is one
  void forget(std::optional<Time> now);
  /// Forgets the fingerprints.
  void forget_fingerprints();

  /// The last scan processed of this radar has this stamp.
  bool is_last(Time stamp, std::size_t radar) const { return stamp == of_[radar].last; }
  /// The filtered scan equals the previous one of its radar, which noise excludes for a new scan.
  /// False if all range rates are zero, as at rest with a coarse grid. Stores the fingerprint.
  bool is_repeated(const DetectionList& scan);
  /// The scan follows the one processed last, and the estimate is still at the time of that one.
  bool follows_last(Time stamp, std::size_t radar, Time estimate) const {
    const std::optional<Time>& last = of_[radar].last;
    return last && radar == last_radar_ && stamp > *last && estimate == last_estimate_;
  }
  /// The IMU has reached the scan, and no earlier one of another radar is expected: each other
  /// radar has sent a later one, or one of the same instant, or is silent, or the scan has waited
  /// long enough.
  /// @param now newest sample of the IMU
  bool is_ready(Time measured, std::size_t radar, Time now) const;

  /// Records that a scan was accepted, to be processed or to wait.
  /// @param now newest sample of the IMU, if there is one
  void take(std::size_t radar, Time measured, std::optional<Time> now);
  /// Records that a scan was processed.
  /// @param estimate time of the estimate afterwards
  void process(Time stamp, std::size_t radar, Time estimate);

 private:
  struct OfRadar {
    std::optional<Time> last;       ///< stamp of the last scan processed
    std::optional<Time> newest;     ///< time of measurement of the newest scan accepted
    std::optional<Time> heard;      ///< newest IMU sample at the last accepted scan or at the start
    std::uint64_t fingerprint = 0;  ///< of the last scan accepted or repeated
  };

  static constexpr Time kSilent = std::chrono::milliseconds(500);  // then no longer waited for

  std::size_t radars_;
  Time wait_;
  std::array<OfRadar, kMaxRadars> of_;
  std::size_t last_radar_ = 0;  ///< whose scan was processed last
  Time last_estimate_{0};       ///< the time of the estimate after it
};

/// Stamp of the newest sample, if there is one.
inline std::optional<Time> newest_of(const ImuBuffer& imu) {
  if (imu.empty()) return std::nullopt;
  return imu.newest().time;
}

/// What is refused is counted.
inline Status refuse(std::uint64_t& counter, Status status) {
  ++counter;
  return status;
}

class ScanIntake {
 public:
  /// @param options kept by reference
  explicit ScanIntake(const Options& options);

  /// A scan that has arrived.
  struct Arrival {
    std::size_t radar;
    Time stamp;     ///< without steps of the radar's clock
    Time measured;  ///< by the time offset; `stamp` if that is none
  };

  /// The stamp without the steps of the radar's clock; the scan may show another one.
  Time corrected(Time stamp, std::size_t radar, const ImuBuffer& imu);
  /// The last stamp that was corrected has shown a step.
  bool clock_stepped(std::size_t radar) const { return clocks_[radar].stepped(); }

  /// Filters a scan and decides: kOk, accepted() is to be processed now; kWaiting, it is in the
  /// queue; otherwise it is refused, and counted.
  /// @param estimate its time
  Status accept(const RadarScan& scan, const Arrival& arrival, Time estimate, const ImuBuffer& imu,
                Counters* counters);
  const DetectionList& accepted() const { return accepted_; }

  /// The scans that wait, oldest first.
  const ScanQueue& queue() const { return queue_; }
  void pop() { queue_.pop_front(); }
  /// The scan may be processed: the IMU has reached it, and no earlier one can still arrive.
  bool is_ready(Time measured, std::size_t radar, const ImuBuffer& imu) const {
    return !imu.empty() && history_.is_ready(measured, radar, imu.newest().time);
  }
  /// A scan was processed.
  /// @param estimate its time afterwards
  void processed(const DetectionList& scan, Time estimate) {
    history_.process(scan.time, scan.radar, estimate);
  }

  /// Too far ahead of the IMU to wait for it.
  bool is_ahead(Time stamp, Time estimate, const ImuBuffer& imu) const;
  /// The stamps of the scans, taken or not, have gone on without a jump from `before` to `after`.
  bool goes_through(Time before, Time after) const { return stamps_.goes_through(before, after); }
  /// A sample of the IMU has arrived.
  void hear_imu() { stamps_.hear_imu(); }
  /// Pause of the IMU so far, according to the stamps of the scans, taken or not.
  Time pause(const ImuBuffer& imu) const {
    return imu.empty() ? Time{0} : stamps_.since_imu(imu.newest().time);
  }

  /// Starts over: the scans that wait are dropped.
  void forget(const ImuBuffer& imu);
  /// Two equal scans in a row are new ones.
  void forget_fingerprints() { history_.forget_fingerprints(); }
  /// Any stamps may follow.
  void reset_clocks();
  /// The stamps of the IMU have jumped, those of the radars perhaps, too.
  void imu_jumped(Time by);

 private:
  /// Measured before the estimate. A scan that follows the last one is not late, even if a change
  /// of the estimated time offset puts it before the estimate.
  bool is_late(const Arrival& arrival, Time estimate) const;

  const Options& options_;
  std::array<ScanClock, kMaxRadars> clocks_;
  StampRun stamps_;
  ScanHistory history_;
  ScanQueue queue_;
  DetectionList accepted_;
};

}  // namespace rio
