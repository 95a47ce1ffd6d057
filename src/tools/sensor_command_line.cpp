// SPDX-License-Identifier: BSD-3-Clause
// The command lines for real and simulated sensors.
#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "command_line.hpp"
#include "commands.hpp"

namespace rio::tools {

namespace {

/// Destinations of the estimates: files and links.
void add_live_outputs(CLI::App* command, LiveArguments* to) {
  const std::string group = "Outputs";
  command->add_option("--out", to->out, "trajectory to write, TUM format")->group(group);
  command
      ->add_option("--states", to->states,
                   "states with covariance to write, csv; P is that of position, attitude (body "
                   "axes), velocity")
      ->group(group);
  command->add_option("--json-lines", to->json_lines, "a line of JSON a scan; - is standard output")
      ->group(group);
  command
      ->add_option("--record", to->record,
                   "folder of a new dataset, for `rio replay`, or FILE.mcap (ROS 2); may be given "
                   "twice")
      ->allow_extra_args(false)
      ->group(group);
  add_view_options(command, &to->view, group);
  CLI::Option* link =
      command
          ->add_option("--mavlink", to->mavlink,
                       "port of the autopilot, as udp:127.0.0.1:14550 or /dev/ttyAMA0@921600; may "
                       "be the IMU's")
          ->group(group);
  command->add_option("--mavlink-rate", to->mavlink_rate, "of ODOMETRY [Hz]")
      ->check(CLI::Range(0.1, 1000.0))
      ->needs(link)
      ->group(group)
      ->capture_default_str();
  command->add_option("--mavlink-system", to->mavlink_system, "number of the vehicle")
      ->check(CLI::Range(1, 255))
      ->needs(link)
      ->group(group)
      ->capture_default_str();
  CLI::Option* only = command
                          ->add_flag("--velocity-only", to->velocity_only,
                                     "tell the autopilot no position or attitude")
                          ->needs(link)
                          ->group(group);
  command
      ->add_flag("--velocity-when-lost", to->velocity_when_lost,
                 "the same while position or heading are lost; PX4")
      ->needs(link)
      ->excludes(only)
      ->group(group);
  command->add_flag("--json", to->json, "print one JSON line instead of the summary")->group(group);
}

/// Disturbances of a simulated flight on the way to `rio live`.
void add_cable_options(CLI::App* command, CLI::Option* live, SimulateArguments* to) {
  const std::string group = "With --live";
  command->add_option("--speed", to->speed, "of the time")
      ->check(CLI::Range(0.1, 100.0))
      ->needs(live)
      ->group(group);
  const auto add = [&](const char* name, double* share, const char* what) {
    command->add_option(name, *share, what)->check(CLI::Range(0.0, 1.0))->needs(live)->group(group);
  };
  add("--dropped", &to->cable.dropped, "share of the packets that never arrive");
  add("--damaged", &to->cable.damaged, "share that lose some of their bytes");
  add("--delayed", &to->cable.delayed, "share that come late, by 20 ms on average");
  add("--split", &to->cable.split, "share that come in pieces");
}

}  // namespace

void add_live_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "live",
      "Sensors on ports through the estimator, to an autopilot, into a recording.\n"
      "A port: /dev/ttyACM1, with a baud rate /dev/ttyACM1@3125000, a file or pipe, - for standard "
      "input,\nudp:PORT (on this machine) or udp:ADDRESS:PORT. Ends with its streams, or on "
      "Ctrl-C");
  auto arguments = std::make_shared<LiveArguments>();
  command
      ->add_option(
          "--radar", arguments->radars,
          "data port of a TI radar (921600 baud; AWR2944 @3125000, xWRL6432 @1250000); up to four")
      ->required()
      ->expected(1, 4);
  command->add_option("--imu", arguments->imu, "port of the IMU (921600 baud)")->required();
  command
      ->add_option("--imu-format", arguments->imu_format,
                   "binary or csv (see data/INTEGRATION.md); mavlink: HIGHRES_IMU of an autopilot, "
                   "mavlink-raw: its RAW_IMU")
      ->check(CLI::IsMember({"binary", "csv", "mavlink", "mavlink-raw"}))
      ->capture_default_str();
  command
      ->add_option("--imu-clock", arguments->imu_clock,
                   "of the IMU's stamps: own, found from the arrivals or by TIMESYNC, or host, "
                   "CLOCK_MONOTONIC of this machine")
      ->check(CLI::IsMember({"own", "host"}))
      ->capture_default_str();
  command
      ->add_option("--sensors", arguments->sensors,
                   "folder with imu0/sensor.yaml, radar0/sensor.yaml, as `rio calibrate --out` "
                   "writes it: mounting and noise")
      ->check(CLI::ExistingDirectory);
  add_estimator_options(command, &arguments->estimator);
  CLI::Option* cfg =
      command
          ->add_option("--radar-cfg", arguments->radar_cfg,
                       "configuration of the radars (.cfg): times, grids and limits from it")
          ->check(CLI::ExistingFile);
  command
      ->add_option("--cli", arguments->cli,
                   "CLI port of a radar (115200 baud), to send it to; as many as there are radars")
      ->expected(1, 4)
      ->needs(cfg);
  command
      ->add_option("--patience", arguments->patience,
                   "how long a port that vanished is waited for [s]; by default for ever")
      ->check(CLI::NonNegativeNumber);
  command
      ->add_option("--speed", arguments->speed,
                   "of the clock: that of `rio simulate --live --speed` at the other end")
      ->check(CLI::Range(0.1, 100.0));
  add_live_outputs(command, arguments.get());
  command->callback([arguments] { live(*arguments); });
}

void add_ti_config_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "ti-config",
      "Is the configuration of a TI radar (.cfg, SDK 3.x) fit for odometry? What it will measure,\n"
      "what is wrong, what to write instead, the options. Exit status 3 if something is wrong, or "
      "if "
      "it\nis of other firmware, which is named and not judged");
  auto arguments = std::make_shared<TiConfigArguments>();
  command->add_option("FILE", arguments->file, "configuration, as sent to the radar")->required();
  command->add_option("--speed", arguments->speed, "of the vehicle at most [m/s]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--points", arguments->points, "of a frame that must get through the UART")
      ->check(CLI::Range(1, 2000))
      ->capture_default_str();
  command->add_flag("--json", arguments->json, "print one JSON line instead of the sentences");
  command->callback([arguments] { ti_config(*arguments); });
}

void add_simulate_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("simulate", "Write a simulated flight");
  auto arguments = std::make_shared<SimulateArguments>();
  command->add_option("OUT", arguments->out, "folder of the new dataset")->required();
  command->add_option("--scenario", arguments->scenario,
                      "name, see `rio scenarios`, or a scenario file");
  command->add_option("--seed", arguments->seed, "of everything random; wins over the scenario's")
      ->check(CLI::NonNegativeNumber);
  CLI::Option* length = command
                            ->add_option("--length", arguments->length,
                                         "of the random path [m]; wins over the scenario's")
                            ->check(CLI::Range(20.0, 1000.0));
  command
      ->add_option("--trajectory", arguments->trajectory,
                   "recorded path to fly: TUM file, EuRoC csv or dataset folder")
      ->excludes(length);
  command
      ->add_option(
          "--radars", arguments->radars,
          "on the body, radar0, radar1, ...: two look ahead and down, three or four around")
      ->check(CLI::Range(1, 4));
  command->add_flag("--ideal", arguments->ideal,
                    "ideal sensors instead of the scenario's: Gaussian noise only, no grids, "
                    "folding, outliers or vibration");
  CLI::Option* live = command->add_flag(
      "--live", arguments->live,
      "then play it: OUT/radar0/port and OUT/imu0/port are serial lines for `rio live` until it is "
      "over");
  add_cable_options(command, live, arguments.get());
  command->callback([arguments] { simulate(*arguments); });
}

void add_bench_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "bench",
      "What the estimator costs on this machine, for every preset and back-end: time of an "
      "update,\n"
      "of an IMU step and of the start, memory, times real time; on a simulated flight");
  auto arguments = std::make_shared<BenchArguments>();
  command->add_option("--detections", arguments->detections, "of a scan")
      ->check(CLI::Range(10, 100000))
      ->capture_default_str();
  command->add_option("--seconds", arguments->seconds, "of flight for each figure")
      ->check(CLI::Range(2.0, 600.0))
      ->capture_default_str();
  CLI::Option* growth = command->add_flag(
      "--growth", arguments->growth,
      "how an update grows with detections, landmarks, clones and window instead");
  command->add_option("--out", arguments->out, "SVG file to write of the growth")->needs(growth);
  command->add_flag("--json", arguments->json, "print one JSON line instead of the table");
  command->callback([arguments] { measure_cost(*arguments); });
}

}  // namespace rio::tools
