// SPDX-License-Identifier: BSD-3-Clause
// A recording that is read while it is used: first all of it is looked at, then the samples of each
// sensor come one by one. In memory are some of them and the stamps of the scans, however long it
// is.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "rio/io/dataset.hpp"

namespace rio::io {

/// What is known of a recording before its samples are given.
struct RecordingOutline {
  /// What is told of the sensors, the ground truth as it was asked for, and the notes; no samples.
  /// A radar of `other_radars` has no scans there.
  Dataset sensors;
  std::size_t imu_samples = 0;
  Time imu_begin{0};  ///< stamp of the first sample in the file
  Time imu_end{0};    ///< stamp of the last one
  /// Stamps of the scans in file order, by radar.
  std::vector<std::vector<Time>> scan_times;
  std::size_t baro_samples = 0;
  /// Empty, or where the file is damaged: the recording is what stands before.
  std::string damage;
};

/// Made by open_dataset(), and by bag::open_recording(). All of it has been read once: what is
/// wrong with it has been thrown by then. Of a file that grows meanwhile the samples of the outline
/// come.
class RecordingStream {
 public:
  virtual ~RecordingStream() = default;
  RecordingStream(const RecordingStream&) = delete;
  RecordingStream& operator=(const RecordingStream&) = delete;

  const RecordingOutline& outline() const { return outline_; }

  /// The next sample or scan of a sensor in file order, in place of the last one; false where there
  /// are no more. Sensors do not wait for each other.
  /// @{
  bool next(ImuSample* sample);
  bool next(RadarScan* scan, std::size_t radar = 0);  ///< radar below outline().scan_times.size()
  bool next(BaroSample* sample);
  /// @}
  /// All sensors begin again.
  void rewind();
  /// The barometer alone does.
  void rewind_baro();

 protected:
  RecordingStream() = default;
  virtual bool read(ImuSample* sample) = 0;
  virtual bool read(RadarScan* scan, std::size_t radar) = 0;
  virtual bool read(BaroSample* sample) = 0;
  virtual void start_over() = 0;
  virtual void start_baro_over() {}

  RecordingOutline outline_;

 private:
  std::size_t imu_ = 0;  ///< given so far
  std::vector<std::size_t> scans_;
  std::size_t baro_ = 0;
};

/// A folder of dataset.hpp; throws as read_dataset() does.
/// @param truth what outline().sensors has of the ground truth
std::unique_ptr<RecordingStream> open_dataset(const std::filesystem::path& path,
                                              Truth truth = Truth::kStart);

/// All of it, from the beginning.
Dataset collect(RecordingStream* stream);

}  // namespace rio::io
