// SPDX-License-Identifier: BSD-3-Clause
// A file that says how the recordings of one kind are to be read: topics, clocks, units, and which
// field of a point is what.
//
//   imu: {topic: /imu/data, clock: header, gyro_unit: deg/s}
//   radar:
//     axes: rdf
//     fields: {doppler: [rdot*-1, velocity], snr: power*0.1}
#pragma once

#include <filesystem>

#include "rio/bag/recording.hpp"

namespace rio::bag {

/// Whatever the file does not say stays as in RecordingRequest{}.
/// @throws std::runtime_error "FILE:LINE: ..." for unknown keys, clocks and units, and what is no
/// text; names of fields are looked at where there are points, by PointMap
RecordingRequest load_recording_map(const std::filesystem::path& path);

}  // namespace rio::bag
