// SPDX-License-Identifier: BSD-3-Clause
#include "rio/frontend/association.hpp"

#include <algorithm>
#include <cmath>

#include "rio/core/small_cholesky.hpp"

namespace rio {

namespace {

// cells of the noise in the region where a landmark is looked for: in more there are other echoes
constexpr double kMostCells = 100.0;

}  // namespace

Association::Association(const FrontendOptions& options, std::size_t max_landmarks,
                         double same_echo)
    : options_(options),
      same_echo_(same_echo),
      gate_(chi2_quantile(options.match_probability, 3.0)),
      core_(chi2_quantile(std::min(options.match_core, options.match_probability), 3.0)),
      seen_(static_cast<std::size_t>(options.max_detections)),
      assignment_(static_cast<std::size_t>(options.max_detections) + max_landmarks,
                  static_cast<std::size_t>(options.max_detections)) {}

void Association::match(const DetectionList& scan, const std::array<bool, kMaxDetections>& usable,
                        const Estimate& predicted, std::size_t landmarks, const TrailSet& trails,
                        AssociationResult* out) {
  const std::size_t rows = landmarks + trails.size();
  assignment_.begin(rows, scan.items.size(),
                    options_.matching == Matching::kEuclidean ? options_.match_gate : kMaxCost);
  for (std::size_t i = 0; i < scan.items.size(); ++i) {
    const Detection& d = scan.items[i];
    const double az = d.sigma_azimuth_S.norm();
    const double el = d.sigma_elevation_S.norm();
    const Vector3d variances = Vector3d(d.sigma_range, az, el).cwiseAbs2();
    seen_[i] = {d.sigma_azimuth_S / az, d.sigma_elevation_S / el, variances, variances.prod(),
                d.range};
  }
  const RigidPose T_WB = predicted.T_WB();
  const RigidPose T_BS(predicted.T_BS);
  for (std::size_t i = 0; i < landmarks; ++i) {
    const LandmarkState& landmark = predicted.landmarks[i];
    if (landmark.retired) continue;
    add_row(i,
            {to_radar(T_WB, T_BS, landmark.p_W), matching_covariance(landmark.covariance_S),
             gate_after(predicted.distance_travelled - landmark.distance_seen)},
            scan, usable, &out->near_landmark);
  }
  for (std::size_t i = 0; i < trails.size(); ++i) {
    const TrailElement& newest = trails[i].newest();
    const int clone = predicted.find_clone(newest.scan);
    if (clone < 0) continue;
    const RigidPose& then = predicted.clones[static_cast<std::size_t>(clone)].T_WB;
    const Vector3d point_W = to_world(then, T_BS, newest.detection.point_S);
    const Matrix3d turn = (T_WB.R * T_BS.R).transpose() * then.R * T_BS.R;
    add_row(landmarks + i,
            {to_radar(T_WB, T_BS, point_W),
             matching_covariance(turn * point_covariance(newest.detection) * turn.transpose()),
             gate_after((T_WB.p - then.p).norm())},
            scan, usable, nullptr);
  }
  assignment_.solve();
  collect(landmarks, rows, scan.items.size(), out);
}

void Association::add_row(std::size_t row, const Known& known, const DetectionList& scan,
                          const std::array<bool, kMaxDetections>& usable,
                          std::array<bool, kMaxDetections>* near) {
  const double range = known.point_S.norm();
  const double trace = known.covariance.trace();
  for (std::size_t i = 0; i < scan.items.size(); ++i) {
    if (!usable[i]) continue;
    if (options_.matching == Matching::kEuclidean) {
      assignment_.set(row, i, (scan.items[i].point_S - known.point_S).norm());  // (E1)
      continue;
    }
    // cheap bounds first: d2 is at least the share of the range, and that of the azimuth
    const Seen& seen = seen_[i];
    const double off = seen.range - range;
    if (off * off > gate_ * (seen.variances[0] + trace)) continue;
    const double across = seen.t_az.dot(known.point_S);
    if (across * across > gate_ * (seen.variances[1] * range * range + trace)) continue;
    const auto distance = mahalanobis_distance(scan.items[i].direction_S, seen, known, range);
    if (!distance) continue;
    if (distance->d2 < known.gate) assignment_.set(row, i, distance->cost);
    if (near != nullptr) (*near)[i] = true;
  }
}

std::optional<Association::Distance> Association::mahalanobis_distance(const Vector3d& direction_S,
                                                                       const Seen& seen,
                                                                       const Known& known,
                                                                       double range) const {
  const double inverse_range = 1.0 / range;
  const Vector3d u = inverse_range * known.point_S;
  if (u.dot(direction_S) <= 0.0) return std::nullopt;  // behind the radar: tangents are invalid
  const double az = seen.t_az.dot(u);
  const double el = seen.t_el.dot(u);
  const Vector3d y(seen.range - range, -az, -el);
  Matrix3d Dt;  // D^T
  Dt << u, inverse_range * (seen.t_az - az * u), inverse_range * (seen.t_el - el * u);
  const Matrix3d PDt = known.covariance * Dt;
  Matrix3d S = Dt.transpose() * PDt;
  S.diagonal() += seen.variances;
  const SmallCholesky<3> root(S);
  if (!root.positive()) return std::nullopt;
  const double spread = root.determinant() / seen.variance_product;
  if (spread > kMostCells * kMostCells) return std::nullopt;  // any echo of the region would do
  const double d2 = root.whitened(y).squaredNorm();
  if (!(d2 < gate_)) return std::nullopt;
  return Distance{d2, d2 + std::log(spread)};
}

void Association::collect(std::size_t landmarks, std::size_t rows, std::size_t columns,
                          AssociationResult* out) const {
  const bool any = options_.matching != Matching::kMahalanobis;
  for (std::size_t row = 0; row < rows; ++row) {
    const int column = assignment_.column_of(row);
    if (column == Assignment::kNone) continue;
    const auto detection = static_cast<std::size_t>(column);
    if (row >= landmarks) {
      out->trails.push_back({row - landmarks, detection});
    } else if (any || is_clear(row, detection, landmarks, columns)) {
      out->landmarks.push_back({row, detection});
    }
  }
}

bool Association::is_clear(std::size_t row, std::size_t column, std::size_t landmarks,
                           std::size_t columns) const {
  const double limit = assignment_.cost(row, column) + options_.match_margin;
  for (std::size_t c = 0; c < columns; ++c) {
    if (c != column && assignment_.cost(row, c) < limit) return false;
  }
  for (std::size_t r = 0; r < landmarks; ++r) {
    if (r != row && assignment_.cost(r, column) < limit) return false;
  }
  return true;
}

}  // namespace rio
