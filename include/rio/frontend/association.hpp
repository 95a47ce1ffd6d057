// SPDX-License-Identifier: BSD-3-Clause
// Stage 3: which detection belongs to which known point: landmarks, and the newest detections of
// trails, both moved into the current radar frame; optimal one-to-one.
//
// (E1) Euclidean:   cost = |m - e|, below a constant gate      Michalczyk et al. 2023, II-B
// (E2) Mahalanobis, in range and direction: with u = e/|e|, t the unit tangents of the detection,
//      y = (r - |e|, -t_az . u, -t_el . u), S = D P_e D^T + R, D the derivative of y in e, R the
//      noise of range and angles: d2 = y^T S^-1 y below the quantile of three degrees of freedom;
//      cost = d2 + ln(det S / det R), the negative log-likelihood up to a constant of the
//      detection: vague points do not win by their vagueness
//      Where reflectors are dense, the outer part of a gate holds more neighbours than right pairs:
//      only its core counts, unless the radar has hardly moved since. Then the echo is the same
//      one, and its error, too.
// (E3) probability: (E2) with P_e = 0                          Xu et al., eq. 13-14
// A landmark's match under (E2) counts only if every other pairing of the two costs more by a
// margin: where reflectors stand close to each other, the nearest one is the one the estimate
// already believes in, and using it would make the estimate sure of itself.
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
};
using Matches = StaticVector<Match, kMaxDetections>;

/// Matches of one scan.
struct AssociationResult {
  Matches landmarks;
  Matches trails;
  /// Per detection: inside the gate of a landmark, so that it is no new point (not kEuclidean).
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
  /// @param same_echo distance travelled over which an echo stays the same [m]
  Association(const FrontendOptions& options, std::size_t max_landmarks, double same_echo);

  /// @param usable per detection: may be matched
  /// @param landmarks how many of the estimate's landmarks take part, from the first on
  /// @param out cleared
  void match(const DetectionList& scan, const std::array<bool, kMaxDetections>& usable,
             const Estimate& predicted, std::size_t landmarks, const TrailSet& trails,
             AssociationResult* out);

 private:
  /// A known point in radar axes.
  struct Known {
    Vector3d point_S;
    Matrix3d covariance;
    double gate = 0.0;  ///< of a match, at most that of being near
  };
  /// Of a detection, what (E2) asks for against every known point.
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

  static constexpr double kMaxCost = 1e3;  // above any gate and logarithm

  /// The gate for a point that was seen that distance ago [m].
  double gate_after(double distance) const {
    return options_.matching == Matching::kMahalanobis && distance > same_echo_ ? core_ : gate_;
  }
  /// The covariance of a known point as far as the matching minds it.
  Matrix3d believed(const Matrix3d& covariance) const;

  /// The costs of one known point against every usable detection.
  void add_row(std::size_t row, const Known& known, const DetectionList& scan,
               const std::array<bool, kMaxDetections>& usable,
               std::array<bool, kMaxDetections>* near);

  /// (E2) (E3); nothing if the points are not near.
  std::optional<Distance> mahalanobis_distance(const Vector3d& direction_S, const Seen& seen,
                                               const Known& known, double range) const;

  /// The assigned pairs; of landmarks only the clear ones.
  void collect(std::size_t landmarks, std::size_t rows, std::size_t columns,
               AssociationResult* out) const;

  /// No other pairing of this landmark or this detection is nearly as good.
  bool is_clear(std::size_t row, std::size_t column, std::size_t landmarks,
                std::size_t columns) const;

  FrontendOptions options_;
  double same_echo_;
  double gate_;
  double core_;
  std::vector<Seen> seen_;  ///< of the scan at hand, by detection
  Assignment assignment_;
};

}  // namespace rio
