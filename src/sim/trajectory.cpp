// SPDX-License-Identifier: BSD-3-Clause
#include "rio/sim/trajectory.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace rio::sim {

double cumulative_basis(std::size_t j, double u, int derivative) {
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

double Trajectory::length() const {
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

Vector3d Trajectory::low() const {
  Vector3d corner = controls_.front().head<3>();
  for (const Control& c : controls_) corner = corner.cwiseMin(c.head<3>());
  return corner;
}

Vector3d Trajectory::high() const {
  Vector3d corner = controls_.front().head<3>();
  for (const Control& c : controls_) corner = corner.cwiseMax(c.head<3>());
  return corner;
}

Trajectory::Point Trajectory::at(Time time) const {
  Point point = at(to_seconds(time - settings_.start));
  point.nav.time = time;
  return point;
}

Trajectory::Point Trajectory::at(double seconds) const {
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

  if (settings_.level) {
    drive(x, v, &point);
  } else {
    fly(x, v, jerk, &point);
  }
  return point;
}

void Trajectory::fly(const Control& x, const Control& v, const Control& jerk, Point* point) const {
  const Vector3d f = point->accel_W + settings_.gravity * Vector3d::UnitZ();
  const double thrust = f.norm();
  const Vector3d x_C(std::cos(x[3]), std::sin(x[3]), 0.0);
  const Vector3d y_C(-x_C.y(), x_C.x(), 0.0);
  Matrix3d R_WB;  // (E2)
  R_WB.col(2) = f / thrust;
  R_WB.col(1) = R_WB.col(2).cross(x_C).normalized();
  R_WB.col(0) = R_WB.col(1).cross(R_WB.col(2));
  point->nav.q_WB = Quaternion(R_WB);
  point->accel_B = thrust * Vector3d::UnitZ();

  const Vector3d j = jerk.head<3>();
  const Vector3d h = (j - R_WB.col(2).dot(j) * R_WB.col(2)) / thrust;  // (E3)
  const double w_x = -h.dot(R_WB.col(1));
  const double w_y = h.dot(R_WB.col(0));
  const double w_z =
      (v[3] * y_C.dot(R_WB.col(1)) + w_x * x_C.dot(R_WB.col(2))) / x_C.dot(R_WB.col(0));
  point->gyro_B = {w_x, w_y, w_z};
}

void Trajectory::drive(const Control& x, const Control& v, Point* point) const {
  point->nav.q_WB = Quaternion(Eigen::AngleAxisd(x[3], Vector3d::UnitZ()));
  point->gyro_B = {0.0, 0.0, v[3]};
  point->accel_B = point->nav.q_WB.conjugate() *
                   Vector3d(point->accel_W + settings_.gravity * Vector3d::UnitZ());
}

Trajectory::Control Trajectory::spline(double s, int derivative) const {
  const auto span = static_cast<std::size_t>(std::min(s, spans() - 1.0));
  const double u = s - static_cast<double>(span);
  Control value = derivative == 0 ? controls_[span] : Control(Control::Zero());
  for (std::size_t j = 1; j < kOrder; ++j) {
    value += cumulative_basis(j, u, derivative) * (controls_[span + j] - controls_[span + j - 1]);
  }
  return value;
}

}  // namespace rio::sim
