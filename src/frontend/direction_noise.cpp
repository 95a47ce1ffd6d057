// SPDX-License-Identifier: BSD-3-Clause
#include "rio/frontend/direction_noise.hpp"

#include <Eigen/LU>
#include <cmath>

#include "rio/core/small_cholesky.hpp"

namespace rio {

void DirectionNoise::apply(DetectionList* scan) const {
  for (Detection& d : scan->items) {
    d.sigma_azimuth_S *= factor_[0];
    d.sigma_elevation_S *= factor_[1];
  }
}

void DirectionNoise::observe(const Observations& seen, double distance) {
  constexpr double kCells = 4.0;    // of the grid: rounding errors of the points are independent
  constexpr double kSpread = 1e-2;  // of the directions: nearly in a plane, to half a degree
  constexpr double kMost = 9.0;     // sigmas squared: beyond them is something else
  constexpr double kLeast = 0.04;   // of a variance: a fifth of the sigma
  constexpr double kFree = 0.1;     // least 1 - h: the point determines the velocity itself
  const EgoVelocity& velocity = seen.ego_velocity;
  if (!(velocity.v_S.norm() > kCells * grid_)) return;
  if (std::abs(distance - distance_) < apart_) return;  // also after a restart
  Matrix3d normal = Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  for (std::size_t i = 0; i < seen.scan->items.size(); ++i) {
    if (!seen.is_static(i)) continue;
    const Detection& d = seen.detection(i);
    const Vector3d weighted = d.direction_S / residual_variance(d, velocity.v_S);
    normal += weighted * d.direction_S.transpose();
    right -= weighted * d.range_rate;
  }
  const SmallCholesky<3> root(normal);
  if (!root.positive()) return;
  const auto pivots = root.L().diagonal();
  if (pivots.minCoeff() < kSpread * pivots.maxCoeff()) return;  // no velocity
  const Matrix3d covariance = root.inverse();
  const Vector3d v_S = covariance * right;
  for (std::size_t i = 0; i < seen.scan->items.size(); ++i) {
    if (!seen.is_static(i)) continue;
    const Detection& d = seen.detection(i);
    const double variance = residual_variance(d, velocity.v_S);
    const double free = 1.0 - d.direction_S.dot(covariance * d.direction_S) / variance;
    if (!(free > kFree)) continue;
    const double residual = d.range_rate + d.direction_S.dot(v_S);
    if (residual * residual > kMost * free * variance) continue;
    const double az = d.sigma_azimuth_S.dot(velocity.v_S) / factor_[0];
    const double el = d.sigma_elevation_S.dot(velocity.v_S) / factor_[1];
    const Vector3d gain(d.sigma_doppler * d.sigma_doppler, az * az, el * el);
    const Vector3d weighted = gain / (2.0 * variance * variance);
    information_ += free * weighted * gain.transpose();
    sum_ += weighted * residual * residual;
  }
  distance_ = distance;
  const Matrix3d spread = information_.inverse();
  const Vector3d theta = spread * sum_;
  const Eigen::Array2d most =
      theta.tail<2>().array() + 3.0 * spread.diagonal().tail<2>().array().sqrt();
  factor_ = most.max(kLeast).min(1.0).sqrt();
}

}  // namespace rio
