// SPDX-License-Identifier: BSD-3-Clause
// Stages 3 and 7: what a scan says about the state. observe() reads the predicted state and touches
// nothing; advance() then lives the trails one scan further and proposes landmarks.
//
// Every detection has one sink: a landmark, a trail, or a new trail.
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

/// What one scan contributes; points into the scan and the trails it was made from.
struct Observations {
  const DetectionList* scan =
      nullptr;  ///< its static detections unfolded; null: other sensors only
  /// What other sensors measured up to its time (update/aiding.hpp); may be null.
  const std::vector<AidingObservation>* aiding = nullptr;
  const TrailSet* trails = nullptr;
  EgoVelocity ego_velocity;
  AssociationResult matches;
  std::optional<RestModel::Measurement> rest;             ///< it stands
  std::array<double, kMaxDetections> doppler_residual{};  ///< of trails' matches, in sigmas
  std::array<bool, kMaxDetections> moves{};               ///< an inlier, but no part of the world

  const Detection& detection(std::size_t i) const { return scan->items[i]; }
  bool is_static(std::size_t i) const { return ego_velocity.inlier[i] && !moves[i]; }
  /// The scan tells nothing.
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

  /// Static set and matches of a scan, corrected for the radar errors of the state predicted to its
  /// time. Pure.
  /// @param velocity_covariance_S of the predicted radar velocity [m^2/s^2]
  void observe(const DetectionList& scan, const Estimate& predicted, Observations* out,
               const Matrix3d& velocity_covariance_S = Matrix3d::Zero());

  /// Stage 7, after a successful update: extends, ends and begins trails with the scan of `id`, and
  /// proposes those matched `promote_after` times in a row, newest detection as the landmark's.
  /// @param room landmarks the back-end can take; a trail without room goes on as a trail
  void advance(const Observations& seen, ScanId id, std::size_t room, Promotions* promotions);

 private:
  /// The parts of a body move together, but not all of them along the line of sight.
  void find_companions(Observations* out) const;

  /// A mover slow enough for the consensus shows by residuals that agree with each other.
  void find_movers(const Vector3d& v_S, Observations* out) const;

  /// The scan with the Dopplers of its static set unfolded.
  void unwrap(const DetectionList& scan, Observations* out);

  FrontendOptions options_;
  bool use_trails_;
  bool use_landmarks_;
  bool unwrap_;
  EgoVelocityRansac ransac_;
  DetectionList unwrapped_;
  TrailSet trails_;
  Association association_;
  std::array<bool, kMaxDetections> taken_{};
  std::array<bool, kMaxDetections> matched_{};
  std::array<bool, kMaxDetections> promoted_{};
};

}  // namespace rio
