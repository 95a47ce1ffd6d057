// SPDX-License-Identifier: BSD-3-Clause
// The node: subscriptions -> estimator -> publishers, in one thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bag/recording_sources.hpp"
#include "rio/bag/messages.hpp"
#include "rio/bag/recording.hpp"
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

  /// Hands over the oldest message that has come; waits for one, 0.2 s at most.
  void step();
  /// What was taken, and what was refused and why.
  std::string summary() const;

 private:
  /// A subscription to messages that begin with a header.
  struct Source {
    Reader reader;
    bag::Topic topic;
    void (Node::*hand_over)(Source*);
    std::size_t radar = 0;
    bag::CloudReader cloud;               ///< of a radar
    std::vector<std::uint8_t> message{};  ///< the oldest one, if one waits
    std::optional<Time> stamp{};          ///< of it
    std::uint64_t taken = 0;
    bool refused = false;  ///< it was told of a message that was left out
  };

  void make_options();
  /// How the messages are read. @throws std::runtime_error if there is no such preset or file
  void make_request();
  void subscribe();
  /// Names the topics of IMU and radars on which nothing has come.
  std::string silence() const;
  /// Of the messages that wait the one with the oldest stamp, so that after a stall of the machine
  /// the sensors go on side by side; nullptr if none waits.
  Source* oldest();
  /// False if the message is not what its type and `request_` say: it is left out, and told of the
  /// first of each topic.
  template <class Decode>
  bool decode(Source* source, const Decode& decode_it);
  void add_imu(Source* source);
  void add_scan(Source* source);
  void add_pressure(Source* source);
  void take_reset();
  /// Within a call of the estimator, which does not throw.
  void publish_scan() noexcept;

  Parameters parameters_;
  Participant participant_;
  Options options_;
  bag::RecordingRequest request_;
  std::unique_ptr<Odometry> odometry_;
  std::optional<Outputs> outputs_;
  std::vector<Source> sources_;  ///< IMU, radars, pressure
  std::optional<Reader> reset_;
  RadarScan scan_;
  io::BarometricScale heights_;  ///< zero at the first pressure since the start or a reset
  /// When silence is told.
  std::optional<std::chrono::steady_clock::time_point> silent_at_ =
      std::chrono::steady_clock::now() + std::chrono::seconds(10);
  std::exception_ptr error_;  ///< of publishing
  std::uint64_t refused_ = 0;
  Time newest_{0};
  Time diagnosed_{0};
};

}  // namespace rio::ros2
