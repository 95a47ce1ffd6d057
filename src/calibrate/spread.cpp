// SPDX-License-Identifier: BSD-3-Clause
#include "calibrate/spread.hpp"

#include <cmath>

namespace rio::calibrate {

Combined combine(const std::vector<Measured>& measured) {
  double weights = 0.0;
  Combined out;
  for (const Measured& m : measured) {
    const double weight = 1.0 / (m.sigma * m.sigma);
    weights += weight;
    out.value += weight * m.value;
  }
  out.value /= weights;
  out.sigma = 1.0 / std::sqrt(weights);
  for (const Measured& m : measured) {
    const double off = (m.value - out.value) / m.sigma;
    out.chi2 += off * off;
  }
  out.dof = static_cast<int>(measured.size()) - 1;
  return out;
}

double apart(const Measured& a, const Measured& b) {
  return std::abs(a.value - b.value) / std::hypot(a.sigma, b.sigma);
}

}  // namespace rio::calibrate
