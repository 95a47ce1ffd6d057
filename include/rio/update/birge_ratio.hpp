// SPDX-License-Identifier: BSD-3-Clause
// Honest sigma of a parameter that walks with variance q t: by how much its successive corrections
// exceed what the covariance allows.
//
// The corrections of a consistent estimator over disjoint intervals are independent, with zero mean
// and the variance that they take from P: (E1) E D^2 = P- - P+ + q t. Measurement errors that
// persist, such as ghosts and the directions of reflectors that stay in view, make them larger. The
// sigma is multiplied by the Birge ratio, the root of the mean of D^2 / (E1), if it exceeds 1.
// Reference: R. T. Birge, The calculation of errors by the method of least squares, 1932.
#pragma once

#include "rio/types.hpp"

namespace rio {

/// Of one parameter. Constant memory.
class BirgeRatio {
 public:
  /// Adds the estimate after an update.
  /// @param sigma by the covariance, not 0
  /// @param walk q, variance of the random walk per second
  /// @return the ratio so far, at least 1
  double add(Time time, double value, double sigma, double walk);

 private:
  struct Sample {
    Time time{0};
    double value = 0.0;
    double sigma = 0.0;  ///< 0: none yet
  };

  Sample begin_;         ///< of the current interval
  double widest_ = 0.0;  ///< largest sigma so far
  double sum_ = 0.0;     ///< of D^2 / (E1)
  int intervals_ = 0;
};

}  // namespace rio
