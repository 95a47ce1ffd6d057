// SPDX-License-Identifier: BSD-3-Clause
// Stages 3 and 4 for external models: a measurement at its own time as rows in the error of a later
// state.
//
// (E1) the IMU increments D, u, w over the s seconds between the two (propagate/strapdown.hpp)
// (E2) errors at a by those of the later state: dphi_a = D dphi + s Jl(log D) db_g,
//      dv_a = dv + R_a [u] (dphi_a - s / 2 db_g),
//      dp_a = dp - s dv_a + R_a [w] (dphi_a - s / 3 db_g)
//      to first order in the rotation over s. IMU noise and accelerometer bias error over s are
//      neglected: within a scan interval they are far below the noise of any measurement.
#pragma once

#include "rio/core/static_vector.hpp"
#include "rio/models/aiding_measurement.hpp"
#include "rio/propagate/strapdown.hpp"
#include "rio/state/estimate.hpp"
#include "rio/update/linear_rows.hpp"

namespace rio {

/// A measurement of another sensor, used with a scan or between scans.
struct AidingObservation {
  AidingMeasurement measurement;
  ImuIncrements to_now;     ///< to the state of the scan
  Time anchor{0};           ///< time of the window state that keeps it
  ImuIncrements to_anchor;  ///< to the anchor
  Model model = Model::kAiding;
};

/// Most aiding measurements in one update.
inline constexpr std::size_t kMaxAiding = 32;

/// @param layout of the error state, of the measurement's radar: Layout or WindowLayout
template <class AnyLayout>
AidingColumns aiding_columns(const AnyLayout& layout) {
  return {layout.template column<BodyPose>(0) - body::kAttitude,
          layout.template column<Extrinsics>(0), layout.template column<DopplerScale>(0),
          layout.auxiliary()};
}

using AidingRows = StaticVector<LinearRow, static_cast<std::size_t>(AidingMeasurement::kMaxRows)>;

/// The state at the time of the measurement (E1), its auxiliary states aside.
AidedState aided_state(const AidingMeasurement& z, const ImuIncrements& since, const NavState& nav,
                       const Estimate& x, double gravity);

/// Rows of unit variance in the errors of `nav`, of the calibration of the measurement's radar and
/// of the auxiliary states.
/// @param x the calibration and the auxiliary states
/// @return false: outside the domain of the measurement's model
bool linearize(const AidingMeasurement& z, const ImuIncrements& since, const NavState& nav,
               const Estimate& x, const AuxiliaryStates& states, double gravity,
               const AidingColumns& columns, AidingRows* rows);

}  // namespace rio
