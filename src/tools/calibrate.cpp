// SPDX-License-Identifier: BSD-3-Clause
// `rio calibrate`: mounting, time offset and Doppler scale of the radar and the noise of the
// sensors from recordings, and the sensor files with the results.
#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "calibrate_report.hpp"
#include "commands.hpp"
#include "estimator_options.hpp"
#include "findings.hpp"
#include "recording.hpp"
#include "rio/core/so3.hpp"
#include "rio/io/dataset.hpp"
#include "view/calibration_names.hpp"

namespace rio::tools {

namespace fs = std::filesystem;

namespace {

using calibrate::Determination;

/// The folder that holds, or will hold, the sensor folders of `out`.
fs::path sensor_root(const fs::path& out) {
  return !fs::exists(out / "imu0") && fs::is_directory(out / "mav0") ? out / "mav0" : out;
}

/// Checked before the long computation.
void check_output(const CalibrateArguments& arguments) {
  if (arguments.out.empty()) {
    if (arguments.overwrite) throw std::runtime_error("--overwrite needs --out");
    return;
  }
  const fs::path root = sensor_root(arguments.out);
  if (fs::exists(root) && !fs::is_directory(root)) {
    throw std::runtime_error(root.string() + ": is not a folder");
  }
  if (arguments.overwrite) return;
  for (const char* sensor : {"radar0", "imu0"}) {
    const fs::path file = root / sensor / "sensor.yaml";
    if (fs::exists(file)) {
      throw std::runtime_error(file.string() + ": exists; --overwrite replaces it");
    }
  }
}

/// The first recording's mounting is the configured one; those of the others may differ by rounding
/// only.
void note_other_mounting(const io::Dataset& first, const io::Dataset& other,
                         const std::string& name, const Options& options,
                         std::vector<std::string>* notes) {
  if (!first.radar_info.T_BS || !other.radar_info.T_BS) return;
  const Pose& a = *first.radar_info.T_BS;
  const Pose& b = *other.radar_info.T_BS;
  const double turn = quaternion_log(a.rotation.conjugate() * b.rotation).norm();
  const double shift = (a.translation - b.translation).norm();
  if (turn <= options.calibration.rotation_sigma &&
      shift <= options.calibration.translation_sigma) {
    return;
  }
  notes->push_back(
      fmt::format("{} tells another T_BS ({:.1f} deg, {:.1f} cm): that of the first counts", name,
                  eval::kDegreesPerRadian * turn, 100.0 * shift));
}

std::vector<io::Dataset> read_all(const CalibrateArguments& arguments) {
  std::vector<io::Dataset> datasets;
  for (const std::string& name : arguments.datasets) {
    io::Dataset& dataset = datasets.emplace_back(read_any(name, arguments.how));
    Options options;  // what overrides what is noted once, later
    (void)io::tell_sensors_and_values(dataset, arguments.values, &options);
    take_out_clock_steps(options, &dataset);
    print_notes(dataset.notes);
    print_wrong(findings_of(name, dataset, options));
  }
  return datasets;
}

/// Contents of the radar's file afterwards.
io::RadarInfo radar_info(io::RadarInfo info, const CalibrateReport& report) {
  const RadarOptions& radar = report.radar.radar;
  const CalibrationOptions& priors = report.radar.priors;
  info.T_BS = radar.T_BS;
  info.time_offset = radar.time_offset;
  info.doppler_scale = radar.doppler_scale;
  info.prior_rotation = priors.rotation_sigma;
  info.prior_position = priors.translation_sigma;
  info.prior_time_offset = priors.time_offset_sigma;
  info.prior_doppler_scale = priors.doppler_scale_sigma;
  const std::array<std::optional<double>*, 4> sigmas = {&info.sigma_range, &info.sigma_azimuth,
                                                        &info.sigma_elevation, &info.sigma_doppler};
  for (std::size_t k = 0; k < sigmas.size(); ++k) {
    const calibrate::NoiseEstimate& noise = report.noise.radar[k];
    if (noise.verdict == Determination::kDetermined) *sigmas[k] = noise.value;
  }
  if (report.noise.radar[1].verdict == Determination::kDetermined) {
    info.weak_snr_db = report.noise.weak_snr_db;
  }
  return info;
}

void write_files(const CalibrateArguments& arguments, const io::Dataset& first,
                 CalibrateReport* report) {
  const fs::path root = sensor_root(arguments.out);
  const std::string comment =
      fmt::format("by `rio calibrate {}`", fmt::join(arguments.datasets, " "));
  io::write_radar_info(root, radar_info(first.radar_info, *report), comment);
  report->written.push_back((root / "radar0" / "sensor.yaml").string());
  const calibrate::SensorNoise& noise = report->noise;
  const bool gyro = exceeds_configured(noise.gyro, report->configured.imu.gyro_noise_density);
  const bool accel = exceeds_configured(noise.accel, report->configured.imu.accel_noise_density);
  io::ImuInfo imu = first.imu_info;
  const bool configured = imu.gyro_noise_density || imu.accel_noise_density;
  if (!gyro && !accel && !configured) return;  // the folder takes the place of the recording's
  if (gyro) imu.gyro_noise_density = noise.gyro.value;
  if (accel) imu.accel_noise_density = noise.accel.value;
  io::write_imu_info(root, imu, comment);
  report->written.push_back((root / "imu0" / "sensor.yaml").string());
}

}  // namespace

void calibrate(const CalibrateArguments& arguments) {
  check_output(arguments);
  const std::vector<io::Dataset> datasets = read_all(arguments);
  CalibrateReport report;
  report.datasets = arguments.datasets;
  report.configured = options_of(datasets.front(), arguments.values);
  std::vector<calibrate::Recording> recordings;
  for (std::size_t i = 0; i < datasets.size(); ++i) {
    recordings.push_back({datasets[i].imu, datasets[i].scans, std::nullopt, {}});
    if (!datasets[i].other_radars.empty()) {
      report.notes.push_back(fmt::format(
          "{}: the first of {} radars is calibrated; --radar TOPIC chooses one of a bag",
          arguments.datasets[i], datasets[i].other_radars.size() + 1));
    }
    note_other_mounting(datasets.front(), datasets[i], arguments.datasets[i], report.configured,
                        &report.notes);
  }
  const auto progress = [](const std::string& what) { fmt::print(stderr, "{}\n", what); };
  report.radar = calibrate::calibrate_radar(recordings, report.configured, progress);
  for (std::size_t i = 0; i < datasets.size(); ++i) {
    if (report.radar.recordings[i].velocity_resets == 0) continue;
    report.notes.push_back(fmt::format("{}: {} times the scans contradicted the velocity for long",
                                       arguments.datasets[i],
                                       report.radar.recordings[i].velocity_resets));
  }
  Options calibrated = report.configured;
  calibrated.radar = report.radar.radar;
  report.noise =
      calibrate::noise_over_recordings(recordings, report.radar.recordings, calibrated, progress);
  report.notes.insert(report.notes.end(), report.noise.notes.begin(), report.noise.notes.end());
  if (!arguments.out.empty()) write_files(arguments, datasets.front(), &report);
  fmt::print("{}", arguments.json ? report.json() + "\n" : report.text());
  for (const io::Dataset& dataset : datasets) throw_damage(dataset.damage);
}

}  // namespace rio::tools
