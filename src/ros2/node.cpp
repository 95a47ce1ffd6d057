// SPDX-License-Identifier: BSD-3-Clause
#include "ros2/node.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <sstream>
#include <stdexcept>

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

void Node::subscribe() {
  const Qos qos = parameters_.reliable ? Qos::kReliable : Qos::kSensorData;
  imu_.emplace(&participant_, parameters_.imu_topic, sensor_msgs_msg_dds__Imu__desc, qos,
               kImuDepth);
  const bool scans = parameters_.radar_type == "RadarScan";
  if (!scans && parameters_.radar_type != "PointCloud2") {
    throw std::runtime_error("radar_type: PointCloud2 or RadarScan is expected");
  }
  for (const std::string& name : names_in(parameters_.radar_topics)) {
    radars_.push_back({Reader(&participant_, name,
                              scans ? radar_msgs_msg_dds__RadarScan__desc
                                    : sensor_msgs_msg_dds__PointCloud2__desc,
                              qos, kScanDepth),
                       topic(name, scans ? bag::kRadarScanType : bag::kCloudType),
                       {}});
  }
  if (!parameters_.pressure_topic.empty()) {
    pressure_.emplace(&participant_, parameters_.pressure_topic,
                      sensor_msgs_msg_dds__FluidPressure__desc, qos, kImuDepth);
  }
  reset_.emplace(&participant_, parameters_.reset_topic, std_msgs_msg_dds__Empty__desc,
                 Qos::kReliable, 1);
}

void Node::step() {
  participant_.wait(DDS_MSECS(200));
  take_reset();
  take_pressure();
  take_imu();
  for (std::size_t r = 0; r < radars_.size(); ++r) take_scans(r);
  if (silent_at_ && std::chrono::steady_clock::now() > *silent_at_) {
    fmt::print(stderr, "{}", silence());
    silent_at_.reset();
  }
  if (newest_ - diagnosed_ < from_seconds(1.0) && newest_ >= diagnosed_) return;
  outputs_->diagnose(*odometry_, newest_);
  diagnosed_ = newest_;
}

template <class TakeOne>
void Node::take(Reader* reader, const std::string& name, const TakeOne& take_one) {
  while (reader->take(&bytes_)) {
    try {
      take_one();
    } catch (const bag::Damage& damage) {
      ++refused_;
      if (std::count(refusals_.begin(), refusals_.end(), name) == 0) {
        refusals_.push_back(name);
        fmt::print(stderr, "rio-ros2: {}: a message is left out: {}\n", name, damage.what());
      }
    }
    if (error_) std::rethrow_exception(error_);
  }
}

void Node::take_imu() {
  const bag::Topic of = topic(parameters_.imu_topic, bag::kImuType);
  take(&*imu_, of.name, [&] {
    const bag::ImuMessage message = bag::decode_imu_of(of, bytes_);
    outputs_->set_body_frame(message.header.frame_id);
    (void)odometry_->add_imu(message.sample);  // its outcome is counted
    ++imu_samples_;
    newest_ = message.sample.time;
    outputs_->on_imu(*odometry_, message.sample);
  });
}

void Node::take_scans(std::size_t r) {
  Radar& radar = radars_[r];
  take(&radar.reader, radar.topic.name, [&] {
    const bag::PointCloud cloud = bag::decode_cloud_of(radar.topic, bytes_);
    scan_.time = cloud.header.stamp;
    scan_.detections.clear();
    if (cloud.size() > 0) {
      if (!radar.map || radar.map->fields() != cloud.fields) {
        bag::PointRequest request;
        request.preset = parameters_.points;
        radar.map.emplace(cloud.fields, request);
        fmt::print(stderr, "rio-ros2: {}: {}\n", radar.topic.name, radar.map->text());
      }
      (void)radar.map->convert(cloud, &scan_.detections);
    }
    ++radar.scans;
    outputs_->keep_points(scan_, r, cloud.header.frame_id);
    (void)odometry_->add_scan(scan_, r);  // its outcome is counted
  });
}

void Node::take_pressure() {
  if (!pressure_) return;
  take(&*pressure_, parameters_.pressure_topic, [&] {
    bag::Header header;
    const double pressure = bag::decode_pressure(bag::Encoding::kCdr, bytes_, &header);
    const io::BaroSample sample{header.stamp, pressure};
    if (!heights_.any && heights_.height(sample)) {
      heights_.zero = *heights_.height(sample);
      heights_.any = true;
    }
    const std::optional<double> height = heights_.height(sample);
    if (!height) return;
    const HeightModel::Measurement z{*height, parameters_.pressure_sigma};
    (void)odometry_->add_measurement({sample.time, HeightModel{}, z});  // its outcome is counted
  });
}

void Node::take_reset() {
  while (reset_->take(&bytes_)) {
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
  std::string text = fmt::format("rio-ros2: {} IMU samples", imu_samples_);
  for (const Radar& radar : radars_) {
    text += fmt::format(", {} scans of {}", radar.scans, radar.topic.name);
  }
  const Counters& counters = odometry_->counters();
  text += fmt::format("; {} processed, {} before the start, {} late, {} messages left out; {}\n",
                      counters.scans, counters.scans_uninitialized, counters.scans_late, refused_,
                      to_string(odometry_->health().state));
  return text + silence();
}

std::string Node::silence() const {
  std::string text;
  const auto add = [&text](const std::string& name, std::uint64_t count) {
    if (count > 0) return;
    text += "rio-ros2: nothing came on " + name + ": topic name, ROS_DOMAIN_ID, QoS?\n";
  };
  add(parameters_.imu_topic, imu_samples_);
  for (const Radar& radar : radars_) add(radar.topic.name, radar.scans);
  return text;
}

}  // namespace rio::ros2
