// SPDX-License-Identifier: BSD-3-Clause
// A recording in the layout of dataset.hpp, written while it is made.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "rio/io/dataset.hpp"
#include "rio/io/text_file.hpp"

namespace rio::io {

/// Reads back as what was added, to the last bit. All functions throw std::runtime_error if a file
/// cannot be written.
class DatasetStream {
 public:
  /// Writes the sensor files of `info`, whose data are not looked at, and begins the others.
  /// Throws if `path` holds a recording already.
  DatasetStream(const std::filesystem::path& path, const Dataset& info);

  void add(const ImuSample& sample);
  /// A scan with the stamp of the one before of the same radar is left out: in the file both would
  /// be one.
  /// @param radar one of those in `info`
  void add(const RadarScan& scan, std::size_t radar = 0);

  /// What was added survives the end of this program.
  void flush();
  void close();

 private:
  struct Radar {
    TextFile file;
    Time last{0};
    bool any = false;
  };

  TextFile imu_;
  std::vector<Radar> radars_;
};

}  // namespace rio::io
