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

/// The estimate at every scan. An empty name: no such file.
class EstimateFiles : public Listener {
 public:
  /// @param states as `rio replay --states`
  /// @param json lines of JSON: t [ns], p [m], q (w x y z), v [m/s], 1-sigma of position, attitude
  /// and velocity, health, quality, radar, detections, and the number of static ones; "-" is
  /// standard output
  EstimateFiles(const std::string& tum, const std::string& states, const std::string& json);

  void on_estimate(const Session& session, Time arrival) override;
  void on_end() override;

 private:
  io::PathFiles path_;
  std::optional<io::TextFile> json_;
  bool to_stdout_ = false;
};

/// The inputs of the estimator in a file. Once a second they are flushed to the system, so that a
/// crash loses no more.
template <class File, class About>
class RecorderTo : public Listener {
 public:
  RecorderTo(const std::filesystem::path& path, const About& about) : file_(path, about) {}

  void on_imu(const Session& /*session*/, const ImuSample& sample) override {
    file_.add(sample);
    if (sample.time - flushed_ < std::chrono::seconds(1)) return;
    flushed_ = sample.time;
    file_.flush();
  }
  void on_scan(const Session& /*session*/, const RadarScan& scan, std::size_t radar) override {
    file_.add(scan, radar);
  }
  void on_end() override { file_.close(); }

 private:
  File file_;
  Time flushed_{0};
};
/// A data set for `rio replay`, of sensors with these properties.
using Recorder = RecorderTo<io::DatasetStream, io::Dataset>;
/// MCAP of ROS 2, of so many radars.
using McapRecorder = RecorderTo<bag::RecordingWriter, std::size_t>;

}  // namespace rio::live
