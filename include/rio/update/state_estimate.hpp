// SPDX-License-Identifier: BSD-3-Clause
// Mean and covariance at one instant, and the operations on both: initialisation, propagation,
// stochastic cloning, landmark augmentation and marginalisation, re-initialisation of parts. Either
// back-end predicts, matches and gates with a state estimate.
//
// Stages 1, 7 and 6.
#pragma once

#include "rio/core/static_vector.hpp"
#include "rio/frontend/mounting_search.hpp"
#include "rio/models/detection.hpp"
#include "rio/options.hpp"
#include "rio/propagate/imu_buffer.hpp"
#include "rio/propagate/steady_motion.hpp"
#include "rio/report.hpp"
#include "rio/state/calibration.hpp"
#include "rio/state/estimate.hpp"
#include "rio/state/layout.hpp"
#include "rio/update/covariance.hpp"
#include "rio/update/linearize.hpp"

namespace rio {

class StateEstimate {
 public:
  /// @param max_clones past poses with a covariance: none, or those of all radars
  StateEstimate(const Options& options, int max_clones);

  const Layout& layout() const { return layout_; }
  const Estimate& estimate() const { return estimate_; }
  const Covariance& covariance() const { return covariance_; }
  const ParameterNoise& parameters() const { return parameters_; }
  /// For the updates.
  Estimate& estimate() { return estimate_; }
  Covariance& covariance() { return covariance_; }

  /// Starts from `prior` with covariance P0, order of namespace body; no clones, no landmarks.
  void reset(const NavState& prior, const BodyCovariance& P0);

  /// A scan of radar r is processed next: estimate and layout refer to its calibration.
  void select_radar(std::size_t r) {
    estimate_.select_radar(r);
    layout_ = layout_.of_radar(r);
  }

  /// Propagates to exactly `to`. kNumerical, with nothing changed, if the result is not finite.
  Status propagate(Time to, const ImuBuffer& imu, bool* gap);

  /// The velocity is off by `error`, with that covariance, both in W: corrects the mean by a
  /// measurement of it.
  void measure_velocity(const Vector3d& error, const Matrix3d& covariance) {
    covariance_.measure_velocity(error, covariance, &dx_);
    correct(dx_);
  }
  /// The motion before tells nothing of that from now on (propagate/steady_motion.hpp).
  /// @param v_B velocity of the body in its axes [m/s]
  void restart_steady_motion(const Vector3d& v_B) {
    steady_.reset(v_B);
    estimate_.steady = steady_.motion();
  }

  /// The mounting of radar r, which was unknown, has been found. It must be estimated.
  void set_mounting(std::size_t r, const Mounting& mounting);
  /// Same, at the time of the scan that completed the evidence: corrects position and velocity.
  void set_mounting_and_motion(std::size_t r, const Mounting& mounting);

  /// The auxiliary state whose first element is `first`, independent of all so far, becomes `value`
  /// with the error by_body dx + n, cov(n) = noise (update/delayed_start.hpp).
  void set_auxiliary(int first, const Eigen::Ref<const Eigen::VectorXd>& value,
                     const Eigen::Ref<const Eigen::MatrixXd>& by_body,
                     const Eigen::Ref<const Eigen::MatrixXd>& noise);

  /// Covariance of the calibration that rotates and scales a measured velocity of the radar:
  /// rotation of T_BS, axes S [rad], and Doppler scale. Zero where not estimated.
  Eigen::Matrix4d velocity_calibration() const;

  /// V, covariance of the predicted velocity of the radar in its axes, scaled as it measures it
  /// [m^2/s^2]: a Doppler along u has the variance u^T V u due to the errors of the state and of
  /// the gyro sample.
  Matrix3d radar_velocity_covariance(const LinearizationPoint& x) const;
  Matrix3d radar_velocity_covariance() const;

  /// Stochastic cloning: keeps the current pose as the clone of `scan`, in place of the oldest one
  /// of its radar, or of another radar's scan of that number; for matching only, without a
  /// covariance, if the layout has no clones.
  void clone(ScanId scan);

  /// Landmark augmentation by the inverse observation model.
  void add_landmark(const Detection& d);
  /// Marginalises landmark i; the last one takes its place.
  void remove_landmark(std::size_t i);

  /// Injects an error in the order of the layout, clones and landmarks included. Calibration is
  /// limited to kCalibrationLimit sigmas of its prior.
  void correct(const Eigen::VectorXd& dx);

  /// After an update: an error d that is considered has mean zero and its prior again, while its
  /// covariance with the other states x is that of the update. The gain of d is zero (Schmidt 1966;
  /// data/theory.md, 7): nothing tells d, however many measurements share it.
  void consider();

 private:
  /// Fills LandmarkState::covariance_S.
  void predict_landmarks();

  /// Variance of the velocity in body axes, all axes: the heading does not count [m^2/s^2].
  double body_velocity_variance() const;

  /// Where the clone of this scan goes.
  std::size_t slot_for(ScanId scan);

  void correct_calibration(std::size_t r, const Eigen::VectorXd& dx);

  Options options_;
  Layout layout_;
  ParameterNoise parameters_;
  Estimate estimate_;
  Covariance covariance_;
  SteadyMotionFilter steady_;
  Eigen::VectorXd dx_;
};

}  // namespace rio
