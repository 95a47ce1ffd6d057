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
#include <utility>
#include <vector>

#include "rio/types.hpp"

namespace rio::sim {

namespace trajectory_detail {

/// C_j(u) of (E1), j = 1..5, 0 <= u <= 1, or its derivative of order 0..3 with respect to u.
inline double cumulative_basis(std::size_t j, double u, int derivative) {
  // 120 C_j(u), coefficients of 1, u, ... u^5
  static constexpr std::array<std::array<double, 6>, 5> kBasis = {{{119, 5, -10, 10, -5, 1},
                                                                   {93, 55, -30, -10, 15, -4},
                                                                   {27, 55, 30, -10, -15, 6},
                                                                   {1, 5, 10, 10, 5, -4},
                                                                   {0, 0, 0, 0, 0, 1}}};
  double c = 0.0;
  for (int power = 5; power >= derivative; --power) {
    double coefficient = kBasis[j - 1][static_cast<std::size_t>(power)];
    for (int d = 0; d < derivative; ++d) coefficient *= power - d;
    c = c * u + coefficient;
  }
  return c / 120.0;
}

}  // namespace trajectory_detail

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

  /// Corners of a box that holds the path [m]: that of the control points.
  Vector3d low() const {
    Vector3d corner = controls_.front().head<3>();
    for (const Control& c : controls_) corner = corner.cwiseMin(c.head<3>());
    return corner;
  }
  Vector3d high() const {
    Vector3d corner = controls_.front().head<3>();
    for (const Control& c : controls_) corner = corner.cwiseMax(c.head<3>());
    return corner;
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
    const auto span = static_cast<std::size_t>(std::min(s, spans() - 1.0));
    const double u = s - static_cast<double>(span);
    Control value = derivative == 0 ? controls_[span] : Control(Control::Zero());
    for (std::size_t j = 1; j < kOrder; ++j) {
      value += trajectory_detail::cumulative_basis(j, u, derivative) *
               (controls_[span + j] - controls_[span + j - 1]);
    }
    return value;
  }

  std::vector<Control> controls_;
  Settings settings_;
};

}  // namespace rio::sim
