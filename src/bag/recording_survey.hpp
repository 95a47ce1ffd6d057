// SPDX-License-Identifier: BSD-3-Clause
// One pass over a ROS recording: topics, stamps on one clock, dropped data; private to rio_bag.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "rio/bag/messages.hpp"
#include "rio/bag/recording.hpp"
#include "rio/io/recording_stream.hpp"

namespace rio::bag {

/// A topic, and its role in messages.
struct Role {
  const char* role;
  std::string type;
  std::string name;  ///< empty: any of the type

  bool fits(const Topic& topic) const {
    return topic.encoding != Encoding::kOther && (name.empty() || topic.name == name) &&
           (topic.type == type || (type == kCloudType && is_cloud(topic.type)) ||
            (type == kHeaderType && !name.empty() && begins_with_header(topic)));
  }
};

/// Throws Damage if the bytes are not such a message.
ImuSample imu_sample(const Topic& topic, const Message& message, const RecordingRequest& request,
                     Header* header);

/// Scans from clouds, whose fields may change within the recording.
class CloudReader {
 public:
  explicit CloudReader(PointRequest request) : request_(std::move(request)) {}

  /// Replaces the detections; throws Damage if the bytes are not such a message, and as PointMap
  /// does.
  /// @param notes receives the field assignment, if not null
  void read(const Topic& topic, const Message& message, Header* header,
            std::vector<RadarDetection>* detections, std::vector<std::string>* notes);
  /// Number of points so far that are not finite.
  std::size_t points_left_out() const { return points_left_out_; }

 private:
  PointRequest request_;
  std::optional<PointMap> map_;
  std::size_t points_left_out_ = 0;
};

struct Surveyed {
  io::RecordingOutline outline;
  Role imu{"imu", kImuType, {}};
  Role radar{"radar", kCloudType, {}};
  bool imu_received = false;  ///< the IMU has receive stamps, else those of its headers
  Time imu_shift{0};          ///< added to these stamps
  std::vector<bool> kept;     ///< for each readable scan, whether the outline contains it
};

/// Throws as read_recording() does.
Surveyed survey(const std::filesystem::path& path, const RecordingRequest& request);

}  // namespace rio::bag
