// SPDX-License-Identifier: BSD-3-Clause
// The factors of the sliding window, linearised at the current point into the normal equations: IMU
// factors between states, measurements of single scans, aiding measurements, and trails between
// scans. Every call returns the cost of the factors it added, robust kernels included.
#pragma once

#include <cstddef>

#include "rio/options.hpp"
#include "rio/smoother/kernel.hpp"
#include "rio/smoother/normal_equations.hpp"
#include "rio/smoother/scan_information.hpp"
#include "rio/smoother/window.hpp"
#include "rio/state/estimate.hpp"
#include "rio/update/linearize.hpp"

namespace rio {

class WindowFactors {
 public:
  /// @param layout [newest state | border] without clones; all three must outlive this
  WindowFactors(const Options& options, const Layout& layout, const Window& window,
                NormalEquations* system);

  double add_all(const Estimate& x);

  /// The IMU factor from state k to the next one.
  double add_imu(std::size_t k);

  /// The measurements of state k that depend on no other state.
  double add_scan(std::size_t k, const Estimate& estimate);

  /// The measurements of other sensors between state k - 1 and k.
  double add_aiding(std::size_t k, const Estimate& estimate);

  /// A trail distance of state k; nothing if the past state has left the window.
  double add_trail(std::size_t k, const Measured<TrailDistanceModel>& m, const Estimate& estimate);

 private:
  /// The measurements of radar r at state k.
  double add_scan_of(std::size_t k, std::size_t r, const Estimate& estimate);
  /// One of them; not a trail distance.
  template <class M>
  void add(const Measured<M>& m, const LinearizationPoint& x, const WindowLayout& layout);

  /// The state at the time of its scan by radar r according to the current calibration.
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
  RadarModels models_;
  ScanInformation scan_;
  RowBatch row_;
  AidingRows aiding_;
};

}  // namespace rio
