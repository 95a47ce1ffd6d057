// SPDX-License-Identifier: BSD-3-Clause
#include "check/axes.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "check/numbers.hpp"
#include "rio/core/so3.hpp"

namespace rio::check {

namespace {

/// "90 deg about the +z axis", if it is about an axis.
std::string turn_text(const Matrix3d& turn, const char* whose) {
  const Vector3d phi = quaternion_log(Quaternion(turn));
  int axis = 0;
  const double along = phi.cwiseAbs().maxCoeff(&axis);
  const double angle = phi.norm() / kDegree;
  if (along < 0.99 * phi.norm()) {
    return fmt::format("{:.0f} deg about ({:.2f} {:.2f} {:.2f}) of the {}", angle,
                       phi.x() / phi.norm(), phi.y() / phi.norm(), phi.z() / phi.norm(), whose);
  }
  return fmt::format("{:.0f} deg about the {}{} axis of the {}", angle,
                     phi[axis] < 0.0 && angle < 179.0 ? "-" : "", "xyz"[axis], whose);
}

/// The equivalent description about an axis of the radar or of the body, if there is one.
std::string turn_text(const Matrix3d& configured, const Matrix3d& R) {
  const Matrix3d of_body = R * configured.transpose();
  const Vector3d phi = quaternion_log(Quaternion(of_body));
  const bool body_axis = phi.cwiseAbs().maxCoeff() > 0.99 * phi.norm();
  return body_axis ? turn_text(of_body, "body") : turn_text(configured.transpose() * R, "radar");
}

std::string mounting_line(const Matrix3d& R, const Vector3d& p, const Advice& advice) {
  const Quaternion q(R);
  const std::string line = fmt::format(
      "T_BS: {{translation: [{:.4f}, {:.4f}, {:.4f}], quaternion_wxyz: [{:.6f}, {:.6f}, {:.6f}, "
      "{:.6f}]}}",
      p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z());
  return advice.option(line, line);
}

}  // namespace

double angle_between(const Matrix3d& a, const Matrix3d& b) {
  return quaternion_log(Quaternion(a.transpose() * b)).norm();
}

std::optional<std::string> mirror_of_points(const Axes& axes, const Matrix3d& configured) {
  return mirror_text(configured.transpose() * axes.R, "the points");
}

bool allowed(const Axes& axes, const Matrix3d& configured, DopplerSign sign) {
  switch (sign) {
    case DopplerSign::kAsConfigured:
      return !axes.doppler_flipped || axes.turn < 1e-6 || mirror_of_points(axes, configured);
    case DopplerSign::kOpposite:
      return axes.doppler_flipped;
    default:
      return true;
  }
}

std::vector<Axes> candidates(const Quaternion& configured) {
  const Matrix3d R = configured.toRotationMatrix();
  std::vector<Axes> out;
  for (const bool flipped : {false, true}) {
    const double sign = flipped ? -1.0 : 1.0;
    for (const Matrix3d& P : right_angles()) {
      for (const Matrix3d& turned : {Matrix3d(R * P), Matrix3d(P * R)}) {
        out.push_back({sign * turned, flipped, angle_between(R, turned)});
      }
    }
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const Axes& a, const Axes& b) { return a.turn < b.turn - 1e-6; });
  return out;
}

std::optional<std::string> mirror_text(const Matrix3d& M, const char* whose) {
  for (int i = 0; i < 3; ++i) {
    Matrix3d flip = Matrix3d::Identity();
    flip(i, i) = -1.0;
    if ((M - flip).norm() < 1e-6)
      return fmt::format("{} of {} has the wrong sign", "xyz"[i], whose);
    const int j = (i + 1) % 3;
    Matrix3d swap = Matrix3d::Identity();
    swap.col(i).swap(swap.col(j));
    if ((M - swap).norm() < 1e-6) {
      return fmt::format("{} and {} of {} are swapped", "xyz"[std::min(i, j)],
                         "xyz"[std::max(i, j)], whose);
    }
  }
  return std::nullopt;
}

std::string describe(const Matrix3d& configured, const Axes& axes, DopplerSign sign) {
  if (!axes.about.isZero()) {
    const Vector3d along = (axes.doppler_flipped ? -1.0 : 1.0) * (axes.R * axes.about);
    return fmt::format(
        "{}the direction ({:.2f} {:.2f} {:.2f}) of the radar is ({:.2f} {:.2f} {:.2f}) of the "
        "body; the turn about it is not shown",
        axes.doppler_flipped ? "the Doppler has the wrong sign and " : "", axes.about.x(),
        axes.about.y(), axes.about.z(), along.x(), along.y(), along.z());
  }
  if (!axes.doppler_flipped) return "the radar is turned by " + turn_text(configured, axes.R);
  if (axes.turn < 1e-6) return "the Doppler has the wrong sign";
  const std::string turned =
      "the Doppler has the wrong sign and the radar is turned by " + turn_text(configured, -axes.R);
  const std::optional<std::string> mirrored = mirror_of_points(axes, configured);
  return mirrored && !seems_opposite(sign) ? *mirrored + " (or " + turned + ")" : turned;
}

std::string change_of(const Matrix3d& configured, const Axes& axes, const FittedRotation& fitted,
                      DopplerSign sign, const Options& options, const Advice& advice) {
  if (!axes.about.isZero()) {
    return "measure the mounting, or fly with changes of speed in other directions, too";
  }
  const double sigma = fitted.sigma / kDegree;
  std::string error = sigma > 0.0 ? fmt::format(" +- {:.1f} deg", sigma) : "";
  if (fitted.sigma > options.calibration.rotation_sigma && advice.radar == 0) {
    error += fmt::format(", with calibration: {{rotation_sigma: {:.1f} deg}}", sigma);
  }
  const auto turned = [&](double hand) {
    const Matrix3d R = hand * axes.R;
    const bool mounted = (advice.info != nullptr && advice.info->T_BS.has_value()) ||
                         (configured - Matrix3d::Identity()).norm() > 1e-6;
    const auto of_points = mounted ? advice.axes(configured.transpose() * R) : std::nullopt;
    const Vector3d& p = options.radar.T_BS.translation;
    if (!of_points) return mounting_line(hand * fitted.R, p, advice) + error;
    return (advice.info->is_from_tree ? mounting_line(configured, p, advice) + " with " : "") +
           *of_points;
  };
  if (!axes.doppler_flipped) return turned(1.0);
  if (axes.turn < 1e-6) return advice.negate_doppler();
  const std::optional<std::string> mirrored = mirror_of_points(axes, configured);
  if (!mirrored || seems_opposite(sign)) return advice.negate_doppler() + " and " + turned(-1.0);
  if (const auto field = advice.mirror(configured.transpose() * axes.R)) return *field;
  const std::string where = advice.bag() ? "--axes or --field x=... y=... z=..."
                                         : "the columns x, y, z of " + advice.csv();
  return fmt::format("{}, by {}", *mirrored, where);
}

}  // namespace rio::check
