// SPDX-License-Identifier: BSD-3-Clause
#include "rio/sim/catalogue.hpp"

namespace rio::sim {

namespace {

/// A radar on the front left of the frame, facing outwards and up.
Pose kart_mount() {
  const Quaternion turn = quaternion_exp(Vector3d(0.0, 0.0, 30.0 * kDegree)) *
                          quaternion_exp(Vector3d(0.0, -25.0 * kDegree, 0.0));
  return {.rotation = turn.normalized(), .translation = {1.2, 0.3, -0.4}};
}

void rough_ground(Scenario* s) {
  s->path.ground = true;
  s->path.length = 35.0;
  s->path.low = {-6.0, -4.0, 0.0};
  s->path.high = {6.0, 4.0, 0.5};
  s->path.reach = {8.0, 6.0, 1.0};
  s->path.min_speed = 0.7;
  s->path.max_speed = 2.0;
  s->path.min_leg = 2.0;
  s->path.max_leg = 6.0;
  s->imu.rate_hz = 100.0;
  s->imu.accel_noise_density = 2e-3;
  s->imu.gyro_vibration = s->imu.accel_vibration = 0.0;
  s->imu.low = {.frequency_hz = 8.0,
                .width_hz = 4.0,
                .gyro_rest = 1e-3,
                .gyro_moving = 0.05,
                .accel_rest = 0.03,
                .accel_moving = 1.8};
  s->imu.high = {.frequency_hz = 28.0,
                 .width_hz = 12.0,
                 .gyro_rest = 1e-3,
                 .gyro_moving = 0.1,
                 .accel_rest = 0.04,
                 .accel_moving = 4.5};
  s->imu.shaking_spread = 0.25;
  s->imu.lost_share = 0.31;
  s->imu.lost_filled = true;
  s->room.low_W = {-9.0, -7.0, -0.8};
  s->room.high_W = {9.0, 7.0, 3.5};
  s->room.floor_density = 4.0;
  s->room.wall_density = 3.0;
  s->room.ceiling_density = 1.0;
  s->room.mat_density = 20.0;
  s->room.clutter_density = 1.0;
  s->room.rcs_sigma_db = 9.0;
  s->radar.T_BS = kart_mount();
  s->radar.rate_hz = 30.0;
  s->radar.max_range = 9.78;
  s->radar.fov_elevation = 110.0 * kDegree;
  s->radar.range_resolution = 0.047;
  s->radar.max_doppler = 7.862;
  s->radar.doppler_resolution = 7.862 / 16.0;
  s->radar.sigma_azimuth = s->radar.sigma_elevation = 2.5 * kDegree;
  s->radar.threshold_db = 15.6;
  s->radar.snr_1m_db = 46.0;
  s->radar.max_static = 16;
  s->radar.false_alarm_share = 0.0;  // it has a high threshold
  s->radar.own_echoes = 3;
  s->radar.own_echo_share = 0.2;
  s->radar.doppler_slip_share = 0.2;
  s->radar.lost_share = 0.02;
}

}  // namespace

const std::vector<CatalogueEntry>& catalogue() {
  static const std::vector<CatalogueEntry> kEntries = {
      {"indoor-1", "by hand in a room, 127.5 m, motion on all axes",
       [](Scenario& s) { s.path.length = kIcraLengths[0]; }},
      {"indoor-2", "the same, 150.5 m", [](Scenario& s) { s.path.length = kIcraLengths[1]; }},
      {"indoor-3", "the same, 158.4 m", [](Scenario& s) { s.path.length = kIcraLengths[2]; }},
      {"indoor-4", "the same, 160.4 m", [](Scenario& s) { s.path.length = kIcraLengths[3]; }},
      {"indoor-5", "the same, 166.7 m", [](Scenario& s) { s.path.length = kIcraLengths[4]; }},
      {"indoor-6", "the same, 168.1 m", [](Scenario& s) { s.path.length = kIcraLengths[5]; }},
      {"indoor-7", "the same, 175 m", [](Scenario& s) { s.path.length = kIcraLengths[6]; }},
      {"hover", "120 s within a few decimetres, slower than the Doppler grid",
       [](Scenario& s) {
         s.path.length = 0.0;
         s.path.duration = 120.0;
         s.path.low = {-0.2, -0.2, 0.8};
         s.path.high = {0.2, 0.2, 1.1};
         s.path.min_speed = 0.02;
         s.path.max_speed = 0.12;
         s.path.max_yaw = 0.2;
         s.path.max_yaw_rate = 0.1;
       }},
      {"aggressive", "150 m through a hall at up to 4 m/s: Doppler folds",
       [](Scenario& s) {
         s.path.low = {-7.0, -5.0, 0.4};
         s.path.high = {7.0, 5.0, 3.0};
         s.path.reach = {10.0, 8.0, 10.0};
         s.path.min_speed = 3.0;
         s.path.max_speed = 4.0;
         s.path.min_leg = 2.0;
         s.path.knot_spacing = 0.8;
         s.room.low_W = {-8.5, -6.5, -0.35};
         s.room.high_W = {8.5, 6.5, 4.5};
         s.room.surface_rcs_dbsm = -26.0;
       }},
      {"people", "people walk about and give 40 % of the points",
       [](Scenario& s) {
         s.radar.people = 10;
         s.radar.max_static = 16;
       }},
      {"sparse", "3 to 8 points a scan",
       [](Scenario& s) {
         s.radar.max_static = 6;
         s.radar.threshold_db = 13.0;
       }},
      {"storm", "three bursts of 4 s with 80 % outliers",
       [](Scenario& s) {
         s.disturbances.bursts = {3, 4.0};
       }},
      {"dropout", "radar silent for 5 s twice, the IMU for 0.2 s in each",
       [](Scenario& s) {
         s.disturbances.outages = {2, 5.0};
         s.disturbances.imu_gaps = {2, 0.2};
       }},
      {"wrong-velocity", "at rest, started with (2, 2, 0) m/s and a sigma of 0.05",
       [](Scenario& s) {
         s.path.length = 60.0;
         s.errors.start_velocity = {2.0, 2.0, 0.0};
       }},
      {"vague-velocity", "the same start with a sigma of 2 m/s",
       [](Scenario& s) {
         s.path.length = 60.0;
         s.errors.start_velocity = {2.0, 2.0, 0.0};
         s.errors.start_velocity_sigma = 2.0;
       }},
      {"extrinsics", "mounting configured 3 deg and 5 cm wrong",
       [](Scenario& s) {
         s.errors.extrinsic_angle = 3.0 * kDegree;
         s.errors.extrinsic_distance = 0.05;
       }},
      {"late-stamps", "radar stamps 30 ms late", [](Scenario& s) { s.radar.stamp_offset = 0.03; }},
      {"miscalibrated", "Doppler 2.8 % too large, elevations 2 deg too high",
       [](Scenario& s) {
         s.radar.doppler_scale = 0.028;
         s.radar.elevation_bias = 2.0 * kDegree;
       }},
      {"scene", "all directions off by 3 deg, other ones every 3 m, as by multipath",
       [](Scenario& s) { s.radar.scene_angle = 3.0 * kDegree; }},
      {"latency", "scans arrive 80 ms after they were measured",
       [](Scenario& s) { s.radar.latency = 0.08; }},
      {"rough-imu", "vibration of 1 g, stamps that jitter by 0.5 ms, worse biases",
       [](Scenario& s) {
         s.imu.accel_vibration = 9.81;
         s.imu.gyro_vibration = 0.2;
         s.imu.stamp_jitter = 0.5e-3;
         s.imu.gyro_turn_on_sigma = 0.02;
         s.imu.accel_turn_on_sigma = 0.2;
       }},
      {"rough-ground", "a kart on rough ground, 35 m: vibration, lost samples, six points a scan",
       [](Scenario& s) { rough_ground(&s); }},
      {"outdoor", "300 m over open ground, points up to 40 m away",
       [](Scenario& s) {
         s.path.length = 300.0;
         s.path.low = {-20.0, -20.0, 2.0};
         s.path.high = {20.0, 20.0, 6.0};
         s.path.reach = {12.0, 12.0, 10.0};
         s.path.min_speed = 0.8;
         s.path.max_speed = 3.0;
         s.path.min_leg = 2.5;
         s.path.max_leg = 6.0;
         s.path.knot_spacing = 0.8;
         s.room.low_W = {-35.0, -35.0, -0.35};
         s.room.high_W = {35.0, 35.0, 14.0};
         s.room.floor_density = 2.0;
         s.room.wall_density = 1.0;
         s.room.ceiling_density = 0.0;
         s.room.clutter_density = 0.1;
         s.room.surface_rcs_dbsm = -15.0;
         s.room.clutter_rcs_dbsm = -3.0;
         s.radar.T_BS = default_radar_mount(20.0 * kDegree);
         s.radar.snr_1m_db = 60.0;
         s.radar.max_range = 40.0;
         s.radar.range_resolution = 0.1;
         s.radar.max_doppler = 4.0;
         s.radar.doppler_resolution = 0.125;
       }},
      {"long", "20 minutes in the room, about 900 m",
       [](Scenario& s) {
         s.path.length = 0.0;
         s.path.duration = 1200.0;
       }},
      {"ideal", "noise exactly as a filter models it, 150 m",
       [](Scenario& s) { s = Scenario::ideal(); }},
      {"monte-carlo", "the same, 40 m: for many runs",
       [](Scenario& s) {
         s = Scenario::ideal();
         s.path.length = 40.0;
       }},
  };
  return kEntries;
}

bool scenario(const std::string& name, Scenario* out) {
  for (const CatalogueEntry& entry : catalogue()) {
    if (name != entry.name) continue;
    Scenario chosen;
    entry.apply(chosen);
    *out = chosen;
    return true;
  }
  return false;
}

}  // namespace rio::sim
