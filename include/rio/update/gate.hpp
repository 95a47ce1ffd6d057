// SPDX-License-Identifier: BSD-3-Clause
// Stage 4: the one-sided chi-squared gate, the same for every model and back-end.
//
// A block passes if its normalised innovation squared r^T S^-1 r is below the quantile of its
// degrees of freedom. There is no lower bound: a measurement that fits too well is not suspicious.
#pragma once

#include <array>
#include <cstddef>

#include "rio/core/chi2.hpp"

namespace rio {

class Gate {
 public:
  /// Largest number of rows in a block.
  static constexpr std::size_t kMaxDof = 6;  // of a measurement of rest or of another sensor

  /// @param probability of a correct measurement to pass, in (0, 1]; 1 = no gate
  explicit Gate(double probability) {
    for (std::size_t dof = 1; dof <= kMaxDof; ++dof) {
      thresholds_[dof - 1] = chi2_quantile(probability, static_cast<double>(dof));
    }
  }
  /// @param dof 1 to kMaxDof
  double threshold(std::size_t dof) const { return thresholds_[dof - 1]; }

 private:
  std::array<double, kMaxDof> thresholds_;
};

}  // namespace rio
