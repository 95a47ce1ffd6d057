// SPDX-License-Identifier: BSD-3-Clause
// Preparation of `rio live`: sensors, options and timing of the radars; and sending of their
// configuration.
#pragma once

#include <string>

#include "commands.hpp"
#include "live/session.hpp"
#include "rio/io/dataset.hpp"
#include "rio/ti/config.hpp"

namespace rio::tools {

/// Throws std::runtime_error if it is no file that can be read.
ti::Config read_config(const std::string& path);

struct LiveSensors {
  io::Dataset info;  ///< without data
  live::SessionSetup setup;
  ti::Config config;  ///< to send; empty if none is given
};

/// Throws std::runtime_error for missing or wrong inputs; prints notes on stderr.
LiveSensors find_sensors(const LiveArguments& arguments);

/// Sends the configuration to the CLI port of a radar, line by line. Throws std::runtime_error with
/// the refused line and the radar's answer.
void send_config(const std::string& port_name, const ti::Config& config);

/// Stops the frames of the radar, if it still listens; notes on stderr why it cannot.
void stop_radar(const std::string& port_name);

}  // namespace rio::tools
