// SPDX-License-Identifier: BSD-3-Clause
// The estimate as messages of ROS 2. The body of rio is the IMU (x forward, y left, z up, REP 103),
// its world is the frame `odom` of REP 105: continuous, level, and drifting.
#pragma once

#include <cstdint>
#include <deque>
#include <string>

#include "messages.h"
#include "rio/mavlink/odometry.hpp"
#include "rio/models/detection.hpp"
#include "rio/rio.hpp"
#include "ros2/dds.hpp"
#include "ros2/parameters.hpp"

namespace rio::ros2 {

/// What the label of a point in the cloud says.
enum class Label : std::uint8_t {
  kLeftOut,   ///< moves, or is an echo of something that is not there
  kStatic,    ///< its Doppler was used
  kLandmark,  ///< it was seen again
};

class Outputs {
 public:
  Outputs(const Participant& participant, const Parameters& parameters, const Options& options);

  /// The frame of the IMU, where no parameter names one.
  void set_body_frame(const std::string& frame);
  /// After an IMU sample: odometry and transform.
  void on_imu(const Odometry& odometry, const ImuSample& sample);
  /// Before a scan is given: its points as the estimator sees them.
  void keep_points(const RadarScan& scan, std::size_t radar, const std::string& frame);
  /// After a scan has been processed: pose and labelled points.
  void on_estimate(const Odometry& odometry);
  /// Once a second: health and counters.
  void diagnose(const Odometry& odometry, Time stamp);

 private:
  struct Points {
    DetectionList list;
    std::string frame;
  };

  void send_transform(const NavState& state);
  void send_points(const UpdateReport& report);

  const Parameters& parameters_;
  const Options& options_;
  std::string body_frame_;
  Writer<nav_msgs_msg_dds__Odometry_> odometry_;
  Writer<tf2_msgs_msg_dds__TFMessage_> transforms_;
  Writer<geometry_msgs_msg_dds__PoseWithCovarianceStamped_> pose_;
  Writer<sensor_msgs_msg_dds__PointCloud2_> points_;
  Writer<diagnostic_msgs_msg_dds__DiagnosticArray_> diagnostics_;
  mavlink::RateLimiter limiter_;
  std::deque<Points> kept_;  ///< scans that may still be waiting in the estimator
};

}  // namespace rio::ros2
