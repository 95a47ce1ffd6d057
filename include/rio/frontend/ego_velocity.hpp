// SPDX-License-Identifier: BSD-3-Clause
// Stage 3: the radar's own velocity and the static set from one scan, by three-point RANSAC.
//
// A static point at direction u has the range rate d = -u . v_S.
// (E1) iterations = ceil(ln(1 - P) / ln(1 - (1 - eps)^3)), eps the outlier ratio, P the success
// (E2) sigma_i^2 = sigma_D^2 + v_S^T Sigma_u v_S: the spread of an inlier's residual
// Hypotheses compete by a constant threshold, because (E2) grows with the hypothesis itself and
// would let an absurdly fast one explain everything; (E2) widens the static set of the winner only.
// Reference: Michalczyk et al. 2023, III-D; Doer and Trommer 2020 (three-point least squares).
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "rio/core/random.hpp"
#include "rio/frontend/detection.hpp"
#include "rio/options.hpp"

namespace rio {

/// (E1), at least 1.
inline int ransac_iterations(double outlier_ratio, double success) {
  const double clean = std::pow(1.0 - outlier_ratio, 3);
  if (clean >= 1.0) return 1;
  return std::max(1, static_cast<int>(std::ceil(std::log(1.0 - success) / std::log(1.0 - clean))));
}

/// Consensus of one scan.
struct EgoVelocity {
  bool valid = false;
  Vector3d v_S = Vector3d::Zero();  ///< velocity of the radar in its own axes [m/s]
  int inliers = 0;
  std::array<bool, kMaxDetections> inlier{};  ///< per detection: moves as the static world does
};

class EgoVelocityRansac {
 public:
  explicit EgoVelocityRansac(const FrontendOptions& options)
      : options_(options),
        iterations_(ransac_iterations(options.ransac_outlier_ratio, options.ransac_success)) {}

  /// @param predicted_S the radar velocity the IMU predicts [m/s]; if given, it is one more
  /// hypothesis,
  ///        and stands alone when the scan is too small for a consensus of its own
  void estimate(const DetectionList& scan, const std::optional<Vector3d>& predicted_S,
                EgoVelocity* out) const {
    const auto n = static_cast<std::uint32_t>(scan.items.size());
    *out = EgoVelocity{};
    // seeded by the stamp: a scan gives the same static set whatever came before it
    SplitMix64 random(static_cast<std::uint64_t>(options_.ransac_seed) ^
                      static_cast<std::uint64_t>(scan.time.count()));
    int best = 0;
    Vector3d best_v = Vector3d::Zero();
    const auto consider = [&](const Vector3d& v) {
      const int count = count_supporters(scan, v);
      if (count > best) {
        best = count;
        best_v = v;
      }
    };
    if (predicted_S) consider(*predicted_S);
    for (int i = 0; n >= 3 && i < iterations_; ++i) {
      if (const auto v = solve_triple(scan, random)) consider(*v);
    }
    out->valid = best >= options_.ransac_min_inliers;
    if (!out->valid) {
      if (predicted_S) mark(scan, *predicted_S, out);
      return;
    }
    mark(scan, best_v, out);
    if (const auto refined = least_squares(scan, *out)) {
      if (count_supporters(scan, *refined) >= best) mark(scan, *refined, out);
    }
  }

 private:
  static double residual(const Detection& d, const Vector3d& v) {
    return d.range_rate + d.direction_S.dot(v);
  }
  int count_supporters(const DetectionList& scan, const Vector3d& v) const {
    int count = 0;
    for (const Detection& d : scan.items) {
      count += std::abs(residual(d, v)) < options_.ransac_threshold ? 1 : 0;
    }
    return count;
  }
  bool is_inlier(const Detection& d, const Vector3d& v) const {
    const double az = d.sigma_azimuth_S.dot(v);
    const double el = d.sigma_elevation_S.dot(v);
    const double sigma = std::sqrt(d.sigma_doppler * d.sigma_doppler + az * az + el * el);  // (E2)
    return std::abs(residual(d, v)) <
           std::max(options_.ransac_threshold, options_.ransac_sigmas * sigma);
  }
  void mark(const DetectionList& scan, const Vector3d& v, EgoVelocity* out) const {
    out->v_S = v;
    out->inliers = 0;
    for (std::size_t i = 0; i < scan.items.size(); ++i) {
      out->inlier[i] = is_inlier(scan.items[i], v);
      out->inliers += out->inlier[i] ? 1 : 0;
    }
  }
  static std::optional<Vector3d> solve_triple(const DetectionList& scan, SplitMix64& random) {
    const auto n = static_cast<std::uint32_t>(scan.items.size());
    const std::uint32_t a = random.below(n);
    std::uint32_t b = random.below(n - 1);
    if (b >= a) ++b;
    std::uint32_t c = random.below(n);
    while (c == a || c == b) c = random.below(n);
    Matrix3d U;
    U << scan.items[a].direction_S.transpose(), scan.items[b].direction_S.transpose(),
        scan.items[c].direction_S.transpose();
    constexpr double kMinVolume = 1e-3;  // nearly coplanar directions amplify noise a thousandfold
    if (std::abs(U.determinant()) < kMinVolume) return std::nullopt;
    const Vector3d rates(scan.items[a].range_rate, scan.items[b].range_rate,
                         scan.items[c].range_rate);
    return -U.inverse() * rates;
  }
  static std::optional<Vector3d> least_squares(const DetectionList& scan, const EgoVelocity& set) {
    Matrix3d A = Matrix3d::Zero();
    Vector3d b = Vector3d::Zero();
    for (std::size_t i = 0; i < scan.items.size(); ++i) {
      if (!set.inlier[i]) continue;
      const Detection& d = scan.items[i];
      A += d.direction_S * d.direction_S.transpose();
      b -= d.direction_S * d.range_rate;
    }
    const Eigen::LDLT<Matrix3d> ldlt(A);
    if (ldlt.info() != Eigen::Success || ldlt.vectorD().minCoeff() < 1e-6) return std::nullopt;
    return ldlt.solve(b);
  }

  FrontendOptions options_;
  int iterations_;
};

}  // namespace rio
