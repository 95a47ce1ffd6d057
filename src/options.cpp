// SPDX-License-Identifier: BSD-3-Clause
// Validation of the options and the presets.
#include "rio/options.hpp"

#include "rio/option_fields.hpp"
#include "rio/state/estimate.hpp"

namespace rio {

static_assert(option_limits::kDetections == kMaxDetections);
static_assert(option_limits::kClones == kMaxClones);
static_assert(option_limits::kLandmarks == kMaxLandmarks);

namespace {

/// The first value outside its range; empty if there is none.
std::string range_problem(const Options& options) {
  std::string first;
  visit_fields(options, [&first](const FieldInfo& info, const auto& value) {
    if (first.empty()) first = field_error(info, value);
  });
  return first;
}

/// The first pair of values that cannot go together; empty if there is none.
std::string coherence_problem(const Options& o) {
  if (o.radar.min_range >= o.radar.max_range) {
    return "radar.min_range is not below radar.max_range";
  }
  if (o.frontend.ransac_min_inliers > o.frontend.max_detections) {
    return "frontend.ransac_min_inliers exceeds frontend.max_detections";
  }
  if ((o.update.use_trails || o.update.use_landmarks) && o.update.max_clones < 1) {
    return "update.max_clones = 0 needs update.use_trails = update.use_landmarks = false";
  }
  if (o.update.use_landmarks && o.update.max_landmarks < 1) {
    return "update.max_landmarks = 0 needs update.use_landmarks = false";
  }
  return {};
}

}  // namespace

bool Options::validate(std::string* why) const {
  std::string problem = range_problem(*this);
  if (problem.empty()) problem = coherence_problem(*this);
  if (problem.empty()) return true;
  if (why != nullptr) *why = problem;
  return false;
}

bool preset(const std::string& name, Options* options) {
  Options chosen;
  if (name == "published-ekf") {
    // Michalczyk et al. 2023: N = 7, pairwise trail distances and range-only landmarks with a
    // constant sigma of 4 cm, landmarks removed at their first miss, directions and calibration
    // taken as exact, no unfolding, no recovery
    chosen.frontend.ransac_sigmas = 0.0;
    chosen.frontend.ransac_use_prediction = false;
    chosen.frontend.unwrap_doppler = false;
    chosen.frontend.velocity_recovery = false;
    chosen.frontend.matching = Matching::kEuclidean;
    chosen.frontend.promote_after = 7;
    chosen.frontend.landmark_timeout = 0.0;
    chosen.update.use_trails = true;
    chosen.update.direction_correction = false;
    chosen.update.direction_noise = false;
    chosen.update.consistent_covariance = false;
    chosen.update.trail_noise = TrailNoise::kIndependent;
    chosen.update.sigma_trail_distance = 0.04;
    chosen.update.landmark_measurement = LandmarkMeasurement::kDistance;
    chosen.update.landmark_walk = 0.0;
    chosen.update.sigma_landmark_distance = 0.04;
    chosen.update.max_landmarks = 20;
    chosen.update.gate_probability = 0.975;
    chosen.update.max_clones = 7;
    chosen.update.extrinsic_rotation_sigma = 0.0;
    chosen.update.extrinsic_translation_sigma = 0.0;
  } else if (name != "default") {
    return false;
  }
  *options = chosen;
  return true;
}

}  // namespace rio
