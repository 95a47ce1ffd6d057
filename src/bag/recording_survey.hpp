// SPDX-License-Identifier: BSD-3-Clause
// One pass over a ROS recording: topics, stamps on one clock, dropped data; private to rio_bag.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "positions.hpp"
#include "rio/bag/messages.hpp"
#include "rio/bag/recording.hpp"
#include "rio/io/recording_stream.hpp"
#include "stamps.hpp"

namespace rio::bag {

/// A topic, and its role in messages.
struct Role {
  const char* role = "";
  std::string type;  ///< the usual one of those for this role
  std::string name;  ///< empty: any of the type

  bool fits(const Topic& topic) const {
    if (topic.encoding == Encoding::kOther || (!name.empty() && topic.name != name)) return false;
    if (type == kImuType) return is_imu(topic.type);
    if (type == kCloudType) return is_cloud(topic.type);
    if (type == kPoseType) return is_truth(topic.type);
    if (type == kPointType) return is_position(topic.type);
    return topic.type == type ||
           (type == kHeaderType && !name.empty() && begins_with_header(topic));
  }
};

/// Throws Damage if the bytes are not such a message.
ImuMessage imu_message(const Topic& topic, const Message& message, const RecordingRequest& request);

/// Scans from clouds, whose fields may change within the recording.
class CloudReader {
 public:
  explicit CloudReader(PointRequest request) : request_(std::move(request)) {}

  /// Replaces the detections; throws Damage if the bytes are not such a message, and as PointMap
  /// does.
  /// @param notes receives the field assignment, if not null
  Header read(const Topic& topic, const Message& message, std::vector<RadarDetection>* detections,
              std::vector<std::string>* notes = nullptr);
  /// The last assignment; null before the first point.
  const PointMap* map() const { return map_ ? &*map_ : nullptr; }
  /// Number of points so far that are not finite.
  std::size_t points_left_out() const { return points_left_out_; }

 private:
  PointRequest request_;
  std::optional<PointMap> map_;
  std::size_t points_left_out_ = 0;
};

struct Surveyed {
  io::RecordingOutline outline;
  struct Imu {
    Role role{"imu", kImuType, {}};
    Stamping stamping;
    Time interval{0};  ///< mean, between messages
  };
  Imu imu;                   ///< or its gyroscope alone,
  std::optional<Imu> accel;  ///< and its accelerometer
  struct Radar {
    Role role{"radar", kCloudType, {}};
    std::vector<bool> kept;  ///< for each readable scan, whether the outline contains it
  };
  std::vector<Radar> radars;
  std::vector<io::BaroSample> baro;
};

/// Throws as read_recording() does.
Surveyed survey(const std::filesystem::path& path, const RecordingRequest& request);

}  // namespace rio::bag
