// SPDX-License-Identifier: BSD-3-Clause
// In place of hardware: a TI radar and an autopilot at the ends of two pseudo-terminals, on a
// simulated flight that runs five times as fast as a real one.
#pragma once

#include <atomic>
#include <chrono>
#include <csignal>
#include <string>
#include <thread>
#include <vector>

#include <rio/mavlink/frame.hpp>
#include <rio/mavlink/parser.hpp>
#include <rio/sim/flight.hpp>

#include "live/host_clock.hpp"
#include "live/player.hpp"

class Hardware {
 public:
  static constexpr double kSpeed = 5.0;

  /// Starts flying.
  Hardware() : thread_([this] { fly(); }) {}
  ~Hardware() {
    over_ = true;
    thread_.join();
  }

  const std::string& radar_port() const { return radar_.path(); }
  const std::string& autopilot_port() const { return autopilot_.path(); }
  const rio::Pose& mounting() const { return flight_.configured_T_BS; }
  rio::ti::FrameTiming timing() const {
    return rio::live::simulated_timing(flight_.scenario.radar.rate_hz);
  }
  rio::NavState truth_at(rio::Time time) const { return flight_.truth_at(time); }
  rio::Time clock() const { return clock_.now(); }  // CLOCK_MONOTONIC, five times as fast
  int odometry_received() const { return received_; }

 private:
  static rio::sim::Flight short_flight() {
    rio::sim::Scenario scenario;
    scenario.seed = 4;
    scenario.max_duration = 15.0;
    return rio::sim::simulate_flight(scenario);
  }

  /// HIGHRES_IMU of every sample.
  std::vector<rio::live::Piece> imu_line() const {
    rio::mavlink::Writer writer({1, 1});
    rio::live::Cable cable({});
    for (const rio::ImuSample& sample : flight_.imu) {
      rio::mavlink::HighresImu message;
      message.time_usec = static_cast<std::uint64_t>(sample.time.count() / 1000);
      for (int i = 0; i < 3; ++i) {
        const float sign = i == 0 ? 1.0F : -1.0F;  // forward, left, up to forward, right, down
        const auto axis = static_cast<std::size_t>(i);
        message.gyro[axis] = sign * static_cast<float>(sample.gyro_B[i]);
        message.accel[axis] = sign * static_cast<float>(sample.accel_B[i]);
      }
      message.fields_updated = 0x3F;
      rio::live::Bytes frame(rio::mavlink::kMaxFrame);
      frame.resize(writer.write(message, frame.data(), frame.size()));
      cable.send(frame, sample.time + std::chrono::microseconds(500));
    }
    return cable.pieces();
  }

  void fly() {
    const std::vector<std::vector<rio::live::Piece>> lines = {
        imu_line(), rio::live::radar_line(flight_.scans, timing(), rio::live::Cable({})).pieces()};
    while (!over_ && !(radar_.is_open() && autopilot_.is_open())) std::this_thread::yield();
    const volatile std::sig_atomic_t never = 0;
    rio::live::play(rio::live::in_order(lines), kSpeed, never,
                    [this](const rio::live::Event& event) {
                      rio::live::Pty& line = event.line == 0 ? autopilot_ : radar_;
                      (void)line.write(event.piece->bytes.data(), event.piece->bytes.size());
                      hear();
                      return !over_;
                    });
    while (!over_) {
      hear();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }

  /// Counts the ODOMETRY that the autopilot gets.
  void hear() {
    std::uint8_t bytes[4096];
    const std::size_t count = autopilot_.read(bytes, sizeof bytes);
    parser_.push(bytes, count, rio::Time{0}, [this](const rio::mavlink::Packet& packet) {
      received_ += packet.id == rio::mavlink::OdometryMessage::kId ? 1 : 0;
    });
  }

  rio::sim::Flight flight_ = short_flight();
  rio::live::HostClock clock_{kSpeed};
  rio::live::Pty radar_;
  rio::live::Pty autopilot_;
  rio::mavlink::Parser parser_;
  std::atomic<int> received_ = 0;
  std::atomic<bool> over_ = false;
  std::thread thread_;  // last: it uses the others
};
