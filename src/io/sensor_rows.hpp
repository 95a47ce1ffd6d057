// SPDX-License-Identifier: BSD-3-Clause
// The data.csv of one sensor, sample by sample; private to rio_io. Every error is a
// std::runtime_error that begins "FILE:LINE: ".
#pragma once

#include <filesystem>

#include "rio/io/csv.hpp"
#include "rio/io/dataset.hpp"

namespace rio::io {

/// Three numbers from cell i on.
Vector3d vector_at(const CsvReader& rows, std::size_t i);

/// In each of these next() replaces the sample or scan; false at the end of the file.
class ImuRows : public CsvReader {
 public:
  explicit ImuRows(const std::filesystem::path& path) : CsvReader(path, ',', true) {
    expect_names({"timestamp", "wx", "wy", "wz", "ax", "ay", "az"});
  }
  bool next(ImuSample* sample);
};

class RadarRows : public CsvReader {
 public:
  explicit RadarRows(const std::filesystem::path& path) : CsvReader(path, ',', true) {
    expect_names({"timestamp", "x", "y", "z", "doppler", "snr", "noise"});
  }
  bool next(RadarScan* scan);

 private:
  RadarDetection detection() const;
  /// By the heading, if there is one.
  bool has_sigmas() const;

  bool begun_ = false;  ///< the current row is the first one of the next scan
  Time time_{0};        ///< of the current row
};

class BaroRows : public CsvReader {
 public:
  explicit BaroRows(const std::filesystem::path& path) : CsvReader(path, ',', true) {}
  bool next(BaroSample* sample);
};

}  // namespace rio::io
