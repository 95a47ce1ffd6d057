// SPDX-License-Identifier: BSD-3-Clause
// Of the state estimate: the calibration of the radars and the rotation of their scenes.
#include <algorithm>
#include <array>

#include "rio/core/so3.hpp"
#include "rio/state/calibration.hpp"
#include "rio/update/state_estimate.hpp"

namespace rio {

void StateEstimate::set_mounting(std::size_t r, const Mounting& mounting) {
  RadarState radar = estimate_.of_radar(r);
  radar.T_BS = mounting.T_BS;
  radar.mounting = mounting.T_BS.rotation;
  estimate_.set_radar(r, radar);
  const auto [rotation, translation] = mounting_columns(r);
  covariance_.replace({rotation, translation}, mounting.covariance.topLeftCorner<6, 6>());
  draw_scene(r);
}

void StateEstimate::set_mounting_and_motion(std::size_t r, const Mounting& mounting) {
  set_mounting(r, mounting);
  NavState& nav = estimate_.nav;
  nav.p_WB += mounting.position_error_W;
  nav.v_WB += mounting.velocity_error_W;
  const auto [rotation, translation] = mounting_columns(r);
  covariance_.replace({rotation, translation, body::kPosition, body::kVelocity},
                      mounting.covariance);
  draw_scene(r);
  restart_steady_motion(nav.q_WB.conjugate() * nav.v_WB);
}

std::array<int, 2> StateEstimate::mounting_columns(std::size_t r) const {
  const Layout layout = layout_.of_radar(r);
  return {calibration_column(layout, 0), layout.extrinsics() + 3};
}

Eigen::Matrix4d StateEstimate::velocity_calibration() const {
  Eigen::Matrix4d P = Eigen::Matrix4d::Zero();
  const auto all = covariance_.matrix();
  if (layout_.has_extrinsics()) {
    P.topLeftCorner<3, 3>() = all.block<3, 3>(layout_.extrinsics(), layout_.extrinsics());
  }
  if (layout_.has_doppler_scale()) {
    P(3, 3) = all(layout_.doppler_scale(), layout_.doppler_scale());
  }
  return P;
}

void StateEstimate::count_points(std::size_t points) {
  constexpr double kScans = 20.0;  // in the mean: a second or two
  const double counted = std::max(1.0, static_cast<double>(points));
  estimate_.points += (counted - estimate_.points) / kScans;
}

SceneStep StateEstimate::scene_step(std::size_t r, double distance) const {
  return {distance, options_.calibration.scene_sigma, estimate_.of_radar(r).points};
}

void StateEstimate::draw_scene(std::size_t r) {
  if (!layout_.has_mounting()) return;
  RadarState radar = estimate_.of_radar(r);
  radar.T_BS.rotation = radar.mounting;
  estimate_.set_radar(r, radar);
  const Layout layout = layout_.of_radar(r);
  covariance_.relax(layout.extrinsics(), layout.mounting(), 0.0,
                    scene_variance(options_.calibration.scene_sigma, radar.points));
}

void StateEstimate::change_scene(double distance) {
  for (std::size_t r = 0; layout_.has_mounting() && r < options_.radars(); ++r) {
    RadarState radar = estimate_.of_radar(r);
    const SceneStep step = scene_step(r, distance);
    step.apply(&radar);
    estimate_.set_radar(r, radar);
    const Layout layout = layout_.of_radar(r);
    covariance_.relax(layout.extrinsics(), layout.mounting(), step.decay, step.variance);
  }
}

void StateEstimate::correct_calibration(std::size_t r, const Eigen::VectorXd& dx) {
  const Layout layout = layout_.of_radar(r);
  CalibrationVector step = CalibrationVector::Zero();
  for (int i = 0; i < step.size(); ++i) {
    const int column = calibration_column(layout, i);
    if (column >= 0) step[i] = dx[column];
  }
  const RadarState configured = configured_state(options_.mount(r));
  const CalibrationVector limits = kCalibrationLimit * calibration_sigmas(options_.calibration);
  const CalibrationVector total =
      corrections_between(configured, corrected(estimate_.of_radar(r), step));
  RadarState now = corrected(configured, total.cwiseMin(limits).cwiseMax(-limits));
  const RadarState before = estimate_.of_radar(r);
  now.points = before.points;
  if (layout.has_mounting()) {
    const Quaternion turn = quaternion_exp(dx.segment<3>(layout.extrinsics()));
    now.T_BS.rotation = (before.T_BS.rotation * turn).normalized();
  }
  estimate_.set_radar(r, now);
}

}  // namespace rio
