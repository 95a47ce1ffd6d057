// SPDX-License-Identifier: BSD-3-Clause
#include "rio/frontend/frontend.hpp"

#include <algorithm>
#include <cmath>

namespace rio {

Frontend::Frontend(const Options& options)
    : options_(options.frontend),
      use_trails_(options.update.use_trails || options.update.use_landmarks),
      use_landmarks_(options.update.use_landmarks),
      unwrap_(options.frontend.unwrap_doppler && options.radar.max_doppler > 0.0),
      ransac_(options.frontend, unwrap_ ? options.radar.max_doppler : 0.0),
      unwrapped_(options.frontend.max_detections),
      trails_(options.frontend.max_detections,
              std::max(1, static_cast<int>(clones_per_radar(options)))),
      association_(options.frontend, static_cast<std::size_t>(options.update.max_landmarks),
                   0.5 * options.radar.noise_distance) {}

void Frontend::observe(const DetectionList& scan, const Estimate& predicted, Observations* out,
                       const Matrix3d& velocity_covariance_S) {
  std::optional<RadarVelocity> predicted_velocity;
  if (options_.ransac_use_prediction) {
    predicted_velocity = {radar_velocity(predicted), velocity_covariance_S};
  }
  ransac_.estimate(scan, predicted_velocity, &out->ego_velocity, 1.0 + predicted.doppler_scale);
  match(scan, predicted, out);
}

void Frontend::match(const DetectionList& scan, const Estimate& predicted, Observations* out) {
  out->scan = &scan;
  out->trails = &trails_;
  out->moves.fill(false);
  if (unwrap_) {  // a copy with the range rates of the static set unfolded
    unwrapped_ = scan;
    for (std::size_t i = 0; i < scan.items.size(); ++i) {
      if (out->is_static(i)) unwrapped_.items[i].range_rate = out->ego_velocity.range_rate[i];
    }
    out->scan = &unwrapped_;
  }
  find_companions(out);
  out->matches.clear();
  if (!use_trails_) return;
  const std::size_t landmarks = use_landmarks_ ? predicted.landmarks.size() : 0;
  std::array<bool, kMaxDetections> usable{};
  for (std::size_t i = 0; i < scan.items.size(); ++i) usable[i] = out->is_static(i);
  association_.match(*out->scan, usable, predicted, landmarks, trails_, &out->matches);
  find_movers(radar_velocity(predicted), out);
}

void Frontend::advance(const Observations& seen, ScanId id, std::size_t room,
                       Promotions* promotions) {
  promotions->births.clear();
  if (!use_trails_) return;
  std::array<bool, kMaxDetections> taken = seen.matches.near_landmark;  // begins no trail
  std::array<bool, kMaxDetections> goes_on{};                           // by trail
  for (const Match& m : seen.matches.landmarks) taken[m.detection] = true;
  for (const Match& m : seen.matches.trails) {
    taken[m.detection] = true;
    goes_on[m.target] = true;
    trails_.extend(m.target, {id, seen.detection(m.detection)}, seen.doppler_residual[m.detection]);
    if (use_landmarks_ && !seen.moves[m.detection] &&
        trails_[m.target].matches >= options_.promote_after && promotions->births.size() < room) {
      promotions->births.push_back(seen.detection(m.detection));
      goes_on[m.target] = false;
    }
  }
  trails_.retain([&goes_on](std::size_t i) { return goes_on[i]; });
  for (std::size_t i = 0; i < seen.scan->items.size(); ++i) {
    if (seen.is_static(i) && !taken[i]) trails_.create({id, seen.detection(i)});
  }
}

void Frontend::find_companions(Observations* out) const {
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

void Frontend::find_movers(const Vector3d& v_S, Observations* out) const {
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

}  // namespace rio
