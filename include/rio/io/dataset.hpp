// SPDX-License-Identifier: BSD-3-Clause
// Recordings in the ASL/EuRoC layout: one folder per sensor with data.csv and sensor.yaml.
//
//   imu0/data.csv      t [ns], gyro x y z [rad/s], accel x y z [m/s^2]
//   radar0/data.csv    t [ns], x, y, z [m], doppler [m/s], snr [dB], noise [dB]: a row per
//                      detection; optional sigmas of range, azimuth, elevation, doppler
//   radar1, radar2, radar3                further radars on the same body               (optional)
//   baro0/data.csv     t [ns], pressure [Pa]                                            (optional)
//   state_groundtruth_estimate0/data.csv   t, p xyz, q wxyz, v xyz, bg xyz, ba xyz      (optional)
//
// Consecutive radar rows with one stamp form a scan; an empty scan is one row whose other fields
// are empty. The body frame is the IMU frame; T_BS of radar0/sensor.yaml is the radar's pose in it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rio/options.hpp"
#include "rio/types.hpp"

namespace rio::io {

/// Contents of imu0/sensor.yaml; units of ImuOptions.
struct ImuInfo {
  std::optional<double> rate_hz;
  std::optional<double> gyro_noise_density;
  std::optional<double> gyro_random_walk;
  std::optional<double> accel_noise_density;
  std::optional<double> accel_random_walk;
};

/// Contents of radar0/sensor.yaml; fields of view are full angles.
struct RadarInfo {
  std::optional<Pose> T_BS;
  std::optional<double> rate_hz;
  std::optional<double> max_range;           ///< [m]
  std::optional<double> max_doppler;         ///< unambiguous, of each sign [m/s]
  std::optional<double> range_resolution;    ///< [m]
  std::optional<double> doppler_resolution;  ///< [m/s]; found from the data if not given
  std::optional<double> fov_azimuth;         ///< [rad]
  std::optional<double> fov_elevation;       ///< [rad]
  std::optional<double> sigma_range;         ///< [m]
  std::optional<double> sigma_azimuth;       ///< [rad]
  std::optional<double> sigma_elevation;     ///< [rad]
  std::optional<double> sigma_doppler;       ///< [m/s]
  std::optional<double> weak_snr_db;         ///< for these sigmas [dB]
  std::optional<double> time_offset;         ///< stamps late by [s]
  std::optional<double> doppler_scale;       ///< range rates too large by this share
  /// Sigmas of CalibrationOptions, for T_BS, time offset and Doppler scale.
  std::optional<double> prior_rotation;       ///< per axis [rad]
  std::optional<double> prior_position;       ///< per axis [m]
  std::optional<double> prior_time_offset;    ///< [s]
  std::optional<double> prior_doppler_scale;  ///< relative
  /// Of a bag, for messages: the field of each quantity of its points, {"snr", "intensity*0.1"},
  /// and their axes, "flu".
  std::vector<std::pair<std::string, std::string>> fields{};
  std::string axes{};
  bool is_from_tree = false;  ///< T_BS is of /tf_static: of the messages, whatever axes they have
};

/// One barometer sample.
struct BaroSample {
  Time time{0};
  double pressure = 0.0;  ///< [Pa]
};

/// A recording, in file order: stamps may go backwards and values may be NaN, as they were
/// recorded.
struct Dataset {
  std::vector<ImuSample> imu;
  std::vector<RadarScan> scans;
  /// radar1, radar2, radar3: further radars on the same body.
  struct OtherRadar {
    std::vector<RadarScan> scans;
    RadarInfo info;  ///< missing keys are as for radar0; priors are those of radar0
  };
  std::vector<OtherRadar> other_radars;
  std::vector<BaroSample> baro;
  std::vector<NavState> ground_truth;
  ImuInfo imu_info;
  RadarInfo radar_info;
  std::vector<std::string> notes;  ///< messages for the user, such as a missing sensor.yaml
  /// Empty, or where a file is damaged: the recording ends there, in a folder the sensor.
  std::string damage;
};

/// All of the ground truth, or only the start of a replay: the first state within the span of the
/// IMU, else the last one.
enum class Truth : std::uint8_t { kAll, kStart };

/// Whether it is a folder of this layout, or has it in `mav0`.
bool is_asl_folder(const std::filesystem::path& path);
/// Whether read_dataset() reads it: the same, or one of scan_folder.hpp.
bool is_dataset_folder(const std::filesystem::path& path);
/// The folder that holds the sensor folders: `path`, or `mav0` inside it.
/// @throws std::runtime_error if `path` is not a folder
std::filesystem::path dataset_root(const std::filesystem::path& path);

/// Reads the folder, or `mav0` inside it, or one of scan_folder.hpp. Throws std::runtime_error,
/// with "FILE:LINE: ..." if a line is at fault, if anything is missing, empty or damaged: the
/// result is never silently shorter.
/// @param truth the part of the ground truth to keep; all of it is read and checked
Dataset read_dataset(const std::filesystem::path& path, Truth truth = Truth::kAll);

/// The contents of the sensor.yaml files below `path`, without data, for a live run. As many radars
/// as there are folders radar0, radar1, ...; a missing file is a note.
Dataset read_sensor_info(const std::filesystem::path& path);

/// The ground truth of a dataset folder, or of one of its csv files; at least eight columns
/// (t, p xyz, q wxyz), velocity and biases zero if absent. Stamps must strictly increase.
std::vector<NavState> read_ground_truth(const std::filesystem::path& path);

/// Writes the folders above below `path`. Reads back identically, T_BS to rounding; `notes` are not
/// written. Throws if a file cannot be written, if two neighbouring scans have one stamp, or if an
/// older recording there would mix with this one.
void write_dataset(const std::filesystem::path& path, const Dataset& dataset);

/// Writes imu0/sensor.yaml below `path`, in place of an older one; `comment` is a line at its top.
/// Throws if it cannot be written.
void write_imu_info(const std::filesystem::path& path, const ImuInfo& info,
                    const std::string& comment = {});
/// The same for radar0/sensor.yaml, or that of another radar.
void write_radar_info(const std::filesystem::path& path, const RadarInfo& info,
                      const std::string& comment = {}, std::size_t radar = 0);

/// Copies the sensor properties of the recording into options->imu and options->radar, and its
/// calibration priors where the options estimate the parameter. The limits of range and field of
/// view are widened by three sigmas, so that noise is not cut off. A radar sigma of zero, as of a
/// noise-free simulation, is not a noise model: the option keeps its value.
/// @param configured receives the keys of the options that were set
void apply_sensor_info(const Dataset& dataset, Options* options,
                       std::vector<std::string>* configured = nullptr);

/// The second half of the above: options->other_radars, each as options->radar except for the keys
/// of its own sensor file. For callers that changed options->radar in between.
void apply_other_radars(const Dataset& dataset, Options* options);

/// The keys of all options that sensor files can set.
std::vector<std::string> sensor_option_keys();

}  // namespace rio::io
