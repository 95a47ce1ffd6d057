// SPDX-License-Identifier: BSD-3-Clause
// The page about one run.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "view/page.hpp"

namespace rio::view {

/// Gathers a run as a page; verdict and further lines of the card are the caller's.
class ReportBuilder : public RunSink {
 public:
  void begin(const RunStart& start) override;
  /// The recording begins, if begin() did not know when.
  void begin_at(Time time) {
    if (!start_.begin) start_.begin = time;
  }
  void add(const Odometry& odometry) override;
  void add_event(const Event& event) override { page_.events.push_back(event); }
  void close() override;

  /// After close().
  Page& page() { return page_; }

 private:
  void add_state(const Odometry& odometry);
  void add_calibration(const UpdateReport& report);
  void add_models(const UpdateReport& report);
  void add_points(const Odometry& odometry, double seconds);
  void add_truth(const Odometry& odometry, double seconds);
  double rate_bin() const;  ///< of the histogram [m/s]
  void finish_histogram();

  Page page_;
  RunStart start_;
  bool begun_ = false;
  double yaw_ = 0.0;            ///< unwound [rad]
  double yaw_sigma_ = 0.0;      ///< [deg]
  std::size_t next_truth_ = 1;  ///< first true pose after the newest scan
  std::optional<Pose> over_;    ///< lays the truth over the estimate
  Vector3d last_truth_ = Vector3d::Zero();
  double truth_length_ = 0.0;      ///< [m]
  Time last_time_{0};              ///< of the newest estimate
  Time error_time_ = Time::min();  ///< of the newest one with an error
  double last_error_ = 0.0;        ///< [m]
  double squares_ = 0.0;           ///< of the position errors before it [m^2]
  std::size_t instants_ = 0;       ///< with a position error
  std::map<std::string, std::pair<double, double>> calibration_;  ///< newest value and sigma
  std::map<int, std::uint64_t> rates_;  ///< range rates by bins of rate_bin()
};

}  // namespace rio::view
