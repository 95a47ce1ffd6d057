// SPDX-License-Identifier: BSD-3-Clause
#include "rio/checks/correction_check.hpp"

#include <algorithm>
#include <cmath>

namespace rio {

void CorrectionCheck::predicted(const NavState& x, double value, double variance) {
  value_ = value;
  variance_ = variance;
  if (parts_.empty() || x.time - parts_.back().begin >= window_.part) {
    parts_.push_back({x.time, x.p_WB, value});
  }
}

double CorrectionCheck::scatter(double slope) const {
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const Part& part = parts_[i];
    if (part.S <= 0.0) continue;
    const double off = part.d - slope * part.S;
    sum += off * off / part.S;
    ++count;
  }
  return count > 1 ? sum / (count - 1) : 0.0;
}

std::optional<LastingError> CorrectionCheck::corrected(const NavState& x, double value,
                                                       double variance) {
  Part& newest = parts_[parts_.size() - 1];
  newest.d += value - value_;
  newest.S += variance_ - variance;
  double d = 0.0;
  double S = 0.0;
  double change = 0.0;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    d += parts_[i].d;
    S += parts_[i].S;
    change = std::max(change, std::abs(parts_[i].value - parts_.front().value));
  }
  const double scale = kScale * change;
  if (S <= 0.0 || parts_.size() < window_.enough) return record_.agree(x.time);
  const double allowed = S * std::max(1.0, scatter(d / S)) + scale * scale;  // (E3) (E4)
  if (d * d <= kSigmas * kSigmas * allowed) return record_.agree(x.time);    // (E2)
  if (!record_.lasts(x.time, window_.patience)) return {};
  const double per_change = variance / S;  // (E5)
  if (per_change * std::sqrt(S) > window_.weak) return {};
  return LastingError{d * per_change, to_seconds(x.time - parts_.front().begin),
                      x.p_WB - parts_.front().p_WB};
}

}  // namespace rio
