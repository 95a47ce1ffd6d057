// SPDX-License-Identifier: BSD-3-Clause
// Stages 3 and 7: what a scan says about the state. observe() reads the predicted state and touches
// nothing; advance() then lives the trails one scan further and proposes landmarks.
//
// Every detection has one sink: a landmark, a trail, or a new trail.
// Reference: Michalczyk et al. 2023, II-B (matching after alignment with the two poses), III-C.
#pragma once

#include <array>
#include <cmath>
#include <optional>

#include "rio/frontend/association.hpp"
#include "rio/frontend/detection.hpp"
#include "rio/frontend/ego_velocity.hpp"
#include "rio/frontend/trails.hpp"
#include "rio/models/rest.hpp"
#include "rio/options.hpp"
#include "rio/state/estimate.hpp"

namespace rio {

/// What one scan contributes; points into the scan and the trails it was made from.
struct Observations {
  const DetectionList* scan = nullptr;  ///< its static detections unfolded
  const TrailSet* trails = nullptr;
  EgoVelocity ego_velocity;
  AssociationResult matches;
  std::optional<RestModel::Measurement> rest;             ///< it stands
  std::array<double, kMaxDetections> doppler_residual{};  ///< of trails' matches, in sigmas
  std::array<bool, kMaxDetections> moves{};               ///< an inlier, but no part of the world

  const Detection& detection(std::size_t i) const { return scan->items[i]; }
  bool is_static(std::size_t i) const { return ego_velocity.inlier[i] && !moves[i]; }
};

/// Detections proposed as landmarks; the back-end decides how many it has room for.
struct Promotions {
  StaticVector<Detection, kMaxDetections> births;
};

class Frontend {
 public:
  explicit Frontend(const Options& options)
      : options_(options.frontend),
        use_trails_(options.update.use_trails || options.update.use_landmarks),
        use_landmarks_(options.update.use_landmarks),
        unwrap_(options.frontend.unwrap_doppler && options.radar.max_doppler > 0.0),
        ransac_(options.frontend, unwrap_ ? options.radar.max_doppler : 0.0),
        trails_(options.frontend.max_detections, std::max(1, options.update.max_clones)),
        association_(options.frontend, static_cast<std::size_t>(options.update.max_landmarks),
                     0.5 * options.radar.noise_distance) {}

  const TrailSet& trails() const { return trails_; }
  void reset() { trails_.clear(); }

  /// Static set and matches of a scan, corrected for the radar errors of the state predicted to its
  /// time. Pure.
  /// @param velocity_covariance_S of the predicted radar velocity [m^2/s^2]
  void observe(const DetectionList& scan, const Estimate& predicted, Observations* out,
               const Matrix3d& velocity_covariance_S = Matrix3d::Zero()) {
    out->scan = &scan;
    out->trails = &trails_;
    out->matches = AssociationResult{};
    out->moves.fill(false);
    std::optional<RadarVelocity> predicted_velocity;
    if (options_.ransac_use_prediction) {
      predicted_velocity = {radar_velocity(predicted), velocity_covariance_S};
    }
    ransac_.estimate(scan, predicted_velocity, &out->ego_velocity,
                     1.0 + predicted.radar_errors[RadarErrors::kDopplerScale]);
    if (unwrap_) unwrap(scan, out);
    find_companions(out);
    if (!use_trails_) return;
    const std::size_t landmarks = use_landmarks_ ? predicted.landmarks.size() : 0;
    std::array<bool, kMaxDetections> usable{};
    for (std::size_t i = 0; i < scan.items.size(); ++i) usable[i] = out->is_static(i);
    association_.match(*out->scan, usable, predicted, landmarks, trails_, &out->matches);
    find_movers(radar_velocity(predicted), out);
  }

  /// Stage 7, after a successful update: extends, ends and begins trails with the scan of `id`, and
  /// proposes those matched `promote_after` times in a row, newest detection as the landmark's.
  /// @param room landmarks the back-end can take; a trail without room goes on as a trail
  void advance(const Observations& seen, ScanId id, std::size_t room, Promotions* promotions) {
    promotions->births.clear();
    if (!use_trails_) return;
    taken_.fill(false);
    matched_.fill(false);
    promoted_.fill(false);
    for (const Match& m : seen.matches.landmarks) taken_[m.detection] = true;
    for (const Match& m : seen.matches.trails) {
      taken_[m.detection] = true;
      matched_[m.target] = true;
      trails_.extend(m.target, {id, seen.detection(m.detection)},
                     seen.doppler_residual[m.detection]);
      if (use_landmarks_ && !seen.moves[m.detection] &&
          trails_[m.target].matches >= options_.promote_after && promotions->births.size() < room) {
        promotions->births.push_back(seen.detection(m.detection));
        promoted_[m.target] = true;
      }
    }
    trails_.retain([this](std::size_t i) { return matched_[i] && !promoted_[i]; });
    for (std::size_t i = 0; i < seen.scan->items.size(); ++i) {
      const bool known = taken_[i] || seen.matches.near_landmark[i];
      if (seen.is_static(i) && !known) trails_.create({id, seen.detection(i)});
    }
  }

 private:
  /// The parts of a body move together, but not all of them along the line of sight.
  void find_companions(Observations* out) const {
    const DetectionList& scan = *out->scan;
    const double square = options_.mover_extent * options_.mover_extent;
    for (std::size_t k = 0; k < scan.items.size(); ++k) {
      if (!out->ego_velocity.outlier[k]) continue;
      for (std::size_t i = 0; i < scan.items.size(); ++i) {
        const Vector3d apart = scan.items[i].point_S - scan.items[k].point_S;
        if (apart.squaredNorm() < square) out->moves[i] = true;
      }
    }
  }

  /// A mover slow enough for the consensus shows by residuals that agree with each other.
  void find_movers(const Vector3d& v_S, Observations* out) const {
    for (const Match& m : out->matches.trails) {
      const Detection& d = out->detection(m.detection);
      const double residual =
          (d.range_rate + d.direction_S.dot(v_S)) / std::sqrt(residual_variance(d, v_S));
      out->doppler_residual[m.detection] = residual;
      const Trail& trail = trails_[m.target];
      if (options_.mover_sigmas <= 0.0 || trail.matches == 0) continue;
      const double bound = options_.mover_sigmas * std::sqrt(trail.matches + 1.0);
      if (std::abs(trail.doppler_sum + residual) > bound) out->moves[m.detection] = true;
    }
  }

  void unwrap(const DetectionList& scan, Observations* out) {
    unwrapped_ = scan;
    for (std::size_t i = 0; i < scan.items.size(); ++i) {
      if (out->is_static(i)) unwrapped_.items[i].range_rate = out->ego_velocity.range_rate[i];
    }
    out->scan = &unwrapped_;
  }

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
