// SPDX-License-Identifier: BSD-3-Clause
// ROS messages as their writers serialise them, for tests of the readers; shares no code with them.
#pragma once

#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <span>
#include <string>
#include <vector>

#include "rio/types.hpp"

namespace rio::test {

inline std::span<const std::uint8_t> bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// Serialised numbers. ROS 1: packed. CDR: aligned to their size, counted after the first four
/// bytes.
class Wire {
 public:
  enum Kind { kRos1, kCdr, kCdrBig };
  explicit Wire(Kind kind) : kind_(kind) {
    if (kind == kCdr) bytes = std::string("\x00\x01\x00\x00", 4);
    if (kind == kCdrBig) bytes = std::string("\x00\x00\x00\x00", 4);
  }

  template <class T>
  Wire& put(T value) {
    while (kind_ != kRos1 && (bytes.size() - 4) % sizeof(T) != 0) bytes += '\xAA';
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      bytes += raw[kind_ == kCdrBig ? sizeof(T) - 1 - i : i];
    }
    return *this;
  }
  /// Each of them, in its type.
  template <class Range>
  Wire& all(const Range& values) {
    for (const auto value : values) put(value);
    return *this;
  }
  template <class T>
  Wire& all(std::initializer_list<T> values) {
    return all<std::initializer_list<T>>(values);
  }
  template <class T>
  Wire& repeat(int count, T value) {
    for (int i = 0; i < count; ++i) put(value);
    return *this;
  }
  Wire& text(const std::string& text) {
    const std::string tail = kind_ == kRos1 ? text : text + '\0';
    put(static_cast<std::uint32_t>(tail.size()));
    bytes += tail;
    return *this;
  }
  Wire& header(Time stamp, const std::string& frame_id, std::uint32_t sequence = 7) {
    if (kind_ == kRos1) put(sequence);
    put(static_cast<std::uint32_t>(stamp.count() / 1'000'000'000));
    put(static_cast<std::uint32_t>(stamp.count() % 1'000'000'000));
    return text(frame_id);
  }

  std::string bytes;

 private:
  Kind kind_;
};

inline std::string imu_message(Wire::Kind kind, const ImuSample& sample,
                               double gyro_covariance = 0) {
  Wire wire(kind);
  wire.header(sample.time, "imu_link");
  for (int i = 0; i < 13; ++i) wire.put(100.0 + i);  // orientation and its covariance
  wire.all(sample.gyro_B).put(gyro_covariance).repeat(8, 0.0);
  return wire.all(sample.accel_B).repeat(9, 0.0).bytes;
}

/// sensor_msgs/FluidPressure [Pa].
inline std::string pressure_message(Wire::Kind kind, Time stamp, double pressure) {
  return Wire(kind).header(stamp, "imu_link").put(pressure).put(0.0).bytes;
}

/// A field of a cloud; types as in sensor_msgs/PointField, here only int16 (3), float32 (7) and
/// float64 (8).
struct CloudField {
  std::string name;
  std::uint32_t offset = 0;
  std::uint8_t type = 7;
};

using Points = std::vector<std::vector<double>>;  ///< a number for each field

/// A cloud of `step` bytes a point in `height` rows, of which each ends with `gap` unused bytes.
inline std::string cloud_message(Wire::Kind kind, Time stamp, const std::vector<CloudField>& fields,
                                 const Points& points, std::uint32_t step, std::uint32_t height = 1,
                                 std::uint32_t gap = 0, std::uint32_t sequence = 7) {
  const bool big = kind == Wire::kCdrBig;
  const auto width = static_cast<std::uint32_t>(points.size()) / height;
  std::string data(height * (width * step + gap), '\x55');
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t k = 0; k < fields.size(); ++k) {
      Wire number(big ? Wire::kCdrBig : Wire::kCdr);
      if (fields[k].type == 3) number.put(static_cast<std::int16_t>(points[i][k]));
      if (fields[k].type == 7) number.put(static_cast<float>(points[i][k]));
      if (fields[k].type == 8) number.put(points[i][k]);
      data.replace(i / width * (width * step + gap) + i % width * step + fields[k].offset,
                   number.bytes.size() - 4, number.bytes.substr(4));
    }
  }
  Wire wire(kind);
  wire.header(stamp, "radar", sequence).put(height).put(width);
  wire.put(static_cast<std::uint32_t>(fields.size()));
  for (const CloudField& field : fields) {
    wire.text(field.name).put(field.offset).put(field.type).put(std::uint32_t{1});
  }
  wire.put(static_cast<std::uint8_t>(big ? 1 : 0)).put(step).put(width * step + gap);
  wire.put(static_cast<std::uint32_t>(data.size()));
  wire.bytes += data;
  return wire.put(std::uint8_t{1}).bytes;
}

/// The fields of TI's driver, 32 bytes a point.
inline std::vector<CloudField> ti_fields() {
  return {{"x", 0}, {"y", 4}, {"z", 8}, {"intensity", 16}, {"velocity", 20}};
}

}  // namespace rio::test
