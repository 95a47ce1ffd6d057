// SPDX-License-Identifier: BSD-3-Clause
#include "rio/checks/calibration_report.hpp"

#include <cmath>

#include "rio/core/so3.hpp"

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
  const Layout& layout = state_estimate.layout();
  const Estimate& x = state_estimate.estimate();
  const CalibrationOptions& priors = options.calibration;
  const auto fill = [&](Calibration parameter, double value, double prior, bool present,
                        int column) {
    if (!present || prior <= 0.0) return;
    const auto i = static_cast<std::size_t>(parameter);
    const double sigma = std::sqrt(state_estimate.covariance().matrix()(column, column));
    report[i] = {value, sigma, prior, observability(value, sigma, prior)};
  };
  const RadarMount mount = options.mount(x.radar);
  const Pose& configured = mount.T_BS;
  const Vector3d turn = quaternion_log(configured.rotation.conjugate() * x.T_BS.rotation);
  const Vector3d shift = x.T_BS.translation - configured.translation;
  for (int i = 0; i < 3; ++i) {
    const auto offset = [i](Calibration first) {
      return static_cast<Calibration>(static_cast<int>(first) + i);
    };
    fill(offset(Calibration::kRotationX), turn[i], priors.rotation_sigma, layout.has_extrinsics(),
         layout.extrinsics() + i);
    fill(offset(Calibration::kTranslationX), shift[i], priors.translation_sigma,
         layout.has_extrinsics(), layout.extrinsics() + 3 + i);
  }
  fill(Calibration::kDopplerScale, x.doppler_scale - mount.doppler_scale,
       priors.doppler_scale_sigma, layout.has_doppler_scale(), layout.doppler_scale());
  fill(Calibration::kTimeOffset, x.time_offset - mount.time_offset, priors.time_offset_sigma,
       layout.has_time_offset(), layout.time_offset());
  return report;
}

}  // namespace rio
