// SPDX-License-Identifier: BSD-3-Clause
#include "rio/sim/radar.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>

namespace rio::sim {

RadarSimulator::RadarSimulator(RadarModel model, Room room, std::uint64_t seed)
    : model_(std::move(model)),
      room_(std::move(room)),
      radar_random_(seed, 4),
      fading_(seed, model_.fading_distance, model_.noise_distance),
      cos_half_azimuth_(std::cos(0.5 * model_.fov_azimuth)),
      sin_half_elevation_(std::sin(0.5 * model_.fov_elevation)),
      highlights_(seed),
      reflector_speckles_(fading_.make(room_.reflectors.size())),
      highlight_speckles_(fading_.make(model_.specular ? kHighlights : 0)),
      own_random_(seed, 15),
      scene_random_(seed, 17) {
  constexpr double kBumper = 1.5;  // parts of the vehicle are within [m]
  for (int i = 0; i < model_.own_echoes; ++i) {
    own_.push_back({own_random_.uniform(model_.min_range, kBumper),
                    own_random_.uniform(-0.5, 0.5) * model_.fov_azimuth,
                    own_random_.uniform(-0.5, 0.5) * model_.fov_elevation});
  }
  Random facing(seed, 16);
  for (std::size_t i = 0; model_.lobe_width > 0.0 && i < room_.reflectors.size(); ++i) {
    facing_W_.push_back(facing.normal3().normalized());
  }
  for (int i = 0; i < model_.people; ++i) {
    people_.emplace_back(seed, i, room_.low_W, room_.high_W);
    people_speckles_.push_back(fading_.make(Person::kCentres));
  }
  age_scene(std::numeric_limits<double>::infinity());
}

LabeledScan RadarSimulator::scan(const Trajectory::Point& body, double outlier_share) {
  const Matrix3d R_WB = body.nav.q_WB.toRotationMatrix();
  const Matrix3d R_WS = R_WB * model_.T_BS.rotation.toRotationMatrix();
  const Vector3d p_WS = body.nav.p_WB + R_WB * model_.T_BS.translation;
  const Vector3d lever_W = R_WB * body.gyro_B.cross(model_.T_BS.translation);
  const View view{R_WS.transpose(), p_WS, R_WS.transpose() * (body.nav.v_WB + lever_W)};  // (E2)

  const double way = first_scan_ ? (p_WS - last_p_WS_).norm() : 0.0;
  path_ += way;
  age_scene(way);
  last_p_WS_ = p_WS;
  if (!first_scan_) first_scan_ = body.nav.time;

  std::vector<Echo> echoes;
  add_reflectors(view, echoes);
  if (model_.specular) add_highlights(view, echoes);
  add_people(view, to_seconds(body.nav.time - *first_scan_), echoes);
  echoes = peaks(std::move(echoes));
  add_own(echoes);
  add_outliers(view, outlier_share, echoes);

  LabeledScan result;
  result.scan.time = body.nav.time;
  std::set<Cell> taken;
  for (const Echo& echo : echoes) {
    const RadarDetection detection = measure(echo);
    // on a grid, if the noise moved two peaks into one cell the stronger hides the other
    const Cell bins = cell(detection.point_S.norm(), detection.range_rate);
    if (model_.quantize && !taken.insert(bins).second) continue;
    result.scan.detections.push_back(detection);
    result.labels.push_back(echo.label);
  }
  return result;
}

bool RadarSimulator::visible(const Vector3d& point_S) const {
  const double range = point_S.norm();
  return range > model_.min_range && range < model_.max_range &&
         point_S.x() > cos_half_azimuth_ * point_S.head<2>().norm() &&
         std::abs(point_S.z()) < sin_half_elevation_ * range;
}

RadarSimulator::Echo RadarSimulator::echo_of(const Vector3d& point_S, const Vector3d& velocity_S,
                                             Label label) {
  Echo echo;
  echo.polar = Polar::of(point_S);
  echo.range_rate = point_S.normalized().dot(velocity_S);
  echo.label = label;
  return echo;
}

void RadarSimulator::receive(Echo echo, double rcs_dbsm, const Speckle& speckle,
                             std::vector<Echo>& echoes) {
  const double azimuth = echo.polar.azimuth / (0.5 * model_.fov_azimuth);
  const double elevation = echo.polar.elevation / (0.5 * model_.fov_elevation);
  echo.snr_db = model_.snr_1m_db + rcs_dbsm - 40.0 * std::log10(echo.polar.range) -
                model_.edge_loss_db * (azimuth * azimuth + elevation * elevation) +
                model_.fading_sigma_db * speckle.fading +
                model_.flicker_sigma_db * fading_.flicker();  // (E4)
  echo.lasting = speckle.noise;
  if (echo.snr_db > model_.threshold_db) echoes.push_back(echo);
}

double RadarSimulator::aspect_loss(const View& view, std::size_t reflector) const {
  if (model_.lobe_width <= 0.0) return 0.0;
  const Vector3d to_radar_W = (view.p_WS - room_.reflectors[reflector].position_W).normalized();
  const double aspect = std::acos(std::clamp(to_radar_W.dot(facing_W_[reflector]), -1.0, 1.0));
  return 3.0 * std::pow(aspect / model_.lobe_width, 2);
}

void RadarSimulator::add_reflectors(const View& view, std::vector<Echo>& echoes) {
  for (std::size_t i = 0; i < room_.reflectors.size(); ++i) {
    const Reflector& reflector = room_.reflectors[i];
    if (!visible(view.to_S(reflector.position_W))) continue;
    const Speckle& speckle = fading_.advance(path_, reflector_speckles_[i]);
    const Vector3d centre_S =
        view.to_S(reflector.position_W + model_.wander_sigma * speckle.wander);
    receive(echo_of(centre_S, -view.v_S, {Cause::kStatic, static_cast<int>(i)}),
            reflector.rcs_dbsm - aspect_loss(view, i), speckle, echoes);
  }
}

void RadarSimulator::add_highlights(const View& view, std::vector<Echo>& echoes) {
  for (int i = 0; i < kHighlights; ++i) {
    const std::optional<Vector3d> foot_W = perpendicular_foot(room_, i, view.p_WS);
    if (!foot_W || !visible(view.to_S(*foot_W))) continue;
    const Speckle& speckle =
        fading_.advance(path_, highlight_speckles_[static_cast<std::size_t>(i)]);
    const Echo echo = echo_of(view.to_S(*foot_W), -view.v_S, {Cause::kSpecular, i});
    receive(echo, highlights_.rcs_dbsm(i, echo.polar.range), speckle, echoes);
  }
}

void RadarSimulator::add_people(const View& view, double seconds, std::vector<Echo>& echoes) {
  for (std::size_t k = 0; k < people_.size(); ++k) {
    const std::vector<MovingPoint> centres = people_[k].at(seconds);
    const double path = path_ + people_[k].walked(seconds);
    for (std::size_t i = 0; i < centres.size(); ++i) {
      const Vector3d point_S = view.to_S(centres[i].position_W);
      if (!visible(point_S)) continue;
      const Vector3d velocity_S = view.R_SW * centres[i].velocity_W - view.v_S;
      receive(echo_of(point_S, velocity_S, {Cause::kPerson, static_cast<int>(k)}),
              model_.person_rcs_dbsm + people_[k].rcs_db(i),
              fading_.advance(path, people_speckles_[k][i]), echoes);
    }
  }
}

void RadarSimulator::add_own(std::vector<Echo>& echoes) {
  for (std::size_t i = 0; i < own_.size(); ++i) {
    if (own_random_.uniform() >= model_.own_echo_share) continue;
    Echo echo;
    echo.polar = own_[i];
    echo.snr_db = model_.threshold_db + 4.0 * std::abs(own_random_.normal());
    echo.label = {Cause::kVehicle, static_cast<int>(i)};
    echoes.push_back(echo);
  }
}

std::vector<RadarSimulator::Echo> RadarSimulator::peaks(std::vector<Echo> echoes) const {
  std::stable_sort(echoes.begin(), echoes.end(),
                   [](const Echo& a, const Echo& b) { return a.snr_db > b.snr_db; });
  std::set<Cell> taken;
  std::vector<Echo> kept;
  int statics = 0;
  for (const Echo& echo : echoes) {
    const bool is_static = echo.label.cause != Cause::kPerson;
    if (is_static && statics >= model_.max_static) continue;
    if (!taken.insert(cell(echo.polar.range, echo.range_rate)).second) continue;
    kept.push_back(echo);
    statics += is_static ? 1 : 0;
  }
  return kept;
}

RadarSimulator::Cell RadarSimulator::cell(double range, double range_rate) const {
  if (model_.ambiguous) range_rate = fold(range_rate, model_.max_doppler);
  return {std::lround(range / model_.range_resolution),
          std::lround(range_rate / model_.doppler_resolution)};
}

void RadarSimulator::add_outliers(const View& view, double share, std::vector<Echo>& echoes) {
  if (share <= 0.0) return;
  std::vector<Echo> sources;
  std::copy_if(echoes.begin(), echoes.end(), std::back_inserter(sources),
               [](const Echo& echo) { return echo.label.cause == Cause::kStatic; });
  std::stable_sort(sources.begin(), sources.end(), [&](const Echo& a, const Echo& b) {
    return reflector(a).ghost_rank > reflector(b).ghost_rank;
  });
  const double expected = static_cast<double>(echoes.size()) * share / (1.0 - share);
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

RadarSimulator::Echo RadarSimulator::false_alarm() {
  Echo echo;
  echo.polar = {radar_random_.uniform(model_.min_range, 0.5 * model_.max_range),
                radar_random_.uniform(-0.5, 0.5) * model_.fov_azimuth,
                radar_random_.uniform(-0.5, 0.5) * model_.fov_elevation};
  echo.range_rate = radar_random_.uniform(-model_.max_doppler, model_.max_doppler);
  echo.snr_db = model_.threshold_db + 2.0 * std::abs(radar_random_.normal());
  return echo;
}

RadarSimulator::Echo RadarSimulator::ghost(const Echo& source, const View& view) {
  const double snr_db =
      std::max(model_.threshold_db, source.snr_db - 6.0) + std::abs(radar_random_.normal());
  const int id = source.label.reflector;
  const Vector3d& source_W = reflector(source).position_W;
  Echo best;
  best.polar.range = model_.max_range;
  for (const Vector3d& image_W : mirror_images(room_, source_W)) {
    if ((image_W - source_W).norm() < 0.2) continue;  // lies on the mirror plane
    const Vector3d image_S = view.to_S(image_W);
    if (!visible(image_S) || image_S.norm() >= best.polar.range) continue;
    best = echo_of(image_S, -view.v_S, {Cause::kMirror, id});
  }
  if (best.label.reflector < 0) {
    best = source;
    best.polar.range *= 2.0;
    best.range_rate *= 2.0;
    best.label.cause = Cause::kDoubleBounce;
    if (best.polar.range >= model_.max_range) return false_alarm();
  }
  best.snr_db = snr_db;
  best.lasting = source.lasting;
  return best;
}

void RadarSimulator::age_scene(double way) {
  const double keep = std::exp(-way / model_.scene_distance);
  const Eigen::Vector2d n(scene_random_.normal(), scene_random_.normal());
  scene_error_ = keep * scene_error_ + std::sqrt(1.0 - keep * keep) * model_.scene_angle * n;
}

RadarDetection RadarSimulator::measure(const Echo& echo) {
  const double fresh = model_.fresh_noise;
  const double keep = std::sqrt(1.0 - fresh * fresh);
  Speckle::Noise n;  // (E7)
  for (int i = 0; i < 4; ++i) n[i] = keep * echo.lasting[i] + fresh * radar_random_.normal();
  const double weakness = std::pow(10.0, -0.1 * (echo.snr_db - model_.threshold_db));
  const double growth = std::sqrt(1.0 + model_.weak_angle_growth * weakness);  // (E6)
  Polar polar = echo.polar;
  polar.range += model_.sigma_range * n[0];
  polar.azimuth += growth * model_.sigma_azimuth / std::cos(echo.polar.azimuth) * n[1];
  polar.elevation += growth * model_.sigma_elevation / std::cos(echo.polar.elevation) * n[2];
  polar.azimuth += scene_error_.x();
  polar.elevation += model_.elevation_bias + scene_error_.y();
  double doppler = echo.range_rate + model_.sigma_doppler * n[3];
  const double in_cells = echo.range_rate / model_.doppler_resolution;
  const double off_centre = in_cells - std::round(in_cells);  // half a cell at most
  if (model_.doppler_slip_share > 0.0 &&
      radar_random_.uniform() < 2.0 * std::abs(off_centre) * model_.doppler_slip_share) {
    const double wrong = std::round(in_cells) + std::copysign(1.0, off_centre);
    doppler = wrong * model_.doppler_resolution;
  }
  if (model_.quantize) {
    polar.range = model_.range_resolution * std::round(polar.range / model_.range_resolution);
    doppler = model_.doppler_resolution * std::round(doppler / model_.doppler_resolution);
  }
  if (model_.ambiguous) doppler = fold(doppler, model_.max_doppler);
  const Vector3d point_S = snap_direction(polar.point(), model_.angle_grid);
  // + 0.0: avoids a negative zero in files
  doppler *= 1.0 + model_.doppler_scale;  // the step of the grid is scaled as well
  return {.point_S = point_S, .range_rate = doppler + 0.0, .snr_db = echo.snr_db};
}

}  // namespace rio::sim
