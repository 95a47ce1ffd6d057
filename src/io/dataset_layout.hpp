// SPDX-License-Identifier: BSD-3-Clause
// Names of folders, files and keys of a recording, and the readers of its parts; private to rio_io.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "rio/io/recording_stream.hpp"

namespace rio::io {

inline constexpr const char* kImu = "imu0";
inline constexpr const char* kRadar = "radar0";
/// r = 0 to 3
inline std::string radar_folder(std::size_t r) {
  return "radar" + std::to_string(r);
}
inline constexpr const char* kBaro = "baro0";
inline constexpr const char* kTruth = "state_groundtruth_estimate0";
inline constexpr const char* kData = "data.csv";
inline constexpr const char* kSensor = "sensor.yaml";

/// A key of sensor.yaml, the unit of its plain numbers, and its target. Keys with the same target
/// exclude each other.
struct SensorKey {
  const char* key;
  const char* unit;
  double factor;  ///< from that unit to SI
  std::optional<double>* target;
  bool is_signed = false;  ///< else negative values are refused
};

/// The keys of imu0/sensor.yaml.
std::vector<SensorKey> imu_keys(ImuInfo* info);
/// The keys of radar0/sensor.yaml; plain numbers of keys that end in _deg are degrees.
std::vector<SensorKey> radar_keys(RadarInfo* info);

/// Reads imu0/sensor.yaml; a missing file is a note.
void read_imu_info(const std::filesystem::path& path, Dataset* dataset);
/// Reads radar0/sensor.yaml; a missing file, and a file without T_BS, are notes.
void read_radar_info(const std::filesystem::path& path, RadarInfo* info,
                     std::vector<std::string>* notes);

/// One pass over a dataset folder; throws as read_dataset() does.
RecordingOutline survey(const std::filesystem::path& root, Truth truth);

}  // namespace rio::io
