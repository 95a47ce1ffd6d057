// SPDX-License-Identifier: BSD-3-Clause
// A run as CSV files, one a kind, for pandas and spreadsheets. Every row begins with
// t_ns, the corrected time of the estimate, and stamp_ns, the stamp of the scan as recorded; every
// header says quantity, unit and axes.
//
//   scans.csv        state, sigmas, points, landmarks, update time
//   innovations.csv  every measurement: innovation, sigma, NIS, gate, result
//   points.csv       every detection: label, position, residual
//   landmarks.csv    every landmark with its covariance
//   calibration.csv  every estimated parameter with sigma and observability
//   health.csv       state, quality, severities
//   events.csv       what happened
#pragma once

#include <array>
#include <filesystem>

#include "rio/io/text_file.hpp"
#include "view/run.hpp"

namespace rio::view {

inline constexpr std::array kLogFiles = {"scans.csv",     "innovations.csv", "points.csv",
                                         "landmarks.csv", "calibration.csv", "health.csv",
                                         "events.csv"};

class CsvLog : public RunSink {
 public:
  /// Creates the folder if there is none. Throws std::runtime_error if a file cannot be written.
  explicit CsvLog(const std::filesystem::path& folder);

  void add(const Odometry& odometry) override;
  void add_event(const Event& event) override;
  void close() override;

 private:
  io::TextFile scans_, innovations_, points_, landmarks_, calibration_, health_, events_;
};

}  // namespace rio::view
