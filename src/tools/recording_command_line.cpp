// SPDX-License-Identifier: BSD-3-Clause
// The command lines for recordings and trajectories.
#include <string>
#include <vector>

#include "command_line.hpp"
#include "commands.hpp"
#include "rio/bag/dataset_presets.hpp"

namespace rio::tools {

using enum Trait;

namespace {

constexpr const char* kFolderOrBag = "folder in ASL/EuRoC layout, or a bag";
constexpr const char* kTrajectory = "TUM file, EuRoC csv, dataset folder or bag";

constexpr const char* kInit =
    "groundtruth, static or a file; by default groundtruth if there is one";

/// Options to read a bag, for every command that takes one.
/// @param truth with --truth, its topic
void add_recording_options(const Command& command, RecordingArguments* how, bool truth = true) {
  command.add(
      "--sensors", &how->sensors,
      "folder with imu0/sensor.yaml, radar0/sensor.yaml: mounting and noise, in place of those "
      "of the recording",
      CLI::ExistingDirectory);
  const Command of_a_bag = command.under("Of a bag");
  const CLI::IsMember axes({"flu", "ti", "rdf", "frd"});
  std::string names;
  for (const bag::DatasetPreset& preset : bag::dataset_presets()) {
    names += (names.empty() ? "" : ", ") + std::string(preset.name);
  }
  of_a_bag.add("--dataset", &how->dataset,
               "public data set, for what follows; --map and the command line win:\n" + names);
  of_a_bag.add("--map", &how->map,
               "file that says what follows, for recordings of one kind; the command line wins",
               CLI::ExistingFile);
  of_a_bag.add("--imu", &how->imu,
               "topic; by default the only sensor_msgs/Imu or px4_msgs/SensorCombined, or "
               "gyroscope and accelerometer on two");
  of_a_bag.add("--radar", &how->radar,
               "topic, or several with commas between; by default the only one with points and "
               "Doppler, or all of whose mountings /tf_static tells");
  of_a_bag.add("--pressure", &how->pressure,
               "topic; by default the only sensor_msgs/FluidPressure");
  if (truth) {
    of_a_bag.add("--truth", &how->truth,
                 "topic; by default the only geometry_msgs/PoseStamped or nav_msgs/Odometry");
  }
  of_a_bag.add("--points", &how->points,
               "fields of the points: ti, rio, mav, coloradar, mimosa, pointxyzi, msc, ars548, "
               "eagle or altos; by default guessed from their names");
  of_a_bag.add("--field", &how->fields,
               "one field, as doppler=rdot, snr=power*0.1, doppler=@12 (byte of a float), or\n"
               "doppler=rdot,velocity: the one that is there",
               kOneEach);
  of_a_bag.add(
      "--imu-clock", &how->imu_clock,
      "stamps: header, receive, carried (headers moved onto the receive clock), auto (default)",
      CLI::IsMember({"auto", "header", "receive", "carried"}));
  of_a_bag.add("--radar-clock", &how->radar_clock,
               "as --imu-clock; or trigger: headers of the messages of what triggers the scans",
               CLI::IsMember({"auto", "header", "receive", "carried", "trigger"}));
  of_a_bag.add("--trigger", &how->trigger, "topic; by default the only std_msgs/Header");
  of_a_bag.add("--trigger-match", &how->trigger_match,
               "the last trigger before a scan: sequence, of those with its number (default), or "
               "earlier, of all",
               CLI::IsMember({"sequence", "earlier"}));
  of_a_bag.add("--imu-offset", &how->imu_offset, "added to the stamps, as \"3 ms\"");
  of_a_bag.add("--radar-offset", &how->radar_offset, "added to the stamps, as \"-0.12 s\"");
  const Command of_files = command.under("Of a bag or a folder");
  of_files.add("--axes", &how->axes, "of the points: flu, ti, rdf or frd; wins over --points",
               axes);
  of_files.add("--approaching", &how->approaching, "the Doppler is positive towards the radar");
  of_files.add("--imu-axes", &how->imu_axes, "of the IMU, turned to flu: ti, rdf or frd", axes);
  of_files.add("--gyro-unit", &how->gyro_unit, "of the file, as deg/s");
  of_files.add("--accel-unit", &how->accel_unit,
               "of the file, as g; -g if it reads -1 at rest on the axis that is up");
}

constexpr const char* kOverTruth = "lay the estimates over the truth first: none, origin, yaw, se3";

CLI::Option* add_pose_topic(const Command& command, std::string* to,
                            const char* name = "--truth-topic") {
  return command.add(name, to, "topic, of a bag; by default the only one with poses");
}

CLI::Option* add_alignment(const Command& command, std::string* to, const char* what = kOverTruth) {
  return command.add("--align", to, what, CLI::IsMember({"none", "origin", "yaw", "se3"}), kShown);
}

void print_checked_options(const OptionsArguments& arguments) {
  const OptionValues& values = arguments.estimator;
  if (arguments.dataset.empty() && arguments.how != RecordingArguments{}) {
    throw CLI::ValidationError("options of a bag are given, but no --from");
  }
  if (arguments.dataset.empty() && !(values.config.empty() && values.set.empty())) {
    throw CLI::ValidationError("--config and --set need --from");
  }
  print_options(arguments);
}

}  // namespace

void add_info_command(CLI::App& app) {
  const Command command(app, "info",
                        "What is in a bag: topics, rates, clocks, fields of the points");
  command.add("FILE", command.runs(&info),
              "ROS 1 bag, MCAP, or .db3 of rosbag2; or a folder of its parts", kRequired);
}

void add_convert_command(CLI::App& app) {
  const Command command(app, "convert",
                        "Write a bag or a folder as a folder in ASL/EuRoC layout, or as MCAP");
  ConvertArguments* to = command.runs(&convert);
  command.add("FILE", &to->recording,
              "ROS 1 bag, MCAP, or .db3 of rosbag2; or a folder of its parts, or in ASL layout",
              kRequired);
  command.add("OUT", &to->out, "folder to write, or file *.mcap", kRequired);
  command.add("--force", &to->force,
              "overwrite a recording in OUT, with what was filled in there by hand");
  add_recording_options(command, &to->how);
}

void add_check_command(CLI::App& app) {
  const Command command(
      app, "check",
      "Is a recording what an estimator takes it to be? Stamps, units, Doppler, axes and delays,\n"
      "each ok, doubtful or wrong, with what to change. Exit status 3 if something is wrong");
  CheckArguments* to = command.runs(&check_recording);
  command.add("RECORDING", &to->dataset, kFolderOrBag, kRequired);
  add_option_values(command, &to->values,
                    "option file with what is known of the sensors, as the mounting");
  command.add("--json", &to->json, "print one JSON line instead of the sentences");
  add_recording_options(command, &to->how);
}

void add_replay_command(CLI::App& app) {
  const Command command(app, "replay", "Run a recording through the estimator");
  ReplayArguments* to = command.runs(&replay);
  command.add("RECORDING", &to->dataset, kFolderOrBag, kRequired);
  add_estimator_options(command, &to->estimator);
  command.add("--init", &to->init, kInit);
  command
      .add("--init-velocity", &to->init_velocity,
           "velocity of the start in the world [m/s]; its covariance stays")
      ->expected(3);
  add_path_files(command, &to->out, &to->states);
  add_view_options(command.under("What a person looks at"), &to->view);
  command.add("--barometer", &to->barometer, "use the heights of baro0, their offset estimated");
  command.add("--no-check", &to->no_check,
              "do not check the recording, as `rio check` does; steps of a clock stay in it");
  command.add("--json", &to->json, "print one JSON line instead of the summary");
  command.add("--verbose", &to->verbose, "a line per scan before the summary");
  command.add("--quiet", &to->quiet, "no line per scan, whatever else is given");
  add_recording_options(command, &to->how);
}

void add_evaluate_command(CLI::App& app) {
  const Command command(app, "evaluate", "Compare an estimated path with the true one");
  EvaluateArguments* to = command.runs(&evaluate);
  command.add("TRUTH", &to->truth, std::string(kTrajectory) + "; t x y z alone, too", kRequired);
  command.add("ESTIMATE", &to->estimates, "same formats; several give a table of a row each",
              kRequired);
  add_pose_topic(command, &to->truth_topic, "--truth-topic,--truth");
  add_pose_topic(command, &to->topic, "--topic");
  add_alignment(command, &to->align,
                "for MAE, RMSE, drift, yaw and tilt: none (as the papers), origin, yaw, se3");
  command.add("--json", &to->json, "print one JSON line an estimate");
  command.add("--max-diff", &to->max_diff,
              "largest difference of stamps if the truth is too sparse to interpolate [s]",
              kNotNegative, kShown);
  command.add("--truth-offset", &to->truth_offset,
              "added to the stamps of the truth, as \"-0.2 s\"");
  command.add("--mae-at", &to->mae_at,
              "also the norm of MAE up to this length of the true path [m]", kPositive);
}

void add_compare_command(CLI::App& app) {
  const Command command(
      app, "compare",
      "Runs of one recording side by side: presets, back-ends, options, other estimators");
  CompareArguments* to = command.runs(&compare);
  command.add(
      "RUN", &to->runs,
      "recordings, which are replayed, and trajectories (TUM, EuRoC csv, bags without an IMU)",
      kRequired);
  command.add("--preset", &to->presets, "several, separated by commas: a run with each", kOneEach)
      ->delimiter(',');
  command
      .add("--backend", &to->backends, "ekf, smoother or both, with a comma",
           CLI::IsMember({"ekf", "smoother"}), kOneEach)
      ->delimiter(',');
  command.add("--vary", &to->vary,
              "KEY=VALUE,VALUE,...: a run with each; several: every combination", kOneEach);
  add_option_values(command, &to->estimator, "option file; see `rio options`");
  command.add("--init", &to->init, kInit);
  command.add(
      "--truth", &to->truth,
      "true path: TUM file, EuRoC csv, dataset folder or bag; by default that of the recording");
  add_pose_topic(command, &to->truth_topic);
  add_alignment(command, &to->align);
  command.add("--report", &to->report, "page to write, HTML: table, paths, differences");
  add_recording_options(command, &to->how, false);
}

void add_plot_command(CLI::App& app) {
  const Command command(app, "plot", "Draw paths, heights and errors as an SVG file");
  PlotArguments* to = command.runs(&plot);
  command.add("ESTIMATE", &to->estimates, kTrajectory, kRequired);
  CLI::Option* truth =
      command.add("--truth", &to->truth, "true path: same formats; adds the errors");
  add_pose_topic(command, &to->truth_topic)->needs(truth);
  add_pose_topic(command, &to->topic, "--topic");
  command.add("--label", &to->labels, "names for the legend, one for each estimate");
  add_alignment(command, &to->align)->needs(truth);
  command.add("--out", &to->out, "SVG file to write", kRequired);
}

void add_fit_noise_command(CLI::App& app) {
  const Command command(app, "fit-noise", "Estimate the noise of the radar from a recording");
  FitNoiseArguments* to = command.runs(&fit_noise);
  command.add("RECORDING", &to->dataset, kFolderOrBag, kRequired);
  add_option_values(command, &to->values, "option file; its sigmas are where it starts");
  command.add("--init", &to->init, "static, groundtruth or a file", kShown);
  command.add("--no-truth", &to->no_truth,
              "hold the Doppler against the estimated velocity, not the true one");
  add_recording_options(command, &to->how);
}

void add_calibrate_command(CLI::App& app) {
  const Command command(
      app, "calibrate",
      "Estimate mounting, time offset and Doppler scale of the radar and the noise of the sensors");
  CalibrateArguments* to = command.runs(&calibrate);
  command.add(
      "RECORDING", &to->datasets,
      "folders in ASL/EuRoC layout, or bags, of one and the same mounting; each begins at rest",
      kRequired);
  command.add("--out", &to->out,
              "folder for the files to fly with: radar0/sensor.yaml, imu0/sensor.yaml");
  command.add("--overwrite", &to->overwrite, "replace sensor files in --out");
  add_option_values(command, &to->values, "option file; its calibration.* are the priors");
  command.add("--json", &to->json, "print one JSON line instead of the table");
  add_recording_options(command, &to->how);
}

void add_options_command(CLI::App& app) {
  const Command command(app, "options", "Print every option as a file to start from");
  OptionsArguments* to = command.runs(&print_checked_options);
  CLI::Option* preset =
      command
          .add("--preset", &to->estimator.preset,
               "default, published-ekf, published-smoother, published-uncertainty or doppler-only")
          ->default_str("default");
  CLI::Option* table =
      command.add("--compare", &to->compare, "the options in which the presets differ, as a table")
          ->excludes(preset);
  command
      .add("--from", &to->dataset,
           "the options that a replay of this folder or bag uses, sensor files and --config "
           "included")
      ->excludes(table);
  add_option_values(command, &to->estimator, "option file, as of `rio replay`");
  add_recording_options(command, &to->how);
}

}  // namespace rio::tools
