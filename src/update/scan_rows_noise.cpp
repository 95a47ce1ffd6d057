// SPDX-License-Identifier: BSD-3-Clause
// The noise of the rows of a scan: what a match and a repetition add to that of its detections.
#include <algorithm>
#include <cmath>

#include "rio/update/look_correlation.hpp"
#include "rio/update/noise_inflation.hpp"
#include "rio/update/scan_rows.hpp"

namespace rio {

Vector3d ScanRows::expected_correction(const EgoVelocity& measured, const LinearizationPoint& x,
                                       const Matrix3d& covariance) {
  if (!measured.covariance) return Vector3d::Zero();
  const Matrix3d S = covariance + *measured.covariance;
  return covariance * (S.inverse() * (measured.v_S - x.radar_velocity_S()));
}

void ScanRows::add_gyro_noise(LandmarkDopplerModel::Measurement* z, const Vector3d& direction_S,
                              const LinearizationPoint& x) {
  const Vector3d by_rate = x.T_BS.p.cross(x.T_BS.R * direction_S);
  const double variance = x.estimate.gyro_variance * by_rate.squaredNorm();
  z->sigma_doppler = std::sqrt(z->sigma_doppler * z->sigma_doppler + variance);
}

void ScanRows::add_curvature(const StateEstimate& state_estimate,
                             LandmarkPointModel::Measurement* z) {
  const Layout& layout = state_estimate.layout();  // of the radar of the scan
  const Covariance& P = state_estimate.covariance();
  const Eigen::Vector2d sigma(z->sigma_azimuth_S.norm(), z->sigma_elevation_S.norm());
  Eigen::Matrix2d M = S_.block<2, 2>(1, 1) - Eigen::Matrix2d::Identity();  // rows have unit noise
  if (layout.has_elevation_error()) {  // of directions with that error known
    const int error = layout.elevation_error();
    const LinearRow* row = &batch_.rows()[batch_.last_block().first];
    const Eigen::Vector2d by_error(P.product(row[1], error), P.product(row[2], error));
    M -= by_error * by_error.transpose() / P.matrix()(error, error);
  }
  M.array() *= (sigma * sigma.transpose()).array();
  const auto curvature = LandmarkPointModel::range_curvature(z->range, M);
  const double variance = curvature.variance / (z->sigma_range * z->sigma_range);
  batch_.correct_first_row(-curvature.mean / z->sigma_range, variance);
  S_(0, 0) += variance;
  z->range -= curvature.mean;
  z->sigma_range *= std::sqrt(1.0 + variance);
}

Eigen::Vector2d ScanRows::direction_innovation() const {
  const LinearRow* row = &batch_.rows()[batch_.last_block().first];
  return {row[1].residual / std::sqrt(S_(1, 1)), row[2].residual / std::sqrt(S_(2, 2))};
}

void ScanRows::add_look(const Eigen::Vector2d& innovation, Measured<LandmarkPointModel>* m,
                        const LinearizationPoint& x) {
  const LandmarkState& landmark = x.estimate.landmarks[m->landmark];
  LookCorrelation& looks = looks_[x.estimate.radar];
  LandmarkState::Looks& sum = look_sums_[m->landmark];
  sum = landmark.looks;
  const double moved = x.estimate.distance_travelled - landmark.distance_seen;
  if (!(moved > noise_distance_[x.estimate.radar])) return;
  if (!ablation_.look_correlation) return;
  looks.add(innovation, &sum);
  const double factor = looks.factor();
  if (ablation_.elevation_walk) {
    sum.elevation_walk = looks.elevation_walk(m->z.sigma_elevation_S.norm());
  }
  batch_.scale_row(1, factor);
  batch_.scale_row(2, factor);
  m->z.sigma_azimuth_S *= std::sqrt(factor);
  m->z.sigma_elevation_S *= std::sqrt(factor);
}

void ScanRows::add_mismatch(Measured<LandmarkPointModel>* m, const LinearizationPoint& x) {
  // as corrected by the scan: after silence the predicted velocity is far off
  const Vector3d v_S = x.radar_velocity_S() + correction_S_;
  const Eigen::Vector2d across(m->z.sigma_azimuth_S.dot(v_S), m->z.sigma_elevation_S.dot(v_S));
  const double variance = mismatch_variance(options_.match_trust, across.squaredNorm());
  batch_.add_variance(variance);
  LandmarkDopplerModel::Measurement& z = *m->doppler;
  z.sigma_doppler = std::sqrt(z.sigma_doppler * z.sigma_doppler + variance);
}

double ScanRows::doppler_repetition(const Detection& d, const LinearizationPoint& x) const {
  constexpr double kSameReflectors = 0.15;  // distance travelled over which they are seen [m]
  constexpr double kCells = 6.0;  // rounding errors of y and y + c cells: correlation 1 - 6 c + ...
  const double distance_at_scan = distance_at_scan_[x.estimate.radar];
  const double other = repetition(distance_at_scan, x);
  if (noise_distance_[x.estimate.radar] <= 0.0) return other;  // every error is new in every scan
  const double grid = doppler_grid_[x.estimate.radar];
  const double rounding = std::min(grid * grid / 12.0, d.sigma_doppler * d.sigma_doppler) /
                          batch_.rows().back().variance;
  if (!(rounding > 0.0)) return other;
  // the range rate changes as the direction rotates and as the radar accelerates
  const Vector3d v = x.radar_velocity_S();
  const double radial = d.direction_S.dot(v);
  const double turning = (v.squaredNorm() - radial * radial) / d.range;
  const double accelerating = (x.T_WB.R * (x.T_BS.R * d.direction_S)).dot(x.accel_W);
  const double cells = std::abs(turning - accelerating) * since_scan_ / grid;
  const double distance = std::max(0.0, x.estimate.distance_travelled - distance_at_scan);
  const double rho = (1.0 - kFreshShare) * std::exp(-distance / kSameReflectors - kCells * cells);
  return (1.0 - rounding) * other + rounding * std::max(other, (1.0 + rho) / (1.0 - rho));
}

}  // namespace rio
