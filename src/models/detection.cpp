// SPDX-License-Identifier: BSD-3-Clause
#include "rio/models/detection.hpp"

#include <cstring>
#include <iterator>

namespace rio {

Matrix3d direction_covariance(const Detection& d) {
  return d.sigma_azimuth_S * d.sigma_azimuth_S.transpose() +
         d.sigma_elevation_S * d.sigma_elevation_S.transpose();
}

Matrix3d point_covariance(const Detection& d) {
  const Vector3d along = d.sigma_range * d.direction_S;
  return along * along.transpose() + d.range * d.range * direction_covariance(d);
}

Detection make_detection(const RadarDetection& raw, const RadarOptions& o) {
  Detection d;
  d.point_S = raw.point_S;
  d.range = raw.point_S.norm();
  d.direction_S = raw.point_S / d.range;
  d.range_rate = raw.range_rate;
  d.snr_db = raw.snr_db;
  constexpr double kLeast = 1e-4;       // [m, m/s]
  constexpr double kLeastAngle = 1e-5;  // [rad]
  d.sigma_range = own_or(raw.sigma_range, with_grid(o.sigma_range, o.range_resolution), kLeast);
  d.sigma_doppler =
      own_or(raw.sigma_doppler, with_grid(o.sigma_doppler, o.doppler_resolution), kLeast);
  const Vector3d& u = d.direction_S;
  const double horizontal = std::hypot(u.x(), u.y());  // cos(el)
  const double cos_az = horizontal > 1e-9 ? u.x() / horizontal : 1.0;
  const double sin_az = horizontal > 1e-9 ? u.y() / horizontal : 0.0;
  // beyond 75 deg, where no array measures, the growth is limited and the azimuth keeps its noise
  constexpr double kMinCosine = 0.25;
  const double growth = weak_echo_growth(raw.snr_db, o.weak_snr_db);
  // (E4) with the tangents below, a constant sigma is that of the direction
  const double level = std::max(horizontal, kMinCosine);
  const double off_azimuth = o.angle_growth ? std::max(cos_az, kMinCosine) : level;
  const double off_elevation = o.angle_growth ? level : 1.0;
  const double sigma_az =
      own_or(raw.sigma_azimuth, growth * o.sigma_azimuth / off_azimuth, kLeastAngle);
  const double sigma_el =
      own_or(raw.sigma_elevation, growth * o.sigma_elevation / off_elevation, kLeastAngle);
  d.sigma_azimuth_S = sigma_az * level * Vector3d(-sin_az, cos_az, 0.0);
  d.sigma_elevation_S = sigma_el * Vector3d(-u.z() * cos_az, -u.z() * sin_az, horizontal);
  return d;
}

std::uint64_t fingerprint(const DetectionList& scan) {
  std::uint64_t hash = 14695981039346656037U;  // FNV-1a, by words
  bool moves = false;
  for (const Detection& d : scan.items) {
    moves = moves || d.range_rate != 0.0;
    for (const double value :
         {d.point_S.x(), d.point_S.y(), d.point_S.z(), d.range_rate, d.snr_db}) {
      std::uint64_t bits = 0;
      std::memcpy(&bits, &value, sizeof bits);
      hash = (hash ^ bits) * 1099511628211U;
      hash ^= hash >> 32U;
    }
  }
  return moves ? std::max<std::uint64_t>(hash, 1) : 0;
}

bool is_valid(const RadarDetection& d) {
  constexpr double kMost = 1e3;  // no radar reports more [m/s, dB, m, rad]
  const double sigmas[] = {d.sigma_range, d.sigma_azimuth, d.sigma_elevation, d.sigma_doppler};
  return d.point_S.allFinite() && std::abs(d.range_rate) <= kMost && std::abs(d.snr_db) <= kMost &&
         std::all_of(std::begin(sigmas), std::end(sigmas),
                     [](double sigma) { return sigma >= 0.0 && sigma <= kMost; });
}

namespace {

/// Chi-squared test that two detections, Doppler included, are of one reflector.
bool of_one_reflector(const Detection& a, const Detection& b) {
  constexpr double kGate = 13.28;  // chi-squared of four degrees of freedom, 99 %
  const auto square = [](double x) { return x * x; };
  const double range = square(a.range - b.range) / square(a.sigma_range);
  if (range > 2.0 * kGate) return false;
  const double doppler = square(a.range_rate - b.range_rate) / square(a.sigma_doppler);
  const Vector3d turn = b.direction_S - a.direction_S;
  const double azimuth = square(turn.dot(a.sigma_azimuth_S) / a.sigma_azimuth_S.squaredNorm());
  const double elevation =
      square(turn.dot(a.sigma_elevation_S) / a.sigma_elevation_S.squaredNorm());
  return range + doppler + azimuth + elevation < 2.0 * kGate;  // both are noisy
}

/// Keeps the strongest detection of each reflector.
void keep_one_a_reflector(DetectionList* scan) {
  for (std::size_t i = scan->items.size(); i-- > 0;) {
    for (std::size_t k = 0; k < scan->items.size(); ++k) {
      const Detection& other = scan->items[k];
      const bool weaker =
          other.snr_db > scan->items[i].snr_db || (other.snr_db == scan->items[i].snr_db && k < i);
      if (!weaker || !of_one_reflector(other, scan->items[i])) continue;
      scan->items.erase(scan->items.begin() + static_cast<std::ptrdiff_t>(i));
      break;
    }
  }
}

}  // namespace

void filter_detections(const RadarScan& scan, const RadarOptions& radar, int max_detections,
                       DetectionList& out) {
  out.time = scan.time;
  out.received = static_cast<int>(scan.detections.size());
  out.non_finite = 0;
  out.items.clear();
  const auto most = static_cast<std::size_t>(max_detections);
  // a scan of so many times the limit has several detections of one reflector
  constexpr std::size_t kCrowd = 4;
  const bool may_crowd = scan.detections.size() > kCrowd * most;
  bool crowded = false;
  for (const RadarDetection& raw : scan.detections) {
    if (!is_valid(raw)) {
      ++out.non_finite;
      continue;
    }
    // before the norm: the square of a coordinate may overflow
    if (raw.point_S.cwiseAbs().maxCoeff() > radar.max_range) continue;
    const double range = raw.point_S.norm();
    if (range < radar.min_range || range > radar.max_range) continue;
    if (raw.snr_db < radar.min_snr_db) continue;
    const double azimuth = std::atan2(raw.point_S.y(), raw.point_S.x());
    const double elevation = std::asin(std::clamp(raw.point_S.z() / range, -1.0, 1.0));
    if (std::abs(azimuth) > 0.5 * radar.fov_azimuth) continue;
    if (std::abs(elevation) > 0.5 * radar.fov_elevation) continue;
    // drivers pad their messages with the last detection
    if (std::any_of(out.items.begin(), out.items.end(), [&raw](const Detection& kept) {
          return kept.point_S == raw.point_S && kept.range_rate == raw.range_rate;
        })) {
      continue;
    }
    const Detection d = make_detection(raw, radar);
    if (may_crowd && !crowded && out.items.size() == most) {
      crowded = true;
      keep_one_a_reflector(&out);
    }
    if (crowded) {
      const auto same =
          std::find_if(out.items.begin(), out.items.end(),
                       [&d](const Detection& kept) { return of_one_reflector(kept, d); });
      if (same != out.items.end() && same->snr_db >= d.snr_db) continue;
      if (same != out.items.end()) out.items.erase(same);
    }
    if (out.items.size() == most) {
      const auto weakest = std::min_element(
          out.items.begin(), out.items.end(),
          [](const Detection& x, const Detection& y) { return x.snr_db < y.snr_db; });
      if (weakest->snr_db >= d.snr_db) continue;
      out.items.erase(weakest);
    }
    out.items.push_back(d);
  }
}

}  // namespace rio
