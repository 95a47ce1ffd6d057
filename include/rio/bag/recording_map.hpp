// SPDX-License-Identifier: BSD-3-Clause
// A file with the settings to read recordings of one kind: topics, clocks, units, and the
// assignment of point fields.
//
//   imu: {topic: /imu/data, clock: header, gyro_unit: deg/s}
//   radar:
//     axes: rdf
//     fields: {doppler: [rdot*-1, velocity], snr: power*0.1}
#pragma once

#include <filesystem>

#include "rio/bag/recording.hpp"

namespace rio::bag {

/// Missing keys keep the value of `base`.
/// @throws std::runtime_error "FILE:LINE: ..." for unknown keys, clocks and units, and for values
/// that are not text; PointMap checks field names once there are points
RecordingRequest load_recording_map(const std::filesystem::path& path, RecordingRequest base = {});

}  // namespace rio::bag
