// SPDX-License-Identifier: BSD-3-Clause
// Stages 2 and 6: the front-end. observe() derives the observations of a scan from the predicted
// state and leaves the trails unchanged; advance() does the trail management: it extends, ends and
// begins trails with the scan and proposes landmarks.
//
// Every static detection is used at most once: for a landmark, a trail, or a new trail.
// Reference: Michalczyk et al. 2023, II-B (matching after alignment with the two poses), III-C.
#pragma once

#include <array>
#include <optional>

#include "rio/frontend/association.hpp"
#include "rio/frontend/ego_velocity.hpp"
#include "rio/frontend/trails.hpp"
#include "rio/models/detection.hpp"
#include "rio/models/rest.hpp"
#include "rio/options.hpp"
#include "rio/state/estimate.hpp"

namespace rio {

struct AidingObservation;

/// Observations of one scan; points into the scan and the trails it was made from.
struct Observations {
  const DetectionList* scan = nullptr;  ///< static detections unfolded; null: other sensors only
  /// Measurements of other sensors up to the scan (update/aiding.hpp); may be null.
  const std::vector<AidingObservation>* aiding = nullptr;
  const TrailSet* trails = nullptr;
  EgoVelocity ego_velocity;
  AssociationResult matches;
  std::optional<RestModel::Measurement> rest;             ///< zero-velocity update, if at rest
  std::array<double, kMaxDetections> doppler_residual{};  ///< of trails' matches, in sigmas
  std::array<bool, kMaxDetections> moves{};               ///< part of a mover, though an inlier

  const Detection& detection(std::size_t i) const { return scan->items[i]; }
  bool is_static(std::size_t i) const { return ego_velocity.inlier[i] && !moves[i]; }
  /// Discards the static set and the matches of the scan.
  void withdraw() {
    ego_velocity.clear();
    matches.clear();
  }
};

/// Detections proposed as landmarks; the back-end decides how many it has room for.
struct Promotions {
  StaticVector<Detection, kMaxLandmarks> births;
};

class Frontend {
 public:
  explicit Frontend(const Options& options);

  const TrailSet& trails() const { return trails_; }
  void reset() { trails_.clear(); }

  /// Static set and matches of a scan, which is corrected for the Doppler scale of the state
  /// predicted to its time. Does not change the trails.
  /// @param velocity_covariance_S of the predicted radar velocity, radar axes [m^2/s^2]
  void observe(const DetectionList& scan, const Estimate& predicted, Observations* out,
               const Matrix3d& velocity_covariance_S = Matrix3d::Zero());
  /// Same, given the static set and the velocity of the scan in out->ego_velocity.
  void match(const DetectionList& scan, const Estimate& predicted, Observations* out);

  /// Stage 6, after a successful update: extends, ends and begins trails with the scan of `id`, and
  /// proposes trails matched `promote_after` times in a row as landmarks at their newest detection.
  /// @param room landmarks the back-end can take; a trail without room continues as a trail
  void advance(const Observations& seen, ScanId id, std::size_t room, Promotions* promotions);

 private:
  /// Marks detections near an outlier: parts of a mover, not all of which move radially.
  void find_companions(Observations* out) const;

  /// Marks slow movers within the static set: their Doppler residuals add up along a trail.
  void find_movers(const Vector3d& v_S, Observations* out) const;

  FrontendOptions options_;
  bool use_trails_;
  bool use_landmarks_;
  bool unwrap_;
  EgoVelocityRansac ransac_;
  DetectionList unwrapped_;
  TrailSet trails_;
  Association association_;
};

}  // namespace rio
