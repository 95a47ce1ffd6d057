// SPDX-License-Identifier: BSD-3-Clause
// Messages of ROS of every type that is read: decoded, or a std::runtime_error. The first byte is
// the number of the type, twice; odd ones are CDR.
#include <iterator>
#include <stdexcept>

#include "fuzz/fuzz.hpp"
#include "rio/bag/point_fields.hpp"

namespace rio::bag {

namespace {

constexpr const char* kTypes[] = {
    kImuType,      kPx4ImuType,          kPoseType,  kOdometryType, kTransformType,
    kPressureType, "tf2_msgs/TFMessage", kCloudType, kOldCloudType, kTiScanType,
    kRadarScanType};

void read(const Topic& topic, Bytes message) {
  Header header;
  bool has_velocity = false;
  if (is_imu(topic.type)) (void)decode_imu_of(topic, message);
  if (is_truth(topic.type)) (void)decode_truth(topic, message, &header, &has_velocity);
  if (is_transforms(topic)) (void)decode_transforms(topic.encoding, message);
  if (topic.type == kPressureType) {
    RIO_FUZZ_CHECK(decode_pressure(topic.encoding, message, &header) > 0.0);
  }
  if (!is_cloud(topic.type)) return;
  (void)ti_point(topic.encoding, message);
  const PointCloud cloud = decode_cloud_of(topic, message);
  std::vector<RadarDetection> detections;
  PointMap(cloud.fields, {}).convert(cloud, &detections);
  RIO_FUZZ_CHECK(detections.size() <= message.size());
}

}  // namespace

}  // namespace rio::bag

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rio::bag;  // NOLINT
  if (size == 0) return 0;
  const Encoding encoding = data[0] % 2 == 0 ? Encoding::kRos1 : Encoding::kCdr;
  try {
    read({"/tf_static", kTypes[data[0] / 2 % std::size(kTypes)], encoding, ""},
         {data + 1, size - 1});
  } catch (const std::runtime_error&) {
  }
  return 0;
}
