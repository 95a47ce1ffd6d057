// SPDX-License-Identifier: BSD-3-Clause
// Stage 2: the radar's own velocity and the static set from one scan, by three-point RANSAC.
//
// A static point at direction u has the range rate d = -u . v_S, known modulo 2 v_max.
// (E1) iterations = ceil(ln(1 - P) / ln(1 - (1 - eps)^3)), eps the outlier ratio, P the success
// (E2) sigma_i^2 = sigma_D^2 + v_S^T Sigma_u v_S: the spread of an inlier's residual
// (E3) v_S = -A^-1 sum u d, A = sum u u^T over the static set
// (E4) Sigma_v = A^-1 (sum sigma_i^2 u u^T) A^-1 + b b^T, b = A^-1 (sum Sigma_u) v_S: noisy
//      directions shrink (E3) by b (errors in variables)
// Hypotheses compete by a constant threshold, because (E2) grows with the hypothesis itself and
// would let an absurdly fast one explain everything; (E2) widens the static set of the winner only.
// Folded range rates: residuals are taken modulo 2 v_max. Triples are tried as measured and
// unfolded towards the prediction or, without a prediction that makes the fold unique, in all
// neighbouring folds. Two hypotheses of equal support more than v_max apart are decided by a
// prediction that makes the fold unique; otherwise there is no consensus. A static point whose fold
// stays ambiguous is left out.
// Reference: Michalczyk et al. 2023, III-D; Doer and Trommer 2020 (three-point least squares).
#pragma once

#include <array>
#include <cmath>
#include <optional>

#include "rio/core/random.hpp"
#include "rio/frontend/doppler_fold.hpp"
#include "rio/models/detection.hpp"
#include "rio/options.hpp"

namespace rio {

/// (E1), at least 1.
int ransac_iterations(double outlier_ratio, double success);

/// (E2): variance of the residual of a static point [m^2/s^2].
double residual_variance(const Detection& d, const Vector3d& v_S);

/// Bound of the residual of a static point with the variance (E2) [m/s].
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
  /// (E4) [m^2/s^2]; none if the directions of the static set do not determine a velocity
  std::optional<Matrix3d> covariance;
  int inliers = 0;
  std::array<bool, kMaxDetections> inlier{};        ///< per detection: of the static set
  std::array<bool, kMaxDetections> outlier{};       ///< not static; neither = its fold is ambiguous
  std::array<double, kMaxDetections> range_rate{};  ///< unfolded, valid for inliers [m/s]

  /// No consensus, no inliers.
  void clear() {
    valid = false;
    v_S.setZero();
    covariance.reset();
    inliers = 0;
    inlier.fill(false);
    outlier.fill(false);
  }
};

class EgoVelocityRansac {
 public:
  /// @param max_doppler range rates fold into +-this [m/s]; 0 = they do not
  explicit EgoVelocityRansac(const FrontendOptions& options, double max_doppler = 0.0);

  /// @param predicted radar velocity predicted by the IMU; if given, it is one more hypothesis, and
  ///        alone defines the static set if the scan has no consensus of its own
  /// @param doppler_scale factor by which the range rates have been divided; v_max is divided, too
  void estimate(const DetectionList& scan, const std::optional<RadarVelocity>& predicted,
                EgoVelocity* out, double doppler_scale = 1.0);

 private:
  struct Best {
    int count = 0;
    Vector3d v_S = Vector3d::Zero();
    bool rival = false;  ///< another fold has as many supporters
  };

  /// Three detections that determine a velocity.
  struct Triple {
    Matrix3d U;  ///< directions, one a row
    Matrix3d inverse;
    Vector3d rates;

    Vector3d velocity() const;
    /// Unfolds the rates towards v_S; false if that changes nothing.
    bool fold_towards(const Vector3d& v_S, const DopplerFold& fold);
  };

  /// Takes the hypothesis v if more detections support it than the best so far.
  void consider(const DetectionList& scan, const Vector3d& v,
                const std::optional<RadarVelocity>& predicted, Best* best) const;
  /// All combinations of the measured folds and their neighbours, e.g. for a start in motion.
  void consider_neighbours(const DetectionList& scan, const Triple& triple,
                           const std::optional<RadarVelocity>& predicted, Best* best) const;
  double residual(const Detection& d, const Vector3d& v) const {
    return fold_.wrap(d.range_rate + d.direction_S.dot(v));
  }
  /// Number of inliers of v; stops early with some number below `least` if there are fewer.
  int count_supporters(const DetectionList& scan, const Vector3d& v, int least) const;
  /// Marks the static set of v; the covariance of v may leave folds ambiguous.
  void mark(const DetectionList& scan, const Vector3d& v, const Matrix3d& covariance,
            EgoVelocity* out) const;
  /// False if the directions are nearly coplanar.
  static bool draw(const DetectionList& scan, SplitMix64& random, Triple* triple);
  /// (E3) and its covariance (E4), if the directions determine a velocity.
  static std::optional<Matrix3d> least_squares(const DetectionList& scan, const EgoVelocity& set,
                                               Vector3d* v_S);

  FrontendOptions options_;
  double max_doppler_;
  DopplerFold fold_;  ///< of the current scan
  int iterations_;
};

}  // namespace rio
