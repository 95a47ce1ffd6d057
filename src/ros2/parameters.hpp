// SPDX-License-Identifier: BSD-3-Clause
// Parameters of rio-ros2: a table of fields.
#pragma once

#include <string>
#include <type_traits>

#include "rio/core/field.hpp"

namespace rio::ros2 {

struct Parameters {
  std::string imu_topic = "/imu/data";
  std::string radar_topics = "/radar/points";
  std::string radar_type = "PointCloud2";
  std::string pressure_topic;
  std::string points;
  std::string map;
  std::string sensors;
  std::string config;
  std::string preset;
  std::string odom_frame = "odom";
  std::string body_frame;
  std::string odometry_topic = "/rio/odometry";
  std::string pose_topic = "/rio/pose";
  std::string points_topic = "/rio/points";
  std::string reset_topic = "/rio/reset";
  double odometry_rate = 0.0;
  bool publish_tf = true;
  bool reliable = false;
  bool use_sim_time = false;
  double gyro_sigma = 0.0;
  double pressure_sigma = 0.3;
};

template <class ParametersT, class Visitor>
std::enable_if_t<std::is_same_v<std::remove_const_t<ParametersT>, Parameters>> visit_fields(
    ParametersT& p, Visitor&& visit) {
  const auto text = [&visit](const char* key, auto& value, const char* doc) {
    visit(FieldInfo{key, "", doc, 0.0, 0.0}, value);
  };
  text("imu_topic", p.imu_topic, "sensor_msgs/Imu.");
  text("radar_topics", p.radar_topics, "One topic, or up to four: a list, or with commas between.");
  text("radar_type", p.radar_type, "PointCloud2 (sensor_msgs) or RadarScan (radar_msgs).");
  text("pressure_topic", p.pressure_topic, "sensor_msgs/FluidPressure; empty: no barometer.");
  text("points", p.points, "Preset of the fields of the points, as `rio replay --points`.");
  text(
      "map", p.map,
      "Map file, as `rio replay --map`: fields and axes of the points, axes and units of the IMU.");
  text("sensors", p.sensors, "Folder with imu0/sensor.yaml, radar0/sensor.yaml, ...");
  text("config", p.config, "Option file of rio; wins over the sensor files.");
  text("preset", p.preset, "Preset of the options.");
  text("odom_frame", p.odom_frame, "The world: gravity along -z, the start at the origin.");
  text("body_frame", p.body_frame, "The IMU; empty: frame_id of its messages.");
  text("odometry_topic", p.odometry_topic, "nav_msgs/Odometry at IMU rate.");
  text("pose_topic", p.pose_topic, "geometry_msgs/PoseWithCovarianceStamped at each scan.");
  text("points_topic", p.points_topic, "sensor_msgs/PointCloud2: the points used, with labels.");
  text("reset_topic", p.reset_topic, "std_msgs/Empty: starts anew.");
  visit(FieldInfo{"odometry_rate", "Hz", "At most so often; 0 = at each IMU sample.", 0.0, 1e4},
        p.odometry_rate);
  visit(FieldInfo{"publish_tf", "", "odom_frame -> body_frame on /tf.", 0.0, 1.0}, p.publish_tf);
  visit(FieldInfo{"reliable", "", "Subscribe reliably; publishers of sensor data must be, too.",
                  0.0, 1.0},
        p.reliable);
  visit(
      FieldInfo{"use_sim_time", "", "Without effect: the stamps of the messages count.", 0.0, 1.0},
      p.use_sim_time);
  visit(FieldInfo{"gyro_sigma", "rad/s", "Noise of a gyroscope sample, for the twist.", 0.0, 10.0},
        p.gyro_sigma);
  visit(FieldInfo{"pressure_sigma", "m", "Noise of a height of the barometer.", 1e-3, 100.0},
        p.pressure_sigma);
}

}  // namespace rio::ros2
