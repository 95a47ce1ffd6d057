// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <Eigen/QR>
#include <cmath>
#include <vector>

#include "check/motion.hpp"
#include "check/points_check.hpp"

namespace rio::check {

namespace {

constexpr double kDopplerNoise = 0.1;  // of a Doppler and its direction [m/s]
constexpr double kStaticWithin = 0.3;  // a static point [m/s]
constexpr double kNearestPoint = 0.3;  // of a point to the origin [m]

/// The Dopplers of a scan, and the velocity of the radar with which most of them agree.
struct Fit {
  std::vector<Vector3d> u;    ///< directions from the origin under test
  std::vector<double> range;  ///< from there [m]
  Eigen::VectorXd residual;   ///< d + u^T v [m/s]
  Vector3d v = Vector3d::Zero();
};

/// Of the scan as seen from `origin`, by weights 1 / (1 + (r / sigma)^2).
Fit fit_of(const ScanView& scan, const Vector3d& origin) {
  constexpr int kIterations = 8;
  Fit fit;
  std::vector<double> dopplers;
  for (const Point& point : scan.detections) {
    const Vector3d from = point.point_S - origin;
    if (!(from.norm() > kNearestPoint)) continue;
    fit.u.push_back(from.normalized());
    fit.range.push_back(from.norm());
    dopplers.push_back(point.range_rate);
  }
  const auto n = static_cast<Eigen::Index>(dopplers.size());
  fit.residual = Eigen::Map<const Eigen::VectorXd>(dopplers.data(), n);
  const Eigen::VectorXd d = fit.residual;
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(n);
  const Eigen::Map<const Eigen::Matrix<double, 3, Eigen::Dynamic>> U(
      n > 0 ? fit.u.front().data() : nullptr, 3, n);
  for (int i = 0; n > 0 && i < kIterations; ++i) {
    const Matrix3d A = U * weights.asDiagonal() * U.transpose() + 1e-9 * Matrix3d::Identity();
    fit.v = -A.ldlt().solve(U * weights.cwiseProduct(d));
    fit.residual = d + U.transpose() * fit.v;
    weights = (1.0 + (fit.residual / kDopplerNoise).array().square()).inverse();
  }
  return fit;
}

/// Not more than some hundred scans, each with points enough for a fit.
Scans some_of(const Scans& scans) {
  constexpr std::size_t kFewest = 6;  // points of a scan: twice the unknowns
  constexpr std::size_t kMost = 600;
  Scans some;
  for (std::size_t i = 0; i < scans.size(); i += 1 + scans.size() / kMost) {
    if (scans[i].detections.size() >= kFewest) some.push_back(scans.get(i));
  }
  return some;
}

/// The scans in which the radar moves: at rest no direction acts.
std::vector<std::size_t> moving_scans(const Scans& scans) {
  constexpr double kMoves = 0.5;  // [m/s]
  std::vector<std::size_t> moving;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    if (fit_of(scans[i], Vector3d::Zero()).v.norm() > kMoves) moving.push_back(i);
  }
  return moving;
}

/// Sum of min(residual^2, kStaticWithin^2): of points that move, or fold, no more than that.
double cost_of(const Fit& fit) {
  return fit.residual.cwiseAbs2().cwiseMin(kStaticWithin * kStaticWithin).sum();
}

/// Normal equations for a correction of the origin, from all scans, without their velocities.
struct Equations {
  Matrix3d H = Matrix3d::Zero();
  Vector3d g = Vector3d::Zero();
  double square = 0.0;  ///< of the residuals
  double free = 0.0;    ///< their number, less that of the velocities
  double cost = 0.0;    ///< of all scans
};

/// (E4) of points_check.hpp.
/// @param moving indices of the scans
Equations equations(const Scans& scans, const std::vector<std::size_t>& moving,
                    const Vector3d& origin) {
  Equations sum;
  for (const std::size_t i : moving) {
    const Fit fit = fit_of(scans[i], origin);
    const Eigen::Index n = fit.residual.size();
    sum.cost += cost_of(fit);
    std::vector<Eigen::Index> fits;
    for (Eigen::Index k = 0; k < n; ++k) {
      if (std::abs(fit.residual[k]) < kStaticWithin) fits.push_back(k);
    }
    const auto rows = static_cast<Eigen::Index>(fits.size());
    if (rows < 6 || 2 * rows < n) continue;
    Eigen::Matrix<double, Eigen::Dynamic, 3> U(rows, 3);
    Eigen::Matrix<double, Eigen::Dynamic, 4> B(rows, 4);  // by the origin, and the residual
    for (Eigen::Index k = 0; k < rows; ++k) {
      const auto point = static_cast<std::size_t>(fits[static_cast<std::size_t>(k)]);
      const Vector3d& u = fit.u[point];
      U.row(k) = u.transpose();
      B.row(k) << (u * u.dot(fit.v) - fit.v).transpose() / fit.range[point],
          fit.residual[static_cast<Eigen::Index>(point)];
    }
    const Eigen::Matrix<double, Eigen::Dynamic, 4> left =
        B - U * Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(U).solve(B);
    sum.H += left.leftCols<3>().transpose() * left.leftCols<3>();
    sum.g += left.leftCols<3>().transpose() * left.col(3);
    sum.square += left.col(3).squaredNorm();
    sum.free += static_cast<double>(rows - 3);
  }
  return sum;
}

}  // namespace

std::optional<Finding> check_origin(const Scans& all, const Advice& advice) {
  constexpr double kLeast = 0.3;    // noise of directions seems to be up to half as much [m]
  constexpr double kBetter = 0.08;  // of the cost; noise of directions: 0.065 at most
  constexpr double kSure = 10.0;    // sigmas; the model of the noise is coarse
  constexpr double kFewestRows = 500;
  constexpr double kLongestStep = 0.3;  // [m]
  const Scans scans = some_of(all);
  const std::vector<std::size_t> moving = moving_scans(scans);
  Vector3d origin = Vector3d::Zero();
  const Equations first = equations(scans, moving, origin);
  Equations last = first;
  for (int i = 0; i < 8 && last.free > kFewestRows; ++i) {
    Vector3d step = -last.H.ldlt().solve(last.g);
    if (!step.allFinite()) return std::nullopt;
    if (step.norm() > kLongestStep) step *= kLongestStep / step.norm();
    origin += step;
    last = equations(scans, moving, origin);
  }
  const double sure = std::sqrt(origin.dot(last.H * origin) * last.free / last.square);
  const double better = 1.0 - last.cost / first.cost;
  if (!(last.free > kFewestRows) || origin.norm() < kLeast || !(sure > kSure) ||
      !(better > kBetter)) {
    return std::nullopt;
  }
  return Finding{
      Verdict::kDoubtful, "origin of the points",
      fmt::format("the Dopplers fit directions from the place ({:.1f} {:.1f} {:.1f}) m among the "
                  "points, not from their origin, by {:.0f} sigmas: their driver moves them into "
                  "the frame of the vehicle, in which the radar is about there",
                  origin.x(), origin.y(), origin.z(), sure),
      fmt::format("record the points in the frame of the radar, or subtract its measured place in "
                  "that frame from the x, y and z of {}",
                  advice.bag() ? "the files of `rio convert`" : advice.csv())};
}

std::optional<Finding> check_elevations(const Scans& all, const Advice& advice) {
  constexpr double kBetter = 0.93;  // right elevations have 0.86 of the others or less
  constexpr double kFewestPoints = 500;
  const Scans scans = some_of(all);
  const Scans other = from_zenith(scans);
  double as_read = 0.0;
  double by_zenith = 0.0;
  double points = 0.0;
  for (const std::size_t i : moving_scans(other)) {
    const Fit fit = fit_of(other[i], Vector3d::Zero());
    as_read += cost_of(fit_of(scans[i], Vector3d::Zero()));
    by_zenith += cost_of(fit);
    points += static_cast<double>(fit.residual.size());
  }
  if (points < kFewestPoints || by_zenith > kBetter * as_read) return std::nullopt;
  return Finding{
      Verdict::kWrong, "elevation",
      fmt::format("the Dopplers of a scan are off the best velocity by {:.2f} m/s (rms), "
                  "with elevations counted from the zenith by {:.2f}",
                  std::sqrt(as_read / points), std::sqrt(by_zenith / points)),
      std::string(advice.bag() ? "in the driver, or in the files of `rio convert`"
                               : "in " + advice.csv()) +
          ": elevations are 90 deg less the angle from the zenith"};
}

}  // namespace rio::check
