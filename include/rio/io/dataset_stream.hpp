// SPDX-License-Identifier: BSD-3-Clause
// Writer of a recording in the layout of dataset.hpp, during the run.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include "rio/io/dataset.hpp"
#include "rio/io/text_file.hpp"

namespace rio::io {

/// Whether a detection has sigmas of its own.
bool has_sigmas(const std::vector<RadarScan>& scans);

/// Reads back identically, to the last bit. All functions throw std::runtime_error if a file cannot
/// be written.
class DatasetStream {
 public:
  /// Writes the sensor files of `info`, ignoring its data, and begins the data files. Throws if
  /// `path` holds a recording already.
  DatasetStream(const std::filesystem::path& path, const Dataset& info);

  void add(const ImuSample& sample);
  /// A scan with the same stamp as the one before of the same radar is dropped: in the file they
  /// would merge.
  /// @param radar one of those in `info`
  void add(const RadarScan& scan, std::size_t radar = 0);

  /// Added data survive the end of this program.
  void flush();
  void close();

 private:
  struct Radar {
    TextFile file;
    std::optional<Time> last{};  ///< stamp
  };

  TextFile imu_;
  std::vector<Radar> radars_;
};

}  // namespace rio::io
