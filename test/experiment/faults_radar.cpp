// SPDX-License-Identifier: BSD-3-Clause
// Faults of the radar data.
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "experiment/fault.hpp"

namespace rio::experiment {

namespace {

using ChangeScan = std::function<void(RadarScan&, Moment&)>;
using ChangePoint = std::function<void(RadarDetection&, Moment&)>;

Fault scans(const std::string& name, double duration, Promised promised, const ChangeScan& change) {
  return {name, Of::kScans, duration, promised,
          [change](Event& e, Moment& m) { change(e.scan, m); }};
}

/// A share of the points.
Fault points(const std::string& name, double duration, Promised promised, double share,
             const ChangePoint& change) {
  return scans(name, duration, promised, [share, change](RadarScan& scan, Moment& m) {
    for (RadarDetection& d : scan.detections) {
      if (m.random.uniform() < share) change(d, m);
    }
  });
}

/// One field of all detections, in turn NaN, infinite and absurd.
Fault bad_field(const char* name, double RadarDetection::*field) {
  return points(fmt::format("{} NaN, infinite, 1e200 for 1 s", name), 1.0, Promise::kBridged, 1.0,
                [field](RadarDetection& d, Moment& m) {
                  constexpr std::array<double, 4> kBad = {NAN, INFINITY, 1e200, -INFINITY};
                  d.*field = kBad[static_cast<std::size_t>(m.n) % kBad.size()];
                });
}

/// A point somewhere in view with random motion.
RadarDetection anything(const sim::RadarModel& radar, sim::Random& random) {
  const double range = random.uniform(0.5, 0.8 * radar.max_range);
  const double azimuth = random.uniform(-0.5, 0.5) * radar.fov_azimuth;
  const double elevation = random.uniform(-0.5, 0.5) * radar.fov_elevation;
  return {range * Vector3d(std::cos(elevation) * std::cos(azimuth),
                           std::cos(elevation) * std::sin(azimuth), std::sin(elevation)),
          random.uniform(-radar.max_doppler, radar.max_doppler),
          radar.threshold_db + random.uniform(0.0, 20.0)};
}

void replace(RadarDetection& d, Moment& m) {
  d = anything(m.flight.scenario.radar, m.random);
}

void add_velocity(const Vector3d& velocity_S, RadarDetection& d, Moment& m) {
  const double ambiguity = 2.0 * m.flight.scenario.radar.max_doppler;
  d.range_rate = std::remainder(d.range_rate + velocity_S.dot(d.point_S.normalized()), ambiguity);
}

/// A common velocity, like a lorry that fills the view.
void move_together(RadarDetection& d, Moment& m) {
  add_velocity({0.6, 0.5, 0.0}, d, m);
}

/// The velocity of one of four bodies; a body is a sector of the view.
void move_in_four(RadarDetection& d, Moment& m) {
  const double azimuth = std::atan2(d.point_S.y(), d.point_S.x());
  const double body = std::floor(4.0 * (azimuth / m.flight.scenario.radar.fov_azimuth + 0.5));
  const double heading = 1.0 + 2.0 * body + 0.2 * m.t;
  add_velocity({std::cos(heading), std::sin(heading), 0.0}, d, m);
}

/// "80 % random outliers for 3 s".
Fault outliers(const char* what, double share, double duration, Promised promised,
               const ChangePoint& change) {
  return points(fmt::format("{:.0f} % {} for {} s", 100.0 * share, what, duration), duration,
                promised, share, change);
}

Fault many_detections(const char* name, Promised promised, double stronger_db, bool same_room) {
  return scans(name, 10.0, promised, [stronger_db, same_room](RadarScan& scan, Moment& m) {
    constexpr std::size_t kMany = 5000;
    const sim::RadarModel& radar = m.flight.scenario.radar;
    const std::size_t real = scan.detections.size();
    if (real == 0) return;
    while (scan.detections.size() < kMany) {
      RadarDetection d =
          same_room ? scan.detections[scan.detections.size() % real] : anything(radar, m.random);
      if (same_room) {  // an echo that spreads over its neighbours
        d.point_S += 0.02 * d.point_S.norm() * m.random.normal3();
        d.range_rate += radar.sigma_doppler * m.random.normal();
      }
      d.snr_db += stronger_db;
      scan.detections.push_back(d);
    }
  });
}

}  // namespace

std::vector<Fault> radar_faults() {
  constexpr Promise kBridged = Promise::kBridged;
  constexpr Promise kHonest = Promise::kHonest;
  const Promised soon = recovered(5.0);
  const Promised later = recovered(10.0);
  std::vector<Fault> all = {
      points("points NaN for 1 s", 1.0, kBridged, 1.0,
             [](auto& d, auto& m) { d.point_S[m.n % 3] = NAN; }),
      points("points of 1e200 m for 1 s", 1.0, kBridged, 1.0,
             [](auto& d, auto&) { d.point_S *= 1e200; }),
      points("points at 0 for 1 s", 1.0, kBridged, 1.0,
             [](auto& d, auto&) { d.point_S.setZero(); }),
      bad_field("range rate", &RadarDetection::range_rate),
      bad_field("SNR", &RadarDetection::snr_db),
      bad_field("noise floor", &RadarDetection::noise_db),
      bad_field("sigma of the range", &RadarDetection::sigma_range),
      bad_field("sigma of the azimuth", &RadarDetection::sigma_azimuth),
      bad_field("sigma of the elevation", &RadarDetection::sigma_elevation),
      bad_field("sigma of the Doppler", &RadarDetection::sigma_doppler),
      points("range rates 1.5 times too large for 10 s", 10.0, Promise::kReported, 1.0,
             [](auto& d, auto&) { d.range_rate *= 1.5; }),
      points("range rates negated for 10 s", 10.0, Promise::kReported, 1.0,
             [](auto& d, auto&) { d.range_rate *= -1.0; }),
      points("range rates 0 for 10 s", 10.0, Promise::kReported, 1.0,
             [](auto& d, auto&) { d.range_rate = 0.0; }),
      scans("one point 40 times for 10 s", 10.0, kBridged,
            [](auto& scan, auto&) {
              if (!scan.detections.empty()) scan.detections.assign(40, scan.detections.front());
            }),
  };
  for (const double s : {1.0, 5.0, 15.0, 30.0}) {
    all.push_back(scans(fmt::format("empty scans for {} s", s), s, s < 10.0 ? kBridged : kHonest,
                        [](RadarScan& scan, Moment&) { scan.detections.clear(); }));
  }
  for (const double s : {1.0, 3.0, 10.0}) {
    all.push_back(scans(fmt::format("the same scan again for {} s", s), s, later,
                        [](auto& scan, auto& m) { scan.detections = m.before.scan.detections; }));
  }
  for (const double s : {1.0, 3.0, 10.0}) {
    all.push_back(outliers("random outliers", 0.8, s, s < 10.0 ? kBridged : soon, replace));
  }
  all.push_back(outliers("random outliers", 1.0, 10.0, soon, replace));
  for (const double s : {1.0, 3.0, 10.0}) {
    all.push_back(outliers("coherent outliers", 0.6, s, soon, move_together));
    all.push_back(outliers("coherent outliers", 1.0, s, later, move_together));
  }
  for (const double share : {0.5, 0.7, 0.9}) {
    all.push_back(outliers("movers", share, 10.0, share > 0.5 ? soon : kBridged, move_in_four));
  }
  all.push_back(many_detections("5000 detections, noise", kBridged, -20.0, false));
  all.push_back(many_detections("5000 detections, strong noise", soon, 20.0, false));
  all.push_back(many_detections("5000 detections of the same room", kBridged, 0.0, true));
  for (const double hz : {1.0, 2.0, 5.0, 30.0, 60.0}) {
    all.push_back({.name = fmt::format("radar at {} Hz", hz),
                   .duration = kForGood,
                   .promised = hz < 5.0 ? kHonest : kBridged,
                   .sensors = [hz](sim::Scenario& s) { s.radar.rate_hz = hz; }});
  }
  return all;
}

}  // namespace rio::experiment
