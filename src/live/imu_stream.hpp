// SPDX-License-Identifier: BSD-3-Clause
// The samples of an IMU as bytes, in two formats of this library.
//
// Binary, 38 bytes a sample, little-endian:
//
//    0  u8[2]   'R' 'I'
//    2  u8      version, 1
//    3  u8      sequence: counts the samples, wraps
// 4  i64     stamp [ns], of any clock with a steady rate
//   12  f32[3]  angular rate, x forward, y left, z up [rad/s]
//   24  f32[3]  specific force, same axes, +g upwards at rest [m/s^2]
//   36  u16     CRC-16/MCRF4XX of bytes 2 to 35
//
// 115200 baud are sufficient for 300 samples a second, 921600 baud for 2400.
//
// CSV, a line per sample, as in imu0/data.csv: stamp [ns], rate x, y, z, force x, y, z. Lines that
// begin with # are ignored.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "rio/types.hpp"

namespace rio::live {

inline constexpr std::size_t kImuFrame = 38;

/// The binary frame of a sample; its numbers are rounded to float.
std::array<std::uint8_t, kImuFrame> imu_frame(const ImuSample& sample, std::uint8_t sequence);

struct ImuCounters {
  std::uint64_t samples = 0;  ///< delivered
  std::uint64_t lost = 0;     ///< missing sequence numbers
  std::uint64_t damaged = 0;  ///< frames with a wrong checksum, invalid lines
};

/// Bytes in pieces of any size -> samples. Every undamaged frame is found, in any surroundings.
class ImuFrameReader {
 public:
  /// @param on_sample called as on_sample(const ImuSample&)
  template <class OnSample>
  void push(const std::uint8_t* bytes, std::size_t count, OnSample&& on_sample) {
    for (std::size_t i = 0; i < count; ++i) {
      frame_[stored_++] = bytes[i];
      while (stored_ > 0 && !may_be_frame()) shift();
      if (stored_ == kImuFrame && take()) on_sample(sample_);
    }
  }
  const ImuCounters& counters() const { return counters_; }

 private:
  bool may_be_frame() const;
  bool take();
  void shift();

  std::array<std::uint8_t, kImuFrame> frame_{};
  std::size_t stored_ = 0;
  std::uint8_t expected_ = 0;  ///< sequence of the next
  ImuSample sample_;
  ImuCounters counters_;
};

/// The same for lines.
class ImuLineReader {
 public:
  template <class OnSample>
  void push(const std::uint8_t* bytes, std::size_t count, OnSample&& on_sample) {
    for (std::size_t i = 0; i < count; ++i) {
      if (bytes[i] != '\n') {
        if (line_.size() < kLongest) line_ += static_cast<char>(bytes[i]);
        continue;
      }
      if (take()) on_sample(sample_);
      line_.clear();
    }
  }
  const ImuCounters& counters() const { return counters_; }

 private:
  static constexpr std::size_t kLongest = 512;

  bool take();

  std::string line_;
  ImuSample sample_;
  ImuCounters counters_;
};

}  // namespace rio::live
