// SPDX-License-Identifier: BSD-3-Clause
#include "rio/bag/messages.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <sstream>

namespace rio::bag {

namespace {

WireReader reader_of(Encoding encoding, Bytes message) {
  if (encoding == Encoding::kCdr) return WireReader::cdr(message);
  if (encoding == Encoding::kRos1) return WireReader(message);
  throw Damage(0, "neither ROS 1 nor CDR");
}

Header read_header(WireReader* reader) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  Header header;
  if (!reader->is_cdr()) header.sequence = reader->read<std::uint32_t>();
  // seconds: unsigned in ROS 1, signed in ROS 2; they differ beyond 2038 only
  const auto seconds = reader->read<std::uint32_t>();
  const auto nanoseconds = reader->read<std::uint32_t>();
  header.stamp = Time(std::int64_t{seconds} * kSecond + nanoseconds);
  header.frame_id = reader->text();
  return header;
}

Vector3d read_vector(WireReader* reader) {
  Vector3d v;
  for (double& value : v) value = reader->read<double>();
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

/// Fields x, y, z... of type float32, one after the other.
PointCloud floats(const Header& header, const std::vector<std::string>& names,
                  const std::vector<float>& values) {
  constexpr std::uint8_t kFloat32 = 7;
  PointCloud cloud;
  cloud.header = header;
  cloud.height = 1;
  cloud.width = static_cast<std::uint32_t>(values.size() / names.size());
  for (const std::string& name : names) {
    cloud.fields.push_back({name, cloud.point_step, kFloat32});
    cloud.point_step += sizeof(float);
  }
  auto data = std::make_shared<std::vector<std::uint8_t>>(values.size() * sizeof(float));
  if (!values.empty()) std::memcpy(data->data(), values.data(), data->size());
  cloud.big_endian = std::endian::native == std::endian::big;
  cloud.data = *data;
  cloud.own = std::move(data);
  return cloud;
}

ImuMessage decode_px4_imu(Encoding encoding, Bytes message) {
  constexpr std::int32_t kNone = 0x7FFFFFFF;  // no sample of the accelerometer
  WireReader reader = reader_of(encoding, message);
  const auto frd = [&reader] {
    Vector3d v;
    for (double& value : v) value = static_cast<double>(reader.read<float>());
    return Vector3d(v.x(), -v.y(), -v.z());
  };
  ImuMessage out;
  const auto microseconds = reader.read<std::uint64_t>();
  if (microseconds > (std::uint64_t{1} << 52)) throw Damage(4, "a stamp out of all reason");
  out.header.stamp = Time(static_cast<std::int64_t>(microseconds) * 1000);
  out.sample.time = out.header.stamp;
  out.sample.gyro_B = frd();
  (void)reader.read<std::uint32_t>();  // interval of the gyro
  const std::size_t where = reader.position();
  if (reader.read<std::int32_t>() == kNone) throw Damage(where, "it has no accelerometer");
  out.sample.accel_B = frd();
  return out;
}

/// The messages of the points of a scan, each after its length.
PointCloud decode_ti_scan(Encoding encoding, Bytes messages) {
  Header header;
  std::vector<float> values;
  WireReader points(messages);
  while (points.remaining() > 0) {
    WireReader reader = reader_of(encoding, points.block());
    const Header of_point = read_header(&reader);
    if (values.empty()) header = of_point;
    (void)reader.read<std::uint16_t>();  // number of the point
    std::array<float, 5> xyz_range_velocity{};
    for (float& value : xyz_range_velocity) value = reader.read<float>();
    (void)reader.read<std::uint16_t>();  // Doppler bin
    (void)reader.read<float>();          // bearing
    const auto intensity = reader.read<float>();
    const auto& p = xyz_range_velocity;
    values.insert(values.end(), {p[0], p[1], p[2], intensity, p[4]});
  }
  return floats(header, {"x", "y", "z", "intensity", "velocity"}, values);
}

PointCloud decode_radar_scan(Encoding encoding, Bytes message) {
  const std::vector<std::string> names = {"range", "azimuth", "elevation", "doppler_velocity",
                                          "amplitude"};
  WireReader reader = reader_of(encoding, message);
  const Header header = read_header(&reader);
  const auto count = reader.read<std::uint32_t>();
  std::vector<float> values;
  for (std::uint64_t i = 0; i < std::uint64_t{count} * names.size(); ++i) {  // ends with the bytes
    values.push_back(reader.read<float>());
  }
  return floats(header, names, values);
}

Quaternion read_xyzw(WireReader* reader) {
  Quaternion q;
  for (double& value : q.coeffs()) value = reader->read<double>();
  const double norm = q.norm();
  if (!(std::abs(norm - 1.0) < 0.01))
    throw Damage(reader->position(), "no unit quaternion, which a pose needs");
  return q.normalized();
}

void check_points(const PointCloud& cloud, std::size_t where) {
  if (cloud.size() == 0) return;
  const std::uint64_t row = std::uint64_t{cloud.width} * cloud.point_step;
  const std::uint64_t last_row = std::uint64_t{cloud.height - 1} * cloud.row_step;
  const std::uint64_t bytes = cloud.data.size();
  if (cloud.point_step == 0 || cloud.size() > bytes / cloud.point_step || last_row > bytes - row) {
    throw Damage(where, "a cloud of " + std::to_string(cloud.width) + " x " +
                            std::to_string(cloud.height) + " points of " +
                            std::to_string(cloud.point_step) + " bytes in " +
                            std::to_string(cloud.data.size()) + " bytes");
  }
  for (const PointField& field : cloud.fields) {
    const std::uint32_t size = datatype_size(field.datatype);
    if (size == 0 || std::uint64_t{field.offset} + size > cloud.point_step) {
      throw Damage(where, "field \"" + field.name + "\" is of no known type or outside of a point");
    }
  }
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

PointCloud decode_cloud(Encoding encoding, Bytes message) {
  WireReader reader = reader_of(encoding, message);
  PointCloud cloud;
  cloud.header = read_header(&reader);
  cloud.height = reader.read<std::uint32_t>();
  cloud.width = reader.read<std::uint32_t>();
  const auto count = reader.read<std::uint32_t>();
  for (std::uint32_t i = 0; i < count; ++i) {  // ends with the bytes, whatever `count` says
    PointField field;
    field.name = reader.text();
    field.offset = reader.read<std::uint32_t>();
    field.datatype = reader.read<std::uint8_t>();
    (void)reader.read<std::uint32_t>();  // the first number of an array is used
    cloud.fields.push_back(std::move(field));
  }
  cloud.big_endian = reader.read<std::uint8_t>() != 0;
  cloud.point_step = reader.read<std::uint32_t>();
  cloud.row_step = reader.read<std::uint32_t>();
  const std::size_t where = reader.position();
  cloud.data = reader.block();
  check_points(cloud, where);
  return cloud;
}

PointCloud decode_old_cloud(Encoding encoding, Bytes message) {
  WireReader reader = reader_of(encoding, message);
  const Header header = read_header(&reader);
  const auto width = reader.read<std::uint32_t>();
  std::vector<std::vector<float>> columns(3);
  for (std::uint32_t i = 0; i < width; ++i) {  // ends with the bytes
    for (std::size_t k = 0; k < 3; ++k) columns[k].push_back(reader.read<float>());
  }
  std::vector<std::string> names = {"x", "y", "z"};
  const auto channels = reader.read<std::uint32_t>();
  for (std::uint32_t k = 0; k < channels; ++k) {
    names.emplace_back(reader.text());
    const std::size_t where = reader.position();
    if (reader.read<std::uint32_t>() != width) {
      throw Damage(where, "channel \"" + names.back() + "\" has not one number a point");
    }
    std::vector<float>& column = columns.emplace_back();
    for (std::uint32_t i = 0; i < width; ++i) column.push_back(reader.read<float>());
  }
  std::vector<float> values;
  for (std::uint32_t i = 0; i < width; ++i) {
    for (const std::vector<float>& column : columns) values.push_back(column[i]);
  }
  return floats(header, names, values);
}

bool is_ti_scan(const std::string& type) {
  return type.find("mmwave") != std::string::npos && type.ends_with("/RadarScan");
}

bool is_cloud(const std::string& type) {
  return type == kCloudType || type == kOldCloudType || is_ti_scan(type) || type == kRadarScanType;
}

PointCloud decode_cloud_of(const Topic& topic, Bytes message) {
  if (is_ti_scan(topic.type)) return decode_ti_scan(topic.encoding, message);
  if (topic.type == kRadarScanType) return decode_radar_scan(topic.encoding, message);
  return topic.type == kOldCloudType ? decode_old_cloud(topic.encoding, message)
                                     : decode_cloud(topic.encoding, message);
}

std::optional<std::uint32_t> ti_point_id(Encoding encoding, Bytes message) {
  try {
    WireReader reader = reader_of(encoding, message);
    (void)read_header(&reader);
    return reader.read<std::uint16_t>();
  } catch (const Damage&) {
    return std::nullopt;
  }
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

double decode_pressure(Encoding encoding, Bytes message, Header* header) {
  WireReader reader = reader_of(encoding, message);
  *header = read_header(&reader);
  const std::size_t where = reader.position();
  const auto pressure = reader.read<double>();
  if (!(std::isfinite(pressure) && pressure > 0.0))
    throw Damage(where, "a pressure that is not above zero");
  return pressure;
}

bool is_transforms(const Topic& topic) {
  const bool type = topic.type == "tf2_msgs/TFMessage" || topic.type == "tf/tfMessage";
  return type && topic.name.ends_with("tf_static");
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
    transform.pose.translation = read_vector(&reader);
    transform.pose.rotation = read_xyzw(&reader);
    out.push_back(transform);
  }
  return out;
}

Header decode_header(Encoding encoding, Bytes message) {
  WireReader reader = reader_of(encoding, message);
  return read_header(&reader);
}

bool begins_with_header(const Topic& topic) {
  if (topic.encoding == Encoding::kOther) return false;
  if (is_ti_scan(topic.type)) return false;  // the messages of a scan
  if (topic.type == kHeaderType || topic.type == kImuType || is_cloud(topic.type) ||
      is_truth(topic.type) || topic.type == kPressureType) {
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

std::string datatype_name(std::uint8_t datatype) {
  constexpr std::array<const char*, 9> kNames = {"",      "int8",   "uint8",   "int16",  "uint16",
                                                 "int32", "uint32", "float32", "float64"};
  return datatype < kNames.size() ? kNames[datatype] : "";
}

std::uint32_t datatype_size(std::uint8_t datatype) {
  constexpr std::array<std::uint32_t, 9> kSizes = {0, 1, 1, 2, 2, 4, 4, 4, 8};
  return datatype < kSizes.size() ? kSizes[datatype] : 0;
}

double number_of_type(const std::uint8_t* bytes, std::uint8_t datatype, bool big_endian) {
  switch (datatype) {
    case 1:
      return number_at<std::int8_t>(bytes, big_endian);
    case 2:
      return number_at<std::uint8_t>(bytes, big_endian);
    case 3:
      return number_at<std::int16_t>(bytes, big_endian);
    case 4:
      return number_at<std::uint16_t>(bytes, big_endian);
    case 5:
      return number_at<std::int32_t>(bytes, big_endian);
    case 6:
      return number_at<std::uint32_t>(bytes, big_endian);
    case 7:
      return static_cast<double>(number_at<float>(bytes, big_endian));
    default:
      return number_at<double>(bytes, big_endian);
  }
}

std::string fields_text(const std::vector<PointField>& fields) {
  std::string text;
  for (const PointField& field : fields) {
    text += (text.empty() ? "" : ", ") + field.name + " " + datatype_name(field.datatype) + " @" +
            std::to_string(field.offset);
  }
  return text;
}

}  // namespace rio::bag
