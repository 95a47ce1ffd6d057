// SPDX-License-Identifier: BSD-3-Clause
// Stages 3 and 7: what a scan says about the state. observe() reads the predicted state and touches
// nothing; advance() then lives the trails one scan further and proposes landmarks.
//
// Every detection has one sink: a landmark, a trail, or a new trail.
// Reference: Michalczyk et al. 2023, II-B (matching after alignment with the two poses), III-C.
#pragma once

#include <array>
#include <optional>

#include "rio/frontend/assignment.hpp"
#include "rio/frontend/detection.hpp"
#include "rio/frontend/ego_velocity.hpp"
#include "rio/frontend/trails.hpp"
#include "rio/options.hpp"
#include "rio/state/estimate.hpp"

namespace rio {

/// A matched pair: `target` is the index of a trail or a landmark.
struct Match {
  std::size_t target = 0;
  std::size_t detection = 0;
};

/// What one scan contributes; points into the scan and the trails it was made from.
struct Observations {
  const DetectionList* scan = nullptr;
  const TrailSet* trails = nullptr;
  EgoVelocity ego_velocity;
  StaticVector<Match, kMaxDetections> trail_matches;
  StaticVector<Match, kMaxDetections> landmark_matches;

  const Detection& detection(std::size_t i) const { return scan->items[i]; }
  bool is_static(std::size_t i) const { return ego_velocity.inlier[i]; }
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
        ransac_(options.frontend),
        trails_(options.frontend.max_detections, std::max(1, options.update.max_clones)),
        assignment_(static_cast<std::size_t>(options.frontend.max_detections +
                                             options.update.max_landmarks),
                    static_cast<std::size_t>(options.frontend.max_detections)) {}

  const TrailSet& trails() const { return trails_; }
  void reset() { trails_.clear(); }

  /// Static set and matches of a scan, given the state predicted to its time. Pure.
  void observe(const DetectionList& scan, const Estimate& predicted, Observations* out) {
    out->scan = &scan;
    out->trails = &trails_;
    out->trail_matches.clear();
    out->landmark_matches.clear();
    std::optional<Vector3d> predicted_velocity;
    if (options_.ransac_use_prediction) predicted_velocity = radar_velocity(predicted);
    ransac_.estimate(scan, predicted_velocity, &out->ego_velocity);
    if (use_trails_) associate(predicted, out);
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
    for (const Match& m : seen.landmark_matches) taken_[m.detection] = true;
    for (const Match& m : seen.trail_matches) {
      taken_[m.detection] = true;
      matched_[m.target] = true;
      trails_.extend(m.target, {id, seen.detection(m.detection)});
      if (use_landmarks_ && trails_[m.target].matches >= options_.promote_after &&
          promotions->births.size() < room) {
        promotions->births.push_back(seen.detection(m.detection));
        promoted_[m.target] = true;
      }
    }
    trails_.retain([this](std::size_t i) { return matched_[i] && !promoted_[i]; });
    for (std::size_t i = 0; i < seen.scan->items.size(); ++i) {
      if (seen.is_static(i) && !taken_[i]) trails_.create({id, seen.detection(i)});
    }
  }

 private:
  /// Velocity of the radar in its own axes.
  static Vector3d radar_velocity(const Estimate& x) {
    const Vector3d w = x.gyro_B - x.nav.gyro_bias;
    const RigidPose T_BS(x.T_BS);
    const Vector3d v_B = x.T_WB().R.transpose() * x.nav.v_WB;
    return T_BS.R.transpose() * (v_B + w.cross(T_BS.p));
  }

  /// Landmarks and the newest detection of each trail, moved into the current radar frame, against
  /// the static detections: Euclidean distance, gated, optimal one-to-one.
  void associate(const Estimate& predicted, Observations* out) {
    const RigidPose T_WB = predicted.T_WB();
    const RigidPose T_BS(predicted.T_BS);
    const std::size_t landmarks = use_landmarks_ ? predicted.landmarks.size() : 0;
    const std::size_t rows = landmarks + trails_.size();
    assignment_.begin(rows, out->scan->items.size(), options_.match_gate);
    for (std::size_t row = 0; row < rows; ++row) {
      Vector3d point_W;
      if (row < landmarks) {
        point_W = predicted.landmarks[row].p_W;
      } else {
        const TrailElement& newest = trails_[row - landmarks].newest();
        const int clone = predicted.find_clone(newest.scan);
        if (clone < 0) continue;
        point_W = to_world(predicted.clones[static_cast<std::size_t>(clone)].T_WB, T_BS,
                           newest.detection.point_S);
      }
      const Vector3d point_S = to_radar(T_WB, T_BS, point_W);
      for (std::size_t i = 0; i < out->scan->items.size(); ++i) {
        if (!out->is_static(i)) continue;
        assignment_.set(row, i, (out->detection(i).point_S - point_S).norm());
      }
    }
    assignment_.solve();
    for (std::size_t row = 0; row < rows; ++row) {
      const int column = assignment_.column_of(row);
      if (column == Assignment::kNone) continue;
      const auto detection = static_cast<std::size_t>(column);
      if (row < landmarks) {
        out->landmark_matches.push_back({row, detection});
      } else {
        out->trail_matches.push_back({row - landmarks, detection});
      }
    }
  }

  FrontendOptions options_;
  bool use_trails_;
  bool use_landmarks_;
  EgoVelocityRansac ransac_;
  TrailSet trails_;
  Assignment assignment_;
  std::array<bool, kMaxDetections> taken_{};
  std::array<bool, kMaxDetections> matched_{};
  std::array<bool, kMaxDetections> promoted_{};
};

}  // namespace rio
