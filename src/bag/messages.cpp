// SPDX-License-Identifier: BSD-3-Clause
#include "rio/bag/messages.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>

namespace rio::bag {

namespace {

template <class Number = double>
Vector3d read_vector(WireReader* reader) {
  Vector3d v;
  for (double& value : v) value = static_cast<double>(reader->read<Number>());
  return v;
}

void skip_numbers(WireReader* reader, int count) {
  for (int i = 0; i < count; ++i) (void)reader->read<double>();
}

/// A vector and its covariance, whose first number is -1 if there is no such sensor (REP 145). Some
/// drivers write that although they have one.
Vector3d read_measured(WireReader* reader, bool* is_there, ImuMessage* message) {
  Vector3d v = read_vector(reader);
  const bool none = reader->read<double>() == -1.0;
  skip_numbers(reader, 8);
  *is_there = v.allFinite() && !v.isZero(0.0);
  message->denied = message->denied || (none && *is_there);
  message->absent = message->absent || (none && !*is_there);
  return v;
}

ImuMessage decode_px4_imu(Encoding encoding, Bytes message) {
  constexpr std::int32_t kNone = 0x7FFFFFFF;  // no sample of the accelerometer
  WireReader reader = reader_of(encoding, message);
  ImuMessage out;
  const auto microseconds = reader.read<std::uint64_t>();
  if (microseconds > (std::uint64_t{1} << 52)) throw Damage(4, "a stamp out of all reason");
  out.header.stamp = Time(static_cast<std::int64_t>(microseconds) * 1000);
  out.sample.time = out.header.stamp;
  out.sample.gyro_B = read_vector<float>(&reader);
  (void)reader.read<std::uint32_t>();  // interval of the gyro
  const std::size_t where = reader.position();
  if (reader.read<std::int32_t>() == kNone) throw Damage(where, "it has no accelerometer");
  out.sample.accel_B = read_vector<float>(&reader);
  return out;
}

Quaternion read_xyzw(WireReader* reader) {
  Quaternion q;
  for (double& value : q.coeffs()) value = reader->read<double>();
  const double norm = q.norm();
  if (!(std::abs(norm - 1.0) < 0.01))
    throw Damage(reader->position(), "no unit quaternion, which a pose needs");
  return q.normalized();
}

/// East, north and up of the first of two fixes.
Vector3d from_first(const Vector3d& fix, const Vector3d& first) {
  constexpr double kEquator = 6378137.0;               // WGS 84 [m]
  constexpr double kEccentricity2 = 6.69437999014e-3;  // squared
  const double latitude = fix[0] * kDegree;
  const double first_latitude = first[0] * kDegree;
  const double s = 1.0 - kEccentricity2 * std::pow(std::sin(first_latitude), 2);
  const double prime_vertical = kEquator / std::sqrt(s);  // radii of curvature [m]
  const double meridian = prime_vertical * (1.0 - kEccentricity2) / s;
  const double turn = std::remainder(fix[1] * kDegree - first[1] * kDegree, 2.0 * std::numbers::pi);
  const double between = 0.5 * (latitude + first_latitude);
  return {turn * (prime_vertical + first[2]) * std::cos(between),
          (latitude - first_latitude) * (meridian + first[2]), fix[2] - first[2]};
}

}  // namespace

bool is_imu(const std::string& type) {
  return type == kImuType || type == kPx4ImuType;
}

ImuMessage decode_imu_of(const Topic& topic, Bytes message) {
  if (topic.type == kPx4ImuType) return decode_px4_imu(topic.encoding, message);
  WireReader reader = reader_of(topic.encoding, message);
  ImuMessage out;
  out.header = read_header(&reader);
  skip_numbers(&reader, 4 + 9);  // orientation and its covariance
  out.sample.time = out.header.stamp;
  out.sample.gyro_B = read_measured(&reader, &out.gyro, &out);
  out.sample.accel_B = read_measured(&reader, &out.accel, &out);
  return out;
}

bool is_truth(const std::string& type) {
  return type == kPoseType || type == kOdometryType || type == kTransformType ||
         type == "geometry_msgs/PoseWithCovarianceStamped";
}

NavState decode_truth(const Topic& topic, Bytes message, Header* header, bool* has_velocity) {
  WireReader reader = reader_of(topic.encoding, message);
  *header = read_header(&reader);
  *has_velocity = topic.type == kOdometryType;
  if (*has_velocity || topic.type == kTransformType) (void)reader.text();  // frame of the body
  NavState state;
  state.time = header->stamp;
  state.p_WB = read_vector(&reader);
  state.q_WB = read_xyzw(&reader);
  if (*has_velocity) {
    skip_numbers(&reader, 36);
    state.v_WB = state.q_WB * read_vector(&reader);  // of the body, in its axes
  }
  if (!(state.p_WB + state.v_WB).allFinite()) throw Damage(0, "a pose that is not finite");
  return state;
}

bool is_position(const std::string& type) {
  return type == kPointType || type == kFixType;
}

NavState decode_position(const Topic& topic, Bytes message, Header* header,
                         std::optional<Vector3d>* first) {
  WireReader reader = reader_of(topic.encoding, message);
  *header = read_header(&reader);
  const bool is_fix = topic.type == kFixType;
  const std::size_t where = reader.position();
  if (is_fix) {
    if (reader.read<std::int8_t>() < 0) throw Damage(where, "it says that there is no fix");
    (void)reader.read<std::uint16_t>();  // which satellites
  }
  const Vector3d read = read_vector(&reader);
  if (!read.allFinite()) throw Damage(where, "a position that is not finite");
  if (is_fix && !*first) *first = read;
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  NavState state;
  state.time = header->stamp;
  state.p_WB = is_fix ? from_first(read, **first) : read;
  state.q_WB.coeffs().setConstant(kNaN);
  state.v_WB.setConstant(kNaN);
  return state;
}

double decode_pressure(Encoding encoding, Bytes message, Header* header) {
  WireReader reader = reader_of(encoding, message);
  *header = read_header(&reader);
  const std::size_t where = reader.position();
  const auto pressure = reader.read<double>();
  if (!(std::isfinite(pressure) && pressure > 0.0))
    throw Damage(where, "a pressure that is not above zero");
  return pressure;
}

static bool carries_transforms(const Topic& topic) {
  return topic.type == "tf2_msgs/TFMessage" || topic.type == "tf/tfMessage";
}
bool is_transforms(const Topic& topic) {
  return carries_transforms(topic) && topic.name.ends_with("tf_static");
}
bool is_moving_transforms(const Topic& topic) {
  return carries_transforms(topic) && topic.name.ends_with("tf");
}

std::vector<Transform> decode_transforms(Encoding encoding, Bytes message) {
  const auto frame = [](const std::string& name) {
    return name.substr(name.starts_with('/') ? 1 : 0);
  };
  WireReader reader = reader_of(encoding, message);
  std::vector<Transform> out;
  const auto count = reader.read<std::uint32_t>();
  for (std::uint32_t i = 0; i < count; ++i) {  // ends with the bytes
    Transform transform;
    transform.parent = frame(read_header(&reader).frame_id);
    transform.child = frame(std::string(reader.text()));
    const std::size_t where = reader.position();
    transform.pose.translation = read_vector(&reader);
    if (!transform.pose.translation.allFinite()) throw Damage(where, "a translation is not finite");
    transform.pose.rotation = read_xyzw(&reader);
    out.push_back(transform);
  }
  return out;
}

bool begins_with_header(const Topic& topic) {
  if (topic.encoding == Encoding::kOther) return false;
  if (is_ti_scan(topic.type)) return false;  // the messages of a scan
  if (topic.type == kHeaderType || topic.type == kImuType || is_cloud(topic.type) ||
      is_truth(topic.type) || is_position(topic.type) || topic.type == kPressureType) {
    return true;
  }
  std::istringstream lines(topic.definition);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string type;
    words >> type;
    if (type.empty() || type[0] == '#') continue;
    return type == "Header" || type == "std_msgs/Header" || type == "std_msgs/msg/Header";
  }
  return false;
}

}  // namespace rio::bag
