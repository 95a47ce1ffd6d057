// SPDX-License-Identifier: BSD-3-Clause
#include "rio/state/calibration.hpp"

#include "rio/core/so3.hpp"

namespace rio {

namespace {

constexpr int kRotation = static_cast<int>(Calibration::kRotationX);
constexpr int kTranslation = static_cast<int>(Calibration::kTranslationX);
constexpr int kDopplerScale = static_cast<int>(Calibration::kDopplerScale);
constexpr int kTimeOffset = static_cast<int>(Calibration::kTimeOffset);

}  // namespace

CalibrationVector calibration_sigmas(const CalibrationOptions& options) {
  CalibrationVector sigmas;
  sigmas.segment<3>(kRotation).setConstant(options.rotation_sigma);
  sigmas.segment<3>(kTranslation).setConstant(options.translation_sigma);
  sigmas[kDopplerScale] = options.doppler_scale_sigma;
  sigmas[kTimeOffset] = options.time_offset_sigma;
  return sigmas;
}

RadarState corrected(const RadarState& from, const CalibrationVector& corrections) {
  const Quaternion turn = quaternion_exp(corrections.segment<3>(kRotation));
  return {{(from.T_BS.rotation * turn).normalized(),
           from.T_BS.translation + corrections.segment<3>(kTranslation)},
          from.doppler_scale + corrections[kDopplerScale],
          from.time_offset + corrections[kTimeOffset]};
}

CalibrationVector corrections_between(const RadarState& from, const RadarState& to) {
  CalibrationVector corrections;
  corrections.segment<3>(kRotation) =
      quaternion_log(from.T_BS.rotation.conjugate() * to.T_BS.rotation);
  corrections.segment<3>(kTranslation) = to.T_BS.translation - from.T_BS.translation;
  corrections[kDopplerScale] = to.doppler_scale - from.doppler_scale;
  corrections[kTimeOffset] = to.time_offset - from.time_offset;
  return corrections;
}

int calibration_column(const Layout& layout, int i) {
  if (i < kDopplerScale) return layout.has_extrinsics() ? layout.extrinsics() + i : -1;
  if (i == kDopplerScale) return layout.has_doppler_scale() ? layout.doppler_scale() : -1;
  return layout.time_offset_column();
}

ParameterNoise parameter_noise(const Layout& layout, const CalibrationOptions& calibration,
                               const AuxiliaryStates& auxiliary) {
  const int size = layout.clone(0) - body::kSize;
  ParameterNoise out{Eigen::VectorXd::Zero(size), Eigen::VectorXd::Zero(size)};
  const auto set = [&out](int column, int length, double sigma, double walk) {
    out.prior.segment(column - body::kSize, length).setConstant(sigma * sigma);
    out.walk.segment(column - body::kSize, length).setConstant(walk * walk);
  };
  const CalibrationVector sigmas = calibration_sigmas(calibration);
  const CalibrationVector usual = calibration_sigmas({});
  for (std::size_t r = 0; r < layout.radars(); ++r) {
    for (int i = 0; i < sigmas.size(); ++i) {
      const int column = calibration_column(layout.of_radar(r), i);
      if (column >= 0)
        set(column, 1, sigmas[i], sigmas[i] > 0.0 ? calibration.walk * usual[i] : 0.0);
    }
    if (layout.has_elevation_error()) {
      set(layout.of_radar(r).elevation_error(), 1, calibration.elevation_sigma, 0.0);
    }
  }
  int column = layout.auxiliary();
  for (const AuxiliaryState& state : auxiliary) {
    set(column, state.size, state.sigma, state.walk);
    column += state.size;
  }
  return out;
}

}  // namespace rio
