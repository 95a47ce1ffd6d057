// SPDX-License-Identifier: BSD-3-Clause
// Mean and covariance at one instant, and what happens to both alike: start, propagation, blocks
// that enter and leave. Either back-end predicts, matches and gates with a state estimate.
//
// Stages 1, 2 and 7.
#pragma once

#include <array>

#include "rio/core/static_vector.hpp"
#include "rio/models/detection.hpp"
#include "rio/options.hpp"
#include "rio/propagate/imu_buffer.hpp"
#include "rio/report.hpp"
#include "rio/state/estimate.hpp"
#include "rio/state/layout.hpp"
#include "rio/update/covariance.hpp"
#include "rio/update/gyro_bias_check.hpp"
#include "rio/update/linearize.hpp"

namespace rio {

/// That of the body, without its vibration: what vibration adds to the velocity and to its change
/// would agree on a time offset that is none. A low-pass of second order.
struct Acceleration {
  Vector3d once_W = Vector3d::Zero();    ///< smoothed once [m/s^2]
  Vector3d smooth_W = Vector3d::Zero();  ///< smoothed twice [m/s^2]

  /// @param change of the velocity in `seconds`
  void add(const Vector3d& change_W, double seconds);
};

/// A parameter of the calibration that the data move away from its configured value.
struct Contradiction {
  int column = 0;            ///< in the layout
  double value = 0.0;        ///< off the configured value
  double information = 0.0;  ///< of the tight prior, beyond that of the options
};

/// What is configured of the calibration is usually as good as it can be measured, and sometimes
/// wrong by far; the prior sigma of the options covers both. On a few noisy points a loose
/// parameter soaks up whatever errors there are. So each is believed to a share k of its prior
/// sigma s until the data contradict it, and to s from then on.
///
/// (E1) configured: P_0 = (k s)^2; a right prior is moved by a value of the variance P_0 - P;
///      contradicted if value^2 > 9 (P_0 - P) and value^2 > P_0
/// (E2) the information 1 / (k s)^2 - 1 / s^2, that the value is zero, is taken back
class StateEstimate {
 public:
  /// @param max_clones past poses with a covariance: none, or as many as the options keep
  StateEstimate(const Options& options, int max_clones);

  const Layout& layout() const { return layout_; }
  const Estimate& estimate() const { return estimate_; }
  const Covariance& covariance() const { return covariance_; }
  /// For those who correct them.
  Estimate& estimate() { return estimate_; }
  Covariance& covariance() { return covariance_; }

  void reset(const NavState& prior, const BodyCovariance& P0);

  /// A scan of radar r is at hand: its calibration is that of the estimate and of the layout.
  void select_radar(std::size_t r);

  /// To exactly `to`. kNumerical, with nothing changed, if the result is not finite.
  Status propagate(Time to, const ImuBuffer& imu, bool* gap);

  /// The parameters contradicted since the last call (E1); each is reported once. The caller takes
  /// back the information (E2).
  StaticVector<Contradiction, kMaxRadars * kCalibrationCount> contradictions();
  /// Of the prior sigma of the options, to which a parameter of the radar at hand is believed now.
  double prior_share(Calibration parameter) const;

  /// The velocity was off by what it differs from `v_B` [m/s, body axes] for `duration` [s]; it may
  /// have been for the time `doubtful` [s], and the position off by what that has done.
  void restart_velocity(const Vector3d& v_B, const Matrix3d& covariance_B, double duration,
                        double doubtful);

  /// Gravity turns out to be g_B, sigma per axis [m/s^2, body axes], and the velocity v_B [m/s],
  /// for `duration` [s]: the body is tilted to it, and keeps its velocity; attitude, gyro bias and
  /// accelerometer bias become uncertain by what may have made the difference, the position by what
  /// that has done.
  void restart_attitude(const Vector3d& g_B, double sigma, const Vector3d& v_B, double duration);

  /// The gyro bias turns out to be wrong about the vertical: it becomes uncertain, and with it
  /// heading, velocity and position by what it has done to them meanwhile.
  void restart_heading(const GyroBiasOpinion& opinion);

  /// Covariance of what turns and scales a measured velocity of the radar: rotation of T_BS, axes
  /// S, and Doppler scale. Zero what is not estimated.
  Eigen::Matrix4d velocity_calibration() const;

  /// Of the radar's own velocity as predicted, in its axes [m/s], and of the error of elevations
  /// [rad]. A Doppler along u, of an echo that would rise along the unit tangent t, has the
  /// variance c^T V c with c = [u, t . v_S] by the error of the state.
  Eigen::Matrix4d doppler_covariance(const LinearizationPoint& x) const;
  /// The velocity's part of it [m^2/s^2].
  Matrix3d radar_velocity_covariance() const {
    return doppler_covariance(LinearizationPoint(estimate_)).topLeftCorner<3, 3>();
  }

  /// The pose of now is kept as the clone of `scan`, in place of the oldest one; for matching alone
  /// if the layout has no clones.
  void clone(ScanId scan);

  void add_landmark(const Detection& d);
  /// The last one takes its place.
  void remove_landmark(std::size_t i);

  /// Injects an error in the order of the layout, clones and landmarks included. Calibration stops
  /// at kCalibrationLimit sigmas of its prior.
  void correct(const Eigen::VectorXd& dx);

 private:
  /// Fills what matching needs to know of the landmarks.
  void predict_landmarks();

  void correct_calibration(std::size_t r, const Eigen::VectorXd& dx);

  Options options_;
  Layout layout_;
  Estimate estimate_;
  Covariance covariance_;
  Acceleration acceleration_;
  Eigen::VectorXd dx_;
  std::array<std::array<bool, kCalibrationCount>, kMaxRadars> contradicted_{};
};

}  // namespace rio
