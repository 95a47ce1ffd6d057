// SPDX-License-Identifier: BSD-3-Clause
// Reports of the scans, silence, gaps -> how far the estimate can be trusted (health.hpp).
//
// Shares are of what has come in lately: sums that fade with kMemory. A step (kReopened) and a lost
// second (kImuGaps) fade likewise. The sigmas are those at the newest scan, or of the dead
// reckoning.
#pragma once

#include <array>
#include <cstddef>

#include "rio/health.hpp"
#include "rio/options.hpp"
#include "rio/report.hpp"
#include "rio/state/estimate.hpp"
#include "rio/types.hpp"

namespace rio {

/// No allocation; a constant number of operations a call.
class HealthMonitor {
 public:
  const Health& health() const { return health_; }

  /// The estimate starts at `time`, or starts over. Only the reset counter goes on.
  void reset(Time time);

  /// A scan was processed.
  /// @param P_body of x, order of namespace body
  void observe(const UpdateReport& report, const Estimate& x, const BodyCovariance& P_body);

  /// The IMU has reached `now`; the estimate, which may be older, is x.
  /// @param pause for which the IMU has told nothing, according to the scans that wait for it
  void wait(Time now, Time pause, const Estimate& x, const BodyCovariance& P_body);

  /// The IMU has told nothing for so long.
  void add_gap(Time duration) { gaps_ += to_seconds(duration); }

  /// The estimate has made a step.
  void add_step();

 private:
  void fade(Time now);
  double& severity(HealthReason reason) {
    return health_.severity[static_cast<std::size_t>(reason)];
  }
  double calibration_doubt(const UpdateReport& report) const;
  double clock_doubt(const UpdateReport& report, Time now);
  void judge_scans(Time now, Time pause);
  void judge_sigmas(const Estimate& x, const BodyCovariance& P_body);
  void conclude();

  static constexpr double kMemory = 1.0;        // of shares: a person passes by, a fault stays [s]
  static constexpr double kStepMemory = 3.0;    // of a step [s]
  static constexpr double kSilence = 1.0;       // the IMU alone stays within centimetres [s]
  static constexpr double kFewRows = 3.0;       // a velocity has three components
  static constexpr double kOutliers = 0.7;      // beyond that no majority is safe
  static constexpr double kGated = 0.3;         // a gate refuses one in a hundred
  static constexpr double kInnovations = 2.0;   // mean NIS of a row
  static constexpr double kVelocityTime = 0.5;  // contradicted [s]
  static constexpr double kTiltTime = 0.75;     // same, a person passes by
  static constexpr double kLostTime = 0.3;      // of the last second [s]
  static constexpr double kPosition = 1.0;      // [m]
  static constexpr double kPositionShare = 0.05;
  static constexpr double kVelocity = 0.5;  // [m/s]
  static constexpr double kHeading = 0.17;  // [rad]
  static constexpr double kTilt = 0.05;     // [rad]
  static constexpr double kFastest = 30.0;  // [m/s]
  static constexpr double kClockSigmas = 5.0;
  static constexpr Time kClockStep = std::chrono::seconds(1);
  static constexpr std::size_t kClockSteps = 10;

  /// The time offset of a radar in the last seconds; it is a constant, unless the clock is changed.
  struct PastOffsets {
    struct Offset {
      Time time{0};
      double value = 0.0;
      double sigma = 0.0;
    };
    std::array<Offset, kClockSteps> ring;
    std::size_t count = 0;  ///< taken so far

    const Offset& newest() const { return ring[(count + kClockSteps - 1) % kClockSteps]; }
    const Offset& oldest() const { return ring[count < kClockSteps ? 0 : count % kClockSteps]; }
  };

  Health health_;
  Time now_{0};         ///< to which everything has faded
  Time told_{0};        ///< the radar last told anything
  bool begun_ = false;  ///< it has told a velocity since the start
  // faded sums
  double detections_ = 0.0;
  double static_detections_ = 0.0;
  double rows_used_ = 0.0;
  double rows_gated_ = 0.0;
  double nis_ = 0.0;
  double gaps_ = 0.0;  ///< [s]
  double steps_ = 0.0;
  double failures_ = 0.0;
  std::array<PastOffsets, kMaxRadars> offsets_{};
  std::array<double, kMaxRadars> calibration_{};  ///< severity of kCalibration, by radar
};

}  // namespace rio
