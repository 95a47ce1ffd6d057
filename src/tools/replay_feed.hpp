// SPDX-License-Identifier: BSD-3-Clause
// The samples and scans of a recording in the order in which a replay gives them, read while they
// are given.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "check/check.hpp"
#include "rio/io/recording_stream.hpp"
#include "rio/types.hpp"

namespace rio::tools {

/// The begin of a recording, for `rio check`: all of one of ten minutes. While the estimator runs,
/// the samples of the IMU are only counted.
class CheckedPart {
 public:
  /// @param sensors what is told of them
  CheckedPart(const io::Dataset& sensors, const io::RecordingOutline& outline);

  /// In the order of each sensor.
  /// @{
  void add(const ImuSample& sample);
  void add(const RadarScan& scan, std::size_t radar);
  /// @}
  /// Whether it takes more.
  bool open() const { return !full_; }
  /// How much of the recording it is [s]; nothing: all.
  std::optional<double> seconds() const;
  /// Reads the samples of the IMU again.
  const check::CheckedData& read(io::RecordingStream* stream);

 private:
  check::CheckedData data_;
  bool full_ = false;
  double seconds_ = 0.0;  ///< of the IMU, without pauses
  std::size_t imu_samples_ = 0;
  Time last_{0};  ///< sample
  std::size_t bytes_ = 0;
};

/// When to give each scan: by its stamp, or, if that is out of order, by the next one that is not.
/// In order is the longest rising sequence: one odd stamp holds up no other scan.
/// Nothing where these are the stamps themselves.
std::optional<std::vector<Time>> due_times(const std::vector<Time>& stamps);

class ReplayFeed {
 public:
  /// @param kept gets what is read, if it is not null
  ReplayFeed(io::RecordingStream* stream, CheckedPart* kept);

  /// The next sample, or the one after; null if there is none. Valid until the next call.
  const ImuSample* imu(std::size_t ahead = 0);
  void pass_imu() { --samples_; }

  /// When the next scan of any radar is to be given; nothing if there is none.
  std::optional<Time> due() const;
  /// That scan, and whose it is; valid until the next call.
  const RadarScan& take_scan(std::size_t* radar);
  std::size_t scans_left() const;

  /// Reads on as long as somebody keeps it.
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
  std::array<ImuSample, 2> imu_{};  ///< read, and not yet passed
  std::size_t samples_ = 0;         ///< of these; the last ones
  std::vector<Radar> radars_;
  RadarScan scan_;
};

}  // namespace rio::tools
