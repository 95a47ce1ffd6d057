// SPDX-License-Identifier: BSD-3-Clause
// A run in messages of ROS 2 that viewers open without a plugin. Frames: world, imu
// (the body), radar0... (x boresight, y left, z up) and radar0_chip... (x right, y forward, z up).
//
//   /tf                     tf2_msgs/TFMessage: world -> imu -> radar0 -> radar0_chip
//   /pose /odometry         geometry_msgs/PoseStamped, nav_msgs/Odometry with covariance
//   /path /truth            nav_msgs/Path: the estimate, and the truth laid over it
//   /radar0/points          sensor_msgs/PointCloud2, frame radar0: x y z [m], doppler, residual,
//                           sigma [m/s], snr [dB], label (rio::PointLabel)
//   /landmarks              sensor_msgs/PointCloud2, frame world: x y z [m], xx ... zz [m^2]
//   /landmarks/ellipsoids   visualization_msgs/MarkerArray, 3 sigma, once a second
//   /innovations            rio/Innovations: every measurement; defined in the file
//   /sigma/position [m], /sigma/attitude [rad], /sigma/velocity [m/s], /bias/gyro [rad/s],
//   /bias/accel [m/s^2]     geometry_msgs/Vector3Stamped
//   /calibration/NAME, /calibration/NAME/sigma, /nis/MODEL (a row), /health/quality [%],
//   /health/state, /points/static_share, /update_ms           std_msgs/Float64
//   /events                 rcl_interfaces/Log
//
// Stamps of headers are corrected times of estimates.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bag/byte_writer.hpp"
#include "bag/mcap_writer.hpp"
#include "view/run.hpp"

namespace rio::view {

/// Where messages go: a file, or viewers.
class MessageTarget {
 public:
  virtual ~MessageTarget() = default;
  /// @return number of the channel
  virtual std::uint16_t add_channel(const std::string& topic, const std::string& type,
                                    const std::string& definition) = 0;
  virtual void add(std::uint16_t channel, Time time, std::string_view message) = 0;
  /// After the messages of a scan.
  virtual void flush(Time /*time*/) {}
  virtual void close() {}
};

class McapTarget : public MessageTarget {
 public:
  explicit McapTarget(const std::filesystem::path& path) : file_(path) {}
  std::uint16_t add_channel(const std::string& topic, const std::string& type,
                            const std::string& definition) override {
    return file_.add_channel(topic, type, definition);
  }
  void add(std::uint16_t channel, Time time, std::string_view message) override {
    file_.add(channel, static_cast<std::uint64_t>(time.count()), message);
  }
  /// Once a second, so that a crash loses no more.
  void flush(Time time) override {
    if (time - flushed_ < std::chrono::seconds(1)) return;
    flushed_ = time;
    file_.flush();
  }
  void close() override { file_.close(); }

 private:
  bag::McapWriter file_;
  Time flushed_{0};
};

/// The messages of a run for viewers that connect while it goes on: a server of the Foxglove
/// WebSocket protocol (subprotocol foxglove.websocket.v1), in a thread of its own. The run never
/// waits for a viewer: it puts a message into a queue of bounded size and goes on. A viewer that
/// reads too slowly loses messages, oldest first; they are counted.
class LiveServer : public MessageTarget {
 public:
  virtual int port() const = 0;
  /// Messages that viewers have lost.
  virtual std::uint64_t dropped() const = 0;
};

/// Listens; with libwebsockets only (RIO_HAS_LIBWEBSOCKETS). Throws std::runtime_error if it
/// cannot. Its close() waits for viewers to read on, a second at most; its end disconnects them.
/// @param address of this machine on which it listens; 127.0.0.1: this machine only
/// @param port 0: any that is free
std::unique_ptr<LiveServer> make_live_server(const std::string& address, int port);

class Messages : public RunSink {
 public:
  explicit Messages(std::unique_ptr<MessageTarget> target) : target_(std::move(target)) {}

  void begin(const RunStart& start) override { start_ = start; }
  void add(const Odometry& odometry) override;
  void add_event(const Event& event) override;
  void close() override;

 private:
  void send(const std::string& topic, const char* type, Time time, const bag::CdrWriter& message);
  void tell_others(const NavState& state);
  void send_pose(const Odometry& odometry);
  void send_path(const std::string& topic, Time time, const eval::Trajectory& poses);
  void extend_path(const NavState& state);
  void send_points(const Odometry& odometry);
  void send_landmarks(const Odometry& odometry);
  void send_innovations(const Odometry& odometry);
  void send_series(const Odometry& odometry);

  std::unique_ptr<MessageTarget> target_;
  std::map<std::string, std::uint16_t> channels_;  ///< by topic
  RunStart start_;                                 ///< other paths until they are sent
  eval::Trajectory path_;
  std::size_t path_sent_ = 0;  ///< its length then
  Time ellipsoids_sent_ = Time::min();
};

}  // namespace rio::view
