// SPDX-License-Identifier: BSD-3-Clause
#include "ros2_types.hpp"

#include <cstdint>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "formats.hpp"
#include "rio/bag/messages.hpp"

namespace rio::bag {

namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

/// The types without their members; "rio/..." are our own.
const std::map<std::string, std::string_view>& texts() {
  static const std::map<std::string, std::string_view> kTexts = {
      {"builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"},
      {"builtin_interfaces/Duration", "int32 sec\nuint32 nanosec\n"},
      {"std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"},
      {"std_msgs/Float64", "float64 data\n"},
      {"std_msgs/ColorRGBA", "float32 r\nfloat32 g\nfloat32 b\nfloat32 a\n"},
      {"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"},
      {"geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"},
      {"geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"},
      {"geometry_msgs/Vector3Stamped", "std_msgs/Header header\ngeometry_msgs/Vector3 vector\n"},
      {"geometry_msgs/Transform",
       "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n"},
      {"geometry_msgs/TransformStamped",
       "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n"},
      {"tf2_msgs/TFMessage", "geometry_msgs/TransformStamped[] transforms\n"},
      {"geometry_msgs/Pose",
       "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"},
      {"geometry_msgs/PoseStamped", "std_msgs/Header header\ngeometry_msgs/Pose pose\n"},
      {"geometry_msgs/PoseWithCovariance", "geometry_msgs/Pose pose\nfloat64[36] covariance\n"},
      {"geometry_msgs/Twist", "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n"},
      {"geometry_msgs/TwistWithCovariance", "geometry_msgs/Twist twist\nfloat64[36] covariance\n"},
      {"nav_msgs/Odometry",
       "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n"
       "geometry_msgs/TwistWithCovariance twist\n"},
      {"nav_msgs/Path", "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n"},
      {"sensor_msgs/Imu",
       "std_msgs/Header header\n"
       "geometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n"
       "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
       "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n"},
      {"sensor_msgs/PointField",
       "uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\nuint8 INT32=5\nuint8 UINT32=6\n"
       "uint8 FLOAT32=7\nuint8 FLOAT64=8\n"
       "string name\nuint32 offset\nuint8 datatype\nuint32 count\n"},
      {"sensor_msgs/PointCloud2",
       "std_msgs/Header header\nuint32 height\nuint32 width\nsensor_msgs/PointField[] fields\n"
       "bool is_bigendian\nuint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n"},
      {"visualization_msgs/Marker",
       "int32 SPHERE=2\nint32 ADD=0\nint32 DELETEALL=3\n"
       "std_msgs/Header header\nstring ns\nint32 id\nint32 type\nint32 action\n"
       "geometry_msgs/Pose pose\ngeometry_msgs/Vector3 scale\nstd_msgs/ColorRGBA color\n"
       "builtin_interfaces/Duration lifetime\nbool frame_locked\ngeometry_msgs/Point[] points\n"
       "std_msgs/ColorRGBA[] colors\nstring text\nstring mesh_resource\n"
       "bool mesh_use_embedded_materials\n"},
      {"visualization_msgs/MarkerArray", "visualization_msgs/Marker[] markers\n"},
      {"rcl_interfaces/Log",
       "byte DEBUG=10\nbyte INFO=20\nbyte WARN=30\nbyte ERROR=40\nbyte FATAL=50\n"
       "builtin_interfaces/Time stamp\nuint8 level\nstring name\nstring msg\nstring file\n"
       "string function\nuint32 line\n"},
      {"rio/Innovation",
       "# one measurement; point: index in the points of the scan\n"
       "string model\nuint16 point\nuint16 rows\nfloat64 innovation\nfloat64 sigma\nfloat64 nis\n"
       "float64 gate\nbool used\n"},
      {"rio/Innovations", "std_msgs/Header header\nrio/Innovation[] innovations\n"}};
  return kTexts;
}

/// Appends the types of members that are not yet in the list.
void collect(std::string_view text, std::vector<std::string>* list, std::set<std::string>* seen) {
  std::istringstream lines{std::string(text)};
  for (std::string line; std::getline(lines, line);) {
    const std::string type = line.substr(0, line.find_first_of(" ["));
    if (type.find('/') == std::string::npos || !seen->insert(type).second) continue;
    list->push_back(type);
    collect(texts().at(type), list, seen);
  }
}

}  // namespace

std::string definition_of(const std::string& type) {
  const std::string_view own = texts().at(ros1_type(type));
  std::vector<std::string> members;
  std::set<std::string> seen;
  collect(own, &members, &seen);
  std::string text(own);
  for (const std::string& member : members) {
    text += std::string(80, '=') + "\nMSG: " + member + "\n";
    text += texts().at(member);
  }
  return text;
}

void put_time(CdrWriter* message, Time stamp) {
  const std::int64_t ns = stamp.count();
  if (ns < 0 || ns / kSecond > UINT32_MAX) {
    throw std::runtime_error("stamp " + std::to_string(ns) + " ns is not one of ROS");
  }
  message->put(static_cast<std::uint32_t>(ns / kSecond));
  message->put(static_cast<std::uint32_t>(ns % kSecond));
}

CdrWriter stamped(Time stamp, const std::string& frame) {
  CdrWriter message;
  put_time(&message, stamp);
  message.text(frame);
  return message;
}

void put_vector(CdrWriter* message, const Vector3d& v) {
  for (const double value : v) message->put(value);
}

void put_quaternion(CdrWriter* message, const Quaternion& q) {
  for (const double value : q.coeffs()) message->put(value);
}

CdrWriter cloud_message(Time stamp, const std::string& frame, std::span<const CloudField> fields,
                        const std::string& points) {
  std::uint32_t size = 0;  // of a point
  for (const CloudField& field : fields) size += datatype_size(field.type);
  const auto row = static_cast<std::uint32_t>(points.size());
  CdrWriter message = stamped(stamp, frame);
  message.put(std::uint32_t{1}).put(row / size);  // height, width
  message.put(static_cast<std::uint32_t>(fields.size()));
  std::uint32_t offset = 0;
  for (const CloudField& field : fields) {
    const std::uint8_t type = field.type;
    message.text(field.name).put(offset).put(type).put(std::uint32_t{1});
    offset += datatype_size(type);
  }
  message.put(std::uint8_t{0}).put(size).put(row);
  return message.block(points).put(std::uint8_t{1});
}

}  // namespace rio::bag
