// SPDX-License-Identifier: BSD-3-Clause
// A simulated flight as a recording, without output on the terminal: for the program and for
// Python; and as bytes on pseudo-terminals.
#pragma once

#include <filesystem>

#include "commands.hpp"
#include "live/player.hpp"
#include "rio/io/dataset.hpp"
#include "rio/sim/flight.hpp"

namespace rio::tools {

struct Simulated {
  sim::Flight flight;
  io::Dataset dataset;  ///< as written
};
/// Writes the folder `arguments.out`.
Simulated run_simulate(const SimulateArguments& arguments);

/// Waits until OUT/imu0/port, OUT/radar0/port, ... are all open, then sends the sensor data in
/// time. Ends with the flight, or at a signal.
/// @param noise its seed is that of the first cable
/// @param speed factor of time
void play_live(const std::filesystem::path& out, const io::Dataset& flight,
               const live::CableNoise& noise, double speed);

}  // namespace rio::tools
