// SPDX-License-Identifier: BSD-3-Clause
// The definitions of the written message types, as rosbag2 and viewers expect them: each member
// type follows a line of "=".
#pragma once

namespace rio::bag {

#define RIO_NEXT_TYPE \
  "================================================================================\nMSG: "

inline constexpr char kHeaderText[] = RIO_NEXT_TYPE
    "std_msgs/Header\n"
    "builtin_interfaces/Time stamp\n"
    "string frame_id\n" RIO_NEXT_TYPE
    "builtin_interfaces/Time\n"
    "int32 sec\n"
    "uint32 nanosec\n";

inline constexpr char kImuText[] =
    "std_msgs/Header header\n"
    "geometry_msgs/Quaternion orientation\n"
    "float64[9] orientation_covariance\n"
    "geometry_msgs/Vector3 angular_velocity\n"
    "float64[9] angular_velocity_covariance\n"
    "geometry_msgs/Vector3 linear_acceleration\n"
    "float64[9] linear_acceleration_covariance\n" RIO_NEXT_TYPE
    "geometry_msgs/Quaternion\n"
    "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n" RIO_NEXT_TYPE
    "geometry_msgs/Vector3\n"
    "float64 x\nfloat64 y\nfloat64 z\n";

inline constexpr char kCloudText[] =
    "std_msgs/Header header\n"
    "uint32 height\n"
    "uint32 width\n"
    "sensor_msgs/PointField[] fields\n"
    "bool is_bigendian\n"
    "uint32 point_step\n"
    "uint32 row_step\n"
    "uint8[] data\n"
    "bool is_dense\n" RIO_NEXT_TYPE
    "sensor_msgs/PointField\n"
    "uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\nuint8 INT32=5\nuint8 UINT32=6\n"
    "uint8 FLOAT32=7\nuint8 FLOAT64=8\n"
    "string name\n"
    "uint32 offset\n"
    "uint8 datatype\n"
    "uint32 count\n";

#undef RIO_NEXT_TYPE

}  // namespace rio::bag
