// SPDX-License-Identifier: BSD-3-Clause
// The odometry API, for flight stacks: radar-inertial odometry behind two calls a loop. C++17.
//
//   auto odometry = rio::Odometry::create(options, &why);
//   odometry->add_imu(sample);    // each IMU sample
//   odometry->add_scan(scan);     // each radar scan
//
// and, where there are more: add_scan(scan, 1) of a second radar (Options::other_radars),
// add_measurement() of other sensors (rio/aiding.hpp).
//
// The estimate lives at the time of the newest processed scan; a predictor carries it through the
// buffered IMU samples to now(). There is no lock, no thread, no clock, no logging and, after
// create(), no allocation inside. The same binary fed in the same order gives the same bytes.
//
// One thread feeds both calls and reads. Where the IMU and the radar have a thread each, either
// put their data into one queue that a third thread empties into the calls, or hold one mutex
// around every call, the accessors too: these return references to what the next call changes, so
// copy now() and covariance() under the mutex and use the copies. A scan may then come before or
// after the samples of its time; the estimates at the scans are the same. An update holds the mutex
// for a millisecond or so, during which the IMU waits: with a queue it does not. Two estimators
// share nothing; each may have a thread of its own without a lock.
//
// What goes in is checked in constant time. What is refused has its Status and its counter, and
// changes nothing else:
//   numbers     NaN and infinity (kNonFinite). An IMU sample that is frozen, or beyond what the
//               sensor reads (ImuOptions::max_rate, max_accel), is kImplausible and bridged as if
//               it were lost. A detection that is not finite or beyond what a radar says is left
//               out of its scan.
//   IMU stamps  rise strictly (else kStale), by half a second at most (else kAhead). A single odd
//               one is dropped. Five in a row that rise one after the other have jumped for good:
//               forwards by up to TimingOptions::max_pause it was a pause, bridged as a gap (if the
//               tilt is lost in it, the estimate starts over a second and a half later from the
//               specific force, Counters::restarts; position and heading are carried over); else,
//               once they span a tenth of a second, the clock of the sensors has started again
//               (Counters::clock_restarts), and the estimate is carried over: it keeps its values,
//               with the uncertainty of a pause of some 0.3 s, in the time of the new clock. The
//               calibration and the landmarks start again. Who knows of a longer pause resets.
//   scan stamps are in the clock of the IMU: older than the estimate is kLate, farther ahead of the
//               newest IMU sample than TimingOptions::max_ahead kAhead. In between they wait.
//   all stamps  within 146 years of their epoch; beyond that they are old, or ahead.
#pragma once

#include <memory>
#include <string>

#include "rio/export.hpp"
#include "rio/health.hpp"
#include "rio/options.hpp"
#include "rio/report.hpp"
#include "rio/types.hpp"
#include "rio/version.hpp"

namespace rio {

class AidingMeasurement;

class RIO_API Odometry {
 public:
  /// Validates the options and allocates everything. Bad options: null, and the reason in `why`.
  [[nodiscard]] static std::unique_ptr<Odometry> create(const Options& options,
                                                        std::string* why = nullptr);
  ~Odometry();
  Odometry(const Odometry&) = delete;
  Odometry& operator=(const Odometry&) = delete;

  /// Takes one IMU sample; refused: kStale, kAhead, kNonFinite, kImplausible. O(1), except that a
  /// scan waiting for this sample is processed here, which shows in report().time and
  /// counters().scans. During static alignment kMoving says that a window was refused and a later
  /// one is tried, until StartOptions::max_wait, if given, starts it in motion.
  [[nodiscard]] Status add_imu(const ImuSample& sample) noexcept;

  /// Takes one radar scan. Processed at once when the IMU has reached its stamp (kOk), else queued
  /// (kWaiting). kDuplicate, kLate, kAhead, kQueueFull, kNonFinite, kNotInitialized: dropped and
  /// counted. Of several radars (Options::other_radars) each scan waits until the others have sent
  /// a later one, TimingOptions::scan_wait at most, so that the order of arrival does not matter;
  /// kUndeclared: the options know no such radar.
  [[nodiscard]] Status add_scan(const RadarScan& scan, std::size_t radar = 0) noexcept;

  /// Takes a measurement of another sensor (rio/aiding.hpp), stamped in the clock of the IMU:
  /// kWaiting, it counts with the first scan not before its time, or alone where no scan comes for
  /// TimingOptions::max_lag. kLate: before the estimate by more than aiding_delay; kAhead as for
  /// scans; kQueueFull; kUndeclared: it depends on an auxiliary state that the options do not
  /// declare; kNotInitialized. What the gate says of it is in report().records.
  [[nodiscard]] Status add_measurement(const AidingMeasurement& measurement) noexcept;

  /// Starts, or starts over, from a known state. `prior.time` may lie before, at or after the
  /// newest IMU sample, within what is buffered: kLate if more than TimingOptions::max_lag before
  /// the samples since the last scan, kAhead if more than max_ahead after the newest. Without any
  /// sample yet it may be anything: farther than max_pause from the first sample it is taken to
  /// hold there. kNonFinite if a value is not finite, kImplausible if a position is beyond 1e7 m,
  /// another value beyond 1e4 or a sigma beyond 1e6 (SI units), kNumerical if P0 is not symmetric
  /// positive semi-definite or the norm of the quaternion is not near one (0.5 to 2; it is
  /// normalised); nothing changes then.
  /// @param P0 covariance of the body error state, order of namespace body, SI units
  [[nodiscard]] Status reset(const NavState& prior, const BodyCovariance& P0) noexcept;
  /// Forgets everything and returns to the start mode of the options (static alignment).
  void reset() noexcept;

  bool initialized() const noexcept;
  /// Estimate at the newest IMU sample: at_scan() carried on by the strapdown equations.
  const NavState& now() const noexcept;
  /// Estimate at the newest processed scan, at its stamp minus the time offset as estimated. Before
  /// the first it is the start; while the radar is silent it follows the IMU at
  /// TimingOptions::max_lag.
  const NavState& at_scan() const noexcept;
  /// Covariance of at_scan(), order of namespace body.
  const BodyCovariance& covariance() const noexcept;
  /// Covariance of now(), same order. Computed when asked for, from where it was asked for last: a
  /// few microseconds a sample in between. Valid until the next call of any function.
  const BodyCovariance& covariance_now() const noexcept;
  /// How far the estimate can be trusted, and why not: judged at every scan, and at least 20 times
  /// a second while samples of the IMU arrive. report().health is that of the last scan.
  const Health& health() const noexcept;
  /// Pose of a radar in the body frame: the option's value unless it is estimated.
  const Pose& extrinsics(std::size_t radar = 0) const noexcept;
  /// Value and covariance (column by column) of a declared auxiliary state at the last update;
  /// false if there is none of that name. With its type: rio::auxiliary in rio/aiding.hpp.
  bool auxiliary(const char* name, double* value, double* covariance) const noexcept;
  /// The last update, stage by stage.
  const UpdateReport& report() const noexcept;
  const Counters& counters() const noexcept;

  struct Impl;  ///< defined where it is compiled

 private:
  explicit Odometry(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rio
