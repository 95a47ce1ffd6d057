// SPDX-License-Identifier: BSD-3-Clause
// The Kalman filter as a back-end that records innovations: before each update every landmark match
// contributes range, azimuth and elevation, every static detection its Doppler, with the covariance
// predicted from the state estimate.
//
// If a true velocity is available, the Doppler is compared with that instead of the estimate.
// Measurements that repeat one made a few centimetres before are skipped: their error is in the
// estimate.
#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "calibrate/noise_calibration.hpp"
#include "rio/ekf/ekf.hpp"
#include "rio/models/doppler.hpp"
#include "rio/models/landmark_point.hpp"

namespace rio::calibrate {

/// Result of a run: measures of the noise of its radar.
struct Innovations {
  std::vector<eval::NoiseSample> samples;
  std::size_t landmarks = 0;  ///< of these, matches with landmarks
  std::size_t dopplers = 0;   ///< of these, Dopplers
};

class NoiseProbe : public Ekf {
 public:
  explicit NoiseProbe(const Options& options) : Ekf(options), radar_(options.radar) {}

  /// Output of the innovations, and the truth, which may be empty.
  void connect(Innovations* out, TruthAt truth) {
    out_ = out;
    truth_ = std::move(truth);
  }

  Status update(const Observations& seen, const ScanRows& rows) {
    const LinearizationPoint x(estimate());
    for (const Match& m : seen.matches.landmarks) {
      if (is_fresh(estimate().landmarks[m.target].distance_seen)) {
        add_landmark(seen.detection(m.detection), m.target, x);
      }
    }
    if (is_fresh(distance_at_scan_)) add_dopplers(seen, x);
    distance_at_scan_ = estimate().distance_travelled;
    return Ekf::update(seen, rows);
  }

 private:
  /// Of errors that repeat with the distance travelled, e^-2 is left.
  bool is_fresh(double distance) const {
    return estimate().distance_travelled - distance >= 2.0 * radar_.noise_distance;
  }

  void add_landmark(const Detection& d, std::size_t landmark, const LinearizationPoint& x) {
    using M = LandmarkPointModel;
    Evaluation<M> e;
    if (!M{}.evaluate(M::measurement(d), x.T_WB, x.T_BS, estimate().landmarks[landmark].p_W, 0.0,
                      e.r, &e.J, e.R)) {
      return;
    }
    const BlockIndex index{0, static_cast<int>(landmark)};
    const auto rows = state_rows<M::kDim>(e.J, M::Blocks{}, x, index, state_estimate().layout());
    eval::NoiseSample sample;
    sample.innovation = e.r;
    gathered_.begin(state_estimate().covariance());
    sample.predicted = gathered_.product(rows);
    const auto curvature = M::range_curvature(d.range, sample.predicted.block<2, 2>(1, 1));
    sample.innovation[0] -= curvature.mean;
    sample.predicted(0, 0) += curvature.variance;
    const double grid = radar_.range_resolution;
    sample.grid = Vector3d(grid * grid / 12.0, 0.0, 0.0);
    const double growth = weak_echo_growth(d.snr_db, radar_.weak_snr_db);
    const double az = d.sigma_azimuth_S.norm() / (growth * radar_.sigma_azimuth);
    const double el = d.sigma_elevation_S.norm() / (growth * radar_.sigma_elevation);
    sample.gain.setZero(M::kDim, 4);
    sample.gain.diagonal().head<3>() << 1.0, az * az, el * el;
    sample.snr_db = d.snr_db;
    out_->samples.push_back(sample);
    ++out_->landmarks;
  }

  void add_dopplers(const Observations& seen, const LinearizationPoint& predicted) {
    const std::optional<NavState> truth = truth_ ? truth_(estimate().nav.time) : std::nullopt;
    NavState nav = estimate().nav;
    if (truth) {
      nav.q_WB = truth->q_WB;
      nav.v_WB = truth->v_WB;
    }
    const LinearizationPoint x(estimate(), nav, predicted.gyro_B, predicted.steady);
    for (std::size_t i = 0; i < seen.scan->items.size(); ++i) {
      if (seen.is_static(i)) add_doppler(seen.detection(i), x, truth.has_value());
    }
  }

  /// @param exact pose and velocity have no error
  void add_doppler(const Detection& d, const LinearizationPoint& x, bool exact) {
    using M = DopplerModel;
    Evaluation<M> e;
    M(DopplerDirections::kNoisy)
        .evaluate(M::measurement(d, x.gyro_B), x.T_WB, x.v_WB, x.gyro_bias, x.T_BS, x.doppler_scale,
                  e.r, &e.J, e.R);
    if (exact) {
      e.J.middleCols<6>(M::Blocks::column<BodyPose>()).setZero();
      e.J.middleCols<3>(M::Blocks::column<BodyVelocity>()).setZero();
    }
    const LinearRow row = state_rows<1>(e.J, M::Blocks{}, x, {}, state_estimate().layout())[0];
    const Vector3d v_S = x.radar_velocity_S();
    const double growth = weak_echo_growth(d.snr_db, radar_.weak_snr_db);
    const double az = d.sigma_azimuth_S.dot(v_S) / (growth * radar_.sigma_azimuth);
    const double el = d.sigma_elevation_S.dot(v_S) / (growth * radar_.sigma_elevation);
    eval::NoiseSample sample;
    sample.innovation = e.r;
    sample.predicted.setConstant(1, 1, state_estimate().covariance().product(row, row));
    sample.grid.setConstant(1, radar_.doppler_resolution * radar_.doppler_resolution / 12.0);
    sample.gain.resize(1, 4);
    sample.gain << 0.0, az * az, el * el, 1.0;
    sample.snr_db = d.snr_db;
    out_->samples.push_back(sample);
    ++out_->dopplers;
  }

  GatheredCovariance gathered_;
  RadarOptions radar_;
  Innovations* out_ = nullptr;
  TruthAt truth_;
  double distance_at_scan_ = 0.0;  ///< travelled at the last scan [m]
};

}  // namespace rio::calibrate
