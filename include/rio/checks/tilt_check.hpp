// SPDX-License-Identifier: BSD-3-Clause
// Check of the tilt: an independent estimate of gravity in body axes, from the Dopplers of two
// seconds and the IMU increments between them. It checks the tilt of the state estimate: if the
// tilt or a bias is wrong, the acceleration seen by the Dopplers persistently differs from the
// predicted one.
//
// In the current body axes, for a scan of age T: v velocity and g gravity now, s the specific force
// integrated since the scan, biases as estimated,
// (E1) velocity at the scan = v - s - g T
// (E2) N (v - g T) = c + N s, N = sum (a a^T - Sigma_u) / sigma^2, c = sum a y / sigma^2 over the
//      static detections of the scan, y = -d - u_B . (w x p) and a = u_B: Doppler, rate, lever arm;
//      Sigma_u, of the direction, removes what its error adds to a a^T (errors in variables)
// Least squares over the scans gives v and g, linear in both. Errors of tilt and accelerometer bias
// cannot be separated:
// (E3) D = g - g_estimated = g_estimated x theta - b, theta and b the errors of attitude and
//      accelerometer bias
// (E4) cov D = k A^-1 + h h^T + J P J^T + 6/5 q / T I + C Sigma C^T + m^2 I: the Dopplers, whose
//      errors repeat from scan to scan, k = kRepetitionInWindow; the error of Sigma_u, which is known to a share r; the
//      state estimate, J of (E3); the integral of white noise of density q, fitted by a line over
//      T; rotation and Doppler scale of the radar, C their effect on the slope; movers within the
//      static set. With A of the least squares, the rows of g of
//      h = r A^-1 sum over scans of [I -T I]^T sum(Sigma_u / sigma^2) (v - s - g T)
// (E5) Without enough Dopplers g = -s / T: the velocity of a small robot does not change by much
//      for long. This detects a tilt error of 30 deg.
// The state estimate is contradicted if D exceeds four sigmas for kPatience: attitude and velocity
// are then replaced, the covariance of the biases is inflated, and the landmarks are dropped.
#pragma once

#include <optional>

#include "rio/checks/record.hpp"
#include "rio/checks/velocity_check.hpp"
#include "rio/core/ring.hpp"
#include "rio/frontend/doppler_fold.hpp"
#include "rio/frontend/frontend.hpp"
#include "rio/options.hpp"
#include "rio/propagate/imu_buffer.hpp"
#include "rio/state/estimate.hpp"

namespace rio {

/// Independent estimate of gravity and velocity from the Dopplers, current body axes.
struct IndependentGravity {
  Vector3d g_B = Vector3d::Zero();  ///< [m/s^2]
  double sigma = 0.0;               ///< of g_B per axis, a possible bias included [m/s^2]
  IndependentVelocity velocity;     ///< the estimated one may have diverged meanwhile
};

/// No allocation after construction.
class TiltCheck {
 public:
  using Matrix4d = Eigen::Matrix4d;

  explicit TiltCheck(const Options& options);

  /// Starts over at `time`.
  void reset(Time time) {
    scans_.clear();
    density_ = 0.0;
    record_.agree(time);
  }

  /// A gravity that cannot be tested counts as supported.
  const CheckRecord& record() const { return record_; }

  /// Rotates the scans to the body axes of x and adds the IMU increments (E1). Call whenever the
  /// state is propagated, with or without a scan.
  /// @param last time from which it was propagated; the buffer holds the samples since
  /// @param gap the IMU paused since
  void carry(const Estimate& x, Time last, const ImuBuffer& imu, bool gap);

  /// Takes a scan; returns gravity if it contradicts the state estimate's.
  /// @param seen observations of the scan: its static set
  /// @param x predicted to the scan
  /// @param P_body covariance of x, order of namespace body
  /// @param P_radar covariance of the rotation of T_BS (axes S) and of the Doppler scale
  std::optional<IndependentGravity> observe(const Observations& seen, const Estimate& x,
                                            const BodyCovariance& P_body, const Matrix4d& P_radar);

 private:
  using Matrix34d = Eigen::Matrix<double, 3, 4>;

  /// A scan, rotated to the current body axes.
  struct Scan {
    Time time{0};
    Matrix3d N = Matrix3d::Zero();    ///< (E2)
    Matrix3d U = Matrix3d::Zero();    ///< sum Sigma_u / sigma^2
    Vector3d c = Vector3d::Zero();    ///< (E2)
    double square = 0.0;              ///< sum y^2 / sigma^2
    int rows = 0;                     ///< how many they are
    Vector3d s = Vector3d::Zero();    ///< [m/s]
    Matrix34d C = Matrix34d::Zero();  ///< derivative of the velocity by rotation of T_BS and scale
  };
  /// Gravity and velocity fitted to the scans.
  struct Fit {
    Vector3d g = Vector3d::Zero();
    Matrix3d covariance = Matrix3d::Zero();
    IndependentVelocity velocity;
    Matrix34d slope = Matrix34d::Zero();  ///< C of (E4)
  };

  void take(const Observations& seen, const Estimate& x);
  /// None if the Dopplers contain too little information, or if no v and g explain them.
  std::optional<Fit> fit_dopplers(Time now) const;
  /// (E5)
  Fit without_dopplers(const Estimate& x) const;

  static constexpr Time kWindow = std::chrono::seconds(2);            // the gyro alone is accurate
  static constexpr std::size_t kMaxScans = 60;                        // at 30 Hz
  static constexpr Time kSpan = std::chrono::milliseconds(500);       // least, to fit a slope
  static constexpr Time kPatience = std::chrono::milliseconds(1000);  // people come and go
  static constexpr double kSigmas = 4.0;   // three degrees of freedom: one window in nine hundred
  static constexpr double kShare = 0.5;    // r of (E4): sigmas are known to a quarter
  static constexpr double kMovers = 0.05;  // m of (E4): one row in twenty, walking [m/s^2]
  static constexpr double kBadFit = 3.0;   // largest ratio of residual variance to expected
  static constexpr double kWeak = 1.0;     // sigma in the worst direction [m/s^2]

  static constexpr double kMaxBias = 0.5;  // of an accelerometer [m/s^2]

  Options options_;
  DopplerFold fold_;
  Ring<Scan> scans_;
  double density_ = 0.0;  ///< of the accelerometer, largest in the window, about [(m/s^2)^2/Hz]
  CheckRecord record_;
};

}  // namespace rio
