// SPDX-License-Identifier: BSD-3-Clause
// Decoders of the ROS messages for odometry, from serialised bytes: ROS 1, and CDR of ROS 2.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
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
inline constexpr char kPx4ImuType[] = "px4_msgs/SensorCombined";
inline constexpr char kTiScanType[] = "ti_mmwave_rospkg/RadarScan";
inline constexpr char kRadarScanType[] = "radar_msgs/RadarScan";
inline constexpr char kPoseType[] = "geometry_msgs/PoseStamped";
inline constexpr char kOdometryType[] = "nav_msgs/Odometry";
inline constexpr char kTransformType[] = "geometry_msgs/TransformStamped";
inline constexpr char kPointType[] = "geometry_msgs/PointStamped";
inline constexpr char kFixType[] = "sensor_msgs/NavSatFix";
inline constexpr char kPressureType[] = "sensor_msgs/FluidPressure";

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
    const std::uint64_t begin = i / width * row_step + i % width * point_step;
    return data.subspan(static_cast<std::size_t>(begin), point_step);
  }
};

/// At the begin of a message; throws Damage for any other encoding than ROS 1 and CDR.
inline WireReader reader_of(Encoding encoding, Bytes message) {
  if (encoding == Encoding::kCdr) return WireReader::cdr(message);
  if (encoding == Encoding::kRos1) return WireReader(message);
  throw Damage(0, "neither ROS 1 nor CDR");
}

/// std_msgs/Header.
inline Header read_header(WireReader* reader) {
  Header header;
  if (!reader->is_cdr()) header.sequence = reader->read<std::uint32_t>();
  // seconds: unsigned in ROS 1, signed in ROS 2; they differ beyond 2038 only
  header.stamp = std::chrono::seconds(reader->read<std::uint32_t>());
  header.stamp += Time(reader->read<std::uint32_t>());
  header.frame_id = reader->text();
  return header;
}

/// All decoders throw Damage with the position if the bytes are not such a message.
/// @{
PointCloud decode_cloud(Encoding encoding, Bytes message);
inline Header decode_header(Encoding encoding, Bytes message) {
  WireReader reader = reader_of(encoding, message);
  return read_header(&reader);
}
/// @}

/// An IMU message of any type, in its own axes; the stamp of px4_msgs/SensorCombined is the time
/// since boot.
struct ImuMessage {
  Header header;
  ImuSample sample;
  bool gyro = true;     ///< not all zero
  bool accel = true;    ///< the same
  bool absent = false;  ///< a covariance says that there is none of one (REP 145), and it is zero
  bool denied = false;  ///< the same, but it is not zero
};
bool is_imu(const std::string& type);
ImuMessage decode_imu_of(const Topic& topic, Bytes message);

/// Whether a message of the type is a point of a scan, as kTiScanType; of any package of that
/// driver.
bool is_ti_scan(const std::string& type);
/// Whether the type is one of those for points.
bool is_cloud(const std::string& type);
/// Decodes any of them. ti_mmwave_rospkg/RadarScan: the messages of a scan, each after its length.
PointCloud decode_cloud_of(const Topic& topic, Bytes message);
/// A message of ti_mmwave_rospkg/RadarScan.
struct TiPoint {
  Time stamp{0};
  std::uint32_t id = 0;  ///< in its scan; some drivers leave it zero
};
/// Empty if the bytes are not such a message.
std::optional<TiPoint> ti_point(Encoding encoding, Bytes message);

/// A pose of geometry_msgs/PoseStamped, PoseWithCovarianceStamped, TransformStamped or
/// nav_msgs/Odometry.
bool is_truth(const std::string& type);
/// @param has_velocity whether there is one, in world axes
NavState decode_truth(const Topic& topic, Bytes message, Header* header, bool* has_velocity);
/// Ground truth without an attitude: geometry_msgs/PointStamped of a total station, or
/// sensor_msgs/NavSatFix of GNSS.
bool is_position(const std::string& type);
/// @param first the first fix of the topic: latitude, longitude [deg], altitude [m]; is set if
/// empty
/// @return the position, the rest NaN. Of a fix it is east, north and up of the first one [m],
/// along the ellipsoid WGS 84: the local tangent within 2 mm in 100 m, 0.2 m in 1 km, up to 50 deg
/// of latitude. Throws Damage as well if it is not finite, or no fix.
NavState decode_position(const Topic& topic, Bytes message, Header* header,
                         std::optional<Vector3d>* first);
/// sensor_msgs/FluidPressure [Pa]. Throws Damage as well if it is not above zero.
double decode_pressure(Encoding encoding, Bytes message, Header* header);

/// A transform of tf2_msgs/TFMessage: the pose of `child` in `parent`.
struct Transform {
  std::string parent;
  std::string child;
  Pose pose;
};
bool is_transforms(const Topic& topic);         ///< those that do not change
bool is_moving_transforms(const Topic& topic);  ///< the others
std::vector<Transform> decode_transforms(Encoding encoding, Bytes message);

/// Whether messages of this topic are known to begin with a std_msgs/Header.
bool begins_with_header(const Topic& topic);

/// Bytes of the type; 0 if there is no such type.
std::uint32_t datatype_size(std::uint8_t datatype);
/// The number of this type in the first bytes.
double number_of_type(const std::uint8_t* bytes, std::uint8_t datatype, bool big_endian);

/// "x float32 @0, y float32 @4"
std::string fields_text(const std::vector<PointField>& fields);

}  // namespace rio::bag
