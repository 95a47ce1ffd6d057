// SPDX-License-Identifier: BSD-3-Clause
#include "rio/state/parameters.hpp"

#include "rio/state/calibration.hpp"

namespace rio {

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
  }
  int column = layout.auxiliary();
  for (const AuxiliaryState& state : auxiliary) {
    set(column, state.size, state.sigma, state.walk);
    column += state.size;
  }
  return out;
}

}  // namespace rio
