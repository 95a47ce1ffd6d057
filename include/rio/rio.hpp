// SPDX-License-Identifier: BSD-3-Clause
// DOOR 1, for flight stacks: radar-inertial odometry behind two calls a loop. C++17.
//
//   auto odometry = rio::Odometry::create(options, &why);
//   odometry->add_imu(sample);    // each IMU sample
//   odometry->add_scan(scan);     // each radar scan
//
// The estimate lives at the time of the newest processed scan; a predictor carries it through the
// buffered IMU samples to now(). One thread feeds both calls; there is no lock, no thread, no
// clock, no logging and, after create(), no allocation inside. The same binary fed in the same
// order gives the same bytes.
#pragma once

#include <memory>
#include <string>

#include "rio/export.hpp"
#include "rio/options.hpp"
#include "rio/report.hpp"
#include "rio/types.hpp"

namespace rio {

class RIO_API Odometry {
 public:
  /// Validates the options and allocates everything. Bad options: null, and the reason in `why`.
  [[nodiscard]] static std::unique_ptr<Odometry> create(const Options& options,
                                                        std::string* why = nullptr);
  ~Odometry();
  Odometry(const Odometry&) = delete;
  Odometry& operator=(const Odometry&) = delete;

  /// Takes one IMU sample; stamps must strictly increase (else kStale). O(1), except that a scan
  /// waiting for this sample is processed here, which shows in report().time and counters().scans.
  /// During static alignment kMoving says that a window was refused and a later one is tried, until
  /// StartOptions::max_wait, if given, starts it in motion.
  [[nodiscard]] Status add_imu(const ImuSample& sample) noexcept;

  /// Takes one radar scan. Processed at once when the IMU has reached its stamp (kOk), else queued
  /// (kWaiting). kDuplicate, kLate, kQueueFull, kNonFinite, kNotInitialized: dropped and counted.
  [[nodiscard]] Status add_scan(const RadarScan& scan) noexcept;

  /// Starts, or starts over, from a known state. `prior.time` may lie before, at or after the
  /// newest IMU sample. kNonFinite if a value is not finite, kNumerical if P0 is not symmetric
  /// positive semi-definite; nothing changes then.
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
  /// Pose of the radar in the body frame: the option's value unless it is estimated.
  const Pose& extrinsics() const noexcept;
  /// The last processed scan, stage by stage.
  const UpdateReport& report() const noexcept;
  const Counters& counters() const noexcept;

  struct Impl;  ///< defined where it is compiled

 private:
  explicit Odometry(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rio
