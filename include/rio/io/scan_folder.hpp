// SPDX-License-Identifier: BSD-3-Clause
// Sequences of public data sets that are distributed as folders with a file per scan.
//
//   ColoRadar  imu/imu_data.txt            accel x y z [m/s^2], gyro x y z [rad/s]
//              imu/timestamps.txt          [s]
//              single_chip/pointclouds/data/radar_pointcloud_N.bin   float32 x y z (TI's axes) [m],
//                                          intensity, doppler [m/s]
//              single_chip/pointclouds/timestamps.txt   [s]
//              groundtruth/                of a frame of the rig: for read_trajectory() alone
//   HeRCULES   sensor_data/xsens_imu.csv   t [ns], q xyzw, 3 angles, gyro, accel, magnetic field
//              Radar/Continental/T.bin     T [ns]; float32 x y z [m], doppler [m/s], range;
//                                          a byte of RCS; float32 azimuth, elevation
#pragma once

#include <filesystem>
#include <memory>

#include "rio/io/recording_stream.hpp"

namespace rio::io {

/// Whether it is one of these.
bool is_scan_folder(const std::filesystem::path& path);

/// What open_dataset() does for such a folder. Holds all of the IMU, and one scan at a time.
/// @throws std::runtime_error with the name of a file that is missing or damaged
std::unique_ptr<RecordingStream> open_scan_folder(const std::filesystem::path& path);

}  // namespace rio::io
