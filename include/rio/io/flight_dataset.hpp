// SPDX-License-Identifier: BSD-3-Clause
// A simulated flight as a recording: the inputs of the estimator, and the truth.
#pragma once

#include "rio/io/dataset.hpp"
#include "rio/sim/flight.hpp"

namespace rio::io {

/// The sensor file of the simulated radar.
/// @param configured_T_BS the mounting as configured
RadarInfo radar_info_of(const sim::RadarModel& model, const Pose& configured_T_BS);

/// Samples, scans, truth and sensor files of a flight with one radar.
Dataset dataset_of(const sim::Flight& flight);

}  // namespace rio::io
