// SPDX-License-Identifier: BSD-3-Clause
// A flight with a fault, judged against the truth during the fault and half a minute later.
//
// Wrong: not finite; the covariance not symmetric positive semi-definite; tilt off by more than 3
// deg; velocity off by more than 0.5 m/s (body axes, since the heading is unobservable); position
// off by more than 0.5 m and 5 sigma; or the estimate older than a second. A sigma is that of the
// covariance in the direction of the error.
#pragma once

#include <cstdint>
#include <string>

#include "experiment/fault.hpp"
#include "rio/rio.hpp"

namespace rio::experiment {

inline constexpr double kFaultBegins = 20.0;  // after the first sample [s]
inline constexpr double kJudgedAfter = 30.0;  // after the end, or the beginning of a permanent one

/// Estimate against truth at one time.
struct Deviation {
  double tilt = 0.0;      ///< [deg]
  double speed = 0.0;     ///< of the velocity's error, body axes [m/s]
  double position = 0.0;  ///< [m]
  double tilt_sigmas = 0.0;
  double velocity_sigmas = 0.0;
  double position_sigmas = 0.0;
  double age = 0.0;  ///< of the estimate [s]
  bool finite = true;
  bool covariance = true;  ///< symmetric positive semi-definite

  bool wrong() const { return !why().empty(); }
  /// The wrong quantities: "tilt, position"; empty if there are none.
  std::string why() const;
  /// Beyond the limits and beyond 5 sigma, or no estimate at all.
  bool dishonest() const;
  bool outside_3_sigma() const;
};

/// Result of a flight with a fault. Times in seconds.
struct Survival {
  Deviation last;                 ///< at the end
  bool kept = false;              ///< Fault::promised
  bool reported_last = false;     ///< at the end
  bool reported_before = false;   ///< degraded or worse at any time before the fault
  bool always_finite = true;      ///< from the fault on
  bool always_covariance = true;  ///< same
  double wrong_until = 0.0;  ///< last time it was wrong, relative to the fault's end; or below 0
  double longest_unreported = 0.0;  ///< longest interval wrong and not reported
  double outside_unreported = 0.0;  ///< sum of times outside of 3 sigma and not reported
  std::uint32_t states = 0;         ///< bit i: health was in state i, from the fault on
  Counters counters;                ///< at the end
};

/// The flight with the fault, from `begin` on, through a new estimator; judged at begin + duration
/// + `after`, or where the flight ends. `options` need not include the fault.
/// @throws std::runtime_error if the options are invalid
Survival survive(const sim::Flight& flight, const Options& options, const Fault& fault,
                 double begin = kFaultBegins, double after = kJudgedAfter);

}  // namespace rio::experiment
