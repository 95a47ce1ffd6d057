// SPDX-License-Identifier: BSD-3-Clause
// Health of the estimate (health.hpp) from the reports of the scans, radar silence and IMU gaps.
//
// Shares are ratios of sums that decay exponentially with kMemory, as gaps (kImuGaps) do; steps
// (kReopened) decay with kStepMemory. Sigmas are those at the newest scan or of dead reckoning.
#pragma once

#include <array>
#include <cstddef>

#include "rio/core/static_vector.hpp"
#include "rio/health.hpp"
#include "rio/report.hpp"
#include "rio/state/estimate.hpp"
#include "rio/types.hpp"

namespace rio {

/// No allocation; O(1) per call.
class HealthMonitor {
 public:
  explicit HealthMonitor(std::size_t radars = 1) : radars_(radars) {}

  const Health& health() const { return health_; }

  /// The estimate starts at `time`, or starts over. Only the reset counter is kept.
  void reset(Time time);

  /// A scan was processed.
  /// @param P_body covariance of x, order of namespace body
  void observe(const UpdateReport& report, const Estimate& x, const BodyCovariance& P_body);

  /// Measurements of other sensors were processed, without a scan.
  void observe_aiding(const UpdateReport& report);

  /// The IMU has reached `now`; the estimate, which may be older, is x.
  /// @param pause of the IMU so far, according to the stamps of the scans that wait for it
  void wait(Time now, Time pause, const Estimate& x, const BodyCovariance& P_body);

  /// The IMU has paused for `duration`, which ends now.
  void add_gap(Time duration) { new_gaps_ += to_seconds(duration); }

  /// Share of the rows of the last second that the gates rejected, if kGated says it is unusual;
  /// otherwise 0.
  double unusual_gated_share() const {
    const double share = gated_share();
    return share >= kGated ? share : 0.0;
  }

 private:
  /// The estimate has changed discontinuously.
  void add_step() {
    ++health_.reset_counter;
    steps_ += 1.5;
  }
  void fade(Time now);
  double& severity(HealthReason reason) {
    return health_.severity[static_cast<std::size_t>(reason)];
  }
  double calibration_doubt(const UpdateReport& report) const;
  double clock_doubt(const UpdateReport& report, Time now);
  void judge_aiding(const UpdateReport& report);
  void judge_scans(Time now, Time pause);
  double gated_share() const { return rows_gated_ / std::max(rows_used_ + rows_gated_, 10.0); }
  void judge_sigmas(const Estimate& x, const BodyCovariance& P_body);
  void conclude();

  static constexpr double kMemory = 1.0;         // of shares: a person passes, a fault stays [s]
  static constexpr double kStepMemory = 3.0;     // of a step [s]
  static constexpr double kAidingMemory = 10.0;  // of shares: some measure once a second [s]
  static constexpr double kFewAiding = 5.0;      // one rejected row of a slow sensor is no share
  static constexpr double kSilence = 1.0;        // the IMU alone is good to centimetres [s]
  static constexpr double kOneSilence = 2.0;    // the others go on; some send one scan a second [s]
  static constexpr double kFewRows = 3.0;       // a velocity has three components
  static constexpr double kOutliers = 0.7;      // above that a consensus is unreliable
  static constexpr double kGated = 0.3;         // nominally a gate rejects one in a hundred
  static constexpr double kGatedTime = 2.5;     // four times that: the estimate is wrong [s]
  static constexpr double kInnovations = 2.0;   // mean NIS of a row
  static constexpr double kVelocityTime = 0.5;  // contradicted [s]
  static constexpr double kTiltTime = 0.75;     // same: a person may pass by [s]
  // of the last second; after four times that the velocity may be off by the change of 2 m/s that
  // a gap may hide, and the tilt by 30 deg [s]
  static constexpr double kLostTime = 0.3;
  static constexpr double kPosition = 1.0;  // [m]
  static constexpr double kPositionShare = 0.05;
  static constexpr double kVelocity = 0.5;  // [m/s]
  static constexpr double kHeading = 0.17;  // [rad]
  static constexpr double kTilt = 0.05;     // [rad]
  static constexpr double kClockSigmas = 5.0;
  static constexpr Time kClockStep = std::chrono::seconds(1);
  static constexpr std::size_t kClockSteps = 10;

  /// Estimate of a time offset.
  struct Offset {
    Time time{0};
    double value = 0.0;
    double sigma = 0.0;
  };
  /// Time offset of a radar in the last kClockSteps seconds; constant unless its clock was changed.
  using PastOffsets = StaticVector<Offset, kClockSteps>;

  std::size_t radars_;
  Health health_;
  Time now_{0};                          ///< time up to which the sums have decayed
  Time last_used_{0};                    ///< last scan with a row used
  std::array<Time, kMaxRadars> last_{};  ///< scan processed, by radar
  Time not_gated_{0};                    ///< last time without an unusual_gated_share()
  bool begun_ = false;  ///< the radar has determined velocity and tilt since the start
  // decaying sums
  double detections_ = 0.0;
  double static_detections_ = 0.0;
  double rows_used_ = 0.0;
  double rows_gated_ = 0.0;
  double nis_ = 0.0;
  double gaps_ = 0.0;      ///< [s]
  double new_gaps_ = 0.0;  ///< since the last fade() [s]
  double aiding_used_ = 0.0;
  double aiding_gated_ = 0.0;
  double aiding_nis_ = 0.0;
  double steps_ = 0.0;
  double failures_ = 0.0;
  std::array<PastOffsets, kMaxRadars> offsets_{};
  std::array<double, kMaxRadars> calibration_{};  ///< severity of kCalibration, by radar
};

}  // namespace rio
