// SPDX-License-Identifier: BSD-3-Clause
// The odometry API for flight stacks: radar-inertial odometry behind two calls per loop. C++17.
//
//   auto odometry = rio::Odometry::create(options, &why);
//   odometry->add_imu(sample);    // each IMU sample
//   odometry->add_scan(scan);     // each radar scan
//
// Optional: add_scan(scan, 1) for a second radar (Options::other_radars), add_measurement() for
// other sensors (rio/aiding.hpp).
//
// The estimate is at the time of the newest processed scan; a predictor carries it through the
// buffered IMU samples to now(). There are no locks, threads, clocks or logs inside and, after
// create(), no allocations. The same binary fed in the same order gives the same bytes.
//
// One thread makes all calls. If the IMU and the radar have a thread each, either put their data
// into one queue that a third thread empties into the calls, or hold one mutex around every call,
// including the accessors: these return references to data that the next call changes, so copy
// now() and covariance() under the mutex and use the copies. A scan may then come before or after
// the samples of its time; the estimates at the scans are the same. An update holds the mutex for a
// millisecond or so, during which the IMU waits; with a queue it does not. Two estimators share
// nothing and may run in separate threads without a lock.
//
// Inputs are checked in constant time. A refused input has its Status, if it is data of a sensor
// its counter (but for kMoving, and kUndeclared, kNotInitialized and kNumerical of a measurement),
// and changes nothing else:
//   numbers     NaN and infinity in samples, detections and starts (kNonFinite); a measurement of
//               another sensor is judged by its model and its gate, the noise it is said to have
//               at once. An IMU sample that is frozen
//               (all values, those of one sensor or one axis repeat, unlike before), or beyond the
//               range of the sensor (ImuOptions::max_rate, max_accel), is kImplausible and bridged
//               as if it were lost. A detection that is not finite or beyond the range of a radar
//               is removed from its scan.
//   IMU stamps  increase strictly (else kStale), by half a second at most (else kAhead). A single
//               outlier is dropped. Five outliers in a row with increasing stamps are a jump. A
//               jump forwards by up to TimingOptions::max_pause is a pause and bridged as a gap; a
//               pause of more than ten seconds once the stamps after it span a second. If the tilt
//               is lost in it, the estimate restarts a second and a half later from the specific
//               force (Counters::restarts); position and heading are those before the pause, with
//               sigmas of what may have happened in it. A longer jump through which the stamps of
//               the radar have gone on is a pause, too. Any other, once it spans a tenth of a
//               second, is a restart of the sensor clock (Counters::clock_restarts). The estimate
//               then keeps its values in the time of the new clock, with the uncertainty of a pause
//               of some 0.3 s; calibration, auxiliary states and landmarks start again, and
//               measurements of other sensors that wait are dropped. After a longer pause call
//               reset().
//   scan stamps are in the clock of the IMU. If that of a radar steps by more than a tenth of a
//               second - five scans arrive when they are due, with stamps that do not follow - the
//               step is taken out of the stamps from then on (Counters::radar_clock_steps,
//               report().time is without it) and the time offset estimated anew. So it is where the
//               clock of the IMU alone jumps by more than half a second. Older than the estimate is
//               kLate, farther ahead of the newest IMU sample than
//               TimingOptions::max_ahead kAhead. In between they wait.
//   all stamps  within 146 years of their epoch; beyond that they are too old, or ahead.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

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
  /// Validates the options and allocates everything. Invalid options: null, and the reason in
  /// `why`.
  [[nodiscard]] static std::unique_ptr<Odometry> create(const Options& options,
                                                        std::string* why = nullptr);
  ~Odometry();
  Odometry(const Odometry&) = delete;
  Odometry& operator=(const Odometry&) = delete;

  /// Takes one IMU sample; refused: kStale, kAhead, kNonFinite, kImplausible. O(1), except that a
  /// scan waiting for this sample is processed here, which shows in report().time and
  /// counters().scans, and that the estimate is carried along twenty times in max_lag while the
  /// radar is silent. During static alignment kMoving says that a window was rejected; alignment
  /// tries again until StartOptions::max_wait, if given, starts it in motion.
  [[nodiscard]] Status add_imu(const ImuSample& sample) noexcept;

  /// Takes one radar scan. Processed at once if the IMU has reached its stamp (kOk), else queued
  /// (kWaiting). kDuplicate, kLate, kAhead, kQueueFull, kNonFinite, kNotInitialized: dropped and
  /// counted. With several radars (Options::other_radars) each scan waits until the others have
  /// sent a later one, TimingOptions::scan_wait at most, so that the order of arrival does not
  /// matter; kUndeclared: the options have no such radar.
  [[nodiscard]] Status add_scan(const RadarScan& scan, std::size_t radar = 0) noexcept;

  /// Takes a measurement of another sensor (rio/aiding.hpp), stamped in the clock of the IMU.
  /// kWaiting: it is applied with the first scan at or after its time, or alone if no scan comes
  /// for TimingOptions::max_lag. kLate: before the estimate by more than aiding_delay; kAhead as
  /// for scans; kQueueFull; kUndeclared: it depends on an auxiliary state or a radar that the
  /// options do not have; kNotInitialized; kNumerical: its noise is none (Model::is_valid()). The
  /// result of the gate is in report().records.
  [[nodiscard]] Status add_measurement(const AidingMeasurement& measurement) noexcept;

  /// Starts, or restarts, from a known state. `prior.time` may be before, at or after the newest
  /// IMU sample, within the buffered samples: kLate if more than TimingOptions::max_lag before the
  /// oldest of them, kAhead if more than max_ahead after the newest. Before the first
  /// sample any time is accepted; if it is farther than ten seconds from the first sample, the
  /// state is taken to hold there. kNonFinite if a value is not finite, kImplausible if a position
  /// is beyond 1e7 m, another value beyond 1e4 or a sigma beyond 1e6 (SI units), kNumerical if P0
  /// is not symmetric positive semi-definite or the norm of the quaternion is not near one (0.5 to
  /// 2; it is normalised). A refused call changes nothing.
  /// @param P0 covariance of the body error state, order of namespace body, SI units
  [[nodiscard]] Status reset(const NavState& prior, const BodyCovariance& P0) noexcept;
  /// Discards everything and returns to the start mode of the options (static alignment).
  void reset() noexcept;

  bool initialized() const noexcept;
  /// Estimate at the newest IMU sample: at_scan() propagated by the strapdown equations.
  const NavState& now() const noexcept;
  /// Estimate at the newest processed scan, at its stamp minus the estimated time offset. Before
  /// the first scan it is the start; while the radar is silent it follows the IMU at
  /// TimingOptions::max_lag.
  const NavState& at_scan() const noexcept;
  /// Covariance of at_scan(), order of namespace body.
  const BodyCovariance& covariance() const noexcept;
  /// Covariance of now(), same order. Computed on demand from the last call: a few microseconds per
  /// sample in between, or since at_scan() if that has changed. Valid until the next call of any
  /// function.
  const BodyCovariance& covariance_now() const noexcept;
  /// How far the estimate can be trusted, and why: evaluated at every scan, and at least 20 times a
  /// second while IMU samples arrive. report().health is that of the last scan.
  const Health& health() const noexcept;
  /// Radars of the options.
  std::size_t radars() const noexcept;
  /// Pose of a radar in the body frame: the estimate, or the option's value if it is not estimated.
  /// Of the last one if there is no such radar.
  const Pose& extrinsics(std::size_t radar = 0) const noexcept;
  /// Value and covariance (column by column) of a declared auxiliary state at the last update;
  /// false before the start, for none of that name and index, and for a delayed one that is not
  /// known yet. `value` has room for its n elements, `covariance` for n x n. Typed access:
  /// rio::auxiliary in rio/aiding.hpp.
  /// @param size if it is not 0, only a state of so many elements
  bool auxiliary(const char* name, double* value, double* covariance, int index = 0,
                 int size = 0) const noexcept;
  /// The last update, stage by stage.
  const UpdateReport& report() const noexcept;
  /// The detections of the last scan with label, world position and residual, in the order of
  /// InnovationRecord::detection; empty if the scan was not used, as after a failed update.
  const std::vector<PointReport>& points() const noexcept;
  /// The landmarks in the state, in no particular order. Copied on demand; valid until the next
  /// call of any function.
  const std::vector<LandmarkReport>& landmarks() const noexcept;
  const Counters& counters() const noexcept;

  /// From now on `call` is called for every scan that was processed, within the call that did it,
  /// when at_scan(), covariance(), report() and points() are of that scan: with several radars one
  /// call may process several. It must not throw, nor add anything to this estimator or reset it;
  /// it may set another. It stays over reset(); an empty function ends it.
  void on_scan(std::function<void()> call) noexcept;

  struct Impl;  ///< private implementation

 private:
  explicit Odometry(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rio
