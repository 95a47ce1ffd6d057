// SPDX-License-Identifier: BSD-3-Clause
// Stage 2: a radar detection with its polar noise.
//
// m = r u, u = (cos el cos az, cos el sin az, sin el); e_az, e_el the unit tangents at u.
// (E1) Sigma_u = sigma_az^2 cos^2(el) e_az e_az^T + sigma_el^2 e_el e_el^T
// (E2) Sigma_m = sigma_r^2 u u^T + r^2 Sigma_u      (Xu et al., eq. 5-8, in an aligned basis)
// The angle sigmas grow off boresight as 1/cos: an array measures the direction cosine.
// (E3) weak echoes: sigma_az^2 and sigma_el^2 times 1 + 10^(-(SNR - SNR_weak) / 10), at most 2: the
//      phase noise of a receiver falls with the SNR (Cramer-Rao bound), other errors do not
// (E4) Sigma_u = sigma_az^2 e_az e_az^T + sigma_el^2 e_el e_el^T with RadarOptions::angle_growth
//      off: the same in all directions (Xu et al., eq. 4)
// A sigma supplied with the detection is used instead, but not below the least value an option may
// have: no radar is that accurate, and products of smaller ones underflow.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "rio/core/static_vector.hpp"
#include "rio/options.hpp"
#include "rio/state/estimate.hpp"
#include "rio/types.hpp"

namespace rio {

/// A filtered detection in the radar frame.
struct Detection {
  Vector3d point_S = Vector3d::Zero();            ///< [m]
  Vector3d direction_S = Vector3d::UnitX();       ///< unit vector to the point
  double range = 0.0;                             ///< [m]
  double range_rate = 0.0;                        ///< positive = receding [m/s]
  double snr_db = 0.0;                            ///< [dB]
  double sigma_range = 0.0;                       ///< [m]
  double sigma_doppler = 0.0;                     ///< quantisation included [m/s]
  Vector3d sigma_azimuth_S = Vector3d::Zero();    ///< one-sigma change of direction_S by azimuth
  Vector3d sigma_elevation_S = Vector3d::Zero();  ///< one-sigma change of direction_S by elevation
};

/// (E1): covariance of the measured direction.
Matrix3d direction_covariance(const Detection& d);
/// (E2): covariance of the measured point [m^2].
Matrix3d point_covariance(const Detection& d);

/// The filtered scan.
struct DetectionList {
  DetectionList() = default;
  /// Reserves `capacity` items: copies of scans up to that size do not allocate.
  explicit DetectionList(int capacity) { items.reserve(static_cast<std::size_t>(capacity)); }

  Time time{0};
  std::size_t radar = 0;
  int received = 0;    ///< detections before the filter
  int non_finite = 0;  ///< of those, dropped by is_valid
  std::vector<Detection> items;
};

/// Hash of positions, range rates and SNRs that two scans of a moving radar do not share, so that a
/// repeated scan is recognised; 0 if all range rates are 0.
std::uint64_t fingerprint(const DetectionList& scan);

/// (E3): factor of the angle sigmas of an echo.
inline double weak_echo_growth(double snr_db, double weak_snr_db) {
  return std::sqrt(1.0 + std::min(1.0, std::pow(10.0, -0.1 * (snr_db - weak_snr_db))));
}

/// A sigma including the quantisation error of a grid.
inline double with_grid(double sigma, double grid) {
  return std::sqrt(sigma * sigma + grid * grid / 12.0);
}
/// The detection's `own` sigma, at least `least`, if it was supplied (> 0); else `otherwise`.
inline double own_or(double own, double otherwise, double least) {
  return own > 0.0 ? std::max(own, least) : otherwise;
}

/// A detection with direction, range and noise filled in from its point.
Detection make_detection(const RadarDetection& raw, const RadarOptions& o);

/// The point is finite; range rate, SNR and sigmas do not exceed 1000 (SI units, dB), which no
/// radar reports; no sigma is negative.
bool is_valid(const RadarDetection& d);

/// The detection filter: finite, in range, strong enough, in the field of view, each once (the same
/// point and range rate again is no further measurement). If more than `max_detections` remain, the
/// strongest are kept, in their original order. If the scan has more than four times as many, only
/// the strongest detection of each reflector is kept first: detections within the noise of each
/// other share its error and would be counted several times.
void filter_detections(const RadarScan& scan, const RadarOptions& radar, int max_detections,
                       DetectionList& out);

}  // namespace rio
