// SPDX-License-Identifier: BSD-3-Clause
// Stage 3: tells true rest, on the ground, from everything else. Hovering is no rest.
//
// A span between two scans is still if
// (E1) each axis of the IMU spreads by less than kSpread times its white noise, density / sqrt(dt);
// (E2) the gyroscope reads its bias within that noise;
// (E3) nearly all detections have no Doppler: |d| within half a cell and 2.5 sigmas.
// Rest is declared after kDuration of still spans. An IMU at its noise floor alone could be carried
// at constant speed, a radar without Doppler could hover within its cell; a rotor excludes (E1).
#pragma once

#include <optional>

#include "rio/frontend/detection.hpp"
#include "rio/models/rest.hpp"
#include "rio/options.hpp"
#include "rio/propagate/imu_buffer.hpp"
#include "rio/types.hpp"

namespace rio {

class RestDetector {
 public:
  explicit RestDetector(const Options& options) : options_(options) {}

  void reset() { still_ = 0.0; }

  /// The rest as a measurement, if there is one.
  /// @param from the last scan; `to`: this one; the buffer holds the samples between them
  std::optional<RestModel::Measurement> observe(const DetectionList& scan, Time from, Time to,
                                                const ImuBuffer& imu, const Vector3d& gyro_bias);

 private:
  using Vector6d = Eigen::Matrix<double, 6, 1>;

  /// Of the samples in a span (Welford 1962).
  struct Statistics {
    double count = 0.0;
    Vector6d mean = Vector6d::Zero();
    Vector6d squares = Vector6d::Zero();

    void add(const ImuSample& sample);
    Vector6d deviation() const { return (squares / (count - 1.0)).cwiseSqrt(); }
  };

  /// Of the samples after `from` up to `to`.
  static Statistics statistics(const ImuBuffer& imu, Time from, Time to);

  /// (E1) (E2)
  bool is_still(const Statistics& s, double duration, const Vector3d& gyro_bias) const;

  /// (E3)
  static bool without_doppler(const DetectionList& scan);

  static constexpr double kSpread = 2.0;  // a spread of twelve samples exceeds it once in 1e5 spans
  static constexpr double kGyroFloor = 1e-3;   // grid of a MEMS gyroscope [rad/s]
  static constexpr double kAccelFloor = 1e-2;  // same [m/s^2]
  static constexpr double kMinSamples = 4.0;
  static constexpr double kLongestSpan = 0.5;  // a radar that pauses tells nothing [s]
  static constexpr double kDuration = 1.0;     // [s]
  static constexpr double kDopplerSigmas = 2.5;
  static constexpr double kShare = 0.8;
  static constexpr std::size_t kMinDetections = 5;
  static constexpr double kStandingVelocity = 0.01;  // what passes for standing [m/s]
  static constexpr double kSmallestRate = 1e-5;  // no gyroscope is better in a tenth of a second

  Options options_;
  double still_ = 0.0;  ///< time of still spans in a row [s]
};

}  // namespace rio
