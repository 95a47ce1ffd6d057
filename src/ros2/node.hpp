// SPDX-License-Identifier: BSD-3-Clause
// The node: subscriptions -> estimator -> publishers, in one thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rio/bag/messages.hpp"
#include "rio/bag/point_fields.hpp"
#include "rio/io/barometer.hpp"
#include "rio/rio.hpp"
#include "ros2/dds.hpp"
#include "ros2/outputs.hpp"
#include "ros2/parameters.hpp"

namespace rio::ros2 {

class Node {
 public:
  /// @throws std::runtime_error for parameters, files and DDS
  Node(const Parameters& parameters, unsigned domain);

  /// Waits for messages, 0.2 s at most, and takes all of them.
  void step();
  /// What was taken, and what was refused and why.
  std::string summary() const;

 private:
  struct Radar {
    Reader reader;
    bag::Topic topic;
    std::optional<bag::PointMap> map;
    std::uint64_t scans = 0;
  };

  void make_options();
  void subscribe();
  /// Names the topics of IMU and radars on which nothing has come.
  std::string silence() const;
  /// Takes the messages that have come; one that is not what its type says is left out, and told of
  /// the first of each topic.
  template <class TakeOne>
  void take(Reader* reader, const std::string& topic, const TakeOne& take_one);
  void take_imu();
  void take_scans(std::size_t radar);
  void take_pressure();
  void take_reset();
  /// Within a call of the estimator, which does not throw.
  void publish_scan() noexcept;

  Parameters parameters_;
  Participant participant_;
  Options options_;
  std::unique_ptr<Odometry> odometry_;
  std::optional<Outputs> outputs_;
  std::optional<Reader> imu_;
  std::optional<Reader> pressure_;
  std::optional<Reader> reset_;
  std::deque<Radar> radars_;
  std::vector<std::uint8_t> bytes_;
  RadarScan scan_;
  io::BarometricScale heights_;  ///< zero at the first pressure since the start or a reset
  /// When silence is told.
  std::optional<std::chrono::steady_clock::time_point> silent_at_ =
      std::chrono::steady_clock::now() + std::chrono::seconds(10);
  std::exception_ptr error_;  ///< of publishing
  std::uint64_t imu_samples_ = 0;
  std::uint64_t refused_ = 0;
  std::vector<std::string> refusals_;  ///< topics of which it has been said
  Time newest_{0};
  Time diagnosed_{0};
};

}  // namespace rio::ros2
