// SPDX-License-Identifier: BSD-3-Clause
// Decoders of the ROS messages for odometry, from serialised bytes: ROS 1, and CDR of ROS 2.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "rio/bag/message_stream.hpp"
#include "rio/bag/wire.hpp"
#include "rio/types.hpp"

namespace rio::bag {

inline constexpr char kImuType[] = "sensor_msgs/Imu";
inline constexpr char kCloudType[] = "sensor_msgs/PointCloud2";
inline constexpr char kOldCloudType[] = "sensor_msgs/PointCloud";
inline constexpr char kHeaderType[] = "std_msgs/Header";

/// std_msgs/Header.
struct Header {
  Time stamp{0};
  std::uint32_t sequence = 0;  ///< only in ROS 1
  std::string frame_id;
};

/// sensor_msgs/PointField.
struct PointField {
  std::string name;
  std::uint32_t offset = 0;  ///< of its first byte in a point
  std::uint8_t datatype =
      0;  ///< 1 to 8: int8, uint8, int16, uint16, int32, uint32, float32, float64
  bool operator==(const PointField&) const = default;
};

/// sensor_msgs/PointCloud2; all points lie inside `data`. A sensor_msgs/PointCloud is converted to
/// one with float32 x, y, z and a field for each of its channels.
struct PointCloud {
  Header header;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<PointField> fields;
  bool big_endian = false;
  std::uint32_t point_step = 0;                          ///< bytes of a point
  std::uint32_t row_step = 0;                            ///< bytes of a row
  Bytes data;                                            ///< valid as long as the message, or `own`
  std::shared_ptr<const std::vector<std::uint8_t>> own;  ///< the data, if not in the message

  std::uint64_t size() const { return std::uint64_t{width} * height; }
  /// The bytes of point i, row after row.
  Bytes point(std::uint64_t i) const {
    return data.subspan(i / width * row_step + i % width * point_step, point_step);
  }
};

/// All decoders throw Damage with the position if the bytes are not such a message.
/// @{
ImuSample decode_imu(Encoding encoding, Bytes message, Header* header);
PointCloud decode_cloud(Encoding encoding, Bytes message);
PointCloud decode_old_cloud(Encoding encoding, Bytes message);
Header decode_header(Encoding encoding, Bytes message);
/// @}

/// Whether the type is one of the two cloud types.
bool is_cloud(const std::string& type);
/// Decodes either of the two cloud types.
PointCloud decode_cloud_of(const Topic& topic, Bytes message);

/// Whether messages of this topic are known to begin with a std_msgs/Header.
bool begins_with_header(const Topic& topic);

/// "float32" and so on; empty if there is no such type.
std::string datatype_name(std::uint8_t datatype);
/// Bytes of the type; 0 if there is no such type.
std::uint32_t datatype_size(std::uint8_t datatype);
/// The number of this type in the first bytes.
double number_of_type(const std::uint8_t* bytes, std::uint8_t datatype, bool big_endian);

/// "x float32 @0, y float32 @4"
std::string fields_text(const std::vector<PointField>& fields);

}  // namespace rio::bag
