// SPDX-License-Identifier: BSD-3-Clause
// Simulated FMCW radar: point reflectors to the detections of one scan, each with its truth label.
//
// (E2) v_S = R_SB (R_BW v_WB + w_B x p_BS), the radar's own velocity
// (E3) range rate of a static point in direction u: -u . v_S (positive = receding)
// (E4) SNR = snr_1m + rcs - 40 log10 r - edge_loss ((2 az / fov_az)^2 + (2 el / fov_el)^2) + fading
// (E5) noise: r + sigma_r n, az + sigma_az / cos(az) n, el + sigma_el / cos(el) n, Doppler +
//      sigma_d n, sigmas at the true direction; then range and Doppler snap to their grids and the
//      Doppler folds into [-v_max, v_max)
// One peak a range-Doppler cell. Frames W, B, S; metres, radians, m/s, dB.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "rio/sim/radar_model.hpp"
#include "rio/sim/random.hpp"
#include "rio/sim/room.hpp"
#include "rio/sim/trajectory.hpp"
#include "rio/types.hpp"

namespace rio::sim {

/// The radar in its room, one call a scan.
class RadarSimulator {
 public:
  RadarSimulator(RadarModel model, Room room, std::uint64_t seed)
      : model_(std::move(model)),
        room_(std::move(room)),
        radar_random_(seed, 4),
        echoes_random_(seed, 5),
        cos_half_azimuth_(std::cos(0.5 * model_.fov_azimuth)),
        sin_half_elevation_(std::sin(0.5 * model_.fov_elevation)),
        speckle_(room_.reflectors.size()) {
    for (Speckle& s : speckle_) {
      s.fading = echoes_random_.normal();
      s.wander = echoes_random_.normal3();
    }
  }

  /// The scan of the radar carried through `body`.
  LabeledScan scan(const Trajectory::Point& body) {
    const Matrix3d R_WB = body.nav.q_WB.toRotationMatrix();
    const Matrix3d R_WS = R_WB * model_.T_BS.rotation.toRotationMatrix();
    const Vector3d p_WS = body.nav.p_WB + R_WB * model_.T_BS.translation;
    const Vector3d lever_W = R_WB * body.gyro_B.cross(model_.T_BS.translation);
    const View view{R_WS.transpose(), p_WS, R_WS.transpose() * (body.nav.v_WB + lever_W)};  // (E2)

    path_ += has_last_ ? (p_WS - last_p_WS_).norm() : 0.0;
    last_p_WS_ = p_WS;
    has_last_ = true;

    std::vector<Echo> echoes = peaks(static_echoes(view));
    add_outliers(view, echoes);

    LabeledScan result;
    result.scan.time = body.nav.time;
    std::set<Cell> taken;
    for (const Echo& echo : echoes) {
      const RadarDetection detection = measure(echo);
      // on a grid, the stronger of two peaks that the noise moved into one cell hides the other
      const Cell bins = cell(detection.point_S.norm(), detection.range_rate);
      if (model_.quantize && !taken.insert(bins).second) continue;
      result.scan.detections.push_back(detection);
      result.labels.push_back(echo.label);
    }
    return result;
  }

  const Room& room() const { return room_; }

 private:
  /// The radar's pose and velocity.
  struct View {
    Matrix3d R_SW;
    Vector3d p_WS;
    Vector3d v_S;

    Vector3d to_S(const Vector3d& point_W) const { return R_SW * (point_W - p_WS); }
  };
  /// What arrives at the antenna, free of noise.
  struct Echo {
    Polar polar;
    double range_rate = 0.0;
    double snr_db = 0.0;
    Label label;
  };
  using Cell = std::pair<long, long>;
  /// Interference inside one reflector, unit variance.
  struct Speckle {
    double fading = 0.0;
    Vector3d wander = Vector3d::Zero();
    double path = 0.0;  ///< way of the radar up to which this is advanced [m]
  };

  bool visible(const Vector3d& point_S) const {
    const double range = point_S.norm();
    return range > model_.min_range && range < model_.max_range &&
           point_S.x() > cos_half_azimuth_ * point_S.head<2>().norm() &&
           std::abs(point_S.z()) < sin_half_elevation_ * range;
  }

  /// First-order process in the distance the radar travelled: at rest nothing changes.
  void advance(Speckle& s) {
    const double keep = std::exp(-(path_ - s.path) / model_.fading_distance);
    s.path = path_;
    if (keep == 1.0) return;
    const double fresh = std::sqrt(1.0 - keep * keep);
    s.fading = keep * s.fading + fresh * echoes_random_.normal();
    s.wander = keep * s.wander + fresh * echoes_random_.normal3();
  }

  std::vector<Echo> static_echoes(const View& view) {
    std::vector<Echo> echoes;
    for (std::size_t i = 0; i < room_.reflectors.size(); ++i) {
      const Reflector& reflector = room_.reflectors[i];
      if (!visible(view.to_S(reflector.position_W))) continue;
      advance(speckle_[i]);
      const Vector3d centre_W = reflector.position_W + model_.wander_sigma * speckle_[i].wander;
      Echo echo = echo_of(view.to_S(centre_W), view, {Cause::kStatic, static_cast<int>(i)});
      const double azimuth = echo.polar.azimuth / (0.5 * model_.fov_azimuth);
      const double elevation = echo.polar.elevation / (0.5 * model_.fov_elevation);
      echo.snr_db = model_.snr_1m_db + reflector.rcs_dbsm - 40.0 * std::log10(echo.polar.range) -
                    model_.edge_loss_db * (azimuth * azimuth + elevation * elevation) +
                    model_.fading_sigma_db * speckle_[i].fading +
                    model_.flicker_sigma_db * echoes_random_.normal();  // (E4)
      if (echo.snr_db > model_.threshold_db) echoes.push_back(echo);
    }
    return echoes;
  }

  static Echo echo_of(const Vector3d& point_S, const View& view, Label label) {
    const double range_rate = -point_S.normalized().dot(view.v_S);  // (E3)
    return {.polar = Polar::of(point_S), .range_rate = range_rate, .snr_db = 0.0, .label = label};
  }

  /// The strongest echo of each range-Doppler cell, strongest first.
  std::vector<Echo> peaks(std::vector<Echo> echoes) const {
    std::stable_sort(echoes.begin(), echoes.end(),
                     [](const Echo& a, const Echo& b) { return a.snr_db > b.snr_db; });
    std::set<Cell> taken;
    std::vector<Echo> kept;
    for (const Echo& echo : echoes) {
      if (kept.size() >= static_cast<std::size_t>(model_.max_static)) break;
      if (taken.insert(cell(echo.polar.range, echo.range_rate)).second) kept.push_back(echo);
    }
    return kept;
  }

  /// Bin of the range and of the Doppler; the latter wraps.
  Cell cell(double range, double range_rate) const {
    if (model_.ambiguous) range_rate = fold(range_rate, model_.max_doppler);
    return {std::lround(range / model_.range_resolution),
            std::lround(range_rate / model_.doppler_resolution)};
  }

  /// As many outliers as give the share; ghosts come from the reflectors most prone to them.
  void add_outliers(const View& view, std::vector<Echo>& echoes) {
    if (model_.outlier_share <= 0.0) return;
    std::vector<Echo> sources = echoes;
    std::stable_sort(sources.begin(), sources.end(),
                     [&](const Echo& a, const Echo& b) { return ghost_rank(a) > ghost_rank(b); });
    const double expected =
        static_cast<double>(echoes.size()) * model_.outlier_share / (1.0 - model_.outlier_share);
    for (int i = static_cast<int>(expected + radar_random_.uniform()); i > 0; --i) {
      const bool is_false_alarm = radar_random_.uniform() < model_.false_alarm_share;
      Echo outlier = false_alarm();
      if (!is_false_alarm && !sources.empty()) {
        outlier = ghost(sources.back(), view);
        sources.pop_back();
      }
      echoes.push_back(outlier);
    }
  }

  double ghost_rank(const Echo& echo) const {
    return room_.reflectors[static_cast<std::size_t>(echo.label.reflector)].ghost_rank;
  }

  Echo false_alarm() {
    Echo echo;
    echo.polar = {radar_random_.uniform(model_.min_range, 0.5 * model_.max_range),
                  radar_random_.uniform(-0.5, 0.5) * model_.fov_azimuth,
                  radar_random_.uniform(-0.5, 0.5) * model_.fov_elevation};
    echo.range_rate = radar_random_.uniform(-model_.max_doppler, model_.max_doppler);
    echo.snr_db = model_.threshold_db + 2.0 * std::abs(radar_random_.normal());
    return echo;
  }

  /// The nearest mirror image in view, or the double bounce, or a false alarm when neither exists.
  Echo ghost(const Echo& source, const View& view) {
    const double snr_db =
        std::max(model_.threshold_db, source.snr_db - 6.0) + std::abs(radar_random_.normal());
    const int id = source.label.reflector;
    const Reflector& reflector = room_.reflectors[static_cast<std::size_t>(id)];
    Echo best;
    best.polar.range = model_.max_range;
    for (int axis = 0; axis < 3; ++axis) {
      for (const double plane : {room_.low_W[axis], room_.high_W[axis]}) {
        Vector3d image_W = reflector.position_W;
        image_W[axis] = 2.0 * plane - image_W[axis];
        if (std::abs(image_W[axis] - reflector.position_W[axis]) < 0.2) continue;  // lies on it
        const Vector3d image_S = view.to_S(image_W);
        if (!visible(image_S) || image_S.norm() >= best.polar.range) continue;
        best = echo_of(image_S, view, {Cause::kMirror, id});
      }
    }
    if (best.label.reflector < 0) {
      best = source;
      best.polar.range *= 2.0;
      best.range_rate *= 2.0;
      best.label.cause = Cause::kDoubleBounce;
      if (best.polar.range >= model_.max_range) return false_alarm();
    }
    best.snr_db = snr_db;
    return best;
  }

  /// (E5)
  RadarDetection measure(const Echo& echo) {
    Polar polar = echo.polar;
    polar.range += model_.sigma_range * radar_random_.normal();
    polar.azimuth += model_.sigma_azimuth / std::cos(echo.polar.azimuth) * radar_random_.normal();
    polar.elevation +=
        model_.sigma_elevation / std::cos(echo.polar.elevation) * radar_random_.normal();
    double doppler = echo.range_rate + model_.sigma_doppler * radar_random_.normal();
    if (model_.quantize) {
      polar.range = model_.range_resolution * std::round(polar.range / model_.range_resolution);
      doppler = model_.doppler_resolution * std::round(doppler / model_.doppler_resolution);
    }
    if (model_.ambiguous) doppler = fold(doppler, model_.max_doppler);
    // + 0.0: a negative zero would show in files
    return {.point_S = polar.point(), .range_rate = doppler + 0.0, .snr_db = echo.snr_db};
  }

  RadarModel model_;
  Room room_;
  Random radar_random_;
  Random echoes_random_;
  double cos_half_azimuth_;
  double sin_half_elevation_;
  std::vector<Speckle> speckle_;
  Vector3d last_p_WS_ = Vector3d::Zero();
  bool has_last_ = false;
  double path_ = 0.0;
};

}  // namespace rio::sim
