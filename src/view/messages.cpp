// SPDX-License-Identifier: BSD-3-Clause
#include "view/messages.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <initializer_list>

#include "bag/ros2_types.hpp"
#include "rio/eval/alignment.hpp"
#include "rio/eval/pairing.hpp"
#include "rio/mavlink/axes.hpp"
#include "view/calibration_names.hpp"

namespace rio::view {

namespace {

using bag::CdrWriter;
using bag::cloud_message;
using bag::put_quaternion;
using bag::put_vector;
using bag::stamped;

constexpr const char* kWorld = "world";
constexpr const char* kBody = "imu";

std::string radar_frame(std::size_t radar) {
  return fmt::format("radar{}", radar);
}

void put_header(CdrWriter* message, Time stamp, const std::string& frame) {
  bag::put_time(message, stamp);
  message->text(frame);
}

void put_pose(CdrWriter* message, const Vector3d& p, const Quaternion& q) {
  put_vector(message, p);
  put_quaternion(message, q);
}

void put_transform(CdrWriter* message, Time stamp, const std::string& from, const std::string& to,
                   const Pose& pose) {
  put_header(message, stamp, from);
  message->text(to);
  put_pose(message, pose.translation, pose.rotation);
}

/// 6 x 6, row by row.
void put_covariance(CdrWriter* message, const Eigen::Matrix<double, 6, 6>& P) {
  for (const double value : P.reshaped<Eigen::RowMajor>()) message->put(value);
}

constexpr bag::CloudField kPointFields[] = {
    {"x"},        {"y"},     {"z"},   {"doppler"},
    {"residual"}, {"sigma"}, {"snr"}, {"label", bag::CloudField::kUint8}};
constexpr bag::CloudField kLandmarkFields[] = {{"x"},  {"y"},  {"z"},  {"xx"}, {"xy"},
                                               {"xz"}, {"yy"}, {"yz"}, {"zz"}};

void put_floats(bag::ByteWriter* data, std::initializer_list<double> values) {
  for (const double value : values) data->put(static_cast<float>(value));
}

enum class Action : std::int32_t { kAdd = 0, kDeleteAll = 3 };

/// visualization_msgs/Marker: a sphere that stays for ever.
void put_marker(CdrWriter* message, Time stamp, std::int32_t id, Action action, const Pose& pose,
                const Vector3d& scale, const std::array<float, 4>& colour) {
  put_header(message, stamp, kWorld);
  message->text("landmarks").put(id).put(std::int32_t{2}).put(static_cast<std::int32_t>(action));
  put_pose(message, pose.translation, pose.rotation);
  put_vector(message, scale);
  for (const float channel : colour) message->put(channel);
  message->put(std::int32_t{0}).put(std::uint32_t{0}).put(std::uint8_t{0});  // for ever, not locked
  message->put(std::uint32_t{0}).put(std::uint32_t{0});                      // points, colours
  message->text("").text("").put(std::uint8_t{0});
}

/// Spheres stretched to three sigmas, in place of those before.
CdrWriter ellipsoids(Time stamp, const std::vector<LandmarkReport>& landmarks) {
  CdrWriter message;
  message.put(static_cast<std::uint32_t>(1 + landmarks.size()));
  put_marker(&message, stamp, 0, Action::kDeleteAll, {}, Vector3d::Zero(), {});
  std::int32_t id = 0;
  for (const LandmarkReport& landmark : landmarks) {
    const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(landmark.covariance_W);
    Matrix3d axes = solver.eigenvectors();
    if (axes.determinant() < 0.0) axes.col(0) *= -1.0;
    put_marker(&message, stamp, ++id, Action::kAdd, {Quaternion(axes), landmark.position_W},
               6.0 * solver.eigenvalues().cwiseMax(1e-8).cwiseSqrt(), {0.0F, 0.45F, 0.70F, 0.5F});
  }
  return message;
}

CdrWriter log_message(const Event& event) {
  CdrWriter message;
  bag::put_time(&message, event.time);
  message.put(std::uint8_t{event.serious ? std::uint8_t{40} : std::uint8_t{20}});  // error, info
  message.text("rio").text(event.text).text("");
  message.text(kEventNames[static_cast<std::size_t>(event.kind)]).put(std::uint32_t{0});
  return message;
}

}  // namespace

void Messages::send(const std::string& topic, const char* type, Time time,
                    const CdrWriter& message) {
  const auto [at, added] = channels_.try_emplace(topic);
  if (added) {
    at->second = target_->add_channel(topic, type, bag::definition_of(type));
  }
  target_->add(at->second, time, message.bytes());
}

void Messages::send_pose(const Odometry& odometry) {
  const NavState& x = odometry.at_scan();
  const BodyCovariance& P = odometry.covariance();
  const std::size_t radar = odometry.report().radar;
  CdrWriter tf;
  tf.put(std::uint32_t{3});
  put_transform(&tf, x.time, kWorld, kBody, {x.q_WB, x.p_WB});
  put_transform(&tf, x.time, kBody, radar_frame(radar), odometry.extrinsics(radar));
  const Quaternion chip(std::sqrt(0.5), 0.0, 0.0, -std::sqrt(0.5));  // its y is the boresight
  put_transform(&tf, x.time, radar_frame(radar), radar_frame(radar) + "_chip",
                {chip, Vector3d::Zero()});
  send("/tf", "tf2_msgs/msg/TFMessage", x.time, tf);

  CdrWriter pose = stamped(x.time, kWorld);
  put_pose(&pose, x.p_WB, x.q_WB);
  send("/pose", "geometry_msgs/msg/PoseStamped", x.time, pose);

  Eigen::Matrix<double, 6, 6> twist = 1e9 * Eigen::Matrix<double, 6, 6>::Identity();
  twist.topLeftCorner<3, 3>() = mavlink::twist_covariance(x, P, 0.0).topLeftCorner<3, 3>();
  CdrWriter message = stamped(x.time, kWorld);
  message.text(kBody);
  put_pose(&message, x.p_WB, x.q_WB);
  put_covariance(&message, mavlink::pose_covariance(x.q_WB, P));
  put_vector(&message, x.q_WB.toRotationMatrix().transpose() * x.v_WB);
  put_vector(&message, Vector3d::Zero());  // angular velocity: not estimated
  put_covariance(&message, twist);
  send("/odometry", "nav_msgs/msg/Odometry", x.time, message);
}

void Messages::send_path(const std::string& topic, Time time, const eval::Trajectory& poses) {
  CdrWriter message = stamped(time, kWorld);
  message.put(static_cast<std::uint32_t>(poses.size()));
  for (const eval::StampedPose& pose : poses) {
    put_header(&message, pose.time, kWorld);
    put_pose(&message, pose.p, pose.q);
  }
  send(topic, "nav_msgs/msg/Path", time, message);
}

/// A path is sent when it has grown by a tenth: all of them together are ten times the last one.
void Messages::extend_path(const NavState& state) {
  if (!path_.empty() && path_.back().time >= state.time) return;
  path_.push_back({state.time, state.p_WB, state.q_WB});
  if (10 * path_.size() < 11 * path_sent_ + 10) return;
  path_sent_ = path_.size();
  send_path("/path", state.time, path_);
}

void Messages::send_points(const Odometry& odometry) {
  const Time time = odometry.at_scan().time;
  const std::string frame = radar_frame(odometry.report().radar);
  const std::vector<PointReport>& points = odometry.points();
  bag::ByteWriter data;
  for (const PointReport& point : points) {
    const Vector3d& p = point.point_S;
    put_floats(&data, {p.x(), p.y(), p.z(), point.range_rate, point.residual, point.residual_sigma,
                       point.snr_db});
    data.put(static_cast<std::uint8_t>(point.label));
  }
  send("/" + frame + "/points", "sensor_msgs/msg/PointCloud2", time,
       cloud_message(time, frame, kPointFields, data.bytes()));
}

void Messages::send_landmarks(const Odometry& odometry) {
  const Time time = odometry.at_scan().time;
  const std::vector<LandmarkReport>& landmarks = odometry.landmarks();
  bag::ByteWriter data;
  for (const LandmarkReport& landmark : landmarks) {
    const Vector3d& p = landmark.position_W;
    const Matrix3d& P = landmark.covariance_W;
    put_floats(&data, {p.x(), p.y(), p.z(), P(0, 0), P(0, 1), P(0, 2), P(1, 1), P(1, 2), P(2, 2)});
  }
  send("/landmarks", "sensor_msgs/msg/PointCloud2", time,
       cloud_message(time, kWorld, kLandmarkFields, data.bytes()));
  if (ellipsoids_sent_ != Time::min() && time - ellipsoids_sent_ < std::chrono::seconds(1)) return;
  ellipsoids_sent_ = time;
  send("/landmarks/ellipsoids", "visualization_msgs/msg/MarkerArray", time,
       ellipsoids(time, landmarks));
}

void Messages::send_innovations(const Odometry& odometry) {
  const Time time = odometry.at_scan().time;
  const auto& records = odometry.report().records;
  CdrWriter message = stamped(time, kWorld);
  message.put(static_cast<std::uint32_t>(records.size()));
  for (const InnovationRecord& i : records) {
    message.text(i.name == nullptr ? to_string(i.model) : i.name).put(i.detection).put(i.dof);
    message.put(i.innovation).put(i.sigma).put(i.nis).put(i.gate);
    message.put(static_cast<std::uint8_t>(i.result == GateResult::kUsed ? 1 : 0));
  }
  send("/innovations", "rio/msg/Innovations", time, message);
}

void Messages::send_series(const Odometry& odometry) {
  const NavState& state = odometry.at_scan();
  const BodyCovariance& P = odometry.covariance();
  const UpdateReport& report = odometry.report();
  const auto send_vector = [&](const char* topic, const char* frame, const Vector3d& value) {
    CdrWriter message = stamped(state.time, frame);
    put_vector(&message, value);
    send(topic, "geometry_msgs/msg/Vector3Stamped", state.time, message);
  };
  const auto send_number = [&](const std::string& topic, double value) {
    send(topic, "std_msgs/msg/Float64", state.time, CdrWriter().put(value));
  };
  send_vector("/sigma/position", kWorld, sigma_of(P, body::kPosition));
  send_vector("/sigma/attitude", kBody, sigma_of(P, body::kAttitude));
  send_vector("/sigma/velocity", kWorld, sigma_of(P, body::kVelocity));
  send_vector("/bias/gyro", kBody, state.gyro_bias);
  send_vector("/bias/accel", kBody, state.accel_bias);
  for (std::size_t i = 0; i < kCalibrationCount; ++i) {
    const CalibrationReport& c = report.calibration[i];
    if (c.observability == Observability::kNotEstimated) continue;
    const std::string topic = "/calibration/" + calibration_name(i, report.radar);
    send_number(topic, c.value);
    send_number(topic + "/sigma", c.sigma);
  }
  for (std::size_t i = 0; i < kModelCount; ++i) {
    const ModelReport& model = report.models[i];
    if (model.rows_used == 0) continue;
    send_number(fmt::format("/nis/{}", to_string(static_cast<Model>(i))),
                model.nis / model.rows_used);
  }
  send_number("/health/quality", report.health.quality);
  send_number("/health/state", static_cast<double>(report.health.state));
  if (report.detections_kept > 0) {
    send_number("/points/static_share",
                static_cast<double>(report.static_detections) / report.detections_kept);
  }
  send_number("/update_ms", 1e3 * to_seconds(report.update_time));
}

/// In the world of the estimate, at the first scan with such a pose.
void Messages::tell_others(const NavState& state) {
  const eval::StampedPose here{state.time, state.p_WB, state.q_WB};
  const auto tell = [&](const std::string& topic, bool lay_over, eval::Trajectory* path) {
    if (path->empty()) return;
    const auto pairs = eval::associate(*path, {here}).pairs;
    if (pairs.empty()) return;
    if (lay_over) {
      const Pose T = laid_over(pairs.front().truth, here);
      for (eval::StampedPose& pose : *path) pose = eval::transformed(T, pose);
    }
    send_path(topic, state.time, *path);
    path->clear();
  };
  tell("/truth", start_.lay_truth_over, &start_.truth);
  for (auto& [name, path] : start_.others) tell("/path/" + name, true, &path);
}

void Messages::add(const Odometry& odometry) {
  tell_others(odometry.at_scan());
  send_pose(odometry);
  extend_path(odometry.at_scan());
  send_points(odometry);
  send_landmarks(odometry);
  send_innovations(odometry);
  send_series(odometry);
  target_->flush(odometry.at_scan().time);
}

void Messages::add_event(const Event& event) {
  send("/events", "rcl_interfaces/msg/Log", event.time, log_message(event));
}

void Messages::close() {
  if (path_.size() > path_sent_) send_path("/path", path_.back().time, path_);
  target_->close();
}

}  // namespace rio::view
