// SPDX-License-Identifier: BSD-3-Clause
#include "ros2/outputs.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "rio/mavlink/axes.hpp"
#include "view/run.hpp"

namespace rio::ros2 {

namespace {

constexpr std::size_t kMostKept = 16;  // scans
constexpr int kDepth = 100;            // messages kept for a subscriber that is slow

/// DDS takes strings of C; it does not change them.
char* text(const std::string& string) {
  return const_cast<char*>(string.c_str());
}

std_msgs_msg_dds__Header_ header_of(Time stamp, const std::string& frame) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const std::int64_t t = stamp.count();
  const std::int64_t seconds = t / kSecond - (t % kSecond < 0 ? 1 : 0);
  return {{static_cast<std::int32_t>(seconds), static_cast<std::uint32_t>(t - seconds * kSecond)},
          text(frame)};
}

geometry_msgs_msg_dds__Quaternion_ quaternion_of(const Quaternion& q) {
  return {q.x(), q.y(), q.z(), q.w()};
}

geometry_msgs_msg_dds__Pose_ pose_of(const NavState& state) {
  const Vector3d& p = state.p_WB;
  return {{p.x(), p.y(), p.z()}, quaternion_of(state.q_WB)};
}

/// Row by row; it is symmetric.
void put(const mavlink::Matrix6d& covariance, double (&out)[36]) {
  std::copy_n(covariance.data(), 36, out);
}

/// diagnostic_msgs/DiagnosticStatus of each HealthState.
std::uint8_t level_of(HealthState state) {
  enum Level : std::uint8_t { kOk, kWarning, kError, kStale };
  constexpr Level kLevels[] = {kStale, kOk, kWarning, kWarning, kError};
  return kLevels[static_cast<std::size_t>(state)];
}

std::vector<Label> labels_of(const UpdateReport& report, std::size_t points) {
  std::vector<Label> labels(points, Label::kLeftOut);
  for (const InnovationRecord& record : report.records) {
    if (record.result != GateResult::kUsed || record.detection >= points) continue;
    Label& label = labels[record.detection];
    if (record.model == Model::kDoppler) label = std::max(label, Label::kStatic);
    if (record.model == Model::kLandmarkDistance || record.model == Model::kLandmarkPoint ||
        record.model == Model::kLandmarkPosition) {
      label = Label::kLandmark;
    }
  }
  return labels;
}

}  // namespace

Outputs::Outputs(const Participant& participant, const Parameters& parameters,
                 const Options& options)
    : parameters_(parameters),
      options_(options),
      body_frame_(parameters.body_frame),
      odometry_(participant, parameters.odometry_topic, nav_msgs_msg_dds__Odometry__desc, kDepth),
      transforms_(participant, "/tf", tf2_msgs_msg_dds__TFMessage__desc, kDepth),
      pose_(participant, parameters.pose_topic,
            geometry_msgs_msg_dds__PoseWithCovarianceStamped__desc, kDepth),
      points_(participant, parameters.points_topic, sensor_msgs_msg_dds__PointCloud2__desc, 5),
      diagnostics_(participant, "/diagnostics", diagnostic_msgs_msg_dds__DiagnosticArray__desc, 10),
      limiter_(parameters.odometry_rate) {}

void Outputs::set_body_frame(const std::string& frame) {
  if (body_frame_.empty()) body_frame_ = frame.empty() ? "base_link" : frame;
}

void Outputs::on_imu(const Odometry& odometry, const ImuSample& sample) {
  if (!odometry.initialized()) return;
  const NavState& now = odometry.now();
  if (parameters_.odometry_rate > 0.0 && !limiter_.due(now.time)) return;
  nav_msgs_msg_dds__Odometry_ message{};
  message.header = header_of(now.time, parameters_.odom_frame);
  message.child_frame_id = text(body_frame_);
  message.pose.pose = pose_of(now);
  const BodyCovariance& P = odometry.covariance_now();
  put(mavlink::pose_covariance(now.q_WB, P), message.pose.covariance);
  const Vector3d v = now.q_WB.conjugate() * now.v_WB;  // of the child frame
  const Vector3d w = sample.gyro_B - now.gyro_bias;
  message.twist.twist = {{v.x(), v.y(), v.z()}, {w.x(), w.y(), w.z()}};
  put(mavlink::twist_covariance(now, P, parameters_.gyro_sigma), message.twist.covariance);
  odometry_.write(message);
  if (parameters_.publish_tf) send_transform(now);
}

void Outputs::send_transform(const NavState& state) {
  const Vector3d& p = state.p_WB;
  geometry_msgs_msg_dds__TransformStamped_ transform{
      header_of(state.time, parameters_.odom_frame),
      text(body_frame_),
      {{p.x(), p.y(), p.z()}, quaternion_of(state.q_WB)}};
  transforms_.write({{1, 1, &transform, false}});
}

void Outputs::keep_points(const RadarScan& scan, std::size_t radar, const std::string& frame) {
  kept_.push_back({DetectionList(options_.frontend.max_detections), frame});
  filter_detections(scan, options_.radar_of(radar), options_.frontend.max_detections,
                    kept_.back().list);
  kept_.back().list.radar = radar;
  if (kept_.size() > kMostKept) kept_.pop_front();
}

void Outputs::on_estimate(const Odometry& odometry) {
  const NavState& state = odometry.at_scan();
  geometry_msgs_msg_dds__PoseWithCovarianceStamped_ message{};
  message.header = header_of(state.time, parameters_.odom_frame);
  message.pose.pose = pose_of(state);
  put(mavlink::pose_covariance(state.q_WB, odometry.covariance()), message.pose.covariance);
  pose_.write(message);
  send_points(odometry.report());
}

void Outputs::send_points(const UpdateReport& report) {
  struct Point {
    float x, y, z, doppler, snr;
    std::uint32_t label;
  };
  constexpr std::uint8_t kFloat32 = 7;
  constexpr std::uint8_t kUint32 = 6;
  const auto kept = std::find_if(kept_.begin(), kept_.end(), [&](const Points& points) {
    return points.list.time == report.time && points.list.radar == report.radar;
  });
  if (kept == kept_.end()) return;
  const std::vector<Detection>& items = kept->list.items;
  const std::vector<Label> labels = labels_of(report, items.size());
  std::vector<Point> data;
  for (std::size_t i = 0; i < items.size(); ++i) {
    const Eigen::Vector3f p = items[i].point_S.cast<float>();
    data.push_back({p.x(), p.y(), p.z(), static_cast<float>(items[i].range_rate),
                    static_cast<float>(items[i].snr_db), static_cast<std::uint32_t>(labels[i])});
  }
  std::array<std::string, 6> names = {"x", "y", "z", "doppler", "snr", "label"};
  std::array<sensor_msgs_msg_dds__PointField_, 6> fields{};
  for (std::uint32_t i = 0; i < fields.size(); ++i) {
    fields[i] = {text(names[i]), 4 * i, i + 1 < fields.size() ? kFloat32 : kUint32, 1};
  }
  sensor_msgs_msg_dds__PointCloud2_ message{};
  message.header = header_of(report.time, kept->frame);
  message.height = 1;
  message.width = static_cast<std::uint32_t>(data.size());
  message.fields = {fields.size(), fields.size(), fields.data(), false};
  message.point_step = sizeof(Point);
  message.row_step = message.width * message.point_step;
  message.data = {message.row_step, message.row_step, reinterpret_cast<std::uint8_t*>(data.data()),
                  false};
  message.is_dense = true;
  points_.write(message);
  kept_.erase(kept_.begin(), kept + 1);
}

void Outputs::diagnose(const Odometry& odometry, Time stamp) {
  const Health& health = odometry.health();
  const Counters& counters = odometry.counters();
  const std::string reasons = view::reasons_text(health);
  const std::string message =
      std::string(to_string(health.state)) + (reasons.empty() ? "" : ": " + reasons);
  std::vector<std::pair<std::string, std::string>> values = {
      {"position", to_string(health.position)},
      {"velocity", to_string(health.velocity)},
      {"heading", to_string(health.heading)},
      {"quality", std::to_string(health.quality)},
      {"reset_counter", std::to_string(health.reset_counter)},
      {"imu_samples", std::to_string(counters.imu_samples)},
      {"imu_gaps", std::to_string(counters.imu_gaps)},
      {"scans", std::to_string(counters.scans)},
      {"scans_late", std::to_string(counters.scans_late)},
      {"scans_before_start", std::to_string(counters.scans_uninitialized)}};
  std::vector<diagnostic_msgs_msg_dds__KeyValue_> pairs;
  for (const auto& [key, value] : values) pairs.push_back({text(key), text(value)});
  const std::string name = "rio: odometry";
  const std::string hardware = "rio";
  const std::string none;
  const auto count = static_cast<std::uint32_t>(pairs.size());
  diagnostic_msgs_msg_dds__DiagnosticStatus_ status{level_of(health.state),
                                                    text(name),
                                                    text(message),
                                                    text(hardware),
                                                    {count, count, pairs.data(), false}};
  diagnostics_.write({header_of(stamp, none), {1, 1, &status, false}});
}

}  // namespace rio::ros2
