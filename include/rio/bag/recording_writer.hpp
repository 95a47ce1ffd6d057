// SPDX-License-Identifier: BSD-3-Clause
// Writer of a ROS 2 recording in MCAP, during the run.
//
//   /imu                 sensor_msgs/msg/Imu without orientation, frame "imu"
//   /radar0, /radar1...  sensor_msgs/msg/PointCloud2, frames "radar0_chip"...: the points as a TI
//                        radar sends them, in axes of the chip (x right, y forward, z up): float32
//                        x, y, z [m], doppler [m/s, + = receding], int16 snr, noise [0.1 dB]
//
// Header stamps and file times are those of the samples and scans. Scans of a TI radar read back to
// the last bit, with the preset "mav" (data/README.md); those of others are rounded to these number
// formats. Mounting and noise are not stored.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>

#include "rio/types.hpp"

namespace rio::bag {

/// All functions throw std::runtime_error if the file cannot be written, or a stamp is outside the
/// range of ROS (1970 to 2106).
class RecordingWriter {
 public:
  /// Throws if the file exists.
  /// @param radars number of radars
  RecordingWriter(const std::filesystem::path& path, std::size_t radars);
  ~RecordingWriter();

  void add(const ImuSample& sample);
  /// A scan before time zero is left out: the clock of the IMU had not begun.
  /// @param radar below the number of radars
  void add(const RadarScan& scan, std::size_t radar = 0);

  /// Added data survive the end of this program, even without close(): they are in complete chunks.
  void flush();
  void close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rio::bag
