// SPDX-License-Identifier: BSD-3-Clause
// Outputs of a session to files: estimates and data.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "live/session.hpp"
#include "rio/bag/recording_writer.hpp"
#include "rio/io/dataset_stream.hpp"
#include "rio/io/trajectory.hpp"

namespace rio::live {

/// The estimate at every scan as one line of JSON: t [s], p [m], q (w x y z), v [m/s], 1-sigma of
/// position, attitude and velocity, health, quality, radar, detections, and the number of static
/// ones.
std::string json_line(const Odometry& odometry);

/// The estimate at every scan. An empty name: no such file.
class EstimateFiles : public Listener {
 public:
  struct Names {
    std::string tum;
    std::string states;  ///< as `rio replay --states`
    std::string json;    ///< lines of JSON; "-" is standard output
  };
  explicit EstimateFiles(const Names& names);

  void on_estimate(const Session& session, Time arrival) override;
  void close();

 private:
  std::optional<io::TextFile> tum_;
  std::optional<io::StatesFile> states_;
  std::optional<io::TextFile> json_;
  bool to_stdout_ = false;
  std::optional<Time> written_;  ///< of the newest line of both
};

/// The inputs of the estimator, as a data set for `rio replay`.
class Recorder : public Listener {
 public:
  Recorder(const std::filesystem::path& path, const io::Dataset& info) : stream_(path, info) {}

  void on_imu(const Session& session, const ImuSample& sample) override;
  void on_scan(const Session& session, const RadarScan& scan, std::size_t radar) override;
  void close() { stream_.close(); }

 private:
  io::DatasetStream stream_;
  Time flushed_{0};
};

/// The same in MCAP of ROS 2.
class McapRecorder : public Listener {
 public:
  McapRecorder(const std::filesystem::path& path, std::size_t radars) : file_(path, radars) {}

  void on_imu(const Session& session, const ImuSample& sample) override;
  void on_scan(const Session& session, const RadarScan& scan, std::size_t radar) override;
  void close() { file_.close(); }

 private:
  bag::RecordingWriter file_;
  Time flushed_{0};
};

}  // namespace rio::live
