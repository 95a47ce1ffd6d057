// SPDX-License-Identifier: BSD-3-Clause
#include "rio/update/scan_rows.hpp"

#include <cmath>
#include <limits>

namespace rio {

namespace {

/// The direction along which a Doppler's row measures the velocity, radar axes.
Vector3d direction_of(const LinearRow& doppler, const Matrix3d& R_WS) {
  Vector3d u_S = Vector3d::Zero();
  doppler.for_each_segment([&](int column, const double* h, int) {
    if (column == body::kVelocity) u_S = -R_WS.transpose() * Eigen::Map<const Vector3d>(h);
  });
  return u_S;
}

}  // namespace

ScanRows::ScanRows(const Options& options)
    : options_(options.update),
      ablation_(options.ablation),
      auxiliary_(options.auxiliary),
      gravity_(options.imu.gravity),
      gate_(options.update.gate_probability),
      models_(options.update),
      batch_(capacity(options)) {
  measurements_.reserve(options);
  for (std::size_t r = 0; r < options.radars(); ++r) {
    const RadarOptions radar = options.radar_of(r);
    noise_distance_[r] = radar.noise_distance;
    doppler_grid_[r] = radar.doppler_resolution;
  }
}

std::size_t ScanRows::capacity(const Options& options) {
  // a detection gives at most its Doppler and a trail of distances, or a landmark's four rows
  const int each = 1 + std::max(3, options.update.max_clones);
  return static_cast<std::size_t>(options.frontend.max_detections * each + RestModel::kDim) +
         kMaxAiding * static_cast<std::size_t>(AidingMeasurement::kMaxRows);
}

void ScanRows::build(const Observations& seen, const StateEstimate& state_estimate,
                     UpdateReport* report) {
  batch_.clear();
  measurements_.clear();
  used_aiding_.clear();
  gathered_.begin(state_estimate.covariance());
  if (seen.scan != nullptr) {
    LinearizationPoint x(state_estimate.estimate());
    if (seen.rest) x.stand();
    const Scan scan{seen, state_estimate, x, report};
    begin_scan(scan);
    if (seen.rest) add_rest(scan);
    if (options_.use_landmarks) add_landmarks(scan);
    if (options_.use_doppler) add_doppler(scan);
    if (options_.use_trails) add_trails(scan);
    distance_at_scan_[x.estimate.radar] = x.estimate.distance_travelled;
  }
  if (seen.aiding != nullptr) add_aiding(*seen.aiding, state_estimate, report);
}

void ScanRows::begin_scan(const Scan& scan) {
  const Estimate& x = scan.x.estimate;
  const Time now = x.nav.time;
  std::optional<Time>& last_scan = last_scan_[x.radar];
  since_scan_ = last_scan ? std::min(1.0, to_seconds(now - *last_scan)) : 1.0;
  last_scan = now;
  was_used_.fill(false);
  measures_landmark_.fill(false);
  if (!options_.use_doppler) return;
  velocity_covariance_ = scan.state_estimate.radar_velocity_covariance(scan.x);
  correction_S_ = expected_correction(scan.seen.ego_velocity, scan.x, velocity_covariance_);
}

void ScanRows::add_rest(const Scan& scan) {
  const Measured<RestModel> m{*scan.seen.rest, scan.x.estimate.radar};
  if (decide(RestModel::kModel, 0, add_block(m, scan), scan.report)) keep(m, 1.0);
}

void ScanRows::add_doppler(const Scan& scan) {
  const Observations& seen = scan.seen;
  const LinearizationPoint& x = scan.x;
  const Vector3d v_S = x.radar_velocity_S();
  const Matrix3d& V = velocity_covariance_;
  const Matrix3d R_WS = x.T_WB.R * x.T_BS.R;
  const SteadyOffset steady = x.steady_offset();
  for (std::size_t i = 0; i < seen.scan->items.size(); ++i) {
    if (!seen.is_static(i) || measures_landmark_[i]) continue;
    Measured<DopplerModel> m{DopplerModel::measurement(seen.detection(i), x.gyro_B),
                             x.estimate.radar};
    m.z.steady = steady;
    if (options_.doppler_directions == DopplerDirections::kCorrected) {
      m.z.predicted_var = m.z.direction_S.dot(V * m.z.direction_S);
      const auto expected = DopplerModel::expected_direction(m.z, m.z.direction_S, v_S);
      m.z.variance_factor = expected.variance_factor;
    }
    const bool valid = add_block(m, scan);
    if (valid) {
      const LinearRow& row = batch_.rows().back();
      const Vector3d u_S = direction_of(row, R_WS);
      S_.setConstant(1, 1, u_S.dot(V * u_S) + row.variance);
    }
    if (!judge(DopplerModel::kModel, i, valid, scan.report)) continue;
    m.z.predicted_var = 0.0;  // that of this prediction; the window solves for the state
    keep(m, doppler_repetition(seen.detection(i), x));
  }
}

void ScanRows::add_trails(const Scan& scan) {
  const Observations& seen = scan.seen;
  for (const Match& m : seen.matches.trails) {
    for (const TrailElement& past : (*seen.trails)[m.target].elements) {
      const int clone = scan.x.estimate.find_clone(past.scan);
      if (clone < 0) continue;
      Measured<TrailDistanceModel> distance;
      distance.z = TrailDistanceModel::measurement(seen.detection(m.detection), past.detection);
      distance.radar = scan.x.estimate.radar;
      distance.past = past.scan;
      const bool valid = add_block(distance, scan, {clone, 0});
      if (decide(TrailDistanceModel::kModel, m.detection, valid, scan.report)) keep(distance, 1.0);
    }
  }
}

void ScanRows::add_landmarks(const Scan& scan) {
  const Observations& seen = scan.seen;
  const LinearizationPoint& x = scan.x;
  for (const Match& m : seen.matches.landmarks) {
    if (seen.rest &&
        x.estimate.distance_travelled - x.estimate.landmarks[m.target].distance_born > kSamePlace) {
      was_used_[m.target] = true;
      look_sums_[m.target] = x.estimate.landmarks[m.target].looks;  // not a look
      continue;
    }
    const Detection& d = seen.detection(m.detection);
    const std::size_t radar = x.estimate.radar;
    switch (options_.landmark_measurement) {
      case LandmarkMeasurement::kDistance:
        (void)add_landmark<LandmarkDistanceModel>(
            {LandmarkDistanceModel::measurement(d), radar, m.target}, m.detection, scan);
        was_used_[m.target] = true;  // as published, a match keeps a landmark alive even if gated
        break;
      case LandmarkMeasurement::kPosition:
        was_used_[m.target] = add_landmark<LandmarkPositionModel>(
            {LandmarkPositionModel::measurement(d), radar, m.target}, m.detection, scan);
        break;
      case LandmarkMeasurement::kPoint: {
        Measured<LandmarkPointModel> point{LandmarkPointModel::measurement(d), {}, radar, m.target};
        if (options_.use_doppler) {
          point.doppler = LandmarkDopplerModel::measurement(d, x.gyro_B);
          point.doppler->steady = x.steady_offset();
          add_gyro_noise(&*point.doppler, d.direction_S, x);
        }
        was_used_[m.target] = add_landmark(point, m.detection, scan);
        measures_landmark_[m.detection] = was_used_[m.target];
        break;
      }
    }
  }
}

template <class M>
bool ScanRows::add_landmark(Measured<M> m, std::size_t detection, const Scan& scan) {
  const LinearizationPoint& x = scan.x;
  const bool valid = add_block(m, scan, {0, static_cast<int>(m.landmark)});
  Eigen::Vector2d innovation = Eigen::Vector2d::Zero();
  if (valid) {
    gathered_.innovation_covariance(batch_, batch_.last_block(), &S_);
    if constexpr (std::is_same_v<M, LandmarkPointModel>) {
      if (ablation_.range_curvature) add_curvature(scan.state_estimate, &m.z);
      innovation = direction_innovation();  // now, since the gate overwrites S_
    }
  }
  if (!judge(M::kModel, detection, valid, scan.report)) return false;
  if constexpr (std::is_same_v<M, LandmarkPointModel>) {
    add_look(innovation, &m, x);
    // of directions with that noise
    if (m.doppler && ablation_.mismatch_doppler) add_mismatch(&m, x);
  }
  const double repeated = repetition(x.estimate.landmarks[m.landmark].distance_seen, x);
  keep(m, repeated * mismatch_factor(options_.match_trust));
  return true;
}

void ScanRows::add_aiding(const std::vector<AidingObservation>& aiding,
                          const StateEstimate& state_estimate, UpdateReport* report) {
  const Estimate& x = state_estimate.estimate();
  for (std::size_t i = 0; i < aiding.size(); ++i) {
    const AidingObservation& seen = aiding[i];
    batch_.begin_block();
    const bool valid = linearize(
        seen.measurement, seen.to_now, x.nav, x, auxiliary_, gravity_,
        aiding_columns(state_estimate.layout().of_radar(seen.measurement.radar())), &aiding_);
    if (valid) {
      for (const LinearRow& row : aiding_) batch_.push(row);
    }
    if (decide(seen.model, i, valid, report, seen.measurement.name())) {
      (void)used_aiding_.push_back(i);
    }
  }
}

bool ScanRows::judge(Model model, std::size_t detection, bool valid, UpdateReport* report,
                     const char* name) {
  ModelReport& sums = report->models[static_cast<std::size_t>(model)];
  InnovationRecord record;
  record.model = model;
  record.name = name;
  record.detection = static_cast<std::uint16_t>(detection);
  if (!valid) {
    record.result = GateResult::kOutOfDomain;
    ++sums.rows_out_of_domain;
    batch_.drop_block();
  } else {
    const RowBlock& block = batch_.last_block();
    const int rows = static_cast<int>(block.count);
    record.dof = static_cast<std::uint16_t>(rows);
    record.innovation = batch_.rows()[block.first].residual;
    record.sigma = std::sqrt(S_(0, 0));
    record.nis = normalised_innovation_squared(block);
    record.gate = gate_.threshold(block.count);
    if (record.nis <= record.gate && std::isfinite(record.nis)) {
      sums.rows_used += rows;
      sums.nis += record.nis;
    } else {
      record.result = GateResult::kGated;
      sums.rows_gated += rows;
      batch_.drop_block();
    }
  }
  if (!report->records.push_back(record)) ++report->records_dropped;
  return record.result == GateResult::kUsed;
}

double ScanRows::normalised_innovation_squared(const RowBlock& block) {
  double sum = 0.0;
  std::array<double, Gate::kMaxDof> white{};  // L^-1 r; L takes the place of S
  for (Eigen::Index i = 0; i < S_.rows(); ++i) {
    const auto row = static_cast<std::size_t>(i);
    double r = batch_.rows()[block.first + row].residual;
    for (Eigen::Index j = 0; j < i; ++j) {
      for (Eigen::Index k = 0; k < j; ++k) S_(i, j) -= S_(i, k) * S_(j, k);
      S_(i, j) /= S_(j, j);
      S_(i, i) -= S_(i, j) * S_(i, j);
      r -= S_(i, j) * white[static_cast<std::size_t>(j)];
    }
    if (!(S_(i, i) > 0.0)) return std::numeric_limits<double>::infinity();
    S_(i, i) = std::sqrt(S_(i, i));
    white[row] = r / S_(i, i);
    sum += white[row] * white[row];
  }
  return sum;
}

}  // namespace rio
