// SPDX-License-Identifier: BSD-3-Clause
// An estimator whose every answer is held against the contract of rio.hpp.
#pragma once

#include <memory>

#include "fuzz/fuzz.hpp"
#include "rio/aiding.hpp"
#include "rio/rio.hpp"

namespace rio::fuzz {

struct Calls {
  unsigned long add_imu = 0;
  unsigned long add_scan = 0;
  unsigned long processed = 0;  ///< scans
  unsigned long aiding = 0;     ///< add_measurement
  unsigned long reset = 0;
};
inline Calls calls;  ///< of all inputs of this process

/// Forwards the calls; floating point exceptions are trapped in them when the data are finite.
class Judge {
 public:
  Judge(std::unique_ptr<Odometry> odometry, const Options& options);

  Status add_imu(const ImuSample& sample);
  Status add_scan(const RadarScan& scan, std::size_t radar = 0);
  Status add_measurement(const AidingMeasurement& measurement);
  Status reset(const NavState& prior, const BodyCovariance& P0);
  void reset();

 private:
  /// What a refusal must not change.
  struct Estimate {
    NavState now;
    NavState at_scan;
    BodyCovariance covariance;
    Pose extrinsics;
    bool initialized;
    bool operator==(const Estimate& other) const;
  };

  Estimate estimate() const;
  /// All of it finite, the covariance one, and no counter lower than `before`.
  void check_estimate(const Counters& before) const;
  void check_scans() const;
  void check_new(bool initialized);

  std::unique_ptr<Odometry> odometry_;
  int queue_;
  bool several_;                   ///< radars
  std::uint64_t scans_given_ = 0;  ///< since the last reset
};

}  // namespace rio::fuzz
