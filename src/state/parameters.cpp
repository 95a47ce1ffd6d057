// SPDX-License-Identifier: BSD-3-Clause
#include "rio/state/parameters.hpp"

namespace rio {

ParameterNoise parameter_noise(const Layout& layout, const CalibrationOptions& calibration,
                               const AuxiliaryStates& auxiliary) {
  const int size = layout.clone(0) - body::kSize;
  ParameterNoise out{Eigen::VectorXd::Zero(size), Eigen::VectorXd::Zero(size)};
  const auto set = [&out](int column, int length, double sigma, double walk) {
    out.prior.segment(column - body::kSize, length).setConstant(sigma * sigma);
    out.walk.segment(column - body::kSize, length).setConstant(walk * walk);
  };
  const CalibrationOptions usual;
  const auto calibrate = [&](int column, int length, double sigma, double usual_sigma) {
    set(column, length, sigma, sigma > 0.0 ? calibration.walk * usual_sigma : 0.0);
  };
  for (std::size_t r = 0; r < layout.radars(); ++r) {
    const Layout own = layout.of_radar(r);
    if (own.has_extrinsics()) {
      calibrate(own.extrinsics(), 3, calibration.rotation_sigma, usual.rotation_sigma);
      calibrate(own.extrinsics() + 3, 3, calibration.translation_sigma, usual.translation_sigma);
    }
    if (own.has_doppler_scale()) {
      calibrate(own.doppler_scale(), 1, calibration.doppler_scale_sigma, usual.doppler_scale_sigma);
    }
    if (own.has_time_offset()) {
      calibrate(own.time_offset(), 1, calibration.time_offset_sigma, usual.time_offset_sigma);
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
