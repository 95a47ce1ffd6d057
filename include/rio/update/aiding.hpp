// SPDX-License-Identifier: BSD-3-Clause
// Stages 4 and 5 of the other sensors: a measurement, taken at its own time, as rows in the error
// of a later state.
//
// Between the two the IMU says how the body turned (D), and how its velocity (u) and position (w)
// changed beside gravity and the velocity it had, in the axes of the earlier one a:
// (E1) R = R_a D,  v = v_a + g s + R_a u,  p = p_a + v_a s + g s^2 / 2 + R_a w
// (E2) errors of a by those of the state: dphi_a = D dphi + s Jl(log D) db_g,
//      dv_a = dv + R_a [u] (dphi_a - s / 2 db_g),
//      dp_a = dp - s dv_a + R_a [w] (dphi_a - s / 3 db_g)
//      to first order in the turn over s. The noise of the IMU over s and what its accelerometer
//      bias does are left out: within a scan interval they are far below any measurement's.
#pragma once

#include "rio/core/static_vector.hpp"
#include "rio/models/aiding_measurement.hpp"
#include "rio/propagate/imu_buffer.hpp"
#include "rio/state/estimate.hpp"
#include "rio/update/linear_rows.hpp"

namespace rio {

/// What the IMU says of the time from a measurement to a state (E1).
struct MotionSince {
  double seconds = 0.0;
  Matrix3d turn = Matrix3d::Identity();  ///< D
  Vector3d velocity = Vector3d::Zero();  ///< u [m/s]
  Vector3d position = Vector3d::Zero();  ///< w [m]
};
/// @param biases those of the state count
MotionSince motion_since(Time from, Time to, const NavState& biases, const ImuBuffer& imu);

/// One of another sensor that came with a scan, or between scans.
struct AidingObservation {
  AidingMeasurement measurement;
  MotionSince to_now;     ///< to the state of the scan
  Time anchor{0};         ///< of the state of the window that keeps it
  MotionSince to_anchor;  ///< to that
};

/// At most this many come with one scan.
inline constexpr std::size_t kMaxAiding = 32;

/// Where the states of a layout are.
struct AidingColumns {
  int body = 0;
  int auxiliary = 0;
};

using AidingRows = StaticVector<LinearRow, static_cast<std::size_t>(AidingMeasurement::kMaxRows)>;

/// Rows of unit variance in the error of `nav` and of the auxiliary states. False: outside the
/// domain of its model.
bool linearize(const AidingMeasurement& z, const MotionSince& since, const NavState& nav,
               const AuxiliaryStates& states, const AuxiliaryValues& auxiliary, double gravity,
               AidingColumns columns, AidingRows* rows);

}  // namespace rio
