// SPDX-License-Identifier: BSD-3-Clause
// The hidden part of the odometry API.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "rio/rio.hpp"

namespace rio {

/// The interface between the odometry API and the estimator with either back-end.
struct Odometry::Impl {
  virtual ~Impl() = default;
  virtual Status add_imu(const ImuSample& sample) = 0;
  virtual Status add_scan(const RadarScan& scan, std::size_t radar) = 0;
  virtual Status add_measurement(const AidingMeasurement& measurement) = 0;
  virtual bool auxiliary(const char* name, int index, int size, double* value,
                         double* covariance) const = 0;
  virtual Status reset(const NavState& prior, const BodyCovariance& P0) = 0;
  virtual void reset() = 0;
  virtual const NavState& at_scan() const = 0;
  virtual const NavState& now() const = 0;
  virtual const UpdateReport& report() const = 0;
  virtual const std::vector<PointReport>& points() const = 0;
  virtual const std::vector<LandmarkReport>& landmarks() = 0;
  virtual const Health& health() const = 0;
  virtual const BodyCovariance& covariance_now() = 0;

  BodyCovariance covariance = BodyCovariance::Zero();
  StaticVector<Pose, 1 + Options::kMaxOtherRadars> extrinsics;  ///< of the radars of the options
  Counters counters;
  bool initialized = false;
  std::function<void()> on_scan;  ///< after a scan was processed; may be empty
  bool on_scan_set = false;       ///< since it was called
};

std::unique_ptr<Odometry::Impl> make_ekf_engine(const Options& options);
std::unique_ptr<Odometry::Impl> make_smoother_engine(const Options& options);

}  // namespace rio
