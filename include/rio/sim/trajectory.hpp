// SPDX-License-Identifier: BSD-3-Clause
// Exact trajectory of a quadrotor, or of a vehicle on the ground: a quintic B-spline of position
// and yaw between two standstills.
//
// (E1) x(s) = P_k + sum_j C_j(u) (P_{k+j} - P_{k+j-1}), j = 1..5: cumulative form, four times
//      continuously differentiable, and exactly constant where the control points are equal.
// (E2) The thrust turns z_B along f = a + g e3; y_B is normal to the heading x_C = (cos, sin, 0):
//      z_B = f/|f|, y_B = z_B x x_C / |.|, x_B = y_B x z_B; specific force R^T f = |f| e3.
// (E3) h = (j - (z_B.j) z_B)/|f|: w_x = -h.y_B, w_y = h.x_B,
//      w_z = (yaw_rate y_C.y_B + w_x x_C.z_B) / (x_C.x_B), from d/dt (x_C.y_B) = 0.
// A vehicle on level ground instead keeps z_B = e3, x_B = x_C: gyro (0, 0, yaw_rate), R^T f.
// Reference: Mellinger and Kumar, ICRA 2011 (flatness); Sommer et al., CVPR 2020 (cumulative form).
// Frames W (z up) and B. Valid while thrust is upwards and pitch below 90 deg.
#pragma once

#include <cassert>
#include <utility>
#include <vector>

#include "rio/types.hpp"

namespace rio::sim {

/// C_j(u) of (E1), j = 1..5, 0 <= u <= 1, or its derivative of order 0..3 with respect to u.
double cumulative_basis(std::size_t j, double u, int derivative);

/// Position and yaw as exact functions of time, with every derivative the sensors need.
class Trajectory {
 public:
  /// Position in W [m] and yaw [rad].
  using Control = Eigen::Vector4d;

  /// The motion at one time; all derivatives are consistent.
  struct Point {
    NavState nav;                         ///< biases zero
    Vector3d accel_W = Vector3d::Zero();  ///< second derivative of the position [m/s^2]
    Vector3d gyro_B = Vector3d::Zero();   ///< angular rate [rad/s]
    Vector3d accel_B = Vector3d::Zero();  ///< specific force R^T (a + g e3) [m/s^2]
    bool flying = false;                  ///< between the two standstills
  };

  /// Parameters besides the path itself.
  struct Settings {
    Time start{0};              ///< stamp of the start
    double knot_spacing = 0.5;  ///< between control points [s]
    double stand_before = 0.0;  ///< standstill at the first control point [s]
    double stand_after = 0.0;   ///< standstill at the last control point [s]
    double gravity = 9.81;      ///< along -z of W [m/s^2]
    bool level = false;         ///< a vehicle on the ground: yaw is all its attitude
  };

  /// A standstill at the origin of zero duration.
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

  /// Length of the path [m]; Gauss-Legendre quadrature of the speed, eight panels per span.
  double length() const;

  /// Corners of a box that holds the path [m]: that of the control points.
  Vector3d low() const;
  Vector3d high() const;

  /// The motion at a stamp; standstill before the start and after the end.
  Point at(Time time) const;

  /// The motion `seconds` after the start.
  Point at(double seconds) const;

 private:
  static constexpr std::size_t kOrder = 6;

  double spans() const { return static_cast<double>(controls_.size() - kOrder + 1); }
  double rate(double s) const { return spline(s, 1).head<3>().norm(); }

  /// Attitude, rate and specific force of thrust along the acceleration, (E2) and (E3).
  void fly(const Control& x, const Control& v, const Control& jerk, Point* point) const;
  /// Same, for a vehicle on level ground.
  void drive(const Control& x, const Control& v, Point* point) const;

  /// (E1) or its derivative of order 0..3 with respect to s, in units of knot spacings.
  Control spline(double s, int derivative) const;

  std::vector<Control> controls_;
  Settings settings_;
};

}  // namespace rio::sim
