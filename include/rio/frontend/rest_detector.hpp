// SPDX-License-Identifier: BSD-3-Clause
// Stage 2: detects rest on the ground, for the zero-velocity update (ZUPT). Hovering is not rest.
//
// The points of the last scans are tested together, so that a few points a scan are enough, and the
// IMU must have had a calm moment recently: on the ground a sensor may be touched and tilted, but
// between two touches it lies still. In a hand or in the air it never does.
//
// (E1) The scans of the last second cover kDuration and have at least kMinPoints points without
//      Doppler, |d| < 2.5 sigmas, which are at least a share kShare of all. A scan of which more
//      than half has a Doppler starts over.
// (E2) The common velocity of these points is zero: with A = sum u u^T / sigma^2 + I / kSlow^2 and
//      b = sum u d / sigma^2, b^T A^-1 b is chi-squared of three degrees of freedom; the bound is
//      multiplied by the number of scans, because a point repeats its error. A Doppler that is not
//      quantised, or not to the same cell for all points, reveals a creeping body.
// (E3) A moment is the samples of kMoment, at least kMinSamples. It is calm if each axis of the IMU
//      deviates by less than kCalm times its white noise, density / sqrt(dt), the gyroscope reads
//      its bias within as much, and nothing vibrates: the fourth differences, which are insensitive
//      to the motion of a body, are below kVibration times those of the white noise. Running rotors
//      exceed that.
// (E4) If the whole span since the last scan is as quiet as white noise (kQuiet), the mean of the
//      gyroscope measures its bias.
// (E5) A Doppler grid coarser than kCoarse does not see a body set off, but the accelerometer does:
//      at rest the mean of f - b_a + R_WB^T g_W over kSteady is zero, with the covariance of its
//      white noise, the tilt and the accelerometer bias. Tested from the start, or after kSettled
//      of rest, until the Doppler shows motion: after a drive the tilt is first corrected at rest.
// Limit: without vibration, a body that creeps steadily below the Doppler quantisation counts as at
// rest.
#pragma once

#include <array>
#include <optional>

#include "rio/core/ring.hpp"
#include "rio/models/detection.hpp"
#include "rio/models/rest.hpp"
#include "rio/options.hpp"
#include "rio/propagate/imu_buffer.hpp"
#include "rio/types.hpp"

namespace rio {

class RestDetector {
 public:
  explicit RestDetector(const Options& options);

  void reset();

  /// The zero-velocity measurement, if the body is at rest.
  /// @param from time of the last scan; the buffer holds the samples since
  /// @param x state predicted to this scan, @param P its covariance
  std::optional<RestModel::Measurement> observe(const DetectionList& scan, Time from,
                                                const ImuBuffer& imu, const NavState& x,
                                                const BodyCovariance& P);

 private:
  using Vector6d = Eigen::Matrix<double, 6, 1>;

  /// Specific force minus gravity, integrated from one scan to the next.
  struct Force {
    double duration = 0.0;              ///< [s]
    Vector3d sum_B = Vector3d::Zero();  ///< [m/s]
    double variance = 0.0;              ///< of it by white noise, per axis [m^2/s^2]
  };
  static Force force_beyond_gravity(Time from, const ImuBuffer& imu, const NavState& x,
                                    const ImuOptions& options);
  /// (E5) over the last scans.
  bool starts_to_move(const NavState& x, const BodyCovariance& P) const;

  /// Sums over the points of a scan.
  struct Points {
    Time time{0};
    double all = 0.0;
    double still = 0.0;             ///< points without Doppler
    Matrix3d A = Matrix3d::Zero();  ///< sum u u^T / sigma^2 over those [s^2/m^2]
    Vector3d b = Vector3d::Zero();  ///< sum u d / sigma^2 over those [s/m]
    Force force;                    ///< since the scan before
  };
  static Points points_of(const DetectionList& scan, Time time);
  /// (E1) (E2) over the scans kept.
  bool without_doppler() const;

  /// Statistics of the IMU since the last scan.
  struct Span {
    double samples = 0.0;
    Vector3d gyro_B = Vector3d::Zero();  ///< mean [rad/s]
    double loudest = 0.0;                ///< largest Moment::spread
  };
  Span measure_vibration(Time from, Time to, const ImuBuffer& imu, const Vector3d& gyro_bias);

  /// Of the worst axis, in sigmas of the white noise.
  struct Moment {
    double spread = 0.0;     ///< standard deviation, or rate minus bias if that is more
    double vibration = 0.0;  ///< by the fourth differences
  };
  /// (E3) of the newest samples; none until there are enough.
  std::optional<Moment> moment(const Vector3d& gyro_bias) const;

  static constexpr std::size_t kMaxScans = 64;
  static constexpr Time kWindow = std::chrono::milliseconds(1000);
  static constexpr Time kDuration = std::chrono::milliseconds(500);
  static constexpr double kMinPoints = 15.0;
  static constexpr double kShare = 0.7;  // people may pass by
  static constexpr double kDopplerSigmas = 2.5;
  static constexpr double kSlow = 0.1;    // [m/s]
  static constexpr double kChi2 = 11.34;  // three degrees of freedom, 99 %
  static constexpr double kCoarse = 0.2;  // a cell hides as much as a touch [m/s]
  static constexpr Time kSteady = std::chrono::milliseconds(250);
  static constexpr Time kSettled = std::chrono::milliseconds(1000);
  static constexpr double kForceChi2 = 21.1;      // three degrees of freedom, 99.99 %
  static constexpr double kSameInstant = 5e-3;    // less than a sample of the IMU [s]
  static constexpr double kLongestSpan = 0.5;     // a longer pause of the radar starts over [s]
  static constexpr std::size_t kMaxSamples = 64;  // of a moment
  static constexpr std::size_t kMinSamples = 10;
  static constexpr Time kMoment = std::chrono::milliseconds(50);
  static constexpr Time kCalmLasts = std::chrono::milliseconds(1500);
  static constexpr double kCalm = 5.0;  // a hand at rest on a table; in the air it is 15
  static constexpr double kVibration = 2.0;
  static constexpr double kQuiet = 2.0;
  static constexpr double kGyroFloor = 5e-4;        // quantisation of a MEMS gyroscope [rad/s]
  static constexpr double kAccelFloor = 5e-3;       // same, accelerometer [m/s^2]
  static constexpr double kTouchedVelocity = 0.05;  // same, while the body is touched [m/s]
  static constexpr double kSmallestRate = 1e-5;     // least sigma of a mean rate [rad/s]
  static constexpr double kUnknown = 10.0;          // sigma of a rate without information [rad/s]

  Options options_;
  std::array<bool, kMaxRadars> coarse_{};  ///< (E5) is tested, by radar
  Ring<Points> scans_;
  Ring<ImuSample> samples_;
  std::optional<Time> calm_;   ///< the last calm moment
  std::optional<Time> since_;  ///< begin of the rest
  bool settled_ = true;        ///< rest has lasted for kSettled, or the start; no motion since
};

}  // namespace rio
