// SPDX-License-Identifier: BSD-3-Clause
// The port of the IMU of `rio live`: samples from its bytes; why there are none, or no start.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "live/imu_stream.hpp"
#include "rio/ti/packet_reader.hpp"

namespace rio::tools {

class ImuPort {
 public:
  using OnSample = std::function<void(const ImuSample& sample)>;

  /// @param format binary, csv, mavlink or mavlink-raw
  explicit ImuPort(const std::string& format) : format_(format) {}

  bool is_mavlink() const { return format_.starts_with("mavlink"); }
  /// The bytes, and their samples unless they are MAVLink.
  void take(const std::uint8_t* bytes, std::size_t count, Time arrival, const OnSample& on_sample);
  /// A sample before the start.
  /// @return once why there is no start, after some seconds; mostly empty
  std::string wait(const ImuSample& sample);

  /// Unless they are MAVLink.
  const live::ImuCounters& counters() const {
    return format_ == "csv" ? lines_.counters() : frames_.counters();
  }
  /// After "no sample".
  /// @param messages of MAVLink that came
  std::string why_no_sample(const std::string& messages) const;
  /// What `rio check` says of the samples before the start.
  std::string why_no_start() const;

 private:
  std::string format_;
  live::ImuFrameReader frames_;
  live::ImuLineReader lines_;
  ti::PacketReader others_;               ///< before the first sample: they may be a radar's
  std::vector<ImuSample> first_samples_;  ///< before the start
  bool told_ = false;                     ///< why there is none
};

}  // namespace rio::tools
