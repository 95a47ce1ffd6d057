// SPDX-License-Identifier: BSD-3-Clause
// Stage 3: a second opinion on gravity in the body's axes, from the Dopplers of two seconds and the
// increments of the IMU between them. The estimate follows the Dopplers; if its tilt or a bias is
// wrong, the acceleration that they show is not the one that it predicts, again and again.
//
// In the axes of the body now, for a scan that is T old: v velocity and g gravity now, s the
// specific force summed up since, biases as estimated,
// (E1) velocity then = v - s - g T
// (E2) N (v - g T) = c + N s, N = sum (a a^T - Sigma_u) / sigma^2, c = sum a y / sigma^2 over the
//      static detections of the scan, y = -d - u_B . (w x p) and a = u_B: Doppler, rate, lever arm;
//      Sigma_u, of the direction, is what its error adds to a a^T (errors in variables)
// Least squares over the scans gives v and g, linear in both. The biases tilt and accelerometer
// are seen as one:
// (E3) D = g - g_estimated = g_estimated x theta - b, theta and b the errors of attitude and
//      accelerometer bias
// (E4) cov D = k A^-1 + J P J^T + 6/5 q / T I + C Sigma C^T + m^2 I: the Dopplers, whose errors
//      repeat from scan to scan; the estimate's own, J of (E3); the integral of white noise of
//      density q, fitted by a line over T; mounting and scale of the radar, C what they make of the
//      slope; people who pass for static
// (E5) Without Dopplers g = -s / T: the velocity of a small robot does not change by much for long.
//      It knows a wrong tilt of 30 deg.
// The estimate is contradicted if D is beyond its four sigmas for a while: attitude,
// velocity and biases start over, and landmarks placed with them go.
#pragma once

#include <optional>

#include "rio/core/ring.hpp"
#include "rio/frontend/doppler_fold.hpp"
#include "rio/frontend/frontend.hpp"
#include "rio/frontend/velocity_pool.hpp"
#include "rio/options.hpp"
#include "rio/propagate/imu_buffer.hpp"
#include "rio/state/estimate.hpp"

namespace rio {

/// Gravity and velocity as the Dopplers have them, axes of the body now.
struct GravityOpinion {
  Vector3d g_B = Vector3d::Zero();  ///< [m/s^2]
  double sigma = 0.0;        ///< of it, per axis, with what a bias may have made of it [m/s^2]
  VelocityOpinion velocity;  ///< may have run away meanwhile
};

/// No allocation after construction.
class GravityCheck {
 public:
  using Matrix4d = Eigen::Matrix4d;

  explicit GravityCheck(const Options& options);

  /// Starts over at `time`.
  void reset(Time time);

  /// When gravity as estimated was last supported, or could not be judged.
  Time agreed() const { return agreed_; }
  /// The first of the scans in a row that contradict it; none if the last one does not.
  std::optional<Time> contradicted_since() const { return since_; }

  /// Takes a scan; the result is gravity, if it contradicts the one estimated.
  /// @param seen its static set
  /// @param x predicted to the scan
  /// @param P_body of x, order of namespace body
  /// @param P_radar of the mounting's rotation (axes S) and of the Doppler scale
  /// @param last scan before; the buffer holds the samples since
  /// @param gap the IMU paused since
  std::optional<GravityOpinion> observe(const Observations& seen, const Estimate& x,
                                        const BodyCovariance& P_body, const Matrix4d& P_radar,
                                        Time last, const ImuBuffer& imu, bool gap);

 private:
  using Matrix34d = Eigen::Matrix<double, 3, 4>;

  /// A scan, carried to the axes of now.
  struct Scan {
    Time time{0};
    Matrix3d N = Matrix3d::Zero();    ///< (E2)
    Vector3d c = Vector3d::Zero();    ///< (E2)
    double square = 0.0;              ///< sum y^2 / sigma^2
    int rows = 0;                     ///< how many they are
    Vector3d s = Vector3d::Zero();    ///< [m/s]
    Matrix34d C = Matrix34d::Zero();  ///< velocity by rotation of the mounting and by scale
  };
  /// Gravity as the scans have it.
  struct Fit {
    Vector3d g = Vector3d::Zero();
    Matrix3d covariance = Matrix3d::Zero();
    VelocityOpinion velocity;
    Matrix34d slope = Matrix34d::Zero();  ///< C of (E4)
  };

  void agree(Time time);
  void carry(const Estimate& x, Time last, const ImuBuffer& imu);
  void take(const Observations& seen, const Estimate& x);
  /// None if the Dopplers tell too little, or if no v and g explain them.
  std::optional<Fit> fit_dopplers(Time now) const;
  /// (E5)
  Fit without_dopplers(const Estimate& x) const;

  static constexpr Time kWindow = std::chrono::seconds(2);            // the gyro alone stays good
  static constexpr std::size_t kMaxScans = 60;                        // of 30 Hz
  static constexpr Time kSpan = std::chrono::milliseconds(500);       // a slope needs
  static constexpr Time kPatience = std::chrono::milliseconds(1000);  // people come and go
  static constexpr double kSigmas = 4.0;                              // one window in ten thousand
  static constexpr double kRepetition = 4.0;      // rows of one reflector repeat their error
  static constexpr double kMovers = 0.05;         // m of (E4): one row in twenty, walking [m/s^2]
  static constexpr double kBadFit = 3.0;          // residual variance over its expectation
  static constexpr double kWeak = 1.0;            // sigma in the worst direction [m/s^2]
  static constexpr double kVelocityChange = 2.0;  // of a small robot in the window, sigma [m/s]

  static constexpr double kMaxBias = 0.5;  // of an accelerometer [m/s^2]

  Options options_;
  DopplerFold fold_;
  Ring<Scan> scans_;
  double density_ = 0.0;  ///< of the accelerometer, largest in the window, about [(m/s^2)^2/Hz]
  Time agreed_{0};
  std::optional<Time> since_;
};

}  // namespace rio
