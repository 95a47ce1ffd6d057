// SPDX-License-Identifier: BSD-3-Clause
// Exact trajectory of a quadrotor: a quintic B-spline of position and yaw between two standstills.
//
// (E1) x(s) = P_k + sum_j C_j(u) (P_{k+j} - P_{k+j-1}), j = 1..5: cumulative form, four times
//      continuously differentiable, and exactly constant where the control points are equal.
// (E2) The thrust turns z_B along f = a + g e3; y_B is normal to the heading x_C = (cos, sin, 0):
//      z_B = f/|f|, y_B = z_B x x_C / |.|, x_B = y_B x z_B; specific force R^T f = |f| e3.
// (E3) h = (j - (z_B.j) z_B)/|f|: w_x = -h.y_B, w_y = h.x_B,
//      w_z = (yaw_rate y_C.y_B + w_x x_C.z_B) / (x_C.x_B), from d/dt (x_C.y_B) = 0.
// Reference: Mellinger and Kumar, ICRA 2011 (flatness); Sommer et al., CVPR 2020 (cumulative form).
// Frames W (z up) and B. Valid while thrust is upwards and pitch below 90 deg.
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "rio/sim/random.hpp"
#include "rio/types.hpp"

namespace rio::sim {

/// Position and yaw as exact functions of time, with every derivative the sensors need.
class Trajectory {
 public:
  /// Position in W [m] and yaw [rad].
  using Control = Eigen::Vector4d;

  /// The motion at one instant; all consistent derivatives of one another.
  struct Point {
    NavState nav;                         ///< biases zero
    Vector3d accel_W = Vector3d::Zero();  ///< second derivative of the position [m/s^2]
    Vector3d gyro_B = Vector3d::Zero();   ///< angular rate [rad/s]
    Vector3d accel_B = Vector3d::Zero();  ///< specific force R^T (a + g e3) [m/s^2]
    bool flying = false;                  ///< between the two standstills
  };

  /// What is not the path itself.
  struct Settings {
    Time start{0};              ///< stamp of the first instant
    double knot_spacing = 0.5;  ///< between control points [s]
    double stand_before = 0.0;  ///< standstill at the first control point [s]
    double stand_after = 0.0;   ///< standstill at the last control point [s]
    double gravity = 9.81;      ///< along -z of W [m/s^2]
  };

  /// Stands at the origin for no time.
  Trajectory() : Trajectory(std::vector<Control>(kOrder, Control::Zero()), Settings{}) {}

  /// @param controls at least 6; the motion starts and ends at rest when the first five are equal
  /// and the last five are equal, which a standstill requires.
  Trajectory(std::vector<Control> controls, const Settings& settings)
      : controls_(std::move(controls)), settings_(settings) {
    assert(controls_.size() >= kOrder);
  }

  /// From start() to the end of the last standstill [s].
  double duration() const {
    return settings_.stand_before + spans() * settings_.knot_spacing + settings_.stand_after;
  }
  Time start() const { return settings_.start; }
  double gravity() const { return settings_.gravity; }

  /// Length of the path [m]; Gauss-Legendre quadrature of the speed, eight panels a span.
  double length() const {
    constexpr int kPanels = 8;
    constexpr double kNode = 0.7745966692414834;  // sqrt(3/5), three-point rule
    double sum = 0.0;
    for (int i = 0; i < kPanels * static_cast<int>(spans()); ++i) {
      const double middle = (i + 0.5) / kPanels;
      const double half = 0.5 / kPanels;
      sum += half *
             (5.0 * rate(middle - kNode * half) + 8.0 * rate(middle) +
              5.0 * rate(middle + kNode * half)) /
             9.0;
    }
    return sum;
  }

  /// The motion at a stamp; before the start and after the end it stands.
  Point at(Time time) const {
    Point point = at(to_seconds(time - settings_.start));
    point.nav.time = time;
    return point;
  }

  /// The motion `seconds` after the start.
  Point at(double seconds) const {
    const double s = (seconds - settings_.stand_before) / settings_.knot_spacing;
    const double clamped = std::clamp(s, 0.0, spans());
    const double per_second = 1.0 / settings_.knot_spacing;
    const Control x = spline(clamped, 0);
    const Control v = spline(clamped, 1) * per_second;
    const Control a = spline(clamped, 2) * per_second * per_second;
    const Control jerk = spline(clamped, 3) * per_second * per_second * per_second;

    Point point;
    point.flying = s > 0.0 && s < spans();
    point.nav.time = settings_.start + from_seconds(seconds);
    point.nav.p_WB = x.head<3>();
    point.nav.v_WB = v.head<3>();
    point.accel_W = a.head<3>();

    const Vector3d f = point.accel_W + settings_.gravity * Vector3d::UnitZ();
    const double thrust = f.norm();
    const Vector3d x_C(std::cos(x[3]), std::sin(x[3]), 0.0);
    const Vector3d y_C(-x_C.y(), x_C.x(), 0.0);
    Matrix3d R_WB;  // (E2)
    R_WB.col(2) = f / thrust;
    R_WB.col(1) = R_WB.col(2).cross(x_C).normalized();
    R_WB.col(0) = R_WB.col(1).cross(R_WB.col(2));
    point.nav.q_WB = Quaternion(R_WB);
    point.accel_B = thrust * Vector3d::UnitZ();

    const Vector3d j = jerk.head<3>();
    const Vector3d h = (j - R_WB.col(2).dot(j) * R_WB.col(2)) / thrust;  // (E3)
    const double w_x = -h.dot(R_WB.col(1));
    const double w_y = h.dot(R_WB.col(0));
    const double w_z =
        (v[3] * y_C.dot(R_WB.col(1)) + w_x * x_C.dot(R_WB.col(2))) / x_C.dot(R_WB.col(0));
    point.gyro_B = {w_x, w_y, w_z};
    return point;
  }

 private:
  static constexpr std::size_t kOrder = 6;

  double spans() const { return static_cast<double>(controls_.size() - kOrder + 1); }
  double rate(double s) const { return spline(s, 1).head<3>().norm(); }

  /// (E1) or its derivative of order 0..3 with respect to s, which counts knot spacings.
  Control spline(double s, int derivative) const {
    // 120 C_j(u), coefficients of 1, u, ... u^5
    static constexpr std::array<std::array<double, 6>, 5> kBasis = {{{119, 5, -10, 10, -5, 1},
                                                                     {93, 55, -30, -10, 15, -4},
                                                                     {27, 55, 30, -10, -15, 6},
                                                                     {1, 5, 10, 10, 5, -4},
                                                                     {0, 0, 0, 0, 0, 1}}};
    const auto span = static_cast<std::size_t>(std::min(s, spans() - 1.0));
    const double u = s - static_cast<double>(span);
    Control value = derivative == 0 ? controls_[span] : Control(Control::Zero());
    for (std::size_t j = 0; j < kBasis.size(); ++j) {
      double c = 0.0;
      for (int power = 5; power >= derivative; --power) {
        double coefficient = kBasis[j][static_cast<std::size_t>(power)];
        for (int d = 0; d < derivative; ++d) coefficient *= power - d;
        c = c * u + coefficient;
      }
      value += c / 120.0 * (controls_[span + j + 1] - controls_[span + j]);
    }
    return value;
  }

  std::vector<Control> controls_;
  Settings settings_;
};

namespace trajectory_detail {

/// Lays control points along legs; a step is at most speed * spacing, so the spline's speed, a
/// convex combination of steps, never exceeds the leg speeds.
class Planner {
 public:
  Planner(std::uint64_t seed, double spacing) : random_(seed, 1), spacing_(spacing) {
    controls_.assign(5, Trajectory::Control::Zero());
  }
  Random& random() { return random_; }
  std::vector<Trajectory::Control>& controls() { return controls_; }
  Vector3d position() const { return controls_.back().head<3>(); }

  /// Towards `target` [m] at `speed` [m/s] until it is reached or `time` [s] is over.
  void fly(const Vector3d& target, double speed, double time) {
    for (double t = 0.0; t < time && position() != target; t += spacing_) {
      const Vector3d way = target - position();
      const double step = speed * spacing_;
      turn();
      const Vector3d next =
          way.norm() <= step ? target : Vector3d(position() + step * way.normalized());
      controls_.emplace_back(next.x(), next.y(), next.z(), yaw_);
    }
  }

 private:
  void turn() {
    constexpr double kMaxYaw = 1.75;  // [rad]; smoothing takes a little off
    if (yaw_ == yaw_target_) {
      yaw_target_ = random_.uniform(-kMaxYaw, kMaxYaw);
      yaw_rate_ = random_.uniform(0.3, 1.0);
    }
    const double step = yaw_rate_ * spacing_;
    yaw_ += std::clamp(yaw_target_ - yaw_, -step, step);
    if (std::abs(yaw_target_ - yaw_) < 1e-9) yaw_ = yaw_target_;
  }

  Random random_;
  double spacing_;
  double yaw_ = 0.0;
  double yaw_target_ = 0.0;
  double yaw_rate_ = 0.0;
  std::vector<Trajectory::Control> controls_;
};

}  // namespace trajectory_detail

/// A flight in a volume of 6 x 5 x 1.7 m around and above its start, the origin of W: 4 s standing,
/// level and at yaw 0; zigzag legs of 0.45..1.43 m/s, up and down in turn, yaw within +-1.75 rad;
/// landing at most 1 m from the start; 2 s standing.
/// @param length_m of the flown path [m], at least 20
inline Trajectory indoor_flight(std::uint64_t seed, double length_m = 150.0, Time start = Time(0)) {
  const Vector3d low(-3.0, -2.5, 0.35);
  const Vector3d high(3.0, 2.5, 1.7);
  const Vector3d reach(2.5, 2.5, 0.0);  // short legs: many turns, steep climbs
  constexpr double kForever = 1e3;
  const Trajectory::Settings settings{
      .start = start, .knot_spacing = 0.5, .stand_before = 4.0, .stand_after = 2.0};
  trajectory_detail::Planner planner(seed, settings.knot_spacing);
  const double angle = planner.random().uniform(0.0, 2.0 * std::numbers::pi);
  const double radius = planner.random().uniform(0.3, 1.0);
  const Vector3d landing(radius * std::cos(angle), radius * std::sin(angle), 0.0);
  planner.fly({0.0, 0.0, 0.9}, 0.7, kForever);
  for (bool up = true;; up = !up) {
    Vector3d from = (planner.position() - reach).cwiseMax(low);
    Vector3d to = (planner.position() + reach).cwiseMin(high);
    from.z() = up ? 1.3 : low.z();
    to.z() = up ? high.z() : 0.8;
    planner.fly(planner.random().in_box(from, to), planner.random().uniform(0.45, 1.43),
                planner.random().uniform(1.5, 4.0));
    trajectory_detail::Planner home = planner;
    home.fly(landing + Vector3d(0.0, 0.0, 0.9), 0.8, kForever);
    home.fly(landing, 0.5, kForever);
    home.controls().insert(home.controls().end(), 4, home.controls().back());
    const double length = Trajectory(home.controls(), settings).length();
    if (length < length_m) continue;
    // shrinking about the start is exact: the length is homogeneous in the control points
    for (auto& control : home.controls()) control.head<3>() *= length_m / length;
    return Trajectory(std::move(home.controls()), settings);
  }
}

}  // namespace rio::sim
