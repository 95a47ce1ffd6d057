// SPDX-License-Identifier: BSD-3-Clause
// Mean and covariance at one instant, and what happens to both alike: start, propagation, blocks
// that enter and leave. Either back-end predicts, matches and gates with a belief.
//
// Stages 1, 2 and 7.
#pragma once

#include <algorithm>

#include "rio/models/doppler.hpp"
#include "rio/models/landmark_birth.hpp"
#include "rio/options.hpp"
#include "rio/propagate/imu_buffer.hpp"
#include "rio/propagate/strapdown.hpp"
#include "rio/report.hpp"
#include "rio/state/estimate.hpp"
#include "rio/state/layout.hpp"
#include "rio/update/covariance.hpp"
#include "rio/update/linearize.hpp"

namespace rio {

/// That of the body, without its vibration: what vibration adds to the velocity and to its change
/// would agree on a time offset that is none. A low-pass of second order.
struct Acceleration {
  Vector3d once_W = Vector3d::Zero();    ///< smoothed once [m/s^2]
  Vector3d smooth_W = Vector3d::Zero();  ///< smoothed twice [m/s^2]

  /// @param change of the velocity in `seconds`
  void add(const Vector3d& change_W, double seconds) {
    constexpr double kMemory = 0.05;  // rotors turn faster, bodies accelerate slower [s]
    const double sum = kMemory + seconds;
    once_W += (change_W - seconds * once_W) / sum;
    smooth_W += seconds / sum * (once_W - smooth_W);
  }
};

class Belief {
 public:
  /// @param max_clones past poses with a covariance
  Belief(const Options& options, int max_clones)
      : options_(options),
        layout_(options.calibration, max_clones, options.update.max_landmarks),
        covariance_(layout_) {}

  const Layout& layout() const { return layout_; }
  const Estimate& estimate() const { return estimate_; }
  const Covariance& covariance() const { return covariance_; }
  /// For those who correct them.
  Estimate& estimate() { return estimate_; }
  Covariance& covariance() { return covariance_; }

  void reset(const NavState& prior, const BodyCovariance& P0) {
    estimate_ = Estimate{};
    estimate_.nav = prior;
    estimate_.T_BS = options_.radar.T_BS;
    acceleration_ = {};
    covariance_.reset(P0, options_.calibration);
  }

  /// To exactly `to`. kNumerical, with nothing changed, if the result is not finite.
  Status propagate(Time to, const ImuBuffer& imu, bool* gap) {
    Propagation p;
    p.state = estimate_.nav;
    Acceleration acceleration = acceleration_;
    imu.for_each_step(estimate_.nav.time, to, [&](const ImuStep& step) {
      const Vector3d before = p.state.v_WB;
      p.step(step, options_.imu);
      acceleration.add(p.state.v_WB - before, to_seconds(step.end - step.begin));
    });
    if (!p.finite()) return Status::kNumerical;
    *gap = p.gap;
    acceleration_ = acceleration;
    estimate_.accel_W = acceleration_.smooth_W;
    const double way = (p.state.p_WB - estimate_.nav.p_WB).norm();
    estimate_.nav = p.state;
    estimate_.way += way;
    const ImuSample now = imu.at(to);
    estimate_.gyro_B = now.gyro_B;
    covariance_.propagate(p.transition, p.noise);
    const double walk = options_.update.landmark_walk;
    covariance_.add_landmark_noise(walk * walk * way);
    if (options_.frontend.matching == Matching::kMahalanobis) predict_landmarks();
    return Status::kOk;
  }

  /// Of the radar's own velocity as predicted, in its axes [m^2/s^2].
  Matrix3d radar_velocity_covariance() const {
    const LinearizationPoint x(estimate_);
    const DopplerModel model(false, false);
    DopplerModel::Measurement z;
    z.gyro_B = estimate_.gyro_B;
    std::array<LinearRow, 3> rows;
    for (int i = 0; i < 3; ++i) {  // a Doppler along an axis is a component of the velocity
      z.direction_S = Vector3d::Unit(i);
      rows[static_cast<std::size_t>(i)] = doppler_row(model, z, x);
    }
    return covariance_.covariance_of(rows);
  }

  /// Variance of a predicted Doppler, with the direction as measured [m^2/s^2].
  double doppler_variance(const DopplerModel::Measurement& z, const LinearizationPoint& x) const {
    const LinearRow row = doppler_row(DopplerModel(false, false), z, x);
    return covariance_.product(row, row);
  }

  /// The pose of now is kept as the clone of `scan`, in place of the oldest one.
  void clone(ScanId scan) {
    const auto slots = static_cast<std::size_t>(layout_.max_clones());
    if (slots == 0) return;
    const std::size_t slot = static_cast<std::size_t>(scan % slots);
    if (slot >= estimate_.clones.size()) estimate_.clones.resize(slot + 1);
    estimate_.clones[slot] = {scan, estimate_.T_WB()};
    const Eigen::Matrix<double, 6, 6> same = Eigen::Matrix<double, 6, 6>::Identity();
    covariance_.assign_clone(static_cast<int>(slot), rows_of<6>(same, BlockList<BodyPose>{}));
  }

  void add_landmark(const Detection& d) {
    const LandmarkBirth birth(estimate_.T_WB(), RigidPose(estimate_.T_BS), d);
    covariance_.add_landmark(static_cast<int>(estimate_.landmarks.size()),
                             rows_of<3>(birth.d_l, LandmarkBirth::Blocks{}), birth.noise);
    estimate_.landmarks.push_back(
        {birth.p_WL, estimate_.nav.time, Matrix3d::Zero(), estimate_.way});
  }
  /// The last one takes its place.
  void remove_landmark(std::size_t i) {
    covariance_.remove_landmark(static_cast<int>(i));
    estimate_.landmarks[i] = estimate_.landmarks.back();
    estimate_.landmarks.pop_back();
  }

  /// Injects an error in the order of the layout, clones and landmarks included. Calibration stops
  /// at kCalibrationLimit sigmas of its prior.
  void correct(const Eigen::VectorXd& dx) {
    NavState& nav = estimate_.nav;
    nav.q_WB = (nav.q_WB * quaternion_exp(dx.segment<3>(body::kAttitude))).normalized();
    nav.p_WB += dx.segment<3>(body::kPosition);
    nav.v_WB += dx.segment<3>(body::kVelocity);
    nav.gyro_bias += dx.segment<3>(body::kGyroBias);
    nav.accel_bias += dx.segment<3>(body::kAccelBias);
    correct_calibration(dx);
    for (std::size_t i = 0; layout_.max_clones() > 0 && i < estimate_.clones.size(); ++i) {
      RigidPose& pose = estimate_.clones[i].T_WB;
      pose = PoseBlock::retract(pose, dx.segment<6>(layout_.clone(static_cast<int>(i))));
    }
    for (std::size_t i = 0; i < estimate_.landmarks.size(); ++i) {
      estimate_.landmarks[i].p_W += dx.segment<3>(layout_.landmark(static_cast<int>(i)));
    }
  }

 private:
  template <int kDim, class... B>
  std::array<LinearRow, static_cast<std::size_t>(kDim)> rows_of(
      const JacobianOf<kDim, BlockList<B...>::kDof>& J, BlockList<B...> blocks) const {
    return state_rows<kDim>(J, blocks, LinearizationPoint(estimate_), {}, layout_);
  }

  LinearRow doppler_row(const DopplerModel& model, const DopplerModel::Measurement& z,
                        const LinearizationPoint& x) const {
    Evaluation<DopplerModel> e;
    model.evaluate(z, x.T_WB, x.v_WB, x.gyro_bias, x.T_BS, x.radar_errors, e.r, &e.J, e.R);
    return state_rows<1>(e.J, DopplerModel::Blocks{}, x, {}, layout_)[0];
  }

  /// Fills what matching needs to know of the landmarks.
  void predict_landmarks() {
    const LinearizationPoint x(estimate_);
    for (std::size_t i = 0; i < estimate_.landmarks.size(); ++i) {
      LandmarkState& landmark = estimate_.landmarks[i];
      const ObservedPoint point(x.T_WB, x.T_BS, landmark.p_W);
      landmark.covariance_S = covariance_.covariance_of(
          state_rows<3>(point.d_e, ObservedPoint::Blocks{}, x, {0, static_cast<int>(i)}, layout_));
    }
  }

  void correct_calibration(const Eigen::VectorXd& dx) {
    const CalibrationOptions& priors = options_.calibration;
    const auto limited = [](double value, double sigma) {
      return std::clamp(value, -kCalibrationLimit * sigma, kCalibrationLimit * sigma);
    };
    if (layout_.has_extrinsics()) {
      const Pose& told = options_.radar.T_BS;
      Pose& T_BS = estimate_.T_BS;
      const int at = layout_.extrinsics();
      T_BS.rotation = (T_BS.rotation * quaternion_exp(dx.segment<3>(at))).normalized();
      T_BS.translation += dx.segment<3>(at + 3);
      Vector3d turn = quaternion_log(told.rotation.conjugate() * T_BS.rotation);
      Vector3d shift = T_BS.translation - told.translation;
      for (double& angle : turn) angle = limited(angle, priors.rotation_sigma);
      for (double& length : shift) length = limited(length, priors.translation_sigma);
      T_BS = {(told.rotation * quaternion_exp(turn)).normalized(), told.translation + shift};
    }
    if (layout_.has_radar_errors()) {
      RadarErrors::Value& errors = estimate_.radar_errors;
      errors += dx.segment<2>(layout_.radar_errors());
      errors[RadarErrors::kDopplerScale] =
          limited(errors[RadarErrors::kDopplerScale], priors.doppler_scale_sigma);
      errors[RadarErrors::kElevation] =
          limited(errors[RadarErrors::kElevation], priors.elevation_bias_sigma);
    }
    if (layout_.has_time_offset()) {
      estimate_.time_offset =
          limited(estimate_.time_offset + dx[layout_.time_offset()], priors.time_offset_sigma);
    }
  }

  Options options_;
  Layout layout_;
  Estimate estimate_;
  Covariance covariance_;
  Acceleration acceleration_;
};

}  // namespace rio
