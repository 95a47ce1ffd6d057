// SPDX-License-Identifier: BSD-3-Clause
#include "rio/frontend/own_echoes.hpp"

#include <algorithm>
#include <cmath>

#include "rio/core/small_cholesky.hpp"

namespace rio {

OwnEchoes::Rate OwnEchoes::predicted(const Detection& d, const Vector3d& v_S,
                                     const Matrix3d& covariance_S) {
  return {-d.direction_S.dot(v_S), d.sigma_doppler * d.sigma_doppler +
                                       v_S.dot(direction_covariance(d) * v_S) +
                                       d.direction_S.dot(covariance_S * d.direction_S)};
}

bool OwnEchoes::moves(const DetectionList& scan, const Vector3d& v_S,
                      const Matrix3d& covariance_S) const {
  int as_predicted = 0;
  int otherwise = 0;
  for (const Detection& d : scan.items) {
    if (may_be_zero(d)) continue;
    const Rate rate = predicted(d, v_S, covariance_S);
    ++(std::abs(apart(d, rate)) < kSigmas * std::sqrt(rate.S) ? as_predicted : otherwise);
  }
  return as_predicted >= kWitnesses && as_predicted > 2 * otherwise;
}

OwnEchoes::Place* OwnEchoes::find(const Detection& d) {
  if (places_.empty()) return nullptr;
  // two detections differ by the noise of both
  const SmallCholesky<3> twice(2.0 * point_covariance(d));
  for (Place& place : places_) {
    const Vector3d apart = d.point_S - place.point_S;
    if (twice.whitened(apart).squaredNorm() < kNear) return &place;
  }
  return nullptr;
}

OwnEchoes::Place* OwnEchoes::add(const Detection& d) {
  if (!places_.push_back({})) {
    const auto oldest =
        std::min_element(places_.begin(), places_.end(),
                         [](const Place& a, const Place& b) { return a.seen < b.seen; });
    std::swap(*oldest, places_.back());
  }
  places_.back() = Place{d.point_S, 0.0, Time{0}};
  return &places_.back();
}

void OwnEchoes::observe(const DetectionList& scan, const Vector3d& v_S,
                        const Matrix3d& covariance_S, OwnEchoList* own, double doppler_scale) {
  own->clear();
  fold_ = reported_.divided(doppler_scale);
  for (std::size_t i = places_.size(); i-- > 0;) {
    if (scan.time - places_[i].seen > kForget) {
      places_[i] = places_.back();
      places_.pop_back();
    }
  }
  const bool moving = moves(scan, v_S, covariance_S);
  for (std::size_t i = 0; i < scan.items.size(); ++i) {
    const Detection& d = scan.items[i];
    if (d.range > kReach || !may_be_zero(d)) continue;
    Place* place = find(d);
    const Rate rate = predicted(d, v_S, covariance_S);
    if (moving && rate.h * rate.h > rate.S) {
      if (place == nullptr) place = add(d);
      const double variance = d.sigma_doppler * d.sigma_doppler;
      const double off = apart(d, rate);
      const double ratio = 0.5 * (off * off / rate.S - d.range_rate * d.range_rate / variance +
                                  std::log(rate.S / variance));
      place->evidence = std::clamp(place->evidence + std::min(ratio, kMaxOfSighting),
                                   -kEvidenceOfEcho, kMaxEvidence);
    }
    if (place == nullptr) continue;
    place->seen = scan.time;
    if (place->evidence >= kEvidenceOfEcho) own->push_back(i);
  }
}

}  // namespace rio
