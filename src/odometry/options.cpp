// SPDX-License-Identifier: BSD-3-Clause
// Validation of the options and the presets.
#include "rio/options.hpp"

#include <cmath>

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
  const auto check = [&first](const FieldInfo& info, const auto& value) {
    if (first.empty()) first = field_error(info, value);
  };
  visit_fields(options, check);
  visit_preset_fields(options, check);
  visit_library_fields(options, check);
  return first;
}

/// The first pair of values that cannot go together; empty if there is none.
std::string coherence_problem(const Options& o) {
  if (o.radar.min_range >= o.radar.max_range) {
    return "radar.min_range is not below radar.max_range";
  }
  if ((o.update.use_trails || o.update.use_landmarks) && o.update.max_clones < 1) {
    return "update.max_clones = 0 needs update.use_trails = update.use_landmarks = false";
  }
  if (o.update.use_landmarks && o.update.max_landmarks < 1) {
    return "update.max_landmarks = 0 needs update.use_landmarks = false";
  }
  for (std::size_t r = 1; r < o.radars(); ++r) {
    Options other = o.seen_by(r);
    other.other_radars.clear();
    std::string problem = range_problem(other);
    if (problem.empty()) problem = coherence_problem(other);
    if (!problem.empty()) return "radar " + std::to_string(r) + ": " + problem;
  }
  for (const AuxiliaryState& state : o.auxiliary) {
    constexpr double kLargest = 1e6;  // as of a start; its square is added to others
    const bool good =
        state.sigma > 0.0 && state.sigma <= kLargest && state.walk >= 0.0 && state.walk <= kLargest;
    if (!good) return std::string("auxiliary state ") + state.name + ": sigma or walk out of range";
    if (state.size < 1 || state.size > AuxiliaryState::kMaxSize) {
      return std::string("auxiliary state ") + state.name + ": size out of range";
    }
    if (state.delayed && state.walk > 0.0) {
      return std::string("auxiliary state ") + state.name + ": delayed, and with a random walk";
    }
    if (!std::all_of(state.initial.begin(), state.initial.end(),
                     [](double value) { return std::isfinite(value); })) {
      return std::string("auxiliary state ") + state.name + ": initial value not finite";
    }
  }
  return {};
}

/// Michalczyk et al., ICRA 2023: N = 7, pairwise trail distances and range-only landmarks with a
/// constant sigma of 4 cm, landmarks removed at their first miss, directions and calibration taken
/// as exact, no unfolding, no recovery, the same noise for all echoes, new in every scan, exact
/// stamps.
void publish_ekf(Options* o) {
  o->imu.stamp_sigma = 0.0;
  o->imu.measure_noise = false;
  o->radar.weak_snr_db = -200.0;
  o->radar.noise_distance = 0.0;
  o->frontend.ransac_sigmas = 0.0;
  o->frontend.mover_sigmas = 0.0;
  o->frontend.mover_extent = 0.0;
  o->frontend.own_echoes = false;
  o->frontend.ransac_use_prediction = false;
  o->frontend.unwrap_doppler = false;
  o->checks = {.landmarks = true,
               .velocity = false,
               .tilt = false,
               .heading = false,
               .biases = false,
               .position = false,
               .lost_tilt = false};
  o->frontend.detect_rest = false;
  o->frontend.matching = Matching::kEuclidean;
  o->frontend.promote_after = 7;
  o->frontend.landmark_timeout = 0.0;
  o->update.use_trails = true;
  o->update.doppler_directions = DopplerDirections::kExact;
  o->update.consistent_covariance = false;
  o->update.sigma_trail_distance = 0.04;
  o->update.landmark_measurement = LandmarkMeasurement::kDistance;
  o->update.match_trust = 1.0;
  o->update.landmark_walk = 0.0;
  o->update.sigma_landmark_distance = 0.04;
  o->update.max_landmarks = 20;
  o->update.gate_probability = 0.975;
  o->update.max_clones = 7;
  o->calibration = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
}

/// Michalczyk et al., IROS 2024: the same front-end and models with N = 10 in both places, in a
/// sliding window whose kernels take the place of the gates. It differs from the paper
///   - where that is silent: the kernel's size is the one with which the published convergence from
///     a wrong velocity comes out (with 1, as in Agarwal et al. 2013, it diverges; the authors'
///     public code has 4 for the Doppler, 1 for landmarks, 1e-4 for trails), the sigmas are those
///     of the filter of 2023, and a landmark is matched until its first miss as there;
///   - in the solver: damped Gauss-Newton instead of Levenberg-Marquardt;
///   - in the prior, which is kept in the right-invariant error (smoother/prior.hpp): in the
///     paper's error its linearisation points would make the heading observable.
void publish_smoother(Options* o) {
  publish_ekf(o);
  o->backend = BackEnd::kSmoother;
  o->frontend.promote_after = 10;
  o->update.max_clones = 10;
  o->update.gate_probability = 1.0;
  o->smoother.window = 10;
  o->smoother.kernel = Kernel::kDcs;
  o->smoother.kernel_size = 4.0;
}

/// Xu, Huang, Shen, Yin: the sliding window with IMU, Doppler and the places of landmarks, weighted
/// by the polar noise of each point, the same in all directions; matches by the density of that
/// noise with its 3-sigma check.
/// It differs from the paper
///   - where that is wrong or silent: the Doppler keeps a noise of its own (without it a hovering
///     radar would measure its speed exactly), the angle sigmas stand in an aligned basis, pairs
///     are one-to-one, a window has 10 states, a point becomes a landmark at its fourth match and
///     leaves after a second unseen;
///   - in the front-end and the prior, which are the shared ones: RANSAC instead of a bound on the
///     Doppler residual, Schur marginalisation instead of a fixed oldest state.
void publish_uncertainty(Options* o) {
  publish_smoother(o);
  o->radar.angle_growth = false;
  o->frontend.matching = Matching::kProbability;
  o->frontend.match_probability = 0.9973;
  o->frontend.promote_after = 4;
  o->frontend.landmark_timeout = 1.0;
  o->update.use_trails = false;
  o->update.doppler_directions = DopplerDirections::kNoisy;
  o->update.landmark_measurement = LandmarkMeasurement::kPosition;
  o->smoother.kernel = Kernel::kNone;
}

/// Doer and Trommer, MFI 2020: the velocity that RANSAC and least squares find in a scan is one
/// loosely coupled measurement of the filter; no points. It needs no clone for the delay of the
/// radar, since a scan is processed at the time of its measurement. RANSAC alone rejects outliers:
/// the covariance of the residuals does not know how direction errors shrink the velocity, and a
/// gate with it rejects a third of the scans and at times all of them.
void publish_doppler_only(Options* o) {
  publish_ekf(o);
  o->update.use_ego_velocity = true;
  o->update.use_doppler = false;
  o->update.use_trails = false;
  o->update.use_landmarks = false;
  o->update.max_clones = 0;
  o->update.gate_probability = 1.0;
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
    publish_ekf(&chosen);
  } else if (name == "published-smoother") {
    publish_smoother(&chosen);
  } else if (name == "published-uncertainty") {
    publish_uncertainty(&chosen);
  } else if (name == "doppler-only") {
    publish_doppler_only(&chosen);
  } else if (name != "default") {
    return false;
  }
  *options = chosen;
  return true;
}

}  // namespace rio
