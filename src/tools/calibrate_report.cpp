// SPDX-License-Identifier: BSD-3-Clause
#include "calibrate_report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "json_line.hpp"
#include "view/calibration_names.hpp"

namespace rio::tools {

namespace {

using calibrate::Determination;
using Json = nlohmann::ordered_json;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// A line of the table, in display units.
struct Row {
  std::string name;
  const char* unit = "";
  double scale = 1.0;       ///< from SI
  double found = 0.0;       ///< SI, as all below
  double configured = 0.0;  ///< zero for a correction
  double sigma = 0.0;
  double prior = 0.0;    ///< 0 = none
  double apart = 0.0;    ///< halves, in sigmas
  double between = 0.0;  ///< recordings, in sigmas; NaN = not compared
  Determination verdict = Determination::kNotEstimated;
  std::string advice;
};

std::string advice(const calibrate::ParameterCalibration& p, const char* check) {
  switch (p.verdict) {
    case Determination::kDetermined:
      if (std::abs(p.value) > kCalibrationDoubt * p.prior) {
        return std::string("fly with it, but check ") + check;
      }
      return "fly with it";
    case Determination::kNotDetermined:
      return "configured value kept; record more turns and changes of speed, or measure it";
    case Determination::kContradictory:
      return std::string("configured value kept; check ") + check;
    case Determination::kNotEstimated:
      break;
  }
  return "";
}

std::string advice(const calibrate::NoiseEstimate& n) {
  if (n.verdict == Determination::kDetermined) return "fly with it";
  if (n.verdict == Determination::kContradictory) {
    return "configured value kept; the halves see different surroundings";
  }
  return "configured value kept; hidden by the grid, or too few points";
}

std::vector<Row> rows_of(const CalibrateReport& report) {
  std::vector<Row> rows;
  for (std::size_t i = 0; i < kCalibrationCount; ++i) {
    const calibrate::ParameterCalibration& p = report.radar.parameters[i];
    if (p.verdict == Determination::kNotEstimated) continue;
    const view::CalibrationName& n = view::kCalibrationNames[i];
    rows.push_back({.name = n.name,
                    .unit = n.unit,
                    .scale = n.scale,
                    .found = p.value,
                    .sigma = p.sigma,
                    .prior = p.prior,
                    .apart = p.halves_apart,
                    .between = report.datasets.size() > 1 ? p.recordings_apart : kUnknown,
                    .verdict = p.verdict,
                    .advice = advice(p, n.check)});
  }
  const auto add = [&rows](const char* name, const char* unit, double scale,
                           const calibrate::NoiseEstimate& n, double configured) -> Row& {
    return rows.emplace_back(Row{.name = name,
                                 .unit = unit,
                                 .scale = scale,
                                 .found = n.value,
                                 .configured = configured,
                                 .sigma = n.value * n.relative_error,
                                 .apart = n.halves_apart,
                                 .between = kUnknown,
                                 .verdict = n.verdict,
                                 .advice = advice(n)});
  };
  const auto add_imu = [&add](const char* name, const char* unit, double scale,
                              const calibrate::NoiseEstimate& n, double configured) {
    Row& row = add(name, unit, scale, n, configured);
    if (n.verdict == Determination::kDetermined && !exceeds_configured(n, configured)) {
      row.advice = "configured value kept; at rest there is no vibration";
    } else if (n.verdict == Determination::kNotDetermined) {
      row.advice = "configured value kept; no rest, or too short a one";
    }
  };
  const calibrate::SensorNoise& noise = report.noise;
  const RadarOptions& radar = report.configured.radar;
  const ImuOptions& imu = report.configured.imu;
  constexpr double kDegrees = eval::kDegreesPerRadian;
  add("sigma_range", "cm", 100.0, noise.radar[0], radar.sigma_range);
  add("sigma_azimuth", "deg", kDegrees, noise.radar[1], radar.sigma_azimuth);
  add("sigma_elevation", "deg", kDegrees, noise.radar[2], radar.sigma_elevation);
  add("sigma_doppler", "cm/s", 100.0, noise.radar[3], radar.sigma_doppler);
  add_imu("gyroscope_noise", "mdeg/s/rtHz", 1e3 * kDegrees, noise.gyro, imu.gyro_noise_density);
  add_imu("accelerometer_noise", "mm/s2/rtHz", 1e3, noise.accel, imu.accel_noise_density);
  return rows;
}

/// A number, or a dash if unknown.
std::string number(double value, int decimals) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : "-";
}

/// JSON has no NaN.
Json number_or_null(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json pose_json(const Pose& pose) {
  const Vector3d& p = pose.translation;
  const Quaternion& q = pose.rotation;
  return {{"translation_m", {p.x(), p.y(), p.z()}},
          {"quaternion_wxyz", {q.w(), q.x(), q.y(), q.z()}}};
}

Json run_json(const calibrate::MeasuredCalibration& run) {
  Json out = Json::object();
  for (std::size_t i = 0; i < kCalibrationCount; ++i) {
    if (run[i].sigma > 0.0) {
      out[view::kCalibrationNames[i].name] = {{"correction", run[i].value},
                                              {"sigma", run[i].sigma}};
    }
  }
  return out;
}

}  // namespace

std::string CalibrateReport::text() const {
  std::string out = fmt::format("{:<20} {:<12} {:>9} {:>9} {:>9} {:>9} {:>6} {:>7}  {:<15} {}\n",
                                "parameter", "unit", "configured", "found", "sigma", "prior",
                                "halves", "records", "verdict", "what to do");
  for (const Row& row : rows_of(*this)) {
    const bool found = row.found != 0.0 || row.prior > 0.0;
    out += fmt::format(
        "{:<20} {:<12} {:>9} {:>9} {:>9} {:>9} {:>6} {:>7}  {:<15} {}\n", row.name, row.unit,
        number(row.scale * row.configured, 2), found ? number(row.scale * row.found, 2) : "-",
        found ? number(row.scale * row.sigma, 2) : "-",
        row.prior > 0.0 ? number(row.scale * row.prior, 2) : "-", number(row.apart, 1),
        number(row.between, 1), to_string(row.verdict), row.advice);
  }
  out +=
      "mounting: corrections of what is configured, rotation about the radar's axes, position "
      "along those of the body\nhalves, records: how far halves of a recording, and recordings, "
      "are apart, in their sigmas\n";
  for (const std::string& note : notes) out += "note: " + note + "\n";
  for (const std::string& file : written) out += "written: " + file + "\n";
  return out;
}

std::string CalibrateReport::json() const {
  Json parameters = Json::object();
  for (const Row& row : rows_of(*this)) {
    parameters[row.name] = {{"told", row.configured},
                            {"found", number_or_null(row.found)},
                            {"sigma", number_or_null(row.sigma)},
                            {"prior_sigma", row.prior > 0.0 ? Json(row.prior) : Json(nullptr)},
                            {"halves_apart", number_or_null(row.apart)},
                            {"recordings_apart", number_or_null(row.between)},
                            {"verdict", to_string(row.verdict)},
                            {"advice", row.advice}};
  }
  Json recordings = Json::array();
  for (std::size_t i = 0; i < datasets.size(); ++i) {
    const calibrate::RecordingCalibration& r = radar.recordings[i];
    recordings.push_back({{"dataset", datasets[i]},
                          {"whole", run_json(r.whole)},
                          {"first_half", run_json(r.first)},
                          {"second_half", run_json(r.second)},
                          {"velocity_resets", r.velocity_resets}});
  }
  const Json all = {{"parameters", parameters},
                    {"T_BS", pose_json(radar.radar.T_BS)},
                    {"time_offset_s", radar.radar.time_offset},
                    {"doppler_scale", radar.radar.doppler_scale},
                    {"recordings", recordings},
                    {"notes", notes},
                    {"written", written}};
  return json_line(all);
}

}  // namespace rio::tools
