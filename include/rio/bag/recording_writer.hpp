// SPDX-License-Identifier: BSD-3-Clause
// A recording of ROS 2 in MCAP, written while it is made.
//
//   /imu                 sensor_msgs/msg/Imu without orientation, frame "imu"
//   /radar0, /radar1...  sensor_msgs/msg/PointCloud2, frames "radar0"...: the points as a TI radar
//                        sends them, in axes of the chip (x right, y forward, z up): float32 x, y,
//                        z [m], doppler [m/s, + = receding], int16 snr, noise [0.1 dB]
//
// The stamps of the headers are those of the samples and scans, and so are the times of the file.
// Scans of a TI radar read back to the last bit, by the preset "mav" (data/README.md); of others
// what does not fit into these numbers is rounded. Mounting and noise are not in it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>

#include "rio/types.hpp"

namespace rio::bag {

/// All functions throw std::runtime_error if the file cannot be written, or a stamp is not one of
/// ROS (1970 to 2106).
class RecordingWriter {
 public:
  /// Throws if there is such a file.
  /// @param radars how many
  RecordingWriter(const std::filesystem::path& path, std::size_t radars);
  ~RecordingWriter();

  void add(const ImuSample& sample);
  /// @param radar below the number of radars
  void add(const RadarScan& scan, std::size_t radar = 0);

  /// What was added survives the end of this program, close() or not: it is in whole chunks.
  void flush();
  void close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rio::bag
