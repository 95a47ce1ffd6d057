// SPDX-License-Identifier: BSD-3-Clause
// Moments of a list of numbers.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

namespace rio::test {

/// The numbers as an array of Eigen; `values` must outlive it.
inline Eigen::Map<const Eigen::ArrayXd> array_of(const std::vector<double>& values) {
  return {values.data(), static_cast<Eigen::Index>(values.size())};
}
inline double mean_of(const std::vector<double>& values) {
  return array_of(values).mean();
}
inline double sigma_of(const std::vector<double>& values) {
  return std::sqrt((array_of(values) - mean_of(values)).square().mean());
}
inline double rms_of(const std::vector<double>& values) {
  return std::sqrt(array_of(values).square().mean());
}

}  // namespace rio::test
