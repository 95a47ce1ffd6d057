// SPDX-License-Identifier: BSD-3-Clause
// A simulated flight as a recording: what the estimator is given, and the truth.
#pragma once

#include "rio/io/dataset.hpp"
#include "rio/sim/flight.hpp"

namespace rio::io {

/// What the sensor files of the simulated radar say.
/// @param configured_T_BS the mounting as configured
RadarInfo radar_info_of(const sim::RadarModel& model, const Pose& configured_T_BS);

/// Samples, scans, truth and sensor files of a flight with one radar.
Dataset dataset_of(const sim::Flight& flight);

}  // namespace rio::io
