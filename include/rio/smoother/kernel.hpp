// SPDX-License-Identifier: BSD-3-Clause
// Robust kernels: cost rho(x) / 2 of a residual block with chi-squared x, and its weight rho'(x).
//
// With k the size times the degrees of freedom of the block:
// (E1) Huber   rho = x,               x <= k;   2 sqrt(k x) - k              beyond
// (E2) Cauchy  rho = k ln(1 + x / k)
// (E3) DCS     rho = x,               x <= k;   3 k - 4 k^2 / (k + x)        beyond
// Reference: (E3) Agarwal et al. 2013: the scale s = min(1, 2 k / (k + x)) multiplies the residual,
// so the weight is s^2 = rho'; Michalczyk et al., IROS 2024.
#pragma once

#include <cmath>

#include "rio/options.hpp"

namespace rio {

struct KernelValue {
  double cost = 0.0;    ///< rho
  double weight = 1.0;  ///< rho'
};

/// @param k kernel size times degrees of freedom, @param x chi-squared of the block
inline KernelValue evaluate_kernel(Kernel kernel, double k, double x) {
  switch (kernel) {
    case Kernel::kNone:
      return {x, 1.0};
    case Kernel::kHuber:
      if (x <= k) return {x, 1.0};
      return {2.0 * std::sqrt(k * x) - k, std::sqrt(k / x)};
    case Kernel::kCauchy:
      return {k * std::log1p(x / k), 1.0 / (1.0 + x / k)};
    case Kernel::kDcs: {
      if (x <= k) return {x, 1.0};
      const double s = 2.0 * k / (k + x);
      return {3.0 * k - 2.0 * k * s, s * s};
    }
  }
  return {x, 1.0};
}

}  // namespace rio
