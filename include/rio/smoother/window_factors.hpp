// SPDX-License-Identifier: BSD-3-Clause
// The factors of the sliding window, linearised at the present point into the normal equations:
// the IMU between its states, what each scan measured by itself, and the trails between scans.
// Every call returns the cost of what it added, robust kernels included.
#pragma once

#include <cstddef>

#include "rio/options.hpp"
#include "rio/smoother/kernel.hpp"
#include "rio/smoother/normal_equations.hpp"
#include "rio/smoother/scan_information.hpp"
#include "rio/smoother/window.hpp"
#include "rio/state/estimate.hpp"
#include "rio/update/linearize.hpp"
#include "rio/update/reliability.hpp"

namespace rio {

class WindowFactors {
 public:
  /// @param layout [newest state | border] without clones; all three must outlive this
  WindowFactors(const Options& options, const Layout& layout, const Window& window,
                NormalEquations* system);

  double add_all(const Estimate& x);

  /// From state k to the next one.
  double add_imu(std::size_t k);

  /// All that scan k measured by itself.
  double add_scan(std::size_t k, const Estimate& estimate);

  /// All that other sensors measured before state k.
  double add_aiding(std::size_t k, const Estimate& estimate);

  /// Measured by state k; nothing if the past state has left the window.
  double add_trail(std::size_t k, const TrailFactor& f, const Estimate& estimate);

 private:
  /// All that radar r measured at state k; `rest` with it.
  double add_scan_of(std::size_t k, std::size_t r, bool rest, const Estimate& estimate);

  /// A state, moved to what the calibration of its scan by radar r is known to be now.
  static LinearizationPoint point(const WindowState& state, std::size_t r,
                                  const Estimate& estimate);
  WindowLayout layout_of(std::size_t k, std::size_t r = 0) const {
    return {layout_.of_radar(r), static_cast<int>(window_.size()), static_cast<int>(k)};
  }

  SmootherOptions options_;
  AuxiliaryStates auxiliary_;
  double gravity_;
  const Layout& layout_;
  const Window& window_;
  NormalEquations* system_;
  bool reliable_;
  DopplerModel doppler_;
  TrailDistanceModel trail_;
  LandmarkDistanceModel distance_;
  ScanInformation scan_;
  RowBatch row_;
  AidingRows aiding_;
};

}  // namespace rio
