// SPDX-License-Identifier: BSD-3-Clause
// A simulated flight as a recording, without output on the terminal: for the program and for
// Python.
#pragma once

#include "commands.hpp"
#include "rio/io/dataset.hpp"
#include "rio/sim/flight.hpp"

namespace rio::tools {

struct Simulated {
  sim::Flight flight;
  io::Dataset dataset;  ///< as written
};
/// Writes the folder `arguments.out`.
Simulated run_simulate(const SimulateArguments& arguments);

}  // namespace rio::tools
