// SPDX-License-Identifier: BSD-3-Clause
// One pass over a ROS recording: the topics that may be its sensors, the choice among them, their
// stamps on one clock, dropped data; private to rio_bag.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <deque>
#include <exception>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "io/doppler_grid.hpp"
#include "rio/bag/messages.hpp"
#include "rio/bag/recording.hpp"
#include "rio/bag/summary.hpp"
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

/// The tree of frames of /tf_static.
class Frames {
 public:
  void add(const std::vector<Transform>& transforms) {
    for (const Transform& t : transforms) of_child_[t.child] = t;
  }
  /// Transforms that may move, which are not read.
  void pass_by_moving() { moving_ = true; }
  /// A message that cannot be read.
  void refuse(const std::string& why) { refused_ = why; }
  /// Why pose() is empty; empty without any transform.
  std::string why_not(const std::string& frame, const std::string& in) const {
    if (!refused_.empty()) return "a message of /tf_static cannot be read: " + refused_;
    if (of_child_.empty()) {
      return moving_ ? "transforms on /tf are not read: a fixed one belongs on /tf_static" : "";
    }
    if (frame.empty() || in.empty()) {
      return fmt::format("the messages of the {} have no frame_id", in.empty() ? "IMU" : "radar");
    }
    const bool loops = to_root(frame).root.empty() || to_root(in).root.empty();
    return loops ? "the frames of /tf_static make a loop"
                 : fmt::format("/tf_static does not connect {} with {}", frame, in);
  }
  /// The pose of a frame in another one; empty if they are not in one tree.
  std::optional<Pose> pose(const std::string& frame, const std::string& in) const {
    const auto [root, a] = to_root(frame);
    const auto [other_root, b] = to_root(in);
    if (root != other_root || root.empty()) return std::nullopt;
    const Quaternion back = b.rotation.conjugate();
    return Pose{back * a.rotation, back * (a.translation - b.translation)};
  }

 private:
  struct Rooted {
    std::string root;  ///< empty: a loop
    Pose pose;
  };
  Rooted to_root(std::string frame) const {
    if (frame.starts_with('/')) frame.erase(0, 1);
    Pose pose;
    for (std::size_t i = 0; i <= of_child_.size(); ++i) {
      const auto up = of_child_.find(frame);
      if (up == of_child_.end()) return {frame, pose};
      const Pose& T = up->second.pose;
      pose = {T.rotation * pose.rotation, T.rotation * pose.translation + T.translation};
      frame = up->second.parent;
    }
    return {};
  }

  std::map<std::string, Transform> of_child_;
  std::string refused_;  ///< why the last message was
  bool moving_ = false;
};

/// A topic that may have a role, while it is read.
struct Source {
  Role role;
  Stamps stamps{};
  std::string type{};   ///< of its messages
  std::string frame{};  ///< of the first message
  std::size_t unreadable = 0;
  std::string first_error{};
  // of an IMU
  std::size_t without_gyro = 0;  ///< messages
  std::size_t without_accel = 0;
  std::size_t absent = 0;  ///< messages that say that they have no values
  std::size_t denied = 0;  ///< the same, but have some
  // of a radar
  std::optional<CloudReader> clouds{};
  io::DopplerGrid grid{};
  std::vector<std::string> notes{};
  std::exception_ptr failed{};
  // of a barometer, of the ground truth
  std::vector<io::BaroSample> baro{};
  std::vector<NavState> truth{};
  bool has_velocity = true;
  std::optional<Vector3d> first_fix{};

  bool only_gyro() const { return without_accel == stamps.count && without_gyro < stamps.count; }
  bool only_accel() const { return without_gyro == stamps.count && without_accel < stamps.count; }
};

class Sources {
 public:
  /// Reads all of the file; choose() throws as read_recording() does.
  Sources(const std::filesystem::path& path, const RecordingRequest& request);
  void choose();

  /// All topics of a role that have messages.
  std::vector<Source*> with_messages(const std::string& role);
  /// Of the ground truth: "truth", or "positions" if they will do and there are no poses.
  const char* truth_role() {
    return request_.positions && with_messages("truth").empty() ? "positions" : "truth";
  }
  /// All with a role in the result.
  std::vector<Source*> used() const;
  const std::string& damage() const { return summary_.damage; }
  const std::filesystem::path& path() const { return path_; }
  /// choose() leaves of each name with alternatives the one that is there.
  const RecordingRequest& request() const { return request_; }

  template <class... Args>
  void note(fmt::format_string<Args...> text, Args&&... args) {
    notes.push_back(fmt::format(text, std::forward<Args>(args)...));
  }
  /// Of messages that cannot be read.
  void note_left_out(const std::string& topic, std::size_t count, const std::string& first) {
    note("{}: {} messages cannot be read and are left out; the first one, {}", topic, count, first);
  }
  /// Throws with the name of the file.
  template <class... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> text, Args&&... args) const {
    throw std::runtime_error(path_.string() + ": " +
                             fmt::format(text, std::forward<Args>(args)...));
  }

  Source* imu = nullptr;    ///< or its gyroscope
  Source* accel = nullptr;  ///< if on another topic
  std::vector<Source*> radars;
  Source* trigger = nullptr;
  Source* baro = nullptr;
  Source* truth = nullptr;
  Frames frames;
  std::vector<std::string> notes;

 private:
  std::string present(const std::string& role, const std::string& names);
  Source* find(const std::string& role, const std::string& name);
  void use(const Message& message);
  void decode(Source* source, const Topic& topic, const Message& message);
  /// The sources of a role with messages: those requested, in this order, or all of its type.
  std::vector<Source*> found(const std::string& role, const std::string& names);
  [[noreturn]] void fail_ambiguous(const Source& one, const std::string& why = {}) const;
  Source* only(const std::vector<Source*>& sources) const;
  /// Null if there is none, or several of which none is requested.
  Source* choose_optional(const std::string& role, const std::string& name);
  void choose_imu();
  void choose_radars();
  void check_number_of_radars() const;

  std::filesystem::path path_;
  RecordingRequest request_;
  std::unique_ptr<MessageStream> stream_;
  std::vector<Role> wanted_;
  std::deque<Source> sources_;
  std::vector<std::vector<Source*>> uses_;  ///< of each topic
  Summary summary_;
  RadarScan scan_;
};

struct Surveyed {
  io::RecordingOutline outline;
  struct Imu {
    Role role{"imu", kImuType, {}};
    Stamping stamping;
    Time interval{0};  ///< mean, between messages
    Time late{0};      ///< up to which messages are behind others of later stamps
  };
  Imu imu;                   ///< or its gyroscope alone,
  std::optional<Imu> accel;  ///< and its accelerometer
  struct Radar {
    Role role{"radar", kCloudType, {}};
    /// For each readable scan, its place in the outline; none if it is left out.
    std::vector<std::optional<std::size_t>> place;
  };
  std::vector<Radar> radars;
  std::vector<io::BaroSample> baro;
};

/// The stamps of all used sources on one clock, in `out`.
void put_on_one_clock(Sources* sources, Surveyed* out);

/// Throws as read_recording() does.
Surveyed survey(const std::filesystem::path& path, const RecordingRequest& request);

}  // namespace rio::bag
