// SPDX-License-Identifier: BSD-3-Clause
#include "rio/bag/messages.hpp"

#include <algorithm>
#include <array>
#include <bit>
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

/// A vector and its covariance, whose first number is -1 if there is no such sensor (REP 145).
Vector3d read_measured(WireReader* reader, const char* name) {
  Vector3d v = read_vector(reader);
  const std::size_t where = reader->position();
  const auto first = reader->read<double>();
  for (int i = 1; i < 9; ++i) (void)reader->read<double>();
  if (first == -1.0) throw Damage(where, std::string("says that it has no ") + name);
  return v;
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

ImuSample decode_imu(Encoding encoding, Bytes message, Header* header) {
  WireReader reader = reader_of(encoding, message);
  *header = read_header(&reader);
  for (int i = 0; i < 4 + 9; ++i) (void)reader.read<double>();  // orientation and its covariance
  ImuSample sample;
  sample.time = header->stamp;
  sample.gyro_B = read_measured(&reader, "gyroscope");
  sample.accel_B = read_measured(&reader, "accelerometer");
  return sample;
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
  constexpr std::uint8_t kFloat32 = 7;
  constexpr std::uint32_t kSize = 4;
  WireReader reader = reader_of(encoding, message);
  PointCloud cloud;
  cloud.header = read_header(&reader);
  cloud.height = 1;
  cloud.width = reader.read<std::uint32_t>();
  std::vector<std::vector<float>> columns(3);
  for (std::uint32_t i = 0; i < cloud.width; ++i) {  // ends with the bytes
    for (std::size_t k = 0; k < 3; ++k) columns[k].push_back(reader.read<float>());
  }
  std::vector<std::string> names = {"x", "y", "z"};
  const auto channels = reader.read<std::uint32_t>();
  for (std::uint32_t k = 0; k < channels; ++k) {
    names.emplace_back(reader.text());
    const std::size_t where = reader.position();
    if (reader.read<std::uint32_t>() != cloud.width) {
      throw Damage(where, "channel \"" + names.back() + "\" has not one number a point");
    }
    std::vector<float>& column = columns.emplace_back();
    for (std::uint32_t i = 0; i < cloud.width; ++i) column.push_back(reader.read<float>());
  }
  cloud.point_step = static_cast<std::uint32_t>(columns.size()) * kSize;
  auto data = std::make_shared<std::vector<std::uint8_t>>(cloud.size() * cloud.point_step);
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const auto offset = static_cast<std::uint32_t>(k) * kSize;
    cloud.fields.push_back({names[k], offset, kFloat32});
    for (std::size_t i = 0; i < columns[k].size(); ++i) {
      std::memcpy(data->data() + i * cloud.point_step + offset, &columns[k][i], kSize);
    }
  }
  cloud.big_endian = std::endian::native == std::endian::big;
  cloud.data = *data;
  cloud.own = std::move(data);
  return cloud;
}

bool is_cloud(const std::string& type) {
  return type == kCloudType || type == kOldCloudType;
}

PointCloud decode_cloud_of(const Topic& topic, Bytes message) {
  return topic.type == kOldCloudType ? decode_old_cloud(topic.encoding, message)
                                     : decode_cloud(topic.encoding, message);
}

Header decode_header(Encoding encoding, Bytes message) {
  WireReader reader = reader_of(encoding, message);
  return read_header(&reader);
}

bool begins_with_header(const Topic& topic) {
  if (topic.encoding == Encoding::kOther) return false;
  if (topic.type == kHeaderType || topic.type == kImuType || is_cloud(topic.type)) {
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
