// SPDX-License-Identifier: BSD-3-Clause
#include "ros2/node.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "bag/point_presets.hpp"
#include "estimator_options.hpp"
#include "rio/aiding.hpp"
#include "rio/models/aids.hpp"

namespace rio::ros2 {

namespace {

constexpr int kImuDepth = 1000;  // seconds of samples that wait while the machine is busy
constexpr int kScanDepth = 100;

std::vector<std::string> names_in(const std::string& list) {
  std::istringstream text(list);
  std::vector<std::string> names;
  for (std::string name; std::getline(text >> std::ws, name, ',');) names.push_back(name);
  return names;
}

bag::Topic topic(const std::string& name, const char* type) {
  return {name, type, bag::Encoding::kCdr, {}};
}

}  // namespace

Node::Node(const Parameters& parameters, unsigned domain)
    : parameters_(parameters), participant_(domain) {
  make_options();
  make_request();
  std::string why;
  odometry_ = Odometry::create(options_, &why);
  if (odometry_ == nullptr) throw std::runtime_error(why);
  outputs_.emplace(participant_, parameters_, options_);
  odometry_->on_scan([this] { publish_scan(); });
  subscribe();
  fmt::print(stderr, "rio-ros2: domain {}, IMU {}, radar {}, odometry {}\n", domain,
             parameters_.imu_topic, parameters_.radar_topics, parameters_.odometry_topic);
}

void Node::make_options() {
  const std::size_t radars = names_in(parameters_.radar_topics).size();
  io::Dataset sensors;
  if (parameters_.sensors.empty()) {
    sensors.notes.emplace_back("no `sensors`: mounting and noise by the options");
  } else {
    sensors = io::read_sensor_info(parameters_.sensors);
  }
  tools::print_notes(sensors.notes);
  Options base;
  if (!parameters_.pressure_topic.empty()) (void)base.auxiliary.declare<HeightOffset>();
  tools::EstimatorArguments arguments;
  arguments.config = parameters_.config;
  arguments.preset = parameters_.preset;
  options_ = tools::make_options(arguments, sensors, base);
  if (radars == 0 || radars != options_.radars()) {
    throw std::runtime_error(
        fmt::format("radar_topics: {} topics, but `sensors` has {} radars (radar0, radar1, ...)",
                    radars, options_.radars()));
  }
}

void Node::make_request() {
  if (!parameters_.map.empty()) request_ = bag::load_recording_map(parameters_.map);
  if (!parameters_.points.empty()) request_.points.preset = parameters_.points;
  if (!request_.points.preset.empty()) (void)bag::find_preset(request_.points, {});
}

void Node::subscribe() {
  std::set<std::string> names = {parameters_.odometry_topic, parameters_.pose_topic,
                                 parameters_.points_topic, parameters_.reset_topic};
  const Qos qos = parameters_.reliable ? Qos::kReliable : Qos::kSensorData;
  const auto add = [&](const std::string& name, const dds_topic_descriptor_t& type, int depth,
                       const char* ros_type, void (Node::*hand_over)(Source*), std::size_t radar) {
    if (!names.insert(name).second) throw std::runtime_error(name + ": two topics have this name");
    sources_.push_back({Reader(&participant_, name, type, qos, depth), topic(name, ros_type),
                        hand_over, radar, bag::CloudReader(request_.points)});
  };
  add(parameters_.imu_topic, sensor_msgs_msg_dds__Imu__desc, kImuDepth, bag::kImuType,
      &Node::add_imu, 0);
  const bool scans = parameters_.radar_type == "RadarScan";
  if (!scans && parameters_.radar_type != "PointCloud2") {
    throw std::runtime_error("radar_type: PointCloud2 or RadarScan is expected");
  }
  std::size_t radar = 0;
  for (const std::string& name : names_in(parameters_.radar_topics)) {
    add(name, scans ? radar_msgs_msg_dds__RadarScan__desc : sensor_msgs_msg_dds__PointCloud2__desc,
        kScanDepth, scans ? bag::kRadarScanType : bag::kCloudType, &Node::add_scan, radar++);
  }
  if (!parameters_.pressure_topic.empty()) {
    add(parameters_.pressure_topic, sensor_msgs_msg_dds__FluidPressure__desc, kImuDepth,
        bag::kPressureType, &Node::add_pressure, 0);
  }
  reset_.emplace(&participant_, parameters_.reset_topic, std_msgs_msg_dds__Empty__desc,
                 Qos::kReliable, 1);
}

void Node::step() {
  Source* source = oldest();
  if (source == nullptr) {
    participant_.wait(DDS_MSECS(200));
    source = oldest();
  }
  take_reset();
  if (source != nullptr) {
    (this->*source->hand_over)(source);
    source->stamp.reset();
  }
  if (error_) std::rethrow_exception(error_);
  if (silent_at_ && std::chrono::steady_clock::now() > *silent_at_) {
    fmt::print(stderr, "{}", silence());
    silent_at_.reset();
  }
  if (newest_ - diagnosed_ < from_seconds(1.0) && newest_ >= diagnosed_) return;
  outputs_->diagnose(*odometry_, newest_);
  diagnosed_ = newest_;
}

Node::Source* Node::oldest() {
  Source* oldest = nullptr;
  for (Source& source : sources_) {
    while (!source.stamp && source.reader.take(&source.message)) {
      (void)decode(&source, [&] {
        source.stamp = bag::decode_header(bag::Encoding::kCdr, source.message).stamp;
      });
    }
    if (source.stamp && (oldest == nullptr || source.stamp < oldest->stamp)) oldest = &source;
  }
  return oldest;
}

template <class Decode>
bool Node::decode(Source* source, const Decode& decode_it) {
  try {
    decode_it();
    return true;
  } catch (const std::runtime_error& why) {
    ++refused_;
    if (!std::exchange(source->refused, true)) {
      fmt::print(stderr, "rio-ros2: {}: a message is left out: {}\n", source->topic.name,
                 why.what());
    }
    return false;
  }
}

void Node::add_imu(Source* source) {
  bag::ImuMessage message;
  if (!decode(source, [&] {
        message = bag::imu_message(source->topic, {0, Time(0), source->message}, request_);
      })) {
    return;
  }
  outputs_->set_body_frame(message.header.frame_id);
  (void)odometry_->add_imu(message.sample);  // its outcome is counted
  ++source->taken;
  newest_ = message.sample.time;
  outputs_->on_imu(*odometry_, message.sample);
}

void Node::add_scan(Source* source) {
  bag::Header header;
  std::vector<std::string> notes;
  if (!decode(source, [&] {
        header = source->cloud.read(source->topic, {0, Time(0), source->message}, &scan_.detections,
                                    &notes);
      })) {
    return;
  }
  for (const std::string& note : notes) {
    fmt::print(stderr, "rio-ros2: {}: {}\n", source->topic.name, note);
  }
  scan_.time = header.stamp;
  ++source->taken;
  outputs_->keep_points(scan_, source->radar, header.frame_id);
  (void)odometry_->add_scan(scan_, source->radar);  // its outcome is counted
}

void Node::add_pressure(Source* source) {
  bag::Header header;
  double pressure = 0.0;
  if (!decode(source, [&] {
        pressure = bag::decode_pressure(bag::Encoding::kCdr, source->message, &header);
      })) {
    return;
  }
  const io::BaroSample sample{header.stamp, pressure};
  if (!heights_.any && heights_.height(sample)) {
    heights_.zero = *heights_.height(sample);
    heights_.any = true;
  }
  const std::optional<double> height = heights_.height(sample);
  if (!height) return;
  const HeightModel::Measurement z{*height, parameters_.pressure_sigma};
  (void)odometry_->add_measurement({sample.time, HeightModel{}, z});  // its outcome is counted
}

void Node::take_reset() {
  std::vector<std::uint8_t> message;
  while (reset_->take(&message)) {
    odometry_->reset();
    heights_ = {};  // over the new start
    fmt::print(stderr, "rio-ros2: reset: starts anew\n");
  }
}

void Node::publish_scan() noexcept {
  try {
    if (odometry_->report().status == Status::kOk) outputs_->on_estimate(*odometry_);
  } catch (...) {
    error_ = std::current_exception();
  }
}

std::string Node::summary() const {
  std::string text = fmt::format("rio-ros2: {} IMU samples", sources_[0].taken);
  for (std::size_t r = 1; r <= options_.radars(); ++r) {
    text += fmt::format(", {} scans of {}", sources_[r].taken, sources_[r].topic.name);
  }
  const Counters& counters = odometry_->counters();
  text += fmt::format("; {} processed, {} before the start, {} late, {} messages left out; {}\n",
                      counters.scans, counters.scans_uninitialized, counters.scans_late, refused_,
                      to_string(odometry_->health().state));
  return text + silence();
}

std::string Node::silence() const {
  std::string text;
  for (std::size_t i = 0; i <= options_.radars(); ++i) {
    if (sources_[i].taken > 0) continue;
    text += "rio-ros2: nothing came on " + sources_[i].topic.name +
            ": topic name, ROS_DOMAIN_ID, QoS?\n";
  }
  return text;
}

}  // namespace rio::ros2
