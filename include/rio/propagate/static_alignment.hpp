// SPDX-License-Identifier: BSD-3-Clause
// Stage 1: the first state from a standstill: roll and pitch from gravity, gyro bias from the mean
// rate, and a covariance with the correlation of tilt and accelerometer bias. Any IMU mounting.
//
// With f the mean specific force, y = f/|f| (up in body axes), b_a the accelerometer bias:
// (E1) R y = e_z, yaw 0;  b_g = mean rate;  b_a = y (|f| - g), shrunk by its prior
// (E2) [y] theta = -b_a_perp / g   =>   theta_perp = [y] b_a / g
// (E3) P_aa = sigma_ba^2 (I - y y^T) + s^2 y y^T,  P_theta,a = [y] P_aa / g,
//      P_theta,theta = [y] P_aa [y]^T / g^2 + (noise/g)^2 (I - y y^T) + sigma_yaw^2 y y^T
// where s^2 is the posterior variance of b_a along y given |f| - g and the spread of local gravity.
// Derivation: data/theory.md, 3.
// (E4) noise: the variance of the mean, from the configured density or from the scatter of the
//      means m_i of the n parts of the window, whichever is more: sum (m_i - m)^2 / ((n - 1) n).
//      The scatter includes a running engine and a swaying body.
// (E5) A rotation about y at the rate r looks like a bias of r. With the posterior probability w of
//      a rotating platform, b_g along y is (1 - w) r, its variance grows by
//      w (s_b^2 + (1 - w) r^2). w is negligible for rates typical of a bias.
#pragma once

#include <array>
#include <functional>
#include <optional>

#include "rio/options.hpp"
#include "rio/report.hpp"
#include "rio/types.hpp"

namespace rio {

/// Result of the alignment.
struct Alignment {
  NavState state;
  BodyCovariance covariance = BodyCovariance::Zero();
};

/// The rotation R_WB that takes the up direction y (unit, body axes) to e_z. Heading zero: the x
/// axis points along the world's x, or, where it is vertical, the y axis along the world's y.
Quaternion level(const Vector3d& y);

/// Averages samples until `StartOptions::duration` is covered, then decides; a window that is not a
/// standstill drops its oldest part and continues. A sensor that is switched on at rest and soon
/// moved: of the first window, the first third is enough, with the larger sigma of its mean; less
/// than two thirds only if the gyro shows no running engine either, whose noise hides a slow
/// motion. O(1) memory: the window is kept as parts, whose means must agree, so that slow motion is
/// detected too.
class StaticAligner {
 public:
  StaticAligner(const StartOptions& start, const ImuOptions& imu) : start_(start), imu_(imu) {}

  void reset() {
    for (Part& part : parts_) part = Part{};
    begin_.reset();
    first_ = true;
  }

  /// kOk: more samples are needed, or `result` holds the alignment, which may be of a time before
  /// the sample. kMoving: the window that just ended was not a standstill; the next one ends a part
  /// later.
  Status add(const ImuSample& sample, std::optional<Alignment>* result);

 private:
  using Vector6d = Eigen::Matrix<double, 6, 1>;
  static constexpr std::size_t kParts = 6;
  static constexpr std::size_t kLeast = 2;       ///< at rest in the first window
  static constexpr std::size_t kLeastNoisy = 4;  ///< same, with an engine running

  /// Running mean and sum of squares (Welford 1962).
  struct Part {
    double count = 0.0;
    Vector6d mean = Vector6d::Zero();
    Vector6d squares = Vector6d::Zero();

    void add(const ImuSample& s);
    Vector6d deviation() const;
  };

  /// The part of the rate about the vertical that is a rotation (E5).
  struct Turn {
    double rate = 0.0;      ///< expected [rad/s]
    double variance = 0.0;  ///< added to the bias along y [(rad/s)^2]
  };

  // Of the first n parts.
  Vector6d mean(std::size_t n) const;
  /// Variance of their means.
  Vector6d scatter(std::size_t n) const;
  bool standstill(std::size_t n) const;
  Alignment align(Time time, std::size_t n) const;
  Turn slow_turn(double rate) const;

  static constexpr double kGravitySpread = 0.02;  // [m/s^2]
  static constexpr double kGyroBiasFloor = 1e-4;  // instability of a MEMS gyro over minutes [rad/s]
  /// Scatter of the means of the parts still accepted as a standstill: this share of the largest
  /// deviation of a sample, or so many sigmas of white noise.
  static constexpr double kSway = 0.1;
  static constexpr double kWhiteSigmas = 3.0;
  static constexpr double kTurning = 0.003;  // p_t: on a ship or in a hand, one start in 300
  static constexpr double kTurnOn = 0.01;    // s_b: data sheets of MEMS, 0.5 to 1 deg/s [rad/s]

  StartOptions start_;
  ImuOptions imu_;
  bool first_ = true;  ///< window since reset()
  std::optional<Time> begin_;
  std::array<Part, kParts> parts_{};
};

/// Replaces the sample by the next one of a recording; false at its end.
using NextSample = std::function<bool(ImuSample* sample)>;

/// The gyro bias [rad/s] if the first `StartOptions::duration` of the samples from `from` on is a
/// standstill. Samples that are not finite are skipped; no more are asked for than necessary.
std::optional<Vector3d> standstill_gyro_bias(const NextSample& next, Time from,
                                             const Options& options);

}  // namespace rio
