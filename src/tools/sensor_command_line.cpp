// SPDX-License-Identifier: BSD-3-Clause
// The command lines for real and simulated sensors, and what all estimators have in common.
#include <string>

#include "command_line.hpp"
#include "commands.hpp"

namespace rio::tools {

using enum Trait;

namespace {

/// Empty, or why that is no port.
std::string port_fault(std::string& text) {
  const bool number =
      !text.empty() && text.size() < 6 && text.find_first_not_of("0123456789") == std::string::npos;
  return number && std::stoi(text) < 65536 ? "" : text + ": is no port";
}

/// Destinations of the estimates: files and links.
void add_live_outputs(const Command& command, LiveArguments* to) {
  add_path_files(command, &to->out, &to->states);
  command.add("--json-lines", &to->json_lines, "a line of JSON a scan; - is standard output");
  command.add("--record", &to->record,
              "folder of a new dataset, for `rio replay`, or FILE.mcap (ROS 2); may be given twice",
              kOneEach);
  add_view_options(command, &to->view);
  CLI::Option* link = command.add(
      "--mavlink", &to->mavlink,
      "port of the autopilot, as udp:127.0.0.1:14550 or /dev/ttyAMA0@921600; may be the IMU's");
  command.add("--mavlink-rate", &to->mavlink_rate, "of ODOMETRY [Hz]", CLI::Range(0.1, 1000.0),
              link, kShown);
  command.add("--mavlink-system", &to->mavlink_system, "number of the vehicle", CLI::Range(1, 255),
              link, kShown);
  CLI::Option* only = command.add("--velocity-only", &to->velocity_only,
                                  "tell the autopilot no position or attitude", link);
  command
      .add("--velocity-when-lost", &to->velocity_when_lost,
           "the same while position or heading are lost; PX4", link)
      ->excludes(only);
  command.add("--json", &to->json, "print one JSON line instead of the summary");
}

}  // namespace

void add_option_values(const Command& command, OptionValues* values, const std::string& what) {
  command.add("--config", &values->config, what);
  command.add("--set", &values->set,
              "one option as KEY=VALUE, with keys and units of option files; may be repeated",
              kOneEach);
}

void add_estimator_options(const Command& command, EstimatorArguments* estimator) {
  add_option_values(command, estimator, "option file; see `rio options`");
  command.add("--preset", &estimator->preset,
              "default, published-ekf, published-smoother, published-uncertainty or doppler-only; "
              "wins over the file's");
  command.add("--backend", &estimator->backend, "ekf or smoother, whatever the preset says",
              CLI::IsMember({"ekf", "smoother"}));
}

void add_path_files(const Command& command, std::string* out, std::string* states) {
  command.add("--out", out, "trajectory to write, TUM format");
  command.add("--states", states,
              "states with covariance to write, csv; P is that of position [m], attitude about "
              "body axes [rad], velocity [m/s]");
}

void add_view_options(const Command& command, ViewArguments* view) {
  command.add("--report", &view->report,
              "page to write, HTML: summary, paths, points, plots and events, for any browser");
  command.add("--log", &view->log,
              "folder to write, CSV: innovations, points, landmarks, calibration, health, events");
  command.add("--mcap", &view->mcap,
              "file to write for viewers (Foxglove, Lichtblick, rerun): poses, path, points, ...");
  command.add("--also", &view->also,
              "TUM file of another estimate, shown to the viewers as /path/NAME; may be given "
              "several times",
              kOneEach);
  CLI::Option* port =
      command
          .add("--view", &view->port,
               "serve the same to viewers that connect (Foxglove WebSocket), on this port or 8765")
          ->expected(0, 1)
          ->default_str("8765")
          ->transform(CLI::Validator(port_fault, "", "port"))
          ->type_name("[PORT]");
  command.add("--view-address", &view->address, "of this machine, on which it listens", kShown,
              port);
}

void add_live_command(CLI::App& app) {
  const Command command(
      app, "live",
      "Sensors on ports through the estimator, to an autopilot, into a recording.\n"
      "A port: /dev/ttyACM1, with a baud rate /dev/ttyACM1@3125000, a file or pipe, - for standard "
      "input,\nudp:PORT (on this machine) or udp:ADDRESS:PORT. Ends with its streams, or on "
      "Ctrl-C");
  LiveArguments* to = command.runs(&live);
  command
      .add("--radar", &to->radars,
           "data port of a TI radar (921600 baud; AWR2944 @3125000, xWRL6432 @1250000); up to four",
           kRequired)
      ->expected(1, 4);
  command.add("--imu", &to->imu, "port of the IMU (921600 baud)", kRequired);
  command.add("--imu-format", &to->imu_format,
              "binary or csv (see data/INTEGRATION.md); mavlink: HIGHRES_IMU of an autopilot, "
              "mavlink-raw: its RAW_IMU",
              CLI::IsMember({"binary", "csv", "mavlink", "mavlink-raw"}), kShown);
  command.add("--imu-clock", &to->imu_clock,
              "of the IMU's stamps: own, found from the arrivals or by TIMESYNC, or host, "
              "CLOCK_MONOTONIC of this machine",
              CLI::IsMember({"own", "host"}), kShown);
  command.add("--sensors", &to->sensors,
              "folder with imu0/sensor.yaml, radar0/sensor.yaml, as `rio calibrate --out` writes "
              "it: mounting and noise",
              CLI::ExistingDirectory);
  add_estimator_options(command, &to->estimator);
  CLI::Option* cfg = command.add(
      "--radar-cfg", &to->radar_cfg,
      "configuration of the radars (.cfg): times, grids and limits from it", CLI::ExistingFile);
  command
      .add("--cli", &to->cli,
           "CLI port of a radar (115200 baud), to send it to; as many as there are radars", cfg)
      ->expected(1, 4);
  command.add("--patience", &to->patience,
              "how long a port that vanished is waited for [s]; by default for ever", kNotNegative);
  command.add("--speed", &to->speed,
              "of the clock: that of `rio simulate --live --speed` at the other end",
              CLI::Range(0.1, 100.0), kShown);
  add_live_outputs(command.under("Outputs"), to);
}

void add_ti_config_command(CLI::App& app) {
  const Command command(
      app, "ti-config",
      "Is the configuration of a TI radar (.cfg, SDK 3.x) fit for odometry? What it will measure,\n"
      "what is wrong, what to write instead, the options. Exit status 3 if something is wrong, or "
      "if it\nis of other firmware, which is named and not judged (but clutter removal)");
  TiConfigArguments* to = command.runs(&ti_config);
  command.add("FILE", &to->file, "configuration, as sent to the radar", kRequired);
  command.add("--speed", &to->speed, "of the vehicle at most [m/s]", kPositive, kShown);
  command.add("--points", &to->points, "of a frame that must get through the UART",
              CLI::Range(1, 2000), kShown);
  command.add("--json", &to->json, "print one JSON line instead of the sentences");
}

void add_simulate_command(CLI::App& app) {
  const Command command(app, "simulate", "Write a simulated flight");
  SimulateArguments* to = command.runs(&simulate);
  command.add("OUT", &to->out, "folder of the new dataset", kRequired);
  command.add("--scenario", &to->scenario, "name, see `rio scenarios`, or a scenario file");
  command.add("--seed", &to->seed, "of everything random; wins over the scenario's", kNotNegative);
  CLI::Option* length =
      command.add("--length", &to->length, "of the random path [m]; wins over the scenario's",
                  CLI::Range(20.0, 1000.0));
  command
      .add("--trajectory", &to->trajectory,
           "recorded path to fly: TUM file, EuRoC csv or dataset folder")
      ->excludes(length);
  command.add("--radars", &to->radars,
              "on the body, radar0, radar1, ...: two look ahead and down, three or four around",
              CLI::Range(1, 4), kShown);
  command.add("--ideal", &to->ideal,
              "ideal sensors instead of the scenario's: Gaussian noise only, no grids, folding, "
              "outliers or vibration");
  CLI::Option* live = command.add("--live", &to->live,
                                  "then play it: OUT/radar0/port and OUT/imu0/port are serial "
                                  "lines for `rio live` until it is over");
  const Command played = command.under("With --live");
  const CLI::Range share(0.0, 1.0);
  played.add("--speed", &to->speed, "of the time", CLI::Range(0.1, 100.0), live, kShown);
  played.add("--dropped", &to->cable.dropped, "share of the packets that never arrive", share,
             live);
  played.add("--damaged", &to->cable.damaged, "share that lose some of their bytes", share, live);
  played.add("--delayed", &to->cable.delayed, "share that come late, by 20 ms on average", share,
             live);
  played.add("--split", &to->cable.split, "share that come in pieces", share, live);
}

void add_scenarios_command(CLI::App& app) {
  const Command command(app, "scenarios", "List the scenarios, or print one as a file");
  command.add("SCENARIO", command.runs(&scenarios),
              "name or file, printed with every value and its meaning");
}

void add_bench_command(CLI::App& app) {
  const Command command(
      app, "bench",
      "What the estimator costs on this machine, for every preset and back-end: time of an "
      "update,\nof an IMU step and of the start, memory, times real time; on a simulated flight");
  BenchArguments* to = command.runs(&measure_cost);
  command.add("--detections", &to->detections, "of a scan", CLI::Range(10, 100000), kShown);
  command.add("--seconds", &to->seconds, "of flight for each figure", CLI::Range(2.0, 600.0),
              kShown);
  CLI::Option* growth =
      command.add("--growth", &to->growth,
                  "how an update grows with detections, landmarks, clones and window instead");
  command.add("--out", &to->out, "SVG file to write of the growth", growth);
  command.add("--json", &to->json, "print one JSON line instead of the table");
}

}  // namespace rio::tools
