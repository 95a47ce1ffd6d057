// SPDX-License-Identifier: BSD-3-Clause
// A recorded barometer as heights for the estimator (HeightModel in models/aids.hpp).
#pragma once

#include <optional>
#include <vector>

#include "rio/io/dataset.hpp"

namespace rio::io {

/// R T / g of dry air at 20 degrees: heights are minus this times the logarithm of the pressure
/// [m].
inline constexpr double kPressureScale = 287.05 * 293.0 / 9.81;

/// Heights relative to a zero.
struct BarometricScale {
  bool any = false;   ///< the zero is known
  double zero = 0.0;  ///< height of the zero, relative to an air pressure of 1 Pa [m]
  /// Empty for a pressure that is not a positive number [m].
  std::optional<double> height(const BaroSample& sample) const;
};

/// Heights relative to their mean over the first two seconds.
struct BarometricHeights {
  struct Sample {
    Time time{0};
    double height = 0.0;  ///< [m]
  };
  std::vector<Sample> samples;
  double sigma = 0.0;  ///< of one: root of half the mean squared difference of neighbours [m]
};

/// For dry air at 20 degrees; samples that are not positive numbers are dropped.
BarometricHeights barometric_heights(const std::vector<BaroSample>& baro);

}  // namespace rio::io
