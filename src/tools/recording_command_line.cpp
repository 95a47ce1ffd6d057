// SPDX-License-Identifier: BSD-3-Clause
// The command lines for recordings.
#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "command_line.hpp"
#include "commands.hpp"
#include "rio/bag/dataset_presets.hpp"

namespace rio::tools {

namespace {

/// Options to read a bag, for every command that takes one.
/// @param truth with --truth, its topic
void add_recording_options(CLI::App* command, RecordingArguments* how, bool truth = true) {
  const std::string group = "Of a bag";
  std::string names;
  for (const bag::DatasetPreset& preset : bag::dataset_presets()) {
    names += (names.empty() ? "" : ", ") + std::string(preset.name);
  }
  command
      ->add_option("--dataset", how->dataset,
                   "public data set, for what follows; --map and the command line win:\n" + names)
      ->group(group);
  command
      ->add_option("--map", how->map,
                   "file that says what follows, for recordings of one kind; the command line wins")
      ->check(CLI::ExistingFile)
      ->group(group);
  command
      ->add_option("--imu", how->imu,
                   "topic; by default the only sensor_msgs/Imu or px4_msgs/SensorCombined, or "
                   "gyroscope and accelerometer on two")
      ->group(group);
  command
      ->add_option("--radar", how->radar,
                   "topic, or several with commas between; by default the only one with points and "
                   "Doppler, or all of whose mountings /tf_static tells")
      ->group(group);
  command
      ->add_option("--pressure", how->pressure,
                   "topic; by default the only sensor_msgs/FluidPressure")
      ->group(group);
  if (truth) {
    command
        ->add_option("--truth", how->truth,
                     "topic; by default the only geometry_msgs/PoseStamped or nav_msgs/Odometry")
        ->group(group);
  }
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
  command->add_option("--imu-axes", how->imu_axes, "of the IMU, turned to flu: ti, rdf or frd")
      ->check(CLI::IsMember({"flu", "ti", "rdf", "frd"}))
      ->group(group);
  command->add_option("--gyro-unit", how->gyro_unit, "of the file, as deg/s")->group(group);
  command
      ->add_option("--sensors", how->sensors,
                   "folder with imu0/sensor.yaml, radar0/sensor.yaml: mounting and noise")
      ->check(CLI::ExistingDirectory)
      ->group(group);
  command->add_option("--accel-unit", how->accel_unit, "of the file, as g")->group(group);
}

void add_option_values(CLI::App* command, OptionValues* values, const std::string& what) {
  command->add_option("--config", values->config, what);
  command
      ->add_option("--set", values->set,
                   "one option as KEY=VALUE, with keys and units of option files; may be repeated")
      ->allow_extra_args(false);
}

/// Empty, or why that is no port; "true" is the flag without one.
std::string port_fault(const std::string& text) {
  const bool number =
      !text.empty() && text.size() < 6 && text.find_first_not_of("0123456789") == std::string::npos;
  return text == "true" || (number && std::stoi(text) < 65536) ? "" : text + ": is no port";
}

}  // namespace

void add_view_options(CLI::App* command, ViewArguments* view, const std::string& group) {
  command
      ->add_option("--report", view->report,
                   "page to write, HTML: summary, paths, points, plots and events, for any browser")
      ->group(group);
  command
      ->add_option(
          "--log", view->log,
          "folder to write, CSV: innovations, points, landmarks, calibration, health, events")
      ->group(group);
  command
      ->add_option(
          "--mcap", view->mcap,
          "file to write for viewers (Foxglove, Lichtblick, rerun): poses, path, points, ...")
      ->group(group);
  command
      ->add_option_function<std::string>(
          "--view",
          [view](const std::string& port) { view->port = port == "true" ? "8765" : port; },
          "serve the same to viewers that connect (Foxglove WebSocket), on this port or 8765")
      ->expected(0, 1)
      ->check(CLI::Validator(port_fault, "", "port"))
      ->type_name("[PORT]")
      ->group(group);
  command->add_option("--view-address", view->address, "of this machine, on which it listens")
      ->capture_default_str()
      ->group(group);
}

void add_estimator_options(CLI::App* command, EstimatorArguments* estimator) {
  add_option_values(command, estimator, "option file; see `rio options`");
  command->add_option("--preset", estimator->preset,
                      "default, published-ekf, published-smoother, published-uncertainty or "
                      "doppler-only; wins over the file's");
  command->add_option("--backend", estimator->backend, "ekf or smoother, whatever the preset says")
      ->check(CLI::IsMember({"ekf", "smoother"}));
}

void add_info_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("info", "What is in a bag: topics, rates, clocks, fields of the points");
  auto path = std::make_shared<std::string>();
  command
      ->add_option("FILE", *path, "ROS 1 bag, MCAP, or .db3 of rosbag2; or a folder of its parts")
      ->required();
  command->callback([path] { info(*path); });
}

void add_convert_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "convert", "Write a bag as a folder in ASL/EuRoC layout, or a folder as MCAP");
  auto arguments = std::make_shared<ConvertArguments>();
  command
      ->add_option(
          "FILE", arguments->recording,
          "ROS 1 bag, MCAP, or .db3 of rosbag2; or a folder of its parts, or in ASL layout")
      ->required();
  command->add_option("OUT", arguments->out, "folder to write, or file *.mcap")->required();
  command->add_flag("--force", arguments->force,
                    "overwrite a recording in OUT, with what was filled in there by hand");
  add_recording_options(command, &arguments->how);
  command->callback([arguments] { convert(*arguments); });
}

void add_check_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "check",
      "Is a recording what an estimator takes it to be? Stamps, units, Doppler, axes and delays,\n"
      "each ok, doubtful or wrong, with what to change. Exit status 3 if something is wrong");
  auto arguments = std::make_shared<CheckArguments>();
  command->add_option("DATASET", arguments->dataset, "folder in ASL/EuRoC layout, or a bag")
      ->required();
  add_option_values(command, &arguments->values,
                    "option file with what is known of the sensors, as the mounting");
  command->add_flag("--json", arguments->json, "print one JSON line instead of the sentences");
  add_recording_options(command, &arguments->how);
  command->callback([arguments] { check_recording(*arguments); });
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
  command->add_option("--states", arguments->states,
                      "states with covariance to write, csv; P is that of position, attitude (body "
                      "axes), velocity");
  add_view_options(command, &arguments->view, "What a person looks at");
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

void add_compare_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "compare",
      "Runs of one recording side by side: presets, back-ends, options, other estimators");
  auto arguments = std::make_shared<CompareArguments>();
  command
      ->add_option("RUN", arguments->runs,
                   "recordings, which are replayed, and trajectories (TUM, EuRoC csv)")
      ->required();
  command
      ->add_option("--preset", arguments->presets, "several, separated by commas: a run with each")
      ->delimiter(',');
  command->add_option("--backend", arguments->backends, "ekf, smoother or both, with a comma")
      ->delimiter(',')
      ->check(CLI::IsMember({"ekf", "smoother"}));
  command
      ->add_option("--vary", arguments->vary,
                   "KEY=VALUE,VALUE,...: a run with each; several: every combination")
      ->allow_extra_args(false);
  add_option_values(command, &arguments->estimator, "option file; see `rio options`");
  command->add_option("--init", arguments->init,
                      "groundtruth, static or a file; by default groundtruth if there is one");
  command->add_option("--truth", arguments->truth,
                      "true path: TUM file, EuRoC csv, dataset folder or bag; by default that of "
                      "the recording");
  command
      ->add_option("--align", arguments->align,
                   "lay the estimates over the truth first: none, origin, yaw, se3")
      ->check(CLI::IsMember({"none", "origin", "yaw", "se3"}))
      ->capture_default_str();
  command->add_option("--report", arguments->report,
                      "page to write, HTML: table, paths, differences");
  add_recording_options(command, &arguments->how, false);
  command->callback([arguments] { compare(*arguments); });
}

void add_fit_noise_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("fit-noise", "Estimate the noise of the radar from a recording");
  auto arguments = std::make_shared<FitNoiseArguments>();
  command->add_option("DATASET", arguments->dataset, "folder in ASL/EuRoC layout, or a bag")
      ->required();
  add_option_values(command, &arguments->values, "option file; its sigmas are where it starts");
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
      ->add_option(
          "DATASET", arguments->datasets,
          "folders in ASL/EuRoC layout, or bags, of one and the same mounting; each begins at "
          "rest")
      ->required();
  command->add_option("--out", arguments->out,
                      "folder for the files to fly with: radar0/sensor.yaml, imu0/sensor.yaml");
  command->add_flag("--overwrite", arguments->overwrite, "replace sensor files in --out");
  add_option_values(command, &arguments->values, "option file; its calibration.* are the priors");
  command->add_flag("--json", arguments->json, "print one JSON line instead of the table");
  add_recording_options(command, &arguments->how);
  command->callback([arguments] { calibrate(*arguments); });
}

void add_options_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("options", "Print every option as a file to start from");
  auto arguments = std::make_shared<FlownOptionsArguments>();
  auto name = std::make_shared<std::string>("default");
  CLI::Option* preset = command
                            ->add_option("--preset", *name,
                                         "default, published-ekf, published-smoother, "
                                         "published-uncertainty or doppler-only")
                            ->capture_default_str();
  auto compare = std::make_shared<bool>(false);
  command->add_flag("--compare", *compare, "the options in which the presets differ, as a table");
  command->add_option(
      "--from", arguments->dataset,
      "the options that a replay of this folder or bag uses, sensor files and --config included");
  add_option_values(command, &arguments->estimator, "option file, as of `rio replay`");
  add_recording_options(command, &arguments->how);
  command->callback([arguments, name, compare, preset] {
    if (preset->count() > 0) arguments->estimator.preset = *name;
    const io::OptionValues& values = arguments->estimator;
    if (arguments->dataset.empty() && arguments->how != RecordingArguments{}) {
      throw CLI::ValidationError("options of a bag are given, but no --from");
    }
    if (arguments->dataset.empty() && !(values.config.empty() && values.set.empty())) {
      throw CLI::ValidationError("--config and --set need --from");
    }
    if (*compare) {
      compare_presets();
    } else if (!arguments->dataset.empty()) {
      print_flown_options(*arguments);
    } else {
      print_options(*name);
    }
  });
}

}  // namespace rio::tools
