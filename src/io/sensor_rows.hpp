// SPDX-License-Identifier: BSD-3-Clause
// The data.csv of one sensor, sample by sample; private to rio_io. Every error is a
// std::runtime_error that begins "FILE:LINE: ".
#pragma once

#include <cstdint>
#include <filesystem>

#include "rio/io/csv.hpp"
#include "rio/io/dataset.hpp"

namespace rio::io {

/// Whether the numbers are converted to samples, or only checked: the same errors, in less time.
enum class Numbers : std::uint8_t { kRead, kLookAt };

/// Three numbers from cell i on.
Vector3d vector_at(const CsvReader& rows, std::size_t i);

class ImuRows {
 public:
  explicit ImuRows(const std::filesystem::path& path, Numbers numbers = Numbers::kRead)
      : rows_(path, ',', true), numbers_(numbers) {}

  /// False at the end of the file. If numbers are only checked, the sample has the stamp alone.
  bool next(ImuSample* sample);
  /// CsvReader::cut()
  const std::string& cut() const { return rows_.cut(); }
  /// Whether those of the last sample are.
  bool is_finite() const { return finite_; }
  /// "FILE:LINE" of the last sample.
  std::string place() const { return rows_.place(); }

 private:
  CsvReader rows_;
  Numbers numbers_;
  bool finite_ = true;
};

class RadarRows {
 public:
  explicit RadarRows(const std::filesystem::path& path, Numbers numbers = Numbers::kRead)
      : rows_(path, ',', true), numbers_(numbers) {
    rows_.expect_names({"timestamp", "x", "y", "z", "doppler", "snr", "noise"});
  }

  /// Replaces the scan; false at the end of the file. If numbers are only checked, the detections
  /// have the Doppler alone.
  bool next(RadarScan* scan);
  const std::string& cut() const { return rows_.cut(); }

 private:
  RadarDetection detection() const;
  void look_at_detection(RadarDetection* d) const;

  CsvReader rows_;
  Numbers numbers_;
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
