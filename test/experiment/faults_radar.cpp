// SPDX-License-Identifier: BSD-3-Clause
// Faults of the radar data.
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "experiment/fault.hpp"

namespace rio::experiment {

namespace {

using ChangeScan = std::function<void(RadarScan&, Moment&)>;

Fault scans(const std::string& name, double duration, Promise promise, double within,
            const ChangeScan& change) {
  return {.name = name,
          .promise = promise,
          .within = within,
          .duration = duration,
          .change = [change](Event& e, Moment& m) {
            if (e.is_scan()) change(e.scan, m);
          }};
}

/// One field of all detections, in turn NaN, infinite and absurd.
Fault bad_field(const char* name, double RadarDetection::*field) {
  return scans(fmt::format("{} NaN, infinite, 1e200 for 1 s", name), 1.0, Promise::kBridged, 0.0,
               [field](RadarScan& scan, Moment& m) {
                 constexpr std::array<double, 4> kBad = {NAN, INFINITY, 1e200, -INFINITY};
                 for (RadarDetection& d : scan.detections) {
                   d.*field = kBad[static_cast<std::size_t>(m.n) % kBad.size()];
                 }
               });
}

/// A point somewhere in view with random motion.
RadarDetection anything(const sim::RadarModel& radar, sim::Random& random) {
  const double range = random.uniform(0.5, 0.8 * radar.max_range);
  const double azimuth = random.uniform(-0.5, 0.5) * radar.fov_azimuth;
  const double elevation = random.uniform(-0.5, 0.5) * radar.fov_elevation;
  RadarDetection d;
  d.point_S = range * Vector3d(std::cos(elevation) * std::cos(azimuth),
                               std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
  d.range_rate = random.uniform(-radar.max_doppler, radar.max_doppler);
  d.snr_db = radar.threshold_db + random.uniform(0.0, 20.0);
  return d;
}

/// Into the unambiguous interval of the radar.
double folded(double range_rate, const sim::RadarModel& radar) {
  return std::remainder(range_rate, 2.0 * radar.max_doppler);
}

Fault random_outliers(double share, double duration, Promise promise, double within) {
  return scans(fmt::format("{:.0f} % random outliers for {} s", 100.0 * share, duration), duration,
               promise, within, [share](RadarScan& scan, Moment& m) {
                 for (RadarDetection& d : scan.detections) {
                   if (m.random.uniform() >= share) continue;
                   d = anything(m.flight.scenario.radar, m.random);
                 }
               });
}

/// A share of the points has an additional common velocity, like a lorry that fills the view.
Fault coherent_outliers(double share, double duration, Promise promise, double within) {
  return scans(fmt::format("{:.0f} % coherent outliers for {} s", 100.0 * share, duration),
               duration, promise, within, [share](RadarScan& scan, Moment& m) {
                 const Vector3d velocity_S(0.6, 0.5, 0.0);
                 for (RadarDetection& d : scan.detections) {
                   if (m.random.uniform() >= share) continue;
                   d.range_rate = folded(d.range_rate + velocity_S.dot(d.point_S.normalized()),
                                         m.flight.scenario.radar);
                 }
               });
}

/// Points that move with one of four bodies; a body is a sector of the view.
Fault movers(double share, double duration, Promise promise, double within) {
  return scans(fmt::format("{:.0f} % movers for {} s", 100.0 * share, duration), duration, promise,
               within, [share](RadarScan& scan, Moment& m) {
                 const sim::RadarModel& radar = m.flight.scenario.radar;
                 for (RadarDetection& d : scan.detections) {
                   if (m.random.uniform() >= share) continue;
                   const double azimuth = std::atan2(d.point_S.y(), d.point_S.x());
                   const double body = std::floor(4.0 * (azimuth / radar.fov_azimuth + 0.5));
                   const double heading = 1.0 + 2.0 * body + 0.2 * m.t;
                   const Vector3d velocity_S(std::cos(heading), std::sin(heading), 0.0);
                   d.range_rate =
                       folded(d.range_rate + velocity_S.dot(d.point_S.normalized()), radar);
                 }
               });
}

Fault many_detections(const char* name, Promise promise, double within, double stronger_db,
                      bool same_room) {
  return scans(name, 10.0, promise, within, [stronger_db, same_room](RadarScan& scan, Moment& m) {
    constexpr std::size_t kMany = 5000;
    const sim::RadarModel& radar = m.flight.scenario.radar;
    const std::size_t real = scan.detections.size();
    if (real == 0) return;
    scan.detections.reserve(kMany);
    while (scan.detections.size() < kMany) {
      RadarDetection d = scan.detections[scan.detections.size() % real];
      if (!same_room) d = anything(radar, m.random);
      if (same_room) {  // an echo that spreads over its neighbours
        d.point_S += 0.02 * d.point_S.norm() * m.random.normal3();
        d.range_rate += radar.sigma_doppler * m.random.normal();
      }
      d.snr_db += stronger_db;
      scan.detections.push_back(d);
    }
  });
}

std::vector<Fault> bad_fields() {
  return {
      scans("points NaN for 1 s", 1.0, Promise::kBridged, 0.0,
            [](RadarScan& scan, Moment& m) {
              for (RadarDetection& d : scan.detections) d.point_S[m.n % 3] = NAN;
            }),
      scans("points of 1e200 m for 1 s", 1.0, Promise::kBridged, 0.0,
            [](RadarScan& scan, Moment&) {
              for (RadarDetection& d : scan.detections) d.point_S *= 1e200;
            }),
      scans("points at 0 for 1 s", 1.0, Promise::kBridged, 0.0,
            [](RadarScan& scan, Moment&) {
              for (RadarDetection& d : scan.detections) d.point_S.setZero();
            }),
      bad_field("range rate", &RadarDetection::range_rate),
      bad_field("SNR", &RadarDetection::snr_db),
      bad_field("noise floor", &RadarDetection::noise_db),
      bad_field("sigma of the range", &RadarDetection::sigma_range),
      bad_field("sigma of the azimuth", &RadarDetection::sigma_azimuth),
      bad_field("sigma of the elevation", &RadarDetection::sigma_elevation),
      bad_field("sigma of the Doppler", &RadarDetection::sigma_doppler),
  };
}

Fault empty_scans(double duration, Promise promise) {
  return scans(fmt::format("empty scans for {} s", duration), duration, promise, 0.0,
               [](RadarScan& scan, Moment&) { scan.detections.clear(); });
}

Fault frozen_scan(double duration, Promise promise, double within) {
  return scans(fmt::format("the same scan again for {} s", duration), duration, promise, within,
               [](RadarScan& scan, Moment& m) { scan.detections = m.before.scan.detections; });
}

}  // namespace

std::vector<Fault> radar_faults() {
  constexpr Promise kRecovered = Promise::kRecovered;
  std::vector<Fault> all = bad_fields();
  for (const double s : {1.0, 5.0}) all.push_back(empty_scans(s, Promise::kBridged));
  for (const double s : {15.0, 30.0}) all.push_back(empty_scans(s, Promise::kHonest));
  for (const double s : {1.0, 3.0, 10.0}) all.push_back(frozen_scan(s, kRecovered, 10.0));
  for (const double s : {1.0, 3.0, 10.0}) {
    all.push_back(random_outliers(0.8, s, s < 10.0 ? Promise::kBridged : kRecovered, 5.0));
  }
  all.push_back(random_outliers(1.0, 10.0, kRecovered, 5.0));
  for (const double s : {1.0, 3.0, 10.0}) {
    all.push_back(coherent_outliers(0.6, s, kRecovered, 5.0));
    all.push_back(coherent_outliers(1.0, s, kRecovered, 10.0));
  }
  all.push_back(movers(0.5, 10.0, Promise::kBridged, 0.0));
  for (const double share : {0.7, 0.9}) all.push_back(movers(share, 10.0, kRecovered, 5.0));
  all.push_back(many_detections("5000 detections, noise", Promise::kBridged, 0.0, -20.0, false));
  all.push_back(many_detections("5000 detections, strong noise", kRecovered, 5.0, 20.0, false));
  all.push_back(
      many_detections("5000 detections of the same room", Promise::kBridged, 0.0, 0.0, true));
  for (const double hz : {1.0, 2.0, 5.0, 30.0, 60.0}) {
    all.push_back({.name = fmt::format("radar at {} Hz", hz),
                   .promise = hz < 5.0 ? Promise::kHonest : Promise::kBridged,
                   .duration = kForGood,
                   .sensors = [hz](sim::Scenario& s) { s.radar.rate_hz = hz; }});
  }
  return all;
}

}  // namespace rio::experiment
