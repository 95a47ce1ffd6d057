// SPDX-License-Identifier: BSD-3-Clause
// What `rio live` finds out before it starts: sensors, options, times of the radars; and the
// configuration that it sends them.
#pragma once

#include <string>
#include <vector>

#include "commands.hpp"
#include "live/session.hpp"
#include "rio/io/dataset.hpp"
#include "rio/ti/config.hpp"

namespace rio::tools {

struct LiveSensors {
  io::Dataset info;  ///< without data
  live::SessionSetup setup;
  ti::Config config;  ///< to send; empty if none is given
};

/// Throws std::runtime_error where something is missing or wrong; prints notes on stderr.
LiveSensors find_sensors(const LiveArguments& arguments);

/// Sends the configuration to the CLI port of a radar, line by line. Throws std::runtime_error with
/// the line that the radar refuses and its words.
void send_config(const std::string& port_name, const ti::Config& config);

/// The radar ends its frames, if it still listens.
void stop_radar(const std::string& port_name);

}  // namespace rio::tools
