// SPDX-License-Identifier: BSD-3-Clause
// Random flights through a box: zigzag legs, up and down in turn, between two standstills. The
// same rules give a hover (a small box, slow legs), a race through a hall, and a long flight
// outdoors. Frame W: the origin is where the flight starts, level and at yaw 0.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "rio/sim/random.hpp"
#include "rio/sim/trajectory.hpp"
#include "rio/types.hpp"

namespace rio::sim {

/// Where and how a flight goes. Defaults: a small quadrotor flown by hand in a room.
struct PathOptions {
  std::string file{};              ///< recorded path that is flown instead (TUM, or EuRoC csv)
  double length = 150.0;           ///< of the whole path [m]; 0 = the flight ends by `duration`
  double duration = 120.0;         ///< when length is 0: time before the flight turns home [s]
  Vector3d low{-3.0, -2.5, 0.35};  ///< corner of the box of way points [m]
  Vector3d high{3.0, 2.5, 1.7};    ///< opposite corner [m]
  Vector3d reach{2.5, 2.5, 10.0};  ///< longest leg along each axis; short legs turn often [m]
  double min_speed = 0.45;         ///< of a leg [m/s]
  double max_speed = 1.43;         ///< of a leg [m/s]
  double min_leg = 1.5;            ///< a leg ends at its target or after a time in ... [s]
  double max_leg = 4.0;            ///< ... [min_leg, max_leg] [s]
  double max_yaw = 1.75;           ///< the nose swings between - and + this [rad]
  double max_yaw_rate = 1.0;       ///< of the swing; at least 0.3 of it is used [rad/s]
  double knot_spacing = 0.5;       ///< of the spline; longer is smoother [s]
  double fit_spacing = 0.2;        ///< the same for a recorded path; trajectory_fit.hpp [s]
  double stand_before = 4.0;       ///< standstill before take-off [s]
  double stand_after = 2.0;        ///< standstill after landing [s]
};

namespace path_detail {

/// Lays control points along legs; a step is at most speed * spacing, so the spline's speed, a
/// convex combination of steps, never exceeds the leg speeds.
class Planner {
 public:
  Planner(std::uint64_t seed, const PathOptions& options) : random_(seed, 1), options_(options) {
    controls_.assign(5, Trajectory::Control::Zero());
  }
  Random& random() { return random_; }
  std::vector<Trajectory::Control>& controls() { return controls_; }
  Vector3d position() const { return controls_.back().head<3>(); }
  /// Of the control polygon [m]; the curve is never longer.
  double polygon() const { return polygon_; }
  double seconds() const { return options_.knot_spacing * static_cast<double>(controls_.size()); }

  /// Towards `target` [m] at `speed` [m/s] until it is reached or `time` [s] is over.
  void fly(const Vector3d& target, double speed, double time) {
    for (double t = 0.0; t < time && position() != target; t += options_.knot_spacing) {
      const Vector3d way = target - position();
      const double step = std::min(speed * options_.knot_spacing, way.norm());
      turn();
      const Vector3d next =
          way.norm() <= step ? target : Vector3d(position() + step * way.normalized());
      controls_.emplace_back(next.x(), next.y(), next.z(), yaw_);
      polygon_ += step;
    }
  }

 private:
  void turn() {
    if (yaw_ == yaw_target_) {
      yaw_target_ = random_.uniform(-options_.max_yaw, options_.max_yaw);
      yaw_rate_ = random_.uniform(0.3, 1.0) * options_.max_yaw_rate;
    }
    const double step = yaw_rate_ * options_.knot_spacing;
    yaw_ += std::clamp(yaw_target_ - yaw_, -step, step);
    if (std::abs(yaw_target_ - yaw_) < 1e-9) yaw_ = yaw_target_;
  }

  Random random_;
  PathOptions options_;
  double yaw_ = 0.0;
  double yaw_target_ = 0.0;
  double yaw_rate_ = 0.0;
  double polygon_ = 0.0;
  std::vector<Trajectory::Control> controls_;
};

}  // namespace path_detail

/// A flight of the seed: take-off to 0.4 of the height of the box, legs, landing 0.3 to 1 m from
/// the start. `options.file` is not looked at.
inline Trajectory random_flight(std::uint64_t seed, const PathOptions& options = {},
                                Time start = Time(0)) {
  constexpr double kForever = std::numeric_limits<double>::infinity();
  constexpr double kClimbSpeed = 0.7;  // [m/s], take-off
  constexpr double kHomeSpeed = 0.8;
  constexpr double kSinkSpeed = 0.5;
  const Trajectory::Settings settings{.start = start,
                                      .knot_spacing = options.knot_spacing,
                                      .stand_before = options.stand_before,
                                      .stand_after = options.stand_after};
  path_detail::Planner planner(seed, options);
  Random& random = planner.random();
  const double height = options.high.z() - options.low.z();
  const Vector3d hover(0.0, 0.0, options.low.z() + 0.4 * height);
  const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
  const double radius = random.uniform(0.3, 1.0);
  const Vector3d landing(radius * std::cos(angle), radius * std::sin(angle), 0.0);
  planner.fly(hover, kClimbSpeed, kForever);
  for (bool up = true;; up = !up) {
    // beside the box these change places: the leg then ends between its reach and the box
    Vector3d from = (planner.position() - options.reach).cwiseMax(options.low);
    Vector3d to = (planner.position() + options.reach).cwiseMin(options.high);
    if (up) {
      from.z() = std::max(from.z(), options.low.z() + 0.7 * height);
      to.z() = std::max(to.z(), from.z());
    } else {
      to.z() = std::min(to.z(), options.low.z() + 0.33 * height);
      from.z() = std::min(from.z(), to.z());
    }
    const Vector3d target = random.in_box(from, to);
    const double speed = random.uniform(options.min_speed, options.max_speed);
    planner.fly(target, speed, random.uniform(options.min_leg, options.max_leg));

    if (options.length > 0.0 && planner.polygon() + planner.position().norm() < options.length)
      continue;
    if (options.length <= 0.0 && planner.seconds() < options.duration) continue;
    path_detail::Planner home = planner;
    home.fly(landing + hover, std::max(kHomeSpeed, options.max_speed / 2.0), kForever);
    home.fly(landing, kSinkSpeed, kForever);
    home.controls().insert(home.controls().end(), 4, home.controls().back());
    if (options.length > 0.0) {
      const double length = Trajectory(home.controls(), settings).length();
      if (length < options.length) continue;
      // shrinking about the start is exact: the length is homogeneous in the control points
      for (auto& control : home.controls()) control.head<3>() *= options.length / length;
    }
    return Trajectory(std::move(home.controls()), settings);
  }
}

}  // namespace rio::sim
