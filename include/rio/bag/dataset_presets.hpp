// SPDX-License-Identifier: BSD-3-Clause
// Public data sets by name: what is known of their topics, axes and mounting (data/datasets.md).
#pragma once

#include <array>
#include <span>
#include <string>

#include "rio/bag/recording.hpp"

namespace rio::bag {

/// Topics are those of RecordingRequest, with alternatives.
struct DatasetPreset {
  const char* name;
  const char* meaning;
  const char* imu;
  const char* radar = "";
  const char* pressure = "";
  const char* truth = "";
  const char* points = "";         ///< preset of points; empty: by their fields
  const char* axes = "";           ///< of the points; wins over the preset of points
  std::optional<Axes> imu_axes{};  ///< of the messages
  /// Pose of the radar (forward, left, up) in the IMU frame: x y z [m], quaternion w x y z.
  std::array<double, 7> mounting{};  ///< all zero: not known
  const char* doubt = "";            ///< what no source settles

  bool is_mounted() const { return mounting != std::array<double, 7>{}; }
  Pose T_BS() const;
};

std::span<const DatasetPreset> dataset_presets();

/// @throws std::runtime_error that lists the names if there is none like it
const DatasetPreset& dataset_preset(const std::string& name);

/// The published mounting, if there is one and the recording has none. True: it was taken.
bool take_mounting(const DatasetPreset& preset, io::RadarInfo* radar);

/// What to ask for in a recording of the data set.
RecordingRequest request_of(const DatasetPreset& preset);

}  // namespace rio::bag
