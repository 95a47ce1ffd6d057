// SPDX-License-Identifier: BSD-3-Clause
#include "rio/checks/heading_check.hpp"

#include <algorithm>
#include <cmath>

namespace rio {

void HeadingCheck::predicted(const Estimate& x, const BodyCovariance& P_body) {
  if (!enabled_) return;
  bias_ = x.nav.gyro_bias;
  variance_ = P_body.block<3, 3>(body::kGyroBias, body::kGyroBias);
  if (parts_.empty() || x.nav.time - parts_.back().begin >= kPart) {
    parts_.push_back({x.nav.time, x.nav.p_WB});
  }
}

double HeadingCheck::scatter(const Vector3d& up_B, double slope) const {
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const double variance = up_B.dot(parts_[i].S * up_B);
    if (variance <= 0.0) continue;
    const double off = up_B.dot(parts_[i].d) - slope * variance;
    sum += off * off / variance;
    ++count;
  }
  return count > 1 ? sum / (count - 1) : 0.0;
}

std::optional<GyroBiasStep> HeadingCheck::corrected(const Estimate& x,
                                                    const BodyCovariance& P_body) {
  if (!enabled_) return {};
  const Matrix3d P = P_body.block<3, 3>(body::kGyroBias, body::kGyroBias);
  Part& newest = parts_[parts_.size() - 1];
  newest.d += x.nav.gyro_bias - bias_;
  newest.S += variance_ - P;
  Vector3d d = Vector3d::Zero();
  Matrix3d S = Matrix3d::Zero();
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    d += parts_[i].d;
    S += parts_[i].S;
  }
  const Vector3d up_B = x.nav.q_WB.conjugate() * Vector3d::UnitZ();
  const double change = up_B.dot(d);
  const double variance = up_B.dot(S * up_B);
  if (variance <= 0.0 || parts_.size() < kEnough) return record_.agree(x.nav.time);
  const double allowed = variance * std::max(1.0, scatter(up_B, change / variance));     // (E3)
  if (change * change <= kSigmas * kSigmas * allowed) return record_.agree(x.nav.time);  // (E2)
  if (!record_.lasts(x.nav.time, kPatience)) return {};
  const double per_change = up_B.dot(P * up_B) / variance;  // (E4)
  if (per_change * std::sqrt(variance) > kWeak) return {};
  return GyroBiasStep{change * per_change, to_seconds(x.nav.time - parts_.front().begin),
                      x.nav.p_WB - parts_.front().p_WB};
}

}  // namespace rio
