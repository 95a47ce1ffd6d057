// SPDX-License-Identifier: BSD-3-Clause
// The commands of the `rio` program: their arguments, and the functions that run them. The options
// are described in *_command_line.cpp. Every command throws std::runtime_error on failure.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "estimator_options.hpp"
#include "live/player.hpp"
#include "rio/eval/stamped_pose.hpp"
#include "rio/io/trajectory.hpp"

namespace rio::tools {

/// How to read a bag; of a folder only axes, units and sign. For empty values the map applies, else
/// the data set, else bag::RecordingRequest{}.
struct RecordingArguments {
  std::string dataset;  ///< of bag::dataset_presets()
  std::string map;      ///< file
  std::string imu;      ///< topics
  std::string radar;    ///< several with commas
  std::string pressure;
  std::string truth;
  std::string imu_clock;    ///< auto, header, receive, carried
  std::string radar_clock;  ///< or trigger
  std::string trigger;      ///< topic
  std::string trigger_match;
  std::string imu_offset;  ///< with a unit, or seconds
  std::string radar_offset;
  std::string imu_axes;
  std::string gyro_unit;
  std::string accel_unit;
  std::string points;  ///< preset of fields
  std::vector<std::string> fields;
  std::string axes;
  bool approaching = false;
  std::string sensors;  ///< folder with imu0/sensor.yaml, radar0/sensor.yaml
  bool operator==(const RecordingArguments&) const = default;
};

/// `rio info`: contents of a bag.
void info(const std::string& path);

/// `rio convert`: a recording as a folder in ASL layout, or as MCAP.
struct ConvertArguments {
  std::string recording;
  std::string out;
  bool force = false;
  RecordingArguments how;
};
void convert(const ConvertArguments& arguments);

/// The estimate is lost at its end, or a recording or configuration is wrong: exit status 3; all
/// other failures have 1. Thrown after all outputs are written.
struct WrongResult : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// What a run is shown in, besides its trajectory. Empty: not at all.
struct ViewArguments {
  std::string report;             ///< HTML page
  std::string log;                ///< folder of CSV files
  std::string mcap;               ///< file for viewers
  std::vector<std::string> also;  ///< TUM files of other estimates, for the viewers
  std::string port;               ///< of the live view; 0: any that is free
  std::string address = "127.0.0.1";
};

/// `rio replay`: a recording through the estimator.
struct ReplayArguments {
  std::string dataset;
  RecordingArguments how;
  EstimatorArguments estimator;
  std::string init;
  std::vector<double> init_velocity;
  std::string out;
  std::string states;
  ViewArguments view;
  bool barometer = false;  ///< the estimator uses the barometer of the dataset
  bool no_check = false;   ///< the recording is neither checked nor freed of steps of its clocks
  bool findings = true;    ///< what the check finds is wanted, unless no_check
  bool json = false;
  bool verbose = false;
  bool quiet = false;   ///< overrides verbose
  bool silent = false;  ///< neither lines nor notes nor progress on the terminal
};
void replay(const ReplayArguments& arguments);

/// `rio live`: sensors on ports through the estimator, to an autopilot, into a recording.
struct LiveArguments {
  std::vector<std::string> radars;  ///< ports
  std::string imu;                  ///< port
  std::string imu_format = "binary";
  std::string imu_clock = "own";
  std::string sensors;  ///< folder with imu0/sensor.yaml, radar0/sensor.yaml
  EstimatorArguments estimator;
  std::string radar_cfg;         ///< configuration of the radars
  std::vector<std::string> cli;  ///< ports to send it to, one per radar
  std::string out;               ///< TUM
  std::string states;
  std::string json_lines;
  ViewArguments view;
  std::vector<std::string> record;  ///< folders, and files *.mcap
  std::string mavlink;              ///< port
  double mavlink_rate = 30.0;
  int mavlink_system = 1;
  bool velocity_only = false;
  bool velocity_when_lost = false;  ///< velocity alone while the pose is lost
  double patience = std::numeric_limits<double>::infinity();  ///< wait for a lost port [s]
  double speed = 1.0;                                         ///< factor of the clock
  bool json = false;                                          ///< prints the summary as JSON
};
void live(const LiveArguments& arguments);

/// `rio check`: do the data of a recording agree with the assumptions of an estimator?
struct CheckArguments {
  std::string dataset;
  RecordingArguments how;
  OptionValues values;
  bool json = false;
};
void check_recording(const CheckArguments& arguments);

/// `rio ti-config`: is the configuration of a TI radar fit for odometry?
struct TiConfigArguments {
  std::string file;
  double speed = 5.0;       ///< of the vehicle [m/s]
  std::size_t points = 60;  ///< in a frame
  bool json = false;
};
void ti_config(const TiConfigArguments& arguments);

/// `rio bench`: cost of the estimator on this machine.
struct BenchArguments {
  std::size_t detections = 30;  ///< in a scan
  double seconds = 20.0;        ///< of simulated flight
  bool growth = false;          ///< over detections, landmarks, clones, window instead
  std::string out;              ///< SVG of the growth; empty: none
  bool json = false;
};
void measure_cost(const BenchArguments& arguments);

/// `rio simulate`: a simulated flight as a recording.
struct SimulateArguments {
  std::string out;
  std::string scenario;  ///< name or file; empty = the default scenario
  std::optional<std::uint64_t> seed;
  std::optional<double> length;
  std::string trajectory;
  std::size_t radars = 1;
  bool ideal = false;
  bool live = false;         ///< also plays it on pseudo-terminals
  double speed = 1.0;        ///< factor of time while it is played
  live::CableNoise cable{};  ///< its seed is ignored
};
void simulate(const SimulateArguments& arguments);
/// The same, prints nothing; for Python.
void run_simulate(const SimulateArguments& arguments);

/// `rio evaluate`: estimated paths against the true one.
struct EvaluateArguments {
  std::string truth;
  std::string truth_topic;  ///< if that is a bag
  std::vector<std::string> estimates;
  std::string topic;  ///< of those that are bags
  std::string align = "none";
  double max_diff = 0.01;
  double mae_at = std::numeric_limits<double>::quiet_NaN();
  std::string truth_offset;  ///< added to its stamps; empty: none
  bool json = false;
};
void evaluate(const EvaluateArguments& arguments);
/// Of any file or folder, or of a bag.
/// @param topic of a bag; empty: the only one; an error if it is no bag
eval::Trajectory path_of(const std::string& path, const std::string& topic,
                         io::Attitude attitude = io::Attitude::kRequired);
/// False of positions alone, and of nothing.
bool has_attitude(const eval::Trajectory& path);

/// `rio compare`: runs of one recording side by side.
struct CompareArguments {
  std::vector<std::string> runs;  ///< recordings, and trajectory files of any estimator
  RecordingArguments how;
  EstimatorArguments estimator;       ///< of the recordings
  std::vector<std::string> presets;   ///< a run with each
  std::vector<std::string> backends;  ///< same
  std::vector<std::string> vary;      ///< "KEY=VALUE,VALUE,...": same, every combination
  std::string init;
  std::string truth;
  std::string truth_topic;  ///< of any bag
  std::string align = "none";
  std::string report;  ///< HTML page
};
void compare(const CompareArguments& arguments);

/// `rio plot`: paths, heights and errors as a picture.
struct PlotArguments {
  std::vector<std::string> estimates;
  std::string topic;  ///< of those that are bags
  std::vector<std::string> labels;
  std::string truth;
  std::string truth_topic;  ///< if that is a bag
  std::string align = "none";
  std::string out;
};
void plot(const PlotArguments& arguments);

/// `rio fit-noise`: the noise of the radar from a recording.
struct FitNoiseArguments {
  std::string dataset;
  RecordingArguments how;
  OptionValues values;
  std::string init = "static";
  bool no_truth = false;
};
void fit_noise(const FitNoiseArguments& arguments);

/// `rio calibrate`: mounting, time offset, Doppler scale and noise from recordings.
struct CalibrateArguments {
  std::vector<std::string> datasets;
  RecordingArguments how;
  OptionValues values;
  std::string out;
  bool overwrite = false;
  bool json = false;
};
void calibrate(const CalibrateArguments& arguments);

/// `rio options`: every option with its meaning and the values of a preset, or those that a replay
/// of a recording flies with.
struct OptionsArguments {
  std::string dataset;  ///< empty: a preset
  RecordingArguments how;
  EstimatorArguments estimator;  ///< without a dataset the preset only
  bool compare = false;          ///< the options that differ between presets, as a table
};
void print_options(const OptionsArguments& arguments);

/// `rio scenarios`: the catalogue of simulated flights; with a name or a file that one as YAML.
void scenarios(const std::string& name_or_file);

}  // namespace rio::tools
