// SPDX-License-Identifier: BSD-3-Clause
// Stage 2: data association: optimal one-to-one matching of detections with known points, i.e.
// landmarks and the newest detections of trails, transformed to the current radar frame.
//
// (E1) Euclidean:   cost = |m - e|, below a constant gate      Michalczyk et al. 2023, II-B
// (E2) Mahalanobis, in range and direction: with u = e/|e|, t the unit tangents of the detection,
//      y = (r - |e|, -t_az . u, -t_el . u), S = D P_e D^T + R, D the derivative of y in e, R the
//      noise of range and angles: d2 = y^T S^-1 y below the chi-squared quantile of three degrees
//      of freedom; cost = d2 + ln(det S / det R), the negative log-likelihood up to a constant of
//      the detection: uncertain points do not win by their large S. Where reflectors are dense, the
//      outer part of a gate holds more neighbours than right pairs: only its core counts, unless
//      the radar has hardly moved since the point was last seen. Then the echo repeats, and its
//      error, too.
// (E3) probability: (E2) with P_e = 0                          Xu et al., eq. 13-14
// A landmark's match under (E2) counts only if every other pairing of the two costs more by a
// margin: among close reflectors the nearest is the one that confirms the estimate, and using it
// would make the filter overconfident.
// sqrt(det S / det R) is the volume of the region in which a point is looked for, in cells of the
// noise. That of a landmark seen again after a long way holds other reflectors; most are not in
// every scan, so the margin does not tell. Beyond a number of cells there is no match, until
// landmarks of smaller regions have corrected the estimate.
#pragma once

#include <array>
#include <optional>

#include "rio/core/chi2.hpp"
#include "rio/frontend/assignment.hpp"
#include "rio/frontend/trails.hpp"
#include "rio/models/detection.hpp"
#include "rio/options.hpp"
#include "rio/state/estimate.hpp"

namespace rio {

/// A matched pair: `target` is the index of a trail or a landmark.
struct Match {
  std::size_t target = 0;
  std::size_t detection = 0;
  bool operator==(const Match&) const = default;
};
using Matches = StaticVector<Match, kMaxDetections>;

/// Matches of one scan.
struct AssociationResult {
  Matches landmarks;
  Matches trails;
  /// Per detection: inside the gate of a landmark, so that it starts no trail (not kEuclidean).
  std::array<bool, kMaxDetections> near_landmark{};

  void clear() {
    landmarks.clear();
    trails.clear();
    near_landmark.fill(false);
  }
};

/// Solver with its work space allocated once.
class Association {
 public:
  /// @param same_echo distance travelled over which an echo repeats with its error [m]
  Association(const FrontendOptions& options, std::size_t max_landmarks, double same_echo);

  /// @param usable per detection: may be matched
  /// @param landmarks how many of the estimate's landmarks take part, from the first on
  /// @param out must be clear (AssociationResult::clear)
  void match(const DetectionList& scan, const std::array<bool, kMaxDetections>& usable,
             const Estimate& predicted, std::size_t landmarks, const TrailSet& trails,
             AssociationResult* out);

 private:
  /// A known point in radar axes.
  struct Known {
    Vector3d point_S;
    Matrix3d covariance;
    double gate = 0.0;  ///< chi-squared gate of a match, at most gate_
  };
  /// The terms of (E2) that depend on the detection alone.
  struct Seen {
    Vector3d t_az;  ///< unit tangents
    Vector3d t_el;
    Vector3d variances;             ///< of range [m^2], azimuth and elevation [rad^2]
    double variance_product = 0.0;  ///< det R
    double range = 0.0;             ///< [m]
  };
  struct Distance {
    double d2 = 0.0;
    double cost = 0.0;
  };

  static constexpr double kMaxCost = 1e3;  // above any gate plus logarithm

  /// The gate for a point last seen `distance` of travel ago [m].
  double gate_after(double distance) const {
    return options_.matching == Matching::kMahalanobis && distance > same_echo_ ? core_ : gate_;
  }
  /// The covariance of a known point as used by the matching: zero unless kMahalanobis.
  Matrix3d matching_covariance(const Matrix3d& covariance) const {
    if (options_.matching != Matching::kMahalanobis) return Matrix3d::Zero();
    return covariance;
  }

  /// The costs of one known point against every usable detection.
  void add_row(std::size_t row, const Known& known, const DetectionList& scan,
               const std::array<bool, kMaxDetections>& usable,
               std::array<bool, kMaxDetections>* near);

  /// (E2) (E3); none outside the gate.
  std::optional<Distance> mahalanobis_distance(const Vector3d& direction_S, const Seen& seen,
                                               const Known& known, double range) const;

  /// The assigned pairs; of landmarks only the unambiguous ones.
  void collect(std::size_t landmarks, std::size_t rows, std::size_t columns,
               AssociationResult* out) const;

  /// No other pairing of this landmark or of this detection is within the margin.
  bool is_clear(std::size_t row, std::size_t column, std::size_t landmarks,
                std::size_t columns) const;

  FrontendOptions options_;
  double same_echo_;
  double gate_;
  double core_;
  std::vector<Seen> seen_;  ///< of the current scan, by detection
  Assignment assignment_;
};

}  // namespace rio
