// SPDX-License-Identifier: BSD-3-Clause
#include "rio/checks/calibration_report.hpp"

#include <cmath>

#include "rio/state/calibration.hpp"

namespace rio {

Observability observability(double value, double sigma, double prior_sigma) {
  if (prior_sigma <= 0.0) return Observability::kNotEstimated;
  constexpr double kAtLimit = 0.999;  // rounding of the rotation vector
  if (std::abs(value) >= kAtLimit * kCalibrationLimit * prior_sigma) return Observability::kAtLimit;
  if (sigma > 0.9 * prior_sigma) return Observability::kUnobserved;
  if (std::abs(value) > kCalibrationDoubt * prior_sigma) return Observability::kDoubtful;
  return sigma > 0.5 * prior_sigma ? Observability::kWeak : Observability::kObserved;
}

std::array<CalibrationReport, kCalibrationCount> calibration_report(
    const StateEstimate& state_estimate, const Options& options) {
  std::array<CalibrationReport, kCalibrationCount> report{};
  const Estimate& x = state_estimate.estimate();
  const CalibrationVector values =
      corrections_between(configured_state(options.mount(x.radar)), x.of_radar(x.radar));
  const CalibrationVector priors = calibration_sigmas(options.calibration);
  for (int i = 0; i < values.size(); ++i) {
    const int column = calibration_column(state_estimate.layout(), i);
    if (column < 0 || priors[i] <= 0.0) continue;
    const double sigma = std::sqrt(state_estimate.covariance().matrix()(column, column));
    report[static_cast<std::size_t>(i)] = {values[i], sigma, priors[i],
                                           observability(values[i], sigma, priors[i])};
  }
  return report;
}

}  // namespace rio
