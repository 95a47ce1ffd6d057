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

class ImuRows {
 public:
  explicit ImuRows(const std::filesystem::path& path) : rows_(path, ',', true) {}

  /// False at the end of the file.
  bool next(ImuSample* sample);
  /// CsvReader::cut()
  const std::string& cut() const { return rows_.cut(); }
  /// "FILE:LINE" of the last sample.
  std::string place() const { return rows_.place(); }

 private:
  CsvReader rows_;
};

class RadarRows {
 public:
  explicit RadarRows(const std::filesystem::path& path) : rows_(path, ',', true) {
    rows_.expect_names({"timestamp", "x", "y", "z", "doppler", "snr", "noise"});
  }

  /// Replaces the scan; false at the end of the file.
  bool next(RadarScan* scan);
  const std::string& cut() const { return rows_.cut(); }

 private:
  RadarDetection detection() const;

  CsvReader rows_;
  bool begun_ = false;  ///< the current row is the first one of the next scan
  Time time_{0};        ///< of the current row
};

class BaroRows {
 public:
  explicit BaroRows(const std::filesystem::path& path) : rows_(path, ',', true) {}

  /// False at the end of the file.
  bool next(BaroSample* sample);
  const std::string& cut() const { return rows_.cut(); }

 private:
  CsvReader rows_;
};

}  // namespace rio::io
