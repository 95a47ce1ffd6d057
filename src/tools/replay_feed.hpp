// SPDX-License-Identifier: BSD-3-Clause
// Where an estimate begins, and the samples and scans of the recording in its order, streamed.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "check/clock_steps.hpp"
#include "commands.hpp"
#include "recording.hpp"
#include "rio/io/barometer.hpp"
#include "rio/io/recording_stream.hpp"
#include "rio/io/start.hpp"
#include "rio/options.hpp"
#include "rio/types.hpp"

namespace rio::tools {

/// First state and covariance, with their source.
struct Start : Alignment {
  std::string source;
};

/// Where an estimate begins: at the ground truth, at a state from a file; empty: at rest.
/// @param init groundtruth, static or a file; empty: groundtruth if there is one, else static
/// @param begin stamp of the first sample of the IMU
/// @param end same of the last one
/// @param next called for its samples from the first one on, as far as necessary
/// @throws std::runtime_error if there is no such start
std::optional<Start> make_start(const std::string& init, const std::vector<NavState>& truth,
                                Time begin, Time end, const NextSample& next,
                                const Options& options);

class ReplayFeed {
 public:
  /// From the beginning of the recording.
  /// @param steps of the clocks, to be taken out of the stamps
  explicit ReplayFeed(io::RecordingStream* stream, check::ClockSteps steps = {});

  /// The next sample, or the one after; null if there is none. Valid until the next call.
  const ImuSample* imu(std::size_t ahead = 0);
  void pass_imu() { imu_.pop_front(); }

  /// When the next scan of any radar is due; empty if there is none.
  std::optional<Time> due() const;
  /// That scan, with its radar; valid until the next call.
  const RadarScan& take_scan(std::size_t* radar);
  std::size_t scans_left() const;

 private:
  struct Radar {
    std::vector<Time> due;  ///< when to give each scan
    std::vector<check::ClockStep> steps;
    std::size_t next = 0;

    std::size_t left() const { return due.size() - next; }
    Time next_due() const { return due[next]; }
  };
  std::size_t first_due() const;  ///< radar; the number of radars if none has a scan

  io::RecordingStream* stream_;
  std::deque<ImuSample> imu_;     ///< read, but not yet given
  std::size_t samples_read_ = 0;  ///< of the recording
  std::vector<check::ClockStep> imu_steps_;
  std::vector<Radar> radars_;
  RadarScan scan_;
};

/// The heights of the barometer, which has its own reader, in their order.
class HeightFeed {
 public:
  /// @param stream of whose barometer nothing has been read
  /// @throws std::runtime_error if it has none
  explicit HeightFeed(io::RecordingStream* stream);

  using Height = io::BarometricHeights::Sample;
  /// The next one, if it is not after `until`.
  std::optional<Height> take(Time until);
  double sigma() const { return heights_.sigma; }  ///< [m]

 private:
  io::BarometricHeights heights_;
  std::size_t next_ = 0;
};

}  // namespace rio::tools
