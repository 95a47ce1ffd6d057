// SPDX-License-Identifier: BSD-3-Clause
// The samples and scans of a recording in the order of a replay, streamed.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "check/check.hpp"
#include "rio/io/recording_stream.hpp"
#include "rio/types.hpp"

namespace rio::tools {

/// The beginning of a recording, for `rio check`: all of one of ten minutes. While the estimator
/// runs, the samples of the IMU are only counted.
class CheckedPart {
 public:
  /// @param sensors their properties
  CheckedPart(const io::Dataset& sensors, const io::RecordingOutline& outline);

  /// In the order of each sensor.
  /// @{
  void add(const ImuSample& sample);
  void add(const RadarScan& scan, std::size_t radar);
  /// @}
  /// Whether it accepts more data.
  bool open() const { return !full_; }
  /// Length of the covered part [s]; empty: all.
  std::optional<double> seconds() const;
  /// Reads the samples of the IMU a second time.
  const check::CheckedData& read(io::RecordingStream* stream);

 private:
  check::CheckedData data_;
  bool full_ = false;
  double seconds_ = 0.0;  ///< of the IMU, without pauses
  std::size_t imu_samples_ = 0;
  Time last_{0};  ///< sample
  std::size_t bytes_ = 0;
};

/// When to give each scan: at its stamp, or, if that is out of order, at the next one in order. In
/// order is the longest increasing sequence, so that one outlier holds up no other scan. Empty if
/// these are the stamps themselves.
std::optional<std::vector<Time>> due_times(const std::vector<Time>& stamps);

class ReplayFeed {
 public:
  /// @param kept receives the samples, if not null
  ReplayFeed(io::RecordingStream* stream, CheckedPart* kept);

  /// The next sample, or the one after; null if there is none. Valid until the next call.
  const ImuSample* imu(std::size_t ahead = 0);
  void pass_imu() { --samples_; }

  /// When the next scan of any radar is due; empty if there is none.
  std::optional<Time> due() const;
  /// That scan, with its radar; valid until the next call.
  const RadarScan& take_scan(std::size_t* radar);
  std::size_t scans_left() const;

  /// Reads on as long as `kept` accepts data.
  void read_rest();

 private:
  struct Radar {
    const std::vector<Time>* stamps;
    std::optional<std::vector<Time>> odd;  ///< due_times()
    std::size_t next = 0;
    std::size_t count = stamps->size();

    bool any() const { return next < count; }
    Time due() const { return odd ? (*odd)[next] : (*stamps)[next]; }
  };
  std::size_t first_due() const;  ///< radar; the number of radars if none has a scan

  io::RecordingStream* stream_;
  CheckedPart* kept_;
  std::array<ImuSample, 2> imu_{};  ///< read, but not yet given
  std::size_t samples_ = 0;         ///< number of these; the last ones
  std::vector<Radar> radars_;
  RadarScan scan_;
};

}  // namespace rio::tools
