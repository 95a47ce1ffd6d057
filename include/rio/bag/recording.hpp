// SPDX-License-Identifier: BSD-3-Clause
// The samples and scans of a recording on one clock, as a data set of rio.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "rio/bag/point_fields.hpp"
#include "rio/io/dataset.hpp"
#include "rio/io/recording_stream.hpp"

namespace rio::bag {

/// Source of the stamps of a topic.
enum class Clock {
  kAuto,     ///< see RecordingRequest
  kHeader,   ///< the header of each message
  kReceive,  ///< the time of recording
  kCarried,  ///< the header, shifted by the median of receive - header: the recorder's clock
             ///< without the jitter of transport
  kTrigger   ///< of a scan: the header of the message of its hardware trigger
};
constexpr std::array<std::string_view, 5> names_of(Clock) {
  return {"auto", "header", "receive", "carried", "trigger"};
}

/// The trigger of a scan: the last one received before it, either of those with its sequence number
/// (ROS 1) or of all. If the driver delivers scans a frame late, `earlier` is wrong.
enum class TriggerMatch { kSequence, kEarlier };
constexpr std::array<std::string_view, 2> names_of(TriggerMatch) {
  return {"sequence", "earlier"};
}

/// kAuto: the headers of both topics if none is zero and both clocks agree to a second, or if
/// headers or triggers are selected for the other topic; else kCarried, or kReceive for a topic
/// with zero stamps. Clocks are compared by the smallest delay of a topic: one that arrives later
/// and later is on its clock. Barometer and ground truth are stamped as the IMU is; on another
/// clock, or with zero stamps, as kAuto does.
/// A topic may be several with | between: the first that has messages counts, an empty one at the
/// end stands for the default.
struct RecordingRequest {
  std::string imu_topic;    ///< empty: the only one, or gyroscope and accelerometer on two topics
  std::string radar_topic;  ///< several: separated by commas; empty: the only one, or all of whose
                            ///< mountings /tf_static knows
  std::string pressure_topic;  ///< empty: the only sensor_msgs/FluidPressure
  std::string truth_topic;     ///< empty: the only geometry_msgs/PoseStamped or nav_msgs/Odometry
  bool truth = false;          ///< reads the ground truth
  /// If there is no pose at all, the ground truth may be the only geometry_msgs/PointStamped or
  /// sensor_msgs/NavSatFix: east, north, up of the first fix, its attitude NaN.
  bool positions = false;
  Clock imu_clock = Clock::kAuto;
  Clock radar_clock = Clock::kAuto;
  std::string trigger_topic;  ///< for kTrigger; empty: the only std_msgs/Header
  TriggerMatch trigger_match = TriggerMatch::kSequence;
  double imu_offset = 0.0;       ///< added to the stamps [s]
  double radar_offset = 0.0;     ///< added to the stamps [s]
  std::optional<Axes> imu_axes;  ///< of the messages; none: frd of PX4, flu of others
  double gyro_unit = 1.0;        ///< [rad/s]
  double accel_unit = 1.0;       ///< [m/s^2]
  PointRequest points;
  bool mounting_is_known = false;  ///< from another source: no note about it
};

/// Reads IMU, radars, barometer and ground truth of a file for open_messages(); the types are those
/// of messages.hpp. Messages that cannot be decoded, scans with the stamp of the scan before, scans
/// without a trigger and points that are not finite are dropped and counted in the notes. If the
/// clock of the headers jumps, later headers are moved so that it goes on as the messages were
/// received. Messages that come late are used in the order of their stamps. A pause of all sensors,
/// which may be a clock set forward, is told in the notes. Forces of an accelerometer on its own
/// topic are not interpolated across a gap. The notes also list assignments and assumptions.
/// @throws std::runtime_error that lists the topics if one is missing or not unique; if the fields
/// of the points do not fit; if no readable data are left
io::Dataset read_recording(const std::filesystem::path& path, const RecordingRequest& request);

/// The same, sample by sample; throws as read_recording() does.
std::unique_ptr<io::RecordingStream> open_recording(const std::filesystem::path& path,
                                                    const RecordingRequest& request);

/// The settings to read recordings of one kind, from a file: topics, clocks, units, and the
/// assignment of point fields.
///
///     imu: {topic: /imu/data, clock: header, gyro_unit: deg/s}
///     radar:
///       axes: rdf
///       fields: {doppler: [rdot*-1, velocity], snr: power*0.1}
///
/// Missing keys keep the value of `base`.
/// @throws std::runtime_error "FILE:LINE: ..." for unknown keys, clocks and units, and for values
/// that are not text; PointMap checks field names once there are points
RecordingRequest load_recording_map(const std::filesystem::path& path, RecordingRequest base = {});

/// The ground truth of a file for open_messages(): stamped as the recording in it would be by
/// default, else by the headers.
/// @param positions RecordingRequest::positions
/// @param topic RecordingRequest::truth_topic
/// @throws std::runtime_error if there is no topic with one, or several
std::vector<NavState> read_truth(const std::filesystem::path& path, bool positions = false,
                                 const std::string& topic = {});

}  // namespace rio::bag
