// SPDX-License-Identifier: BSD-3-Clause
#include "rio/frontend/ego_velocity.hpp"

#include <Eigen/LU>
#include <algorithm>

#include "rio/core/small_cholesky.hpp"

namespace rio {

namespace {

constexpr double kSuccess = 0.9999;  // of drawing one outlier-free triple
constexpr int kMinInliers = 5;       // of a consensus: two more than a triple, which always agrees

}  // namespace

int ransac_iterations(double outlier_ratio, double success) {
  const double clean = std::pow(1.0 - outlier_ratio, 3);
  if (clean >= 1.0) return 1;
  return std::max(1, static_cast<int>(std::ceil(std::log(1.0 - success) / std::log(1.0 - clean))));
}

double residual_variance(const Detection& d, const Vector3d& v_S) {
  const double az = d.sigma_azimuth_S.dot(v_S);
  const double el = d.sigma_elevation_S.dot(v_S);
  return d.sigma_doppler * d.sigma_doppler + az * az + el * el;
}

EgoVelocityRansac::EgoVelocityRansac(const FrontendOptions& options, double max_doppler)
    : options_(options),
      max_doppler_(max_doppler),
      fold_(max_doppler),
      iterations_(ransac_iterations(options.ransac_outlier_ratio, kSuccess)) {}

void EgoVelocityRansac::estimate(const DetectionList& scan,
                                 const std::optional<RadarVelocity>& predicted, EgoVelocity* out,
                                 double doppler_scale) {
  fold_ = DopplerFold(max_doppler_).divided(doppler_scale);
  const auto n = static_cast<std::uint32_t>(scan.items.size());
  out->clear();
  // seeded by the stamp: the static set of a scan does not depend on earlier scans
  SplitMix64 random(static_cast<std::uint64_t>(options_.ransac_seed) ^
                    static_cast<std::uint64_t>(scan.time.count()));
  Best best;
  if (predicted) consider(scan, predicted->v_S, predicted, &best);
  // the trace bounds the largest variance
  const bool sure = predicted && fold_.is_unique(predicted->covariance.trace());
  for (int i = 0; n >= 3 && i < iterations_; ++i) {
    Triple triple;
    if (!draw(scan, random, &triple)) continue;
    consider(scan, triple.velocity(), predicted, &best);
    if (fold_.ambiguous() && !sure) {
      consider_neighbours(scan, triple, predicted, &best);
    } else if (predicted && triple.fold_towards(predicted->v_S, fold_)) {
      consider(scan, triple.velocity(), predicted, &best);
    }
  }
  out->valid = best.count >= kMinInliers && !best.rival;
  if (!out->valid) {
    if (predicted) mark(scan, predicted->v_S, predicted->covariance, out);
    return;
  }
  mark(scan, best.v_S, Matrix3d::Zero(), out);
  Vector3d refined;
  out->covariance = least_squares(scan, *out, &refined);
  if (out->covariance) {
    const bool better = count_supporters(scan, refined, best.count) >= best.count;
    mark(scan, better ? refined : best.v_S, *out->covariance, out);
  } else if (predicted) {  // the only covariance available is that of the prediction
    mark(scan, best.v_S, predicted->covariance, out);
  }
}

Vector3d EgoVelocityRansac::Triple::velocity() const {
  return -inverse * rates;
}

bool EgoVelocityRansac::Triple::fold_towards(const Vector3d& v_S, const DopplerFold& fold) {
  const Vector3d measured = rates;
  const Vector3d expected = -U * v_S;
  for (int i = 0; i < 3; ++i) rates[i] = fold.nearest(measured[i], expected[i]);
  return (rates - measured).lpNorm<Eigen::Infinity>() > fold.limit();
}

void EgoVelocityRansac::consider(const DetectionList& scan, const Vector3d& v,
                                 const std::optional<RadarVelocity>& predicted, Best* best) const {
  const int count = count_supporters(scan, v, best->count);
  if (count < best->count || count == 0) return;
  if (count > best->count) {
    *best = {count, v, false};
  } else if ((v - best->v_S).norm() > fold_.limit()) {
    // the trace bounds the largest variance
    if (!predicted || !fold_.is_unique(predicted->covariance.trace())) {
      best->rival = true;
    } else if ((v - predicted->v_S).norm() < (best->v_S - predicted->v_S).norm()) {
      best->v_S = v;
    }
  }
}

void EgoVelocityRansac::consider_neighbours(const DetectionList& scan, const Triple& triple,
                                            const std::optional<RadarVelocity>& predicted,
                                            Best* best) const {
  const Vector3d v = triple.velocity();
  const Matrix3d step = 2.0 * fold_.limit() * triple.inverse;
  for (int a = -1; a <= 1; ++a) {
    for (int b = -1; b <= 1; ++b) {
      for (int c = -1; c <= 1; ++c) consider(scan, v + step * Vector3d(a, b, c), predicted, best);
    }
  }
}

int EgoVelocityRansac::count_supporters(const DetectionList& scan, const Vector3d& v,
                                        int least) const {
  auto count = static_cast<int>(scan.items.size());
  for (const Detection& d : scan.items) {
    if (std::abs(residual(d, v)) < options_.ransac_threshold) continue;
    if (--count < least) break;
  }
  return count;
}

void EgoVelocityRansac::mark(const DetectionList& scan, const Vector3d& v,
                             const Matrix3d& covariance, EgoVelocity* out) const {
  out->v_S = v;
  out->inliers = 0;
  for (std::size_t i = 0; i < scan.items.size(); ++i) {
    const Detection& d = scan.items[i];
    const double spread = residual_variance(d, v);
    const double of_velocity = d.direction_S.dot(covariance * d.direction_S);
    out->outlier[i] = !(std::abs(residual(d, v)) < static_bound(options_, spread));
    out->inlier[i] = !out->outlier[i] && fold_.is_unique(spread + of_velocity);
    out->range_rate[i] = fold_.nearest(d.range_rate, -d.direction_S.dot(v));
    out->inliers += out->inlier[i] ? 1 : 0;
  }
}

bool EgoVelocityRansac::draw(const DetectionList& scan, SplitMix64& random, Triple* triple) {
  const auto n = static_cast<std::uint32_t>(scan.items.size());
  const std::uint32_t a = random.below(n);
  std::uint32_t b = random.below(n - 1);
  if (b >= a) ++b;
  std::uint32_t c = random.below(n);
  while (c == a || c == b) c = random.below(n);
  triple->U << scan.items[a].direction_S.transpose(), scan.items[b].direction_S.transpose(),
      scan.items[c].direction_S.transpose();
  constexpr double kMinVolume = 1e-3;  // nearly coplanar directions amplify noise a thousandfold
  if (std::abs(triple->U.determinant()) < kMinVolume) return false;
  triple->inverse = triple->U.inverse();
  triple->rates = {scan.items[a].range_rate, scan.items[b].range_rate, scan.items[c].range_rate};
  return true;
}

std::optional<Matrix3d> EgoVelocityRansac::least_squares(const DetectionList& scan,
                                                         const EgoVelocity& set, Vector3d* v_S) {
  Matrix3d A = Matrix3d::Zero();
  Matrix3d weighted = Matrix3d::Zero();
  Matrix3d direction_noise = Matrix3d::Zero();
  Vector3d b = Vector3d::Zero();
  for (std::size_t i = 0; i < scan.items.size(); ++i) {
    if (!set.inlier[i]) continue;
    const Detection& d = scan.items[i];
    const Matrix3d square = d.direction_S * d.direction_S.transpose();
    A += square;
    weighted += residual_variance(d, set.v_S) * square;
    direction_noise += direction_covariance(d);
    b -= d.direction_S * set.range_rate[i];
  }
  constexpr double kMinSpread = 1e-3;  // all directions in a plane, to 0.06 deg: no velocity
  const SmallCholesky<3> root(A);
  if (!root.positive() || root.L().diagonal().minCoeff() < kMinSpread) return std::nullopt;
  const Matrix3d inverse = root.inverse();
  *v_S = inverse * b;
  const Vector3d shrinkage = inverse * (direction_noise * *v_S);
  return inverse * weighted * inverse + shrinkage * shrinkage.transpose();
}

}  // namespace rio
