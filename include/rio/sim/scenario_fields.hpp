// SPDX-License-Identifier: BSD-3-Clause
// The table of all fields of a scenario: key, unit, meaning, allowed range. Scenario files and `rio
// scenarios NAME` are loops over it. Scenario::start is not listed, since it only shifts the
// stamps. The lower bounds prevent divisions by zero and paths that never end.
#pragma once

#include <concepts>
#include <limits>
#include <numbers>
#include <type_traits>

#include "rio/core/field.hpp"
#include "rio/sim/scenario.hpp"

namespace rio::sim {

/// Calls visit(FieldInfo, field) for every field in file order. Field types: std::uint64_t, double,
/// int, bool, std::string, Vector3d, Quaternion. `s` is Scenario or const Scenario.
template <class ScenarioT, class Visitor>
requires std::same_as<std::remove_const_t<ScenarioT>, Scenario>
void visit_fields(ScenarioT& s, Visitor&& visit) {
  constexpr double kPi = std::numbers::pi;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr double kLargestSeed = 18446744073709551615.0;
  const auto field = [&visit](const char* key, auto& value, const char* unit, double min,
                              double max, const char* doc) {
    visit(FieldInfo{key, unit, doc, min, max}, value);
  };

  field("seed", s.seed, "", 0, kLargestSeed, "Varies path, room and noise.");
  field("max_duration", s.max_duration, "s", 1, kInfinity,
        "The flight is cut here; inf = it is not.");

  field("path.file", s.path.file, "", 0, 0,
        "Recorded path flown instead of a random one: TUM, EuRoC csv or dataset folder.");
  field("path.ground", s.path.ground, "", 0, 1,
        "A vehicle that drives on level ground, nose ahead, and does not return.");
  field("path.length", s.path.length, "m", 0, 10000,
        "Length of the whole path; 0 = it ends by path.duration.");
  field("path.duration", s.path.duration, "s", 0, 86400,
        "With path.length 0: time before the flight turns home.");
  field("path.low", s.path.low, "m", -1000, 1000, "Corner of the box of way points.");
  field("path.high", s.path.high, "m", -1000, 1000, "Opposite corner.");
  field("path.reach", s.path.reach, "m", 0.1, 1000, "Longest leg along each axis.");
  field("path.min_speed", s.path.min_speed, "m/s", 0.01, 30, "Slowest leg.");
  field("path.max_speed", s.path.max_speed, "m/s", 0.01, 30, "Fastest leg.");
  field("path.min_leg", s.path.min_leg, "s", 0.1, 600,
        "A leg ends at its target, or after a time between this ...");
  field("path.max_leg", s.path.max_leg, "s", 0.1, 600, "... and this.");
  field("path.max_yaw", s.path.max_yaw, "rad", 0, 2 * kPi,
        "The nose swings between minus and plus this.");
  field("path.max_yaw_rate", s.path.max_yaw_rate, "rad/s", 0, 10, "Fastest swing of the nose.");
  field("path.knot_spacing", s.path.knot_spacing, "s", 0.1, 10,
        "Between control points of the spline; longer is smoother.");
  field("path.fit_spacing", s.path.fit_spacing, "s", 0.05, 5,
        "The same for a recorded path; longer averages more of its noise.");
  field("path.stand_before", s.path.stand_before, "s", 0, 600, "Standstill before take-off.");
  field("path.stand_after", s.path.stand_after, "s", 0, 600, "Standstill after landing.");

  field("imu.rate_hz", s.imu.rate_hz, "Hz", 10, 10000, "Samples a second.");
  field("imu.gyro_noise_density", s.imu.gyro_noise_density, "rad/s/sqrt(Hz)", 0, 1,
        "White noise of the gyroscope.");
  field("imu.gyro_random_walk", s.imu.gyro_random_walk, "rad/s^2/sqrt(Hz)", 0, 1,
        "Random walk of the gyroscope bias.");
  field("imu.gyro_turn_on_sigma", s.imu.gyro_turn_on_sigma, "rad/s", 0, 1,
        "First gyroscope bias, per axis.");
  field("imu.gyro_vibration", s.imu.gyro_vibration, "rad/s", 0, 100,
        "Amplitude per axis while flying.");
  field("imu.gyro_limit", s.imu.gyro_limit, "rad/s", 0.1, 1000, "Saturation of the gyroscope.");
  field("imu.accel_noise_density", s.imu.accel_noise_density, "m/s^2/sqrt(Hz)", 0, 10,
        "White noise of the accelerometer.");
  field("imu.accel_random_walk", s.imu.accel_random_walk, "m/s^3/sqrt(Hz)", 0, 10,
        "Random walk of the accelerometer bias.");
  field("imu.accel_turn_on_sigma", s.imu.accel_turn_on_sigma, "m/s^2", 0, 10,
        "First accelerometer bias, per axis.");
  field("imu.accel_vibration", s.imu.accel_vibration, "m/s^2", 0, 1000,
        "Amplitude per axis while flying.");
  field("imu.accel_limit", s.imu.accel_limit, "m/s^2", 1, 10000,
        "Saturation of the accelerometer.");
  field("imu.vibration_frequency_hz", s.imu.vibration_frequency_hz, "Hz", 0, 10000,
        "Of the first rotor; the others are 3 % apart.");
  field("imu.stamp_jitter", s.imu.stamp_jitter, "s", 0, 0.1,
        "Standard deviation of the stamps; at most half a period is used.");
  field("imu.low.frequency_hz", s.imu.low.frequency_hz, "Hz", 0, 10000,
        "One shaking of the frame: centre of its spectrum.");
  field("imu.low.width_hz", s.imu.low.width_hz, "Hz", 0.01, 10000, "Half width at half power.");
  field("imu.low.gyro_rest", s.imu.low.gyro_rest, "rad/s", 0, 100, "RMS per axis at rest.");
  field("imu.low.gyro_moving", s.imu.low.gyro_moving, "rad/s", 0, 100, "Same in motion.");
  field("imu.low.accel_rest", s.imu.low.accel_rest, "m/s^2", 0, 1000, "RMS per axis at rest.");
  field("imu.low.accel_moving", s.imu.low.accel_moving, "m/s^2", 0, 1000, "Same in motion.");
  field("imu.high.frequency_hz", s.imu.high.frequency_hz, "Hz", 0, 10000,
        "Another one: centre of its spectrum.");
  field("imu.high.width_hz", s.imu.high.width_hz, "Hz", 0.01, 10000, "Half width at half power.");
  field("imu.high.gyro_rest", s.imu.high.gyro_rest, "rad/s", 0, 100, "RMS per axis at rest.");
  field("imu.high.gyro_moving", s.imu.high.gyro_moving, "rad/s", 0, 100, "Same in motion.");
  field("imu.high.accel_rest", s.imu.high.accel_rest, "m/s^2", 0, 1000, "RMS per axis at rest.");
  field("imu.high.accel_moving", s.imu.high.accel_moving, "m/s^2", 0, 1000, "Same in motion.");
  field("imu.shaking_speed", s.imu.shaking_speed, "m/s", 0.01, 100,
        "From which on the frame shakes as when moving.");
  field("imu.shaking_spread", s.imu.shaking_spread, "", 0, 3,
        "Of the logarithm of the rms in motion: the ground changes.");
  field("imu.shaking_time", s.imu.shaking_time, "s", 1e-3, 1000, "e-folding time of that.");
  field("imu.lost_share", s.imu.lost_share, "", 0, 0.9, "Of the samples.");
  field("imu.lost_run", s.imu.lost_run, "", 1, 1000, "Mean number of neighbours lost together.");
  field("imu.lost_filled", s.imu.lost_filled, "", 0, 1,
        "Lost samples are put on the line between their neighbours; else they are gone.");

  field("radar.T_BS.translation", s.radar.T_BS.translation, "m", -100, 100,
        "True position of the radar in the body frame.");
  field("radar.T_BS.quaternion_wxyz", s.radar.T_BS.rotation, "", -1, 1,
        "True rotation that takes radar axes to body axes.");
  field("radar.rate_hz", s.radar.rate_hz, "Hz", 0.1, 1000, "Scans a second.");
  field("radar.min_range", s.radar.min_range, "m", 0.01, 1000, "Nothing nearer is seen.");
  field("radar.max_range", s.radar.max_range, "m", 0.01, 1000, "Nothing farther is seen.");
  field("radar.fov_azimuth", s.radar.fov_azimuth, "rad", 0.01, kPi,
        "Full width of the field of view.");
  field("radar.fov_elevation", s.radar.fov_elevation, "rad", 0.01, kPi,
        "Full height of the field of view.");
  field("radar.range_resolution", s.radar.range_resolution, "m", 1e-3, 10,
        "Cell and grid of the range.");
  field("radar.max_doppler", s.radar.max_doppler, "m/s", 0.01, 100, "Unambiguous radial speed.");
  field("radar.doppler_resolution", s.radar.doppler_resolution, "m/s", 1e-3, 10,
        "Cell and grid of the Doppler.");
  field("radar.quantize", s.radar.quantize, "", 0, 1, "Snap range and Doppler to their grids.");
  field("radar.ambiguous", s.radar.ambiguous, "", 0, 1,
        "Fold the Doppler beyond radar.max_doppler.");
  field("radar.sigma_range", s.radar.sigma_range, "m", 1e-4, 10, "Noise of the range.");
  field("radar.sigma_azimuth", s.radar.sigma_azimuth, "rad", 0, 1,
        "Noise of azimuth at boresight.");
  field("radar.sigma_elevation", s.radar.sigma_elevation, "rad", 0, 1,
        "Noise of elevation at boresight.");
  field("radar.sigma_doppler", s.radar.sigma_doppler, "m/s", 1e-4, 10,
        "Noise of the Doppler, before the grid.");
  field("radar.fresh_noise", s.radar.fresh_noise, "", 0, 1,
        "Part of the noise of a point that is new in every scan; the rest lasts like fading.");
  field("radar.noise_distance", s.radar.noise_distance, "m", 1e-4, 100,
        "E-folding distance of the rest of the noise.");
  field("radar.angle_grid", s.radar.angle_grid, "", 0, 1,
        "Grid of the direction cosines y/r and z/r; 0 = none.");
  field("radar.weak_angle_growth", s.radar.weak_angle_growth, "", 0, 100,
        "The angle variance is 1 + this times as large at the detection threshold.");
  field("radar.snr_1m_db", s.radar.snr_1m_db, "dB", -100, 200, "Of 0 dBsm at 1 m on boresight.");
  field("radar.edge_loss_db", s.radar.edge_loss_db, "dB", 0, 100,
        "Two-way antenna loss at the edge of the field of view.");
  field("radar.threshold_db", s.radar.threshold_db, "dB", -100, 200, "Detection threshold.");
  field("radar.fading_sigma_db", s.radar.fading_sigma_db, "dB", 0, 30,
        "Interference; changes as the radar moves.");
  field("radar.fading_distance", s.radar.fading_distance, "m", 1e-3, 100,
        "e-folding distance of fading and wander.");
  field("radar.flicker_sigma_db", s.radar.flicker_sigma_db, "dB", 0, 30,
        "Changes with every scan.");
  field("radar.wander_sigma", s.radar.wander_sigma, "m", 0, 1,
        "Scattering centre about its mean, per axis.");
  field("radar.outlier_share", s.radar.outlier_share, "", 0, 0.95,
        "Ghosts and false alarms, of all detections.");
  field("radar.false_alarm_share", s.radar.false_alarm_share, "", 0, 1,
        "Of the outliers; the others are ghosts.");
  field("radar.max_static", s.radar.max_static, "", 1, 1000,
        "Static detections kept, the strongest.");
  field("radar.specular", s.radar.specular, "", 0, 1,
        "Highlights on walls and edges ride along with the radar.");
  field("radar.people", s.radar.people, "", 0, 100, "People who walk about.");
  field("radar.person_rcs_dbsm", s.radar.person_rcs_dbsm, "dB", -100, 100,
        "Mean cross section of a scatterer of a person, over 1 m^2.");
  field("radar.burst_outlier_share", s.radar.burst_outlier_share, "", 0, 0.95,
        "Outliers of all detections during a burst.");
  field("radar.own_echoes", s.radar.own_echoes, "", 0, 100,
        "Places on the vehicle itself in view, at rest to the radar.");
  field("radar.own_echo_share", s.radar.own_echo_share, "", 0, 1,
        "Of the scans in which each of them shows.");
  field("radar.doppler_slip_share", s.radar.doppler_slip_share, "", 0, 1,
        "Of the points between two Doppler cells, read in the wrong one.");
  field("radar.lobe_width", s.radar.lobe_width, "rad", 0, kPi,
        "Aspect at which the echo of a reflector is 3 dB down; 0 = seen alike from everywhere.");
  field("radar.lost_share", s.radar.lost_share, "", 0, 0.9,
        "Of the scans, lost on their way to the host.");
  field("radar.doppler_scale", s.radar.doppler_scale, "", -0.5, 0.5,
        "Relative error of the reported range rates.");
  field("radar.elevation_bias", s.radar.elevation_bias, "rad", -0.5, 0.5,
        "Added to every elevation.");
  field("radar.scene_angle", s.radar.scene_angle, "rad", 0, 0.5,
        "Error of azimuth and elevation that all points of a scene share, as by multipath.");
  field("radar.scene_distance", s.radar.scene_distance, "m", 1e-3, 1000,
        "E-folding distance of that error.");
  field("radar.stamp_offset", s.radar.stamp_offset, "s", -1, 1, "The stamps are late by this.");
  field("radar.latency", s.radar.latency, "s", 0, 10,
        "From the measurement to the arrival of a scan; acts in experiments, not in recordings.");

  field("room.low_W", s.room.low_W, "m", -1000, 1000,
        "Corner of the room, which grows with the path; its floor is the ground.");
  field("room.high_W", s.room.high_W, "m", -1000, 1000, "Opposite corner.");
  field("room.floor_density", s.room.floor_density, "1/m^2", 0, 1000, "Reflectors on the floor.");
  field("room.wall_density", s.room.wall_density, "1/m^2", 0, 1000, "Reflectors on the walls.");
  field("room.ceiling_density", s.room.ceiling_density, "1/m^2", 0, 1000,
        "Reflectors on the ceiling.");
  field("room.mat_density", s.room.mat_density, "1/m^2", 0, 1000,
        "Fine texture of the floor where take-off happens.");
  field("room.mat_half_width", s.room.mat_half_width, "m", 0, 100,
        "Of the square of that texture about the origin.");
  field("room.clutter_density", s.room.clutter_density, "1/m^2", 0, 1000,
        "Furniture and fittings, mostly near walls, over the area of the floor.");
  field("room.surface_rcs_dbsm", s.room.surface_rcs_dbsm, "dB", -100, 100,
        "Mean cross section on floor, walls and ceiling, over 1 m^2.");
  field("room.mat_rcs_dbsm", s.room.mat_rcs_dbsm, "dB", -100, 100, "The same of the texture.");
  field("room.clutter_rcs_dbsm", s.room.clutter_rcs_dbsm, "dB", -100, 100,
        "The same of furniture and fittings.");
  field("room.rcs_sigma_db", s.room.rcs_sigma_db, "dB", 0, 30,
        "Standard deviation of every cross section.");

  field("disturbances.bursts.count", s.disturbances.bursts.count, "", 0, 1000,
        "Spells of many outliers, spread evenly; see radar.burst_outlier_share.");
  field("disturbances.bursts.duration", s.disturbances.bursts.duration, "s", 0, 600, "Of each.");
  field("disturbances.outages.count", s.disturbances.outages.count, "", 0, 1000,
        "Spells in which the radar is silent.");
  field("disturbances.outages.duration", s.disturbances.outages.duration, "s", 0, 600, "Of each.");
  field("disturbances.imu_gaps.count", s.disturbances.imu_gaps.count, "", 0, 1000,
        "Spells in which the IMU is silent.");
  field("disturbances.imu_gaps.duration", s.disturbances.imu_gaps.duration, "s", 0, 600,
        "Of each.");

  field("told.extrinsic_angle", s.errors.extrinsic_angle, "rad", 0, kPi,
        "Error of the configured mounting, about a random axis.");
  field("told.extrinsic_distance", s.errors.extrinsic_distance, "m", 0, 100,
        "Error of the configured lever arm, in a random direction.");
  field("told.start_velocity", s.errors.start_velocity, "m/s", -100, 100,
        "Error of the velocity it is started with; 0 = it aligns itself while standing.");
  field("told.start_tilt", s.errors.start_tilt, "rad", -kPi, kPi,
        "Error of the attitude it is started with, about the body's x axis.");
  field("told.start_velocity_sigma", s.errors.start_velocity_sigma, "m/s", 1e-3, 100,
        "Sigma configured for that error, per axis.");
}

}  // namespace rio::sim
