// SPDX-License-Identifier: BSD-3-Clause
// The table of the option fields: key, unit, meaning, allowed range. Validation, option files and
// `rio options` are loops over it. What only the presets set, and what only the library sets, have
// tables of their own: validated, but not in files. Not listed: TimingOptions::clock (a function)
// and switches for experiments (CheckOptions::landmarks, AblationOptions). C++17.
//
// Two layers: `field` is what a user knows of the vehicle (sensors, mounting, priors, start,
// budgets), `inner` is the algorithm and what presets differ in.
#pragma once

#include <array>
#include <string_view>
#include <type_traits>

#include "rio/core/field.hpp"
#include "rio/options.hpp"

namespace rio {

/// Capacities fixed at compile time; odometry/options.cpp checks that they agree with the stages.
namespace option_limits {
inline constexpr int kDetections = 1024;
inline constexpr int kClones = 20;
inline constexpr int kLandmarks = 64;
}  // namespace option_limits

/// Calls visit(FieldInfo, field) for every field in file order. Field types: double, int, bool,
/// the enumerations of Options, Vector3d, Quaternion. `o` is Options or const Options.
template <class OptionsT, class Visitor>
std::enable_if_t<std::is_same_v<std::remove_const_t<OptionsT>, Options>> visit_fields(
    OptionsT& o, Visitor&& visit) {
  constexpr double kPi = 3.14159265358979323846;
  const auto field = [&visit](const char* key, auto& value, const char* unit, double min,
                              double max, const char* doc) {
    visit(FieldInfo{key, unit, doc, min, max}, value);
  };
  const auto inner = [&visit](const char* key, auto& value, const char* unit, double min,
                              double max, const char* doc) {
    visit(FieldInfo{key, unit, doc, min, max, Layer::kAlgorithm}, value);
  };

  inner("backend", o.backend, "", 0, 1, "ekf or smoother.");

  field("imu.gyro_noise_density", o.imu.gyro_noise_density, "rad/s/sqrt(Hz)", 0, 1,
        "White noise of the gyroscope.");
  field("imu.gyro_random_walk", o.imu.gyro_random_walk, "rad/s^2/sqrt(Hz)", 0, 1,
        "Random walk of the gyroscope bias.");
  field("imu.accel_noise_density", o.imu.accel_noise_density, "m/s^2/sqrt(Hz)", 0, 10,
        "White noise of the accelerometer.");
  field("imu.accel_random_walk", o.imu.accel_random_walk, "m/s^3/sqrt(Hz)", 0, 10,
        "Random walk of the accelerometer bias.");
  inner("imu.stamp_sigma", o.imu.stamp_sigma, "s", 0, 0.1,
        "Jitter of the stamps; under vibration it adds noise.");
  field("imu.max_rate", o.imu.max_rate, "rad/s", 0.1, 1e4,
        "Range of the gyroscope: samples beyond it are left out.");
  field("imu.max_accel", o.imu.max_accel, "m/s^2", 1, 1e5,
        "Range of the accelerometer: samples beyond it are left out.");
  field("imu.gravity", o.imu.gravity, "m/s^2", 0.1, 30, "Gravity, along -z of the world.");
  inner("imu.max_gap", o.imu.max_gap, "s", 1e-3, 10, "A longer pause between samples is a gap.");

  field("radar.T_BS.translation", o.radar.T_BS.translation, "m", -100, 100,
        "Position of the radar in the body frame.");
  field("radar.T_BS.quaternion_wxyz", o.radar.T_BS.rotation, "", -1, 1,
        "Rotation that takes radar axes to body axes.");
  field("radar.min_range", o.radar.min_range, "m", 0.01, 1000, "Nearer detections are dropped.");
  field("radar.max_range", o.radar.max_range, "m", 0.01, 1000, "Farther detections are dropped.");
  field("radar.min_snr_db", o.radar.min_snr_db, "dB", -200, 200, "Weaker detections are dropped.");
  field("radar.fov_azimuth", o.radar.fov_azimuth, "rad", 0.01, kPi,
        "Full width of the field of view used.");
  field("radar.fov_elevation", o.radar.fov_elevation, "rad", 0.01, kPi,
        "Full height of the field of view used.");
  field("radar.sigma_range", o.radar.sigma_range, "m", 1e-4, 10, "Noise of the range.");
  field("radar.sigma_azimuth", o.radar.sigma_azimuth, "rad", 1e-5, 1,
        "Noise of azimuth at boresight.");
  field("radar.sigma_elevation", o.radar.sigma_elevation, "rad", 1e-5, 1,
        "Noise of elevation at boresight.");
  inner("radar.weak_snr_db", o.radar.weak_snr_db, "dB", -200, 200,
        "An echo this weak has twice the angle variance of a strong one; -200 = all are alike.");
  field("radar.sigma_doppler", o.radar.sigma_doppler, "m/s", 1e-4, 10,
        "Noise of the Doppler, without quantisation.");
  field("radar.range_resolution", o.radar.range_resolution, "m", 0, 10,
        "Grid of the range, adds grid^2/12 to the variance; 0 = none.");
  field("radar.doppler_resolution", o.radar.doppler_resolution, "m/s", 0, 10,
        "Grid of the Doppler, adds grid^2/12 to the variance; 0 = none.");
  field("radar.max_doppler", o.radar.max_doppler, "m/s", 0, 1000,
        "Range rates fold into plus or minus this; 0 = they do not fold.");
  inner("radar.noise_distance", o.radar.noise_distance, "m", 0, 10,
        "E-folding distance of the errors of a point; 0 = they are new in every scan.");
  field("radar.time_offset", o.radar.time_offset, "s", -1, 1, "Delay of the radar's stamps.");
  field("radar.doppler_scale", o.radar.doppler_scale, "", -0.2, 0.2,
        "Relative error of the Doppler; positive = too large.");

  field("frontend.max_detections", o.frontend.max_detections, "", 5, option_limits::kDetections,
        "Detections used per scan; of more, the strongest are kept.");
  inner("frontend.ransac_threshold", o.frontend.ransac_threshold, "m/s", 1e-3, 10,
        "The Doppler residual of an inlier is below this, or in `default` below three of its "
        "sigmas.");
  inner("frontend.ransac_seed", o.frontend.ransac_seed, "", 0, 2147483647,
        "Seed of the deterministic generator.");

  inner("update.use_doppler", o.update.use_doppler, "", 0, 1, "Use the Doppler model.");
  inner("update.use_trails", o.update.use_trails, "", 0, 1, "Use distances to trails.");
  inner("update.use_landmarks", o.update.use_landmarks, "", 0, 1, "Use persistent landmarks.");
  inner("update.max_clones", o.update.max_clones, "", 0, option_limits::kClones,
        "Past poses kept, of each radar.");
  inner("update.max_landmarks", o.update.max_landmarks, "", 0, option_limits::kLandmarks,
        "Persistent landmarks kept.");

  field("calibration.rotation_sigma", o.calibration.rotation_sigma, "rad", 0, kPi,
        "Prior of the radar's rotation per axis; 0 = not estimated, above 1 = sought in flight.");
  field("calibration.translation_sigma", o.calibration.translation_sigma, "m", 0, 10,
        "Prior of the radar's position per axis; 0 = not estimated.");
  field("calibration.time_offset_sigma", o.calibration.time_offset_sigma, "s", 0, 0.1,
        "Prior of the delay of the radar's stamps; 0 = not estimated.");
  field("calibration.doppler_scale_sigma", o.calibration.doppler_scale_sigma, "", 0, 0.1,
        "Prior of the relative error of the Doppler; 0 = not estimated.");

  field("smoother.window", o.smoother.window, "", 2, option_limits::kClones - 1,
        "States of the sliding window.");
  inner("smoother.max_iterations", o.smoother.max_iterations, "", 1, 100,
        "Gauss-Newton steps per scan, at most.");
  inner("smoother.tolerance", o.smoother.tolerance, "", 1e-12, 10,
        "Length of a step that counts as converged, in sigmas.");
  inner("smoother.kernel", o.smoother.kernel, "", 0, 3, "none, huber, cauchy or dcs.");

  field("start.static_alignment", o.start.static_alignment, "", 0, 1,
        "Align while standing; false = wait for a given start.");
  inner("start.duration", o.start.duration, "s", 0.1, 600, "Length of the standstill averaged.");
  field("start.max_wait", o.start.max_wait, "s", 0, 3600,
        "Wait for a standstill, then start in motion; 0 = wait for ever.");
  inner("start.max_rate", o.start.max_rate, "rad/s", 1e-5, 10,
        "Standstill: largest mean rate that can be a bias.");
  field("start.sigma_position", o.start.sigma_position, "m", 0, 1000, "Position, per axis.");
  field("start.sigma_yaw", o.start.sigma_yaw, "rad", 0, kPi, "Heading.");
  field("start.sigma_tilt", o.start.sigma_tilt, "rad", 0, kPi, "Roll and pitch of a given start.");
  field("start.sigma_velocity", o.start.sigma_velocity, "m/s", 0, 100, "Velocity, per axis.");
  field("start.sigma_gyro_bias", o.start.sigma_gyro_bias, "rad/s", 0, 1,
        "Gyroscope bias per axis, when there was no standstill.");
  field("start.sigma_accel_bias", o.start.sigma_accel_bias, "m/s^2", 1e-4, 10,
        "Accelerometer bias, per axis.");

  inner("timing.imu_buffer", o.timing.imu_buffer, "", 16, 1000000,
        "IMU samples kept between the estimate and now.");
  inner("timing.scan_queue", o.timing.scan_queue, "", 1, 1000, "Scans that may wait for the IMU.");
  inner("timing.max_lag", o.timing.max_lag, "s", 0.01, 60,
        "The estimate follows the IMU at most this far behind.");
  inner("timing.max_pause", o.timing.max_pause, "s", 0.5, 3600,
        "A longer pause of the IMU is a jump of its clock.");
  field("timing.aiding_delay", o.timing.aiding_delay, "s", 0, 2,
        "How long after the estimate has passed its time an aiding measurement is accepted.");
}

/// Same for what only the presets set: not in files, but validated and in their table.
template <class OptionsT, class Visitor>
std::enable_if_t<std::is_same_v<std::remove_const_t<OptionsT>, Options>> visit_preset_fields(
    OptionsT& o, Visitor&& visit) {
  const auto field = [&visit](const char* key, auto& value, const char* unit, double min,
                              double max, const char* doc) {
    visit(FieldInfo{key, unit, doc, min, max, Layer::kAlgorithm}, value);
  };
  field("imu.measure_noise", o.imu.measure_noise, "", 0, 1,
        "Use the noise measured in the samples if it exceeds the declared white noise.");
  field("radar.angle_growth", o.radar.angle_growth, "", 0, 1,
        "The angle sigmas grow off boresight as 1/cos.");
  field("update.use_ego_velocity", o.update.use_ego_velocity, "", 0, 1,
        "Use the least-squares velocity of a scan as one measurement (loosely coupled).");
  field("frontend.ransac_sigmas", o.frontend.ransac_sigmas, "", 0, 100,
        "Inlier bound in sigmas, direction error included; 0 = off.");
  field("frontend.ransac_use_prediction", o.frontend.ransac_use_prediction, "", 0, 1,
        "The velocity predicted by the IMU is one more hypothesis.");
  field("frontend.mover_sigmas", o.frontend.mover_sigmas, "", 0, 100,
        "A trail whose Doppler residuals add up to this many sigmas is a mover; 0 = off.");
  field("frontend.mover_extent", o.frontend.mover_extent, "m", 0, 10,
        "Detections this near to an outlier may belong to the same moving body; 0 = off.");
  field("frontend.own_echoes", o.frontend.own_echoes, "", 0, 1,
        "Leave out echoes of the vehicle itself: points that always have zero Doppler.");
  field("frontend.ransac_outlier_ratio", o.frontend.ransac_outlier_ratio, "", 0, 0.8,
        "Share of outliers that sets the number of iterations.");
  field("frontend.detect_rest", o.frontend.detect_rest, "", 0, 1,
        "Zero-velocity and zero-rate updates while standing on the ground.");
  field("frontend.unwrap_doppler", o.frontend.unwrap_doppler, "", 0, 1,
        "Undo the folding of range rates at radar.max_doppler.");
  field("frontend.matching", o.frontend.matching, "", 0, 2,
        "euclidean (Michalczyk et al.), probability (Xu et al.) or mahalanobis.");
  field("frontend.match_gate", o.frontend.match_gate, "m", 1e-3, 100,
        "Euclidean matching: largest distance after alignment.");
  field("frontend.match_probability", o.frontend.match_probability, "", 0.5, 0.9999,
        "Probability and Mahalanobis matching: probability that a right pair passes the gate.");
  field("frontend.match_core", o.frontend.match_core, "", 0.1, 0.9999,
        "Mahalanobis matching: probability that a right pair matches once the radar has moved on.");
  field(
      "frontend.match_margin", o.frontend.match_margin, "", 0, 100,
      "Mahalanobis matching: a landmark's match must be the best by this (chi-squared); 0 = off.");
  field("frontend.promote_after", o.frontend.promote_after, "", 1, 1000,
        "Consecutive matches that make a trail a landmark.");
  field("frontend.landmark_timeout", o.frontend.landmark_timeout, "s", 0, 1000,
        "A landmark not seen for longer is dropped; 0 = at its first miss.");
  field("update.doppler_directions", o.update.doppler_directions, "", 0, 2,
        "Direction errors in the Doppler: exact (ignored), noisy (added to the variance) or "
        "corrected "
        "(errors in variables).");
  field("update.consistent_covariance", o.update.consistent_covariance, "", 0, 1,
        "Re-express the covariance so that yaw and position stay unobservable.");
  field("update.sigma_trail_distance", o.update.sigma_trail_distance, "m", 1e-4, 10,
        "Noise of a distance to an element of a trail.");
  field("update.landmark_measurement", o.update.landmark_measurement, "", 0, 2,
        "distance (Michalczyk et al.), position (Xu et al.) or point: range, direction, Doppler.");
  field("update.match_trust", o.update.match_trust, "", 0.51, 1,
        "Probability that a match with a landmark is right.");
  field("update.landmark_walk", o.update.landmark_walk, "m/sqrt(m)", 0, 10,
        "Walk of a landmark with the distance travelled.");
  field("update.sigma_landmark_distance", o.update.sigma_landmark_distance, "m", 1e-4, 10,
        "Noise of a landmark distance, if that is the measurement.");
  field("update.gate_probability", o.update.gate_probability, "", 0.5, 1,
        "Probability of passing the chi-squared gate; 1 = no gate.");
  field(
      "calibration.walk", o.calibration.walk, "1/sqrt(s)", 0, 1,
      "Random walk of each estimated calibration parameter, in units of its default prior sigma.");
  field("calibration.elevation_sigma", o.calibration.elevation_sigma, "rad", 0, 1,
        "Error common to the elevations of all landmarks, considered, not estimated; 0 = none.");
  field("smoother.kernel_size", o.smoother.kernel_size, "", 1e-6, 1e6,
        "Chi-squared per degree of freedom at which the kernel begins to act.");
  field("smoother.landmark_kernel_size", o.smoother.landmark_kernel_size, "", 0, 1e6,
        "Same for landmarks; 0 = smoother.kernel_size.");
  field("smoother.trail_kernel_size", o.smoother.trail_kernel_size, "", 0, 1e6,
        "Same for trails; 0 = smoother.kernel_size.");
  field("smoother.keep_landmark_factors", o.smoother.keep_landmark_factors, "", 0, 1,
        "A landmark no longer matched stays while states of the window have measured it.");
  field("smoother.factor_reuse", o.smoother.factor_reuse, "", 0, 0.9,
        "A step shorter than this share of the one before reuses its factor; 0 = never.");
  field("checks.velocity", o.checks.velocity, "", 0, 1,
        "Replace a velocity that the Dopplers of a second contradict.");
  field("checks.tilt", o.checks.tilt, "", 0, 1,
        "Replace a tilt that the Dopplers of two seconds contradict.");
  field("checks.heading", o.checks.heading, "", 0, 1,
        "Widen the heading after a step of the gyro bias about the vertical.");
  field("checks.biases", o.checks.biases, "", 0, 1,
        "Widen the biases of the IMU if the velocity drifts.");
  field("checks.position", o.checks.position, "", 0, 1,
        "Widen the position after a doubtful time.");
  field("checks.lost_tilt", o.checks.lost_tilt, "", 0, 1,
        "Restart from the specific force when the tilt is lost.");
}

/// Same for what only a program that links the library sets.
template <class OptionsT, class Visitor>
std::enable_if_t<std::is_same_v<std::remove_const_t<OptionsT>, Options>> visit_library_fields(
    OptionsT& o, Visitor&& visit) {
  visit(FieldInfo{"imu.gap_rate_sigma", "rad/s", "Unknown mean angular rate inside a gap.", 0, 100},
        o.imu.gap_rate_sigma);
  visit(
      FieldInfo{"imu.gap_accel_sigma", "m/s^2", "Unknown mean acceleration inside a gap.", 0, 1000},
      o.imu.gap_accel_sigma);
  visit(FieldInfo{"timing.max_ahead", "s", "A scan farther ahead of the IMU is not waited for.", 0,
                  60},
        o.timing.max_ahead);
  visit(FieldInfo{"timing.scan_wait", "s", "How long a scan is held back for another radar's.", 0,
                  10},
        o.timing.scan_wait);
}

/// The names of the values of an enumeration in files, in order.
constexpr std::array<std::string_view, 3> names_of(Matching) {
  return {"euclidean", "probability", "mahalanobis"};
}
constexpr std::array<std::string_view, 4> names_of(Kernel) {
  return {"none", "huber", "cauchy", "dcs"};
}
constexpr std::array<std::string_view, 2> names_of(BackEnd) {
  return {"ekf", "smoother"};
}
constexpr std::array<std::string_view, 3> names_of(DopplerDirections) {
  return {"exact", "noisy", "corrected"};
}
constexpr std::array<std::string_view, 3> names_of(LandmarkMeasurement) {
  return {"distance", "position", "point"};
}

}  // namespace rio
