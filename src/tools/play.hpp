// SPDX-License-Identifier: BSD-3-Clause
// A simulated flight as bytes on pseudo-terminals.
#pragma once

#include <filesystem>

#include "live/cable.hpp"
#include "rio/io/dataset.hpp"

namespace rio::tools {

/// Waits until OUT/imu0/port, OUT/radar0/port, ... are all open, then sends the sensor data in
/// time. Ends with the flight, or at a signal.
/// @param noise its seed is that of the first cable
/// @param speed factor of time
void play_live(const std::filesystem::path& out, const io::Dataset& flight,
               const live::CableNoise& noise, double speed);

}  // namespace rio::tools
