// SPDX-License-Identifier: BSD-3-Clause
#include "rio/bag/recording_writer.hpp"

#include <stdexcept>
#include <string>
#include <vector>

#include "mcap_writer.hpp"
#include "rio/sim/ti_packet.hpp"
#include "ros2_types.hpp"

namespace rio::bag {

namespace {

constexpr CloudField kFields[] = {
    {"x"}, {"y"}, {"z"}, {"doppler"}, {"snr", CloudField::kInt16}, {"noise", CloudField::kInt16}};

void put_covariance(CdrWriter* message, double first) {
  for (int i = 0; i < 9; ++i) message->put(i == 0 ? first : 0.0);
}

std::string imu_message(const ImuSample& sample) {
  CdrWriter message = stamped(sample.time, "imu");
  for (const double value : {0.0, 0.0, 0.0, 1.0}) message.put(value);
  put_covariance(&message, -1.0);  // no orientation (REP 145)
  put_vector(&message, sample.gyro_B);
  put_covariance(&message, 0.0);  // not known
  put_vector(&message, sample.accel_B);
  put_covariance(&message, 0.0);
  return message.bytes();
}

std::string points_of(const RadarScan& scan) {
  ByteWriter points;
  for (const RadarDetection& d : scan.detections) {
    const sim::WrittenPoint p = sim::written(d);
    points.put(p.x).put(p.y).put(p.z).put(p.velocity).put(p.snr).put(p.noise);
  }
  return points.bytes();
}

McapWriter new_file(const std::filesystem::path& path) {
  if (std::filesystem::exists(path)) throw std::runtime_error(path.string() + ": is another file");
  return McapWriter(path);
}

std::string radar_name(std::size_t radar) {
  return "radar" + std::to_string(radar);
}

}  // namespace

struct RecordingWriter::Impl {
  Impl(const std::filesystem::path& path, std::size_t count)
      : file(new_file(path)), imu(add_channel("imu", "sensor_msgs/msg/Imu")) {
    for (std::size_t r = 0; r < count; ++r) {
      radars.push_back(add_channel(radar_name(r), "sensor_msgs/msg/PointCloud2"));
    }
  }
  std::uint16_t add_channel(const std::string& name, const std::string& type) {
    return file.add_channel("/" + name, type, definition_of(type));
  }
  void add(std::uint16_t channel, Time time, const std::string& message) {
    file.add(channel, static_cast<std::uint64_t>(time.count()), message);
  }

  McapWriter file;
  std::uint16_t imu;
  std::vector<std::uint16_t> radars;
};

RecordingWriter::RecordingWriter(const std::filesystem::path& path, std::size_t radars)
    : impl_(std::make_unique<Impl>(path, radars)) {}

RecordingWriter::~RecordingWriter() = default;

void RecordingWriter::add(const ImuSample& sample) {
  impl_->add(impl_->imu, sample.time, imu_message(sample));
}

void RecordingWriter::add(const RadarScan& scan, std::size_t radar) {
  if (scan.time < Time{0}) return;
  const std::string frame = radar_name(radar) + "_chip";
  impl_->add(impl_->radars.at(radar), scan.time,
             cloud_message(scan.time, frame, kFields, points_of(scan)).bytes());
}

void RecordingWriter::flush() {
  impl_->file.flush();
}

void RecordingWriter::close() {
  impl_->file.close();
}

}  // namespace rio::bag
