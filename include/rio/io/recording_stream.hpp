// SPDX-License-Identifier: BSD-3-Clause
// Streaming reader of a recording: first all of it is checked, then the samples of each sensor are
// given one by one. Memory holds some of them and the stamps of the scans, at any length.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <vector>

#include "rio/io/dataset.hpp"

namespace rio::io {

/// Properties of a recording, known before its samples are given.
struct RecordingOutline {
  /// The sensors, the requested ground truth, the notes and the damage; no samples. A radar of
  /// `other_radars` has no scans there.
  Dataset sensors;
  std::size_t imu_samples = 0;
  Time imu_begin{0};  ///< stamp of the first sample in the file, unless it is corrupt
  Time imu_end{0};    ///< stamp of the last one
  /// Some sample is before the one before; in a folder also: some interval is above 0.05 s.
  bool imu_odd = false;
  /// Stamps of the scans in file order, by radar.
  std::vector<std::vector<Time>> scan_times;
  std::size_t baro_samples = 0;
};

/// Created by open_dataset() and bag::open_recording(). All of it has been read once, so errors
/// have been thrown by then. If the file grows meanwhile, only the samples of the outline are
/// given.
class RecordingStream {
 public:
  virtual ~RecordingStream() = default;
  RecordingStream(const RecordingStream&) = delete;
  RecordingStream& operator=(const RecordingStream&) = delete;

  const RecordingOutline& outline() const { return outline_; }

  /// Replaces the argument by the next sample or scan of a sensor in file order; false at the end.
  /// Sensors are independent of each other.
  /// @{
  bool next(ImuSample* sample);
  bool next(RadarScan* scan, std::size_t radar = 0);  ///< radar below outline().scan_times.size()
  bool next(BaroSample* sample);
  /// @}
  /// Rewinds all sensors.
  void rewind();

 protected:
  RecordingStream() = default;
  virtual bool read(ImuSample* sample) = 0;
  virtual bool read(RadarScan* scan, std::size_t radar) = 0;
  virtual bool read(BaroSample* sample) = 0;
  virtual void start_over() = 0;

  RecordingOutline outline_;

 private:
  std::size_t imu_ = 0;  ///< given so far
  std::vector<std::size_t> scans_;
  std::size_t baro_ = 0;
};

/// A folder of dataset.hpp; throws as read_dataset() does.
/// @param truth the part of the ground truth in outline().sensors
std::unique_ptr<RecordingStream> open_dataset(const std::filesystem::path& path,
                                              Truth truth = Truth::kStart);

/// All of it, from the beginning.
Dataset collect(RecordingStream* stream);

}  // namespace rio::io
