// SPDX-License-Identifier: BSD-3-Clause
#include "experiment/soak_flight.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>
#include <vector>

#include "rio/sim/random.hpp"

namespace rio::experiment {

namespace {

using sim::Trajectory;
using Controls = std::vector<Trajectory::Control>;

constexpr Time kPiece = std::chrono::minutes(10);
constexpr double kKnotSpacing = 0.5;  // [s]
constexpr double kStand = 5.0;        // on the ground at either end [s]
constexpr std::size_t kControls = 1185;

/// Steps towards `target` (position and yaw) until it is reached or `most` steps are made.
void fly(const Trajectory::Control& target, double speed, std::size_t most, Controls* controls) {
  constexpr double kYawRate = 0.8;  // [rad/s]
  for (std::size_t i = 0; i < most && controls->back() != target; ++i) {
    Trajectory::Control next = target;
    const Trajectory::Control way = target - controls->back();
    const double step = speed * kKnotSpacing;
    const double distance = way.head<3>().norm();
    if (distance > step) next.head<3>() -= (1.0 - step / distance) * way.head<3>();
    const double turn = kYawRate * kKnotSpacing;
    next[3] = controls->back()[3] + std::clamp(way[3], -turn, turn);
    controls->push_back(next);
  }
}

/// From rest on the ground at the origin, nose along x, to the same.
Trajectory make_piece(std::uint64_t seed, std::int64_t number, Time start) {
  const Trajectory::Control ground = Trajectory::Control::Zero();
  const Trajectory::Control hover(0.0, 0.0, 0.9, 0.0);
  const Vector3d low(-3.0, -2.5, 0.35);
  const Vector3d high(3.0, 2.5, 1.7);
  constexpr std::size_t kHome = 30;  // steps, enough from anywhere
  sim::Random random(seed, 100 + static_cast<std::uint64_t>(number));
  Controls controls(5, ground);
  fly(hover, 0.7, kHome, &controls);
  while (controls.size() < kControls - kHome) {
    const Vector3d to = random.in_box(low, high);
    const double yaw = random.uniform(-1.75, 1.75);
    const double speed = random.uniform(0.45, 1.43);
    const auto steps = static_cast<std::size_t>(random.uniform(3.0, 8.0));
    fly({to.x(), to.y(), to.z(), yaw}, speed, steps, &controls);
  }
  fly(hover, 0.8, kHome, &controls);
  fly(ground, 0.5, kHome, &controls);
  controls.resize(kControls, ground);
  return Trajectory(std::move(controls), {.start = start,
                                          .knot_spacing = kKnotSpacing,
                                          .stand_before = kStand,
                                          .stand_after = kStand});
}

}  // namespace

EndlessFlight::EndlessFlight(const sim::Scenario& scenario)
    : scenario_(scenario),
      imu_(scenario.imu, scenario.seed),
      radar_(scenario.radar, sim::make_room(scenario.seed, scenario.room), scenario.seed) {}

const Trajectory& EndlessFlight::piece_at(Time time) {
  const std::int64_t number = std::max<std::int64_t>(0, (time - scenario_.start) / kPiece);
  Piece& piece = pieces_[number % 2];
  if (piece.number != number) {
    piece = {number, make_piece(scenario_.seed, number, scenario_.start + number * kPiece)};
  }
  return piece.trajectory;
}

ImuSample EndlessFlight::next_imu() {
  const auto period = from_seconds(1.0 / scenario_.imu.rate_hz);
  const Time time = scenario_.start + samples_++ * period;
  return imu_.sample(piece_at(time).at(time));
}

Time EndlessFlight::next_scan_time() const {
  // whole milliseconds plus a fraction: never the stamp of a sample
  constexpr Time kFirst{23'456'789};
  const auto period = std::chrono::milliseconds(std::lround(1e3 / scenario_.radar.rate_hz));
  return scenario_.start + kFirst + scans_ * period;
}

RadarScan EndlessFlight::next_scan() {
  const Time time = next_scan_time();
  ++scans_;
  return radar_.scan(piece_at(time).at(time)).scan;
}

}  // namespace rio::experiment
