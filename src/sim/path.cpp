// SPDX-License-Identifier: BSD-3-Clause
#include "rio/sim/path.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

namespace rio::sim {

namespace {

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

  /// A point far ahead of the nose [m].
  Vector3d ahead() const {
    return position() + 1000.0 * Vector3d(std::cos(yaw_), std::sin(yaw_), 0.0);
  }

  /// Towards `target` [m] in the plane as a vehicle steers, forward: each step, at least one, is
  /// along the middle of the headings at its ends.
  void drive(const Vector3d& target, double speed, double time) {
    const double h = options_.knot_spacing;
    const double largest = options_.max_yaw_rate * h;
    const double near = speed / options_.max_yaw_rate;  // turning radius [m]
    double t = 0.0;
    do {
      const Vector3d way = target - position();
      const double bearing = std::atan2(way.y(), way.x());
      const double turn =
          std::clamp(std::remainder(bearing - yaw_, 2.0 * std::numbers::pi), -largest, largest);
      const double middle = yaw_ + 0.5 * turn;
      const Vector3d step = speed * h * Vector3d(std::cos(middle), std::sin(middle), 0.0);
      yaw_ += turn;
      const Vector3d next = position() + step;
      controls_.emplace_back(next.x(), next.y(), 0.0, yaw_);
      polygon_ += speed * h;
      t += h;
    } while (t < time && (target - position()).head<2>().norm() > near);
  }

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

/// Legs between way points until the length or the duration is reached.
Trajectory random_drive(std::uint64_t seed, const PathOptions& options,
                        const Trajectory::Settings& settings) {
  constexpr double kMargin = 1.2;  // the curve is shorter than its polygon
  // straight on where the spline accelerates and decelerates: a turn would slip sideways
  const double straight = 4.0 * options.knot_spacing;
  Planner planner(seed, options);
  Random& random = planner.random();
  planner.drive(planner.ahead(), options.min_speed, straight);
  while (options.length > 0.0 ? planner.polygon() < kMargin * options.length
                              : planner.seconds() < options.duration) {
    const Vector3d from = (planner.position() - options.reach).cwiseMax(options.low);
    const Vector3d to = (planner.position() + options.reach).cwiseMin(options.high);
    const Vector3d target = random.in_box(from, to);
    const double speed = random.uniform(options.min_speed, options.max_speed);
    planner.drive(target, speed, random.uniform(options.min_leg, options.max_leg));
  }
  planner.drive(planner.ahead(), options.min_speed, straight);
  std::vector<Trajectory::Control>& controls = planner.controls();
  controls.insert(controls.end(), 4, controls.back());
  if (options.length > 0.0) {
    // shrinking about the start is exact: the length is homogeneous in the control points
    const double scale = options.length / Trajectory(controls, settings).length();
    for (auto& control : controls) control.head<3>() *= scale;
  }
  return Trajectory(std::move(controls), settings);
}

}  // namespace

Trajectory random_flight(std::uint64_t seed, const PathOptions& options, Time start) {
  constexpr double kForever = std::numeric_limits<double>::infinity();
  constexpr double kClimbSpeed = 0.7;  // [m/s], take-off
  constexpr double kHomeSpeed = 0.8;
  constexpr double kSinkSpeed = 0.5;
  const Trajectory::Settings settings{.start = start,
                                      .knot_spacing = options.knot_spacing,
                                      .stand_before = options.stand_before,
                                      .stand_after = options.stand_after,
                                      .level = options.ground};
  if (options.ground) return random_drive(seed, options, settings);
  Planner planner(seed, options);
  Random& random = planner.random();
  const double height = options.high.z() - options.low.z();
  const Vector3d hover(0.0, 0.0, options.low.z() + 0.4 * height);
  const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
  const double radius = random.uniform(0.3, 1.0);
  const Vector3d landing(radius * std::cos(angle), radius * std::sin(angle), 0.0);
  planner.fly(hover, kClimbSpeed, kForever);
  for (bool up = true;; up = !up) {
    // beyond the box these are swapped: the leg then ends between its reach and the box
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
    Planner home = planner;
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
