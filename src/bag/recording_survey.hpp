// SPDX-License-Identifier: BSD-3-Clause
// All of a recording of ROS read once: topics, stamps on one clock, what is left out; private to
// rio_bag.
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

/// A topic, and what it is for in messages.
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

/// Throws Damage if it is no such message.
ImuSample imu_sample(const Topic& topic, const Message& message, const RecordingRequest& request,
                     Header* header);

/// Scans of clouds, whose fields may change on the way.
class CloudReader {
 public:
  explicit CloudReader(PointRequest request) : request_(std::move(request)) {}

  /// Replaces the detections; throws Damage if it is no such message, and as PointMap does.
  /// @param notes gets what was matched, if it is not null
  void read(const Topic& topic, const Message& message, Header* header,
            std::vector<RadarDetection>* detections, std::vector<std::string>* notes);
  /// So far, as they are not finite.
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
  bool imu_received = false;  ///< the IMU is stamped when it was received, else by its headers
  Time imu_shift{0};          ///< added to these stamps
  std::vector<bool> kept;     ///< of each readable scan, whether it is one of the outline
};

/// Throws as read_recording() does.
Surveyed survey(const std::filesystem::path& path, const RecordingRequest& request);

}  // namespace rio::bag
