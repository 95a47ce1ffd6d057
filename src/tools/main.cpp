// SPDX-License-Identifier: BSD-3-Clause
// The `rio` program and the command line of every command. Exit codes: 0 success, 1 the command
// failed, 2 wrong command line, 3 the estimate is lost, or the recording or configuration wrong.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string>

#include "commands.hpp"
#include "describe.hpp"

namespace rio::tools {

namespace {

/// How a bag is read, for every command that takes one.
void add_recording_options(CLI::App* command, RecordingArguments* how) {
  const std::string group = "Of a bag";
  command
      ->add_option("--map", how->map,
                   "file that says what follows, for recordings of one kind; the command line wins")
      ->check(CLI::ExistingFile)
      ->group(group);
  command->add_option("--imu", how->imu, "topic; by default the only sensor_msgs/Imu")
      ->group(group);
  command->add_option("--radar", how->radar, "topic; by default the only sensor_msgs/PointCloud2")
      ->group(group);
  command
      ->add_option("--points", how->points,
                   "fields of the points: ti, rio, mav, coloradar, mimosa, pointxyzi, msc, ars548, "
                   "eagle or altos; by default guessed from their names")
      ->group(group);
  command
      ->add_option("--field", how->fields,
                   "one field, as doppler=rdot, snr=power*0.1, doppler=@12 (byte of a float), or\n"
                   "doppler=rdot,velocity: the one that is there")
      ->allow_extra_args(false)
      ->group(group);
  command->add_option("--axes", how->axes, "of the points: flu, ti, rdf or frd; wins over --points")
      ->check(CLI::IsMember({"flu", "ti", "rdf", "frd"}))
      ->group(group);
  command->add_flag("--approaching", how->approaching, "the Doppler is positive towards the radar")
      ->group(group);
  command
      ->add_option("--imu-clock", how->imu_clock,
                   "stamps: header, receive, carried (headers moved onto the receive clock), auto")
      ->check(CLI::IsMember({"auto", "header", "receive", "carried"}))
      ->group(group);
  command
      ->add_option("--radar-clock", how->radar_clock,
                   "as --imu-clock; or trigger: headers of the messages of what triggers the scans")
      ->check(CLI::IsMember({"auto", "header", "receive", "carried", "trigger"}))
      ->group(group);
  command->add_option("--trigger", how->trigger, "topic; by default the only std_msgs/Header")
      ->group(group);
  command
      ->add_option("--trigger-match", how->trigger_match,
                   "the last trigger before a scan: sequence, of those with its number (default), "
                   "or earlier, of all")
      ->check(CLI::IsMember({"sequence", "earlier"}))
      ->group(group);
  command->add_option("--imu-offset", how->imu_offset, "added to the stamps, as \"3 ms\"")
      ->group(group);
  command->add_option("--radar-offset", how->radar_offset, "added to the stamps, as \"-0.12 s\"")
      ->group(group);
  command->add_option("--gyro-unit", how->gyro_unit, "of the file, as deg/s")->group(group);
  command
      ->add_option("--sensors", how->sensors,
                   "folder with imu0/sensor.yaml, radar0/sensor.yaml: mounting and noise")
      ->check(CLI::ExistingDirectory)
      ->group(group);
  command->add_option("--accel-unit", how->accel_unit, "of the file, as g")->group(group);
}

/// Which options, for every command that runs the estimator.
void add_estimator_options(CLI::App* command, EstimatorArguments* estimator) {
  command->add_option("--config", estimator->config, "option file; see `rio options`");
  command->add_option(
      "--preset", estimator->preset,
      "default, published-ekf, published-smoother or published-uncertainty; wins over the file's");
  command->add_option("--backend", estimator->backend, "ekf or smoother, whatever the preset says")
      ->check(CLI::IsMember({"ekf", "smoother"}));
}

void add_info_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("info", "What is in a bag: topics, rates, clocks, fields of the points");
  auto path = std::make_shared<std::string>();
  command->add_option("FILE", *path, "ROS 1 bag, MCAP, or .db3 of rosbag2")->required();
  command->callback([path] { info(*path); });
}

void add_convert_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("convert", "Write a bag as a folder in ASL/EuRoC layout");
  auto arguments = std::make_shared<ConvertArguments>();
  command->add_option("FILE", arguments->recording, "ROS 1 bag, MCAP, or .db3 of rosbag2")
      ->required();
  command->add_option("OUT", arguments->out, "folder of the new dataset")->required();
  command->add_flag("--force", arguments->force,
                    "overwrite a recording in OUT, with what was filled in there by hand");
  add_recording_options(command, &arguments->how);
  command->callback([arguments] { convert(*arguments); });
}

void add_replay_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("replay", "Run a recording through the estimator");
  auto arguments = std::make_shared<ReplayArguments>();
  command->add_option("DATASET", arguments->dataset, "folder in ASL/EuRoC layout, or a bag")
      ->required();
  add_estimator_options(command, &arguments->estimator);
  command->add_option("--init", arguments->init,
                      "groundtruth, static or a file; by default groundtruth if there is one");
  command
      ->add_option("--init-velocity", arguments->init_velocity,
                   "velocity of the start in the world [m/s]; its covariance stays")
      ->expected(3);
  command->add_option("--out", arguments->out, "trajectory to write, TUM format");
  command->add_option("--states", arguments->states, "states with covariance to write, csv");
  command->add_flag("--barometer", arguments->barometer,
                    "use the heights of baro0, their offset estimated");
  command->add_flag("--no-check", arguments->no_check,
                    "do not check the recording at the end, as `rio check` does");
  command->add_flag("--json", arguments->json, "print one JSON line instead of the summary");
  command->add_flag("--verbose", arguments->verbose, "a line per scan before the summary");
  command->add_flag("--quiet", arguments->quiet, "no line per scan, whatever else is given");
  add_recording_options(command, &arguments->how);
  command->callback([arguments] { replay(*arguments); });
}

/// Files and links that the estimates go to.
void add_live_outputs(CLI::App* command, LiveArguments* to) {
  const std::string group = "Outputs";
  command->add_option("--out", to->out, "trajectory to write, TUM format")->group(group);
  command->add_option("--states", to->states, "states with covariance to write, csv")->group(group);
  command->add_option("--json-lines", to->json_lines, "a line of JSON a scan; - is standard output")
      ->group(group);
  command
      ->add_option("--record", to->record,
                   "folder of a new dataset, for `rio replay`, or FILE.mcap (ROS 2); may be given "
                   "twice")
      ->allow_extra_args(false)
      ->group(group);
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
  command
      ->add_flag("--velocity-only", to->velocity_only, "tell the autopilot no position or attitude")
      ->needs(link)
      ->group(group);
  command->add_flag("--json", to->json, "print one JSON line instead of the summary")->group(group);
}

void add_live_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "live",
      "Sensors on ports through the estimator, to an autopilot, into a recording.\n"
      "A port: /dev/ttyACM1, with a baud rate /dev/ttyACM1@3000000, a file or pipe, - for standard "
      "input,\nudp:PORT (on this machine) or udp:ADDRESS:PORT. Ends with its streams, or on "
      "Ctrl-C");
  auto arguments = std::make_shared<LiveArguments>();
  command
      ->add_option("--radar", arguments->radars,
                   "data port of a TI radar with a demo of SDK 3.x (921600 baud); up to four")
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

void add_check_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "check",
      "Is a recording what an estimator takes it to be? Stamps, units, Doppler, axes and delays,\n"
      "each ok, doubtful or wrong, with what to change. Exit status 3 if something is wrong");
  auto arguments = std::make_shared<CheckArguments>();
  command->add_option("DATASET", arguments->dataset, "folder in ASL/EuRoC layout, or a bag")
      ->required();
  command->add_option("--config", arguments->config,
                      "option file with what you are told of the sensors, as the mounting");
  command->add_flag("--json", arguments->json, "print one JSON line instead of the sentences");
  add_recording_options(command, &arguments->how);
  command->callback([arguments] { check_recording(*arguments); });
}

void add_ti_config_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "ti-config",
      "Is the configuration of a TI radar (.cfg, SDK 3.x) fit for odometry? What it will measure,\n"
      "what is wrong, what to write instead, the options. Exit status 3 if something is wrong");
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

/// What becomes of a simulated flight on the way to `rio live`.
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

void add_evaluate_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("evaluate", "Compare an estimated path with the true one");
  auto arguments = std::make_shared<EvaluateArguments>();
  command->add_option("TRUTH", arguments->truth, "TUM file, EuRoC csv or dataset folder")
      ->required();
  command
      ->add_option("ESTIMATE", arguments->estimates,
                   "same formats; several give a table of a row each")
      ->required();
  command
      ->add_option("--align", arguments->align,
                   "for MAE, RMSE, drift, yaw and tilt: none (as the papers), origin, yaw, se3")
      ->check(CLI::IsMember({"none", "origin", "yaw", "se3"}))
      ->capture_default_str();
  command->add_flag("--json", arguments->json, "print one JSON line an estimate");
  command
      ->add_option("--max-diff", arguments->max_diff,
                   "largest difference of stamps if the truth is too sparse to interpolate [s]")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command
      ->add_option("--mae-at", arguments->mae_at,
                   "also the norm of MAE up to this length of the true path [m]")
      ->check(CLI::PositiveNumber);
  command->callback([arguments] { evaluate(*arguments); });
}

/// rio-lab has its own options and its own help.
void add_experiment_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "experiment", "Answer a question with many simulated flights (starts rio-lab)");
  command->prefix_command();
  command->set_help_flag();
  command->callback([command] { experiment(command->remaining()); });
}

void add_plot_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("plot", "Draw paths, heights and errors as an SVG file");
  auto arguments = std::make_shared<PlotArguments>();
  command->add_option("ESTIMATE", arguments->estimates, "TUM file, EuRoC csv or dataset folder")
      ->required();
  CLI::Option* truth =
      command->add_option("--truth", arguments->truth, "true path: same formats; adds the errors");
  command->add_option("--label", arguments->labels, "names for the legend, one for each estimate");
  command
      ->add_option("--align", arguments->align,
                   "lay the estimates over the truth first: none, origin, yaw, se3")
      ->check(CLI::IsMember({"none", "origin", "yaw", "se3"}))
      ->needs(truth)
      ->capture_default_str();
  command->add_option("--out", arguments->out, "SVG file to write")->required();
  command->callback([arguments] { plot(*arguments); });
}

void add_fit_noise_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("fit-noise", "Estimate the noise of the radar from a recording");
  auto arguments = std::make_shared<FitNoiseArguments>();
  command->add_option("DATASET", arguments->dataset, "folder in ASL/EuRoC layout, or a bag")
      ->required();
  command->add_option("--config", arguments->config, "option file; its sigmas are where it starts");
  command->add_option("--init", arguments->init, "static, groundtruth or a file")
      ->capture_default_str();
  command->add_flag("--no-truth", arguments->no_truth,
                    "hold the Doppler against the estimated velocity, not the true one");
  add_recording_options(command, &arguments->how);
  command->callback([arguments] { fit_noise(*arguments); });
}

void add_calibrate_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "calibrate",
      "Estimate mounting, time offset and Doppler scale of the radar and the noise of the sensors");
  auto arguments = std::make_shared<CalibrateArguments>();
  command
      ->add_option("DATASET", arguments->datasets,
                   "folders in ASL/EuRoC layout, of one and the same mounting; each begins at rest")
      ->required();
  command->add_option("--out", arguments->out,
                      "folder for the files to fly with: radar0/sensor.yaml, imu0/sensor.yaml");
  command->add_flag("--overwrite", arguments->overwrite, "replace sensor files in --out");
  command->add_option("--config", arguments->config,
                      "option file; its calibration.* are the priors");
  command->add_flag("--json", arguments->json, "print one JSON line instead of the table");
  command->callback([arguments] { calibrate(*arguments); });
}

void add_options_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("options", "Print every option as a file to start from");
  auto name = std::make_shared<std::string>("default");
  command
      ->add_option("--preset", *name,
                   "default, published-ekf, published-smoother or published-uncertainty")
      ->capture_default_str();
  auto compare = std::make_shared<bool>(false);
  command->add_flag("--compare", *compare, "the options in which the presets differ, as a table");
  command->callback([name, compare] { *compare ? compare_presets() : print_options(*name); });
}

void add_scenarios_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("scenarios", "List the scenarios, or print one as a file");
  auto name = std::make_shared<std::string>();
  command->add_option("SCENARIO", *name, "name or file, printed with every value and its meaning");
  command->callback([name] { scenarios(*name); });
}

int run(int argc, char** argv) {
  CLI::App app("Radar-inertial odometry: replay, simulate, evaluate and compare", "rio");
  app.set_version_flag("--version", RIO_VERSION);
  app.require_subcommand(1);
  add_info_command(app);
  add_convert_command(app);
  add_check_command(app);
  add_ti_config_command(app);
  add_replay_command(app);
  add_live_command(app);
  add_bench_command(app);
  add_simulate_command(app);
  add_scenarios_command(app);
  add_evaluate_command(app);
  add_experiment_command(app);
  add_plot_command(app);
  add_fit_noise_command(app);
  add_calibrate_command(app);
  add_options_command(app);
  add_describe_command(app);
  try {
    app.parse(argc, argv);
    if (std::fflush(stdout) != 0) throw std::runtime_error("standard output cannot be written");
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return 0;
}

}  // namespace

}  // namespace rio::tools

int main(int argc, char** argv) {
  try {
    return rio::tools::run(argc, argv);
  } catch (const rio::tools::LostEstimate& error) {
    std::fprintf(stderr, "rio: %s\n", error.what());
    return 3;
  } catch (const rio::tools::WrongRecording& error) {
    std::fprintf(stderr, "rio: %s\n", error.what());
    return 3;
  } catch (const rio::tools::WrongConfiguration& error) {
    std::fprintf(stderr, "rio: %s\n", error.what());
    return 3;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "rio: %s\n", error.what());
    return 1;
  }
}
