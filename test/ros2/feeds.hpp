// SPDX-License-Identifier: BSD-3-Clause
// The files of a dataset folder as messages of ROS 2.
#pragma once

#include <cmath>
#include <cstdint>
#include <fstream>
#include <functional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "messagesPubSubTypes.h"

namespace {

using radar_msgs::msg::dds_::RadarReturn_;
using radar_msgs::msg::dds_::RadarScan_;
using sensor_msgs::msg::dds_::FluidPressure_;
using sensor_msgs::msg::dds_::Imu_;
using sensor_msgs::msg::dds_::PointCloud2_;
using sensor_msgs::msg::dds_::PointField_;

template <class Message>
void stamp(Message* message, long long time, const char* frame) {
  message->header().stamp().sec(static_cast<std::int32_t>(time / 1'000'000'000));
  message->header().stamp().nanosec(static_cast<std::uint32_t>(time % 1'000'000'000));
  message->header().frame_id(frame);
}

struct Row {
  long long time = 0;
  std::vector<double> values;
};

std::vector<Row> rows_of(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(file + ": not there");
  std::vector<Row> rows;
  for (std::string line; std::getline(in, line);) {
    if (line[0] == '#') continue;
    std::istringstream cells(line);
    std::string cell;
    std::getline(cells, cell, ',');
    Row row{std::stoll(cell), {}};
    while (std::getline(cells, cell, ',')) {
      if (!cell.empty()) row.values.push_back(std::stod(cell));
    }
    rows.push_back(row);
  }
  return rows;
}

Imu_ imu_of(const Row& row) {
  Imu_ message;
  stamp(&message, row.time, "imu");
  const std::vector<double>& v = row.values;
  message.angular_velocity().x(v[0]);
  message.angular_velocity().y(v[1]);
  message.angular_velocity().z(v[2]);
  message.linear_acceleration().x(v[3]);
  message.linear_acceleration().y(v[4]);
  message.linear_acceleration().z(v[5]);
  return message;
}

/// Rows from..to; in doubles, so that the estimates can be those of a replay to the bit. One of a
/// driver that has no Doppler if the first SNR is below zero.
PointCloud2_ cloud_of(const std::vector<Row>& rows, std::size_t from, std::size_t to) {
  constexpr std::uint8_t kFloat64 = 8;
  const char* const doppler = rows[from].values[4] < 0.0 ? "power" : "doppler";
  const char* const names[] = {"x", "y", "z", doppler, "snr", "noise"};
  PointCloud2_ message;
  stamp(&message, rows[from].time, "radar");
  for (std::uint32_t i = 0; i < 6; ++i) {
    PointField_ field;
    field.name(names[i]);
    field.offset(8 * i);
    field.datatype(kFloat64);
    field.count(1);
    message.fields().push_back(field);
  }
  std::vector<std::uint8_t> data;
  for (std::size_t i = from; i < to; ++i) {
    if (rows[i].values.empty()) continue;
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(rows[i].values.data());
    data.insert(data.end(), bytes, bytes + 48);
  }
  message.height(1);
  message.width(static_cast<std::uint32_t>(data.size() / 48));
  message.point_step(48);
  message.row_step(static_cast<std::uint32_t>(data.size()));
  message.data(data);
  message.is_dense(true);
  return message;
}

/// The same points in the message for radars, whose numbers are floats.
RadarScan_ radar_scan_of(const std::vector<Row>& rows, std::size_t from, std::size_t to) {
  RadarScan_ message;
  stamp(&message, rows[from].time, "radar");
  for (std::size_t i = from; i < to; ++i) {
    const std::vector<double>& v = rows[i].values;
    if (v.empty()) continue;
    RadarReturn_ point;
    point.range(static_cast<float>(std::hypot(v[0], v[1], v[2])));
    point.azimuth(static_cast<float>(std::atan2(v[1], v[0])));
    point.elevation(static_cast<float>(std::atan2(v[2], std::hypot(v[0], v[1]))));
    point.doppler_velocity(static_cast<float>(v[3]));
    point.amplitude(static_cast<float>(v[4]));
    message.returns().push_back(point);
  }
  return message;
}

/// The rows of one sensor, none if there is no file, and how one message is made of them.
struct Feed {
  std::vector<Row> rows;
  std::function<void(const std::vector<Row>& rows, std::size_t from, std::size_t to)> write;
  std::size_t next = 0;

  void publish_until(long long time) {
    while (next < rows.size() && rows[next].time < time) {
      const std::size_t from = next;
      while (next < rows.size() && rows[next].time == rows[from].time) ++next;
      write(rows, from, next);
    }
  }
};

}  // namespace
