// SPDX-License-Identifier: BSD-3-Clause
// Messages with the points of a scan, of any type.
#include <array>
#include <bit>
#include <cstring>
#include <iterator>

#include "rio/bag/messages.hpp"

namespace rio::bag {

namespace {

/// A type of number of sensor_msgs/PointField.
struct Datatype {
  const char* name;
  std::uint32_t size;  ///< [bytes]
  double (*number)(const std::uint8_t* bytes, bool big_endian);
};
template <class T>
constexpr Datatype datatype(const char* name) {
  return {name, sizeof(T), [](const std::uint8_t* bytes, bool big_endian) {
            return static_cast<double>(number_at<T>(bytes, big_endian));
          }};
}
constexpr Datatype kDatatypes[] = {{"", 0, [](const std::uint8_t*, bool) { return 0.0; }},  // none
                                   datatype<std::int8_t>("int8"),
                                   datatype<std::uint8_t>("uint8"),
                                   datatype<std::int16_t>("int16"),
                                   datatype<std::uint16_t>("uint16"),
                                   datatype<std::int32_t>("int32"),
                                   datatype<std::uint32_t>("uint32"),
                                   datatype<float>("float32"),
                                   datatype<double>("float64")};

const Datatype& datatype_of(std::uint8_t number) {
  return kDatatypes[number < std::size(kDatatypes) ? number : 0];
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

}  // namespace

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

std::optional<TiPoint> ti_point(Encoding encoding, Bytes message) {
  try {
    WireReader reader = reader_of(encoding, message);
    const Time stamp = read_header(&reader).stamp;
    return TiPoint{stamp, reader.read<std::uint16_t>()};
  } catch (const Damage&) {
    return std::nullopt;
  }
}

std::uint32_t datatype_size(std::uint8_t datatype) {
  return datatype_of(datatype).size;
}

double number_of_type(const std::uint8_t* bytes, std::uint8_t datatype, bool big_endian) {
  return datatype_of(datatype).number(bytes, big_endian);
}

std::string fields_text(const std::vector<PointField>& fields) {
  std::string text;
  for (const PointField& field : fields) {
    text += (text.empty() ? "" : ", ") + field.name + " " + datatype_of(field.datatype).name +
            " @" + std::to_string(field.offset);
  }
  return text;
}

}  // namespace rio::bag
