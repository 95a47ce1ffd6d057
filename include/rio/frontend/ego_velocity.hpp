// SPDX-License-Identifier: BSD-3-Clause
// Stage 3: the radar's own velocity and the static set from one scan, by three-point RANSAC.
//
// A static point at direction u has the range rate d = -u . v_S, known modulo 2 v_max.
// (E1) iterations = ceil(ln(1 - P) / ln(1 - (1 - eps)^3)), eps the outlier ratio, P the success
// (E2) sigma_i^2 = sigma_D^2 + v_S^T Sigma_u v_S: the spread of an inlier's residual
// (E3) v_S = -A^-1 sum u d, A = sum u u^T over the static set
// (E4) Sigma_v = A^-1 (sum sigma_i^2 u u^T) A^-1 + b b^T, b = A^-1 (sum Sigma_u) v_S: measured
//      directions shrink (E3) by b (errors in variables)
// Hypotheses compete by a constant threshold, because (E2) grows with the hypothesis itself and
// would let an absurdly fast one explain everything; (E2) widens the static set of the winner only.
// Folded range rates: residuals are taken modulo 2 v_max, triples as measured and folded towards
// the prediction or, if there is none surer than the fold, to all neighbouring folds. Two
// hypotheses of equal support more than v_max apart are decided by a prediction surer than the
// fold, or not at all; a static point whose fold stays open is left out. Reference: Michalczyk et
// al. 2023, III-D; Doer and Trommer 2020 (three-point least squares).
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "rio/core/random.hpp"
#include "rio/frontend/detection.hpp"
#include "rio/frontend/doppler_fold.hpp"
#include "rio/options.hpp"

namespace rio {

/// (E1), at least 1.
inline int ransac_iterations(double outlier_ratio, double success) {
  const double clean = std::pow(1.0 - outlier_ratio, 3);
  if (clean >= 1.0) return 1;
  return std::max(1, static_cast<int>(std::ceil(std::log(1.0 - success) / std::log(1.0 - clean))));
}

/// (E2): variance of the residual of a static point [m^2/s^2].
inline double residual_variance(const Detection& d, const Vector3d& v_S) {
  const double az = d.sigma_azimuth_S.dot(v_S);
  const double el = d.sigma_elevation_S.dot(v_S);
  return d.sigma_doppler * d.sigma_doppler + az * az + el * el;
}

/// Bound of the residual of a static point with that variance [m/s].
inline double static_bound(const FrontendOptions& o, double variance) {
  return std::max(o.ransac_threshold, o.ransac_sigmas * std::sqrt(variance));
}

/// A velocity of the radar in its own axes.
struct RadarVelocity {
  Vector3d v_S = Vector3d::Zero();         ///< [m/s]
  Matrix3d covariance = Matrix3d::Zero();  ///< [m^2/s^2]
};

/// Consensus of one scan.
struct EgoVelocity {
  bool valid = false;
  Vector3d v_S = Vector3d::Zero();  ///< velocity of the radar in its own axes [m/s]
  /// (E4) [m^2/s^2]; none if the directions of the static set do not fix a velocity
  std::optional<Matrix3d> covariance;
  int inliers = 0;
  std::array<bool, kMaxDetections> inlier{};   ///< per detection: moves as the static world does
  std::array<bool, kMaxDetections> outlier{};  ///< moves otherwise; neither = its fold is open
  std::array<double, kMaxDetections> range_rate{};  ///< of the inliers, unfolded [m/s]
};

class EgoVelocityRansac {
 public:
  /// @param max_doppler range rates fold into +-this [m/s]; 0 = they do not
  explicit EgoVelocityRansac(const FrontendOptions& options, double max_doppler = 0.0)
      : options_(options),
        max_doppler_(max_doppler),
        fold_(max_doppler),
        iterations_(ransac_iterations(options.ransac_outlier_ratio, options.ransac_success)) {}

  /// @param predicted the radar velocity the IMU predicts; if given, it is one more hypothesis,
  ///        and stands alone when the scan is too small for a consensus of its own
  /// @param doppler_scale by which the range rates have been divided: so is where they fold
  void estimate(const DetectionList& scan, const std::optional<RadarVelocity>& predicted,
                EgoVelocity* out, double doppler_scale = 1.0) {
    fold_ = DopplerFold(max_doppler_ / doppler_scale);
    const auto n = static_cast<std::uint32_t>(scan.items.size());
    *out = EgoVelocity{};
    // seeded by the stamp: a scan gives the same static set whatever came before it
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
    out->valid = best.count >= options_.ransac_min_inliers && !best.rival;
    if (best.count < options_.ransac_min_share * static_cast<double>(n)) {
      out->valid = false;
      return;  // whatever agrees here agrees by chance
    }
    if (!out->valid) {
      if (predicted) mark(scan, predicted->v_S, predicted->covariance, out);
      return;
    }
    mark(scan, best.v_S, Matrix3d::Zero(), out);
    Vector3d refined;
    out->covariance = least_squares(scan, *out, &refined);
    if (out->covariance) {
      const bool better = count_supporters(scan, refined) >= best.count;
      mark(scan, better ? refined : best.v_S, *out->covariance, out);
    } else if (predicted) {  // only the prediction says how far it can be off
      mark(scan, best.v_S, predicted->covariance, out);
    }
  }

 private:
  struct Best {
    int count = 0;
    Vector3d v_S = Vector3d::Zero();
    bool rival = false;  ///< another fold has as many supporters
  };

  /// Three detections that fix a velocity.
  struct Triple {
    Matrix3d U;  ///< directions, one a row
    Matrix3d inverse;
    Vector3d rates;

    Vector3d velocity() const { return -inverse * rates; }
    /// False if that changes nothing.
    bool fold_towards(const Vector3d& v_S, const DopplerFold& fold) {
      const Vector3d measured = rates;
      const Vector3d expected = -U * v_S;
      for (int i = 0; i < 3; ++i) rates[i] = fold.nearest(measured[i], expected[i]);
      return (rates - measured).lpNorm<Eigen::Infinity>() > fold.limit();
    }
  };

  void consider(const DetectionList& scan, const Vector3d& v,
                const std::optional<RadarVelocity>& predicted, Best* best) const {
    const int count = count_supporters(scan, v);
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
  /// All combinations of the measured folds and their neighbours: a start at speed.
  void consider_neighbours(const DetectionList& scan, const Triple& triple,
                           const std::optional<RadarVelocity>& predicted, Best* best) const {
    const Vector3d v = triple.velocity();
    const Matrix3d step = 2.0 * fold_.limit() * triple.inverse;
    for (int a = -1; a <= 1; ++a) {
      for (int b = -1; b <= 1; ++b) {
        for (int c = -1; c <= 1; ++c) consider(scan, v + step * Vector3d(a, b, c), predicted, best);
      }
    }
  }
  double residual(const Detection& d, const Vector3d& v) const {
    return fold_.wrap(d.range_rate + d.direction_S.dot(v));
  }
  int count_supporters(const DetectionList& scan, const Vector3d& v) const {
    int count = 0;
    for (const Detection& d : scan.items) {
      count += std::abs(residual(d, v)) < options_.ransac_threshold ? 1 : 0;
    }
    return count;
  }
  /// The static set of v, whose own covariance may leave folds open.
  void mark(const DetectionList& scan, const Vector3d& v, const Matrix3d& covariance,
            EgoVelocity* out) const {
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
  /// False if the directions are nearly coplanar.
  static bool draw(const DetectionList& scan, SplitMix64& random, Triple* triple) {
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
  /// (E3) and its covariance (E4), if the directions fix a velocity.
  static std::optional<Matrix3d> least_squares(const DetectionList& scan, const EgoVelocity& set,
                                               Vector3d* v_S) {
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
    const Eigen::LLT<Matrix3d> llt(A);
    if (llt.info() != Eigen::Success || llt.matrixLLT().diagonal().minCoeff() < kMinSpread)
      return std::nullopt;
    const Matrix3d inverse = llt.solve(Matrix3d::Identity());
    *v_S = inverse * b;
    const Vector3d shrinkage = inverse * (direction_noise * *v_S);
    return inverse * weighted * inverse + shrinkage * shrinkage.transpose();
  }

  FrontendOptions options_;
  double max_doppler_;
  DopplerFold fold_;  ///< of the current scan
  int iterations_;
};

}  // namespace rio
