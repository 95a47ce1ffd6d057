// SPDX-License-Identifier: BSD-3-Clause
#include "replay_summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "findings.hpp"
#include "json_line.hpp"
#include "plot/svg.hpp"

namespace rio::tools {

namespace {

using Json = nlohmann::ordered_json;

struct Statistics {
  double mean = 0.0;
  double median = 0.0;
  double p99 = 0.0;
  double max = 0.0;
};

/// Percentiles by nearest rank.
Statistics statistics(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto count = static_cast<double>(values.size());
  const auto percentile = [&](double share) {
    return values[static_cast<std::size_t>(std::max(0.0, std::ceil(share * count) - 1.0))];
  };
  return {std::accumulate(values.begin(), values.end(), 0.0) / count, percentile(0.5),
          percentile(0.99), values.back()};
}

Json to_json(const Statistics& s) {
  return {{"mean", s.mean}, {"median", s.median}, {"p99", s.p99}, {"max", s.max}};
}

double realtime_factor(const ReplaySummary& s) {
  return s.wall > Time{0} ? to_seconds(s.span) / to_seconds(s.wall) : 0.0;
}

Model model_at(std::size_t i) {
  return static_cast<Model>(i);
}

/// What a flight without faults has none of.
struct Irregular {
  const char* key;   ///< in JSON
  const char* what;  ///< after its number
  std::uint64_t count;
};

std::array<Irregular, 21> irregular(const ReplaySummary& s) {
  return {{
      {"scans_before_start", "scans before the start",
       static_cast<std::uint64_t>(s.scans_before_start)},
      {"scans_unprocessed", "scans after the last IMU sample were not processed",
       static_cast<std::uint64_t>(s.scans_unprocessed)},
      {"scans_late", "late scans", s.counters.scans_late},
      {"scans_ahead", "scans stamped too far ahead of the IMU", s.counters.scans_ahead},
      {"scans_duplicate", "duplicate scans", s.counters.scans_duplicate},
      {"scans_overflow", "scans lost because the queue was full", s.counters.scans_overflow},
      {"scans_non_finite", "scans without a finite detection", s.counters.scans_non_finite},
      {"detections_non_finite", "detections not finite, or beyond what any radar measures",
       s.counters.detections_non_finite},
      {"imu_stale", "IMU samples not newer than the one before", s.counters.imu_stale},
      {"imu_ahead", "IMU samples stamped too far ahead", s.counters.imu_ahead},
      {"clock_restarts", "times the clock of the sensors started again", s.counters.clock_restarts},
      {"radar_clock_steps", "times the clock of a radar stepped", s.counters.radar_clock_steps},
      {"imu_non_finite", "IMU samples not finite", s.counters.imu_non_finite},
      {"imu_out_of_range", "IMU samples out of range", s.counters.imu_out_of_range},
      {"imu_frozen", "IMU samples frozen", s.counters.imu_frozen},
      {"imu_gaps", "gaps of the IMU", s.counters.imu_gaps},
      {"updates_failed", "updates failed", s.counters.updates_failed},
      {"velocity_resets", "times the scans contradicted the velocity for long",
       s.counters.velocity_resets},
      {"attitude_resets", "times the scans contradicted attitude or biases",
       s.counters.attitude_resets},
      {"position_reopened", "times the sigma of the position was widened after doubtful scans",
       s.counters.position_reopened},
      {"restarts", "times the tilt was lost and found again", s.counters.restarts},
  }};
}

}  // namespace

std::string start_name(const Counters& counters) {
  return counters.moving_starts > 0 ? "in motion" : "static";
}

void ReplaySummary::add(const UpdateReport& report, const NavState& state) {
  int rows_used = 0;
  for (std::size_t i = 0; i < kModelCount; ++i) {
    models[i].rows_used += report.models[i].rows_used;
    models[i].rows_gated += report.models[i].rows_gated;
    models[i].nis += report.models[i].nis;
    rows_used += report.models[i].rows_used;
  }
  if (scans == 0) first_position = last_position = state.p_WB;
  if (scans == 0 || state.time != last_time) {  // of several scans at one time the last counts
    length_before = path_length;
    position_before = last_position;
  }
  last_time = state.time;
  last_position = state.p_WB;
  path_length = length_before + (last_position - position_before).norm();
  fastest = std::max(fastest, state.v_WB.norm());
  farthest = std::max(farthest, (state.p_WB - first_position).norm());
  ++scans;
  if (rows_used > 0) ++updates;
  update_ms.push_back(1e3 * to_seconds(report.update_time));
  propagation_ms.push_back(1e3 * to_seconds(report.propagation_time));
  if (calibration.size() <= report.radar) calibration.resize(report.radar + 1);
  calibration[report.radar] = report.calibration;
  clones = report.clones;
  landmarks = report.landmarks;
}

bool ReplaySummary::is_absurd() const {
  constexpr double kSound = 340.0;  // [m/s]
  return fastest > kSound || farthest > kSound * to_seconds(span);
}

double ReplaySummary::height_nis() const {
  const ModelReport& aiding = models[static_cast<std::size_t>(Model::kAiding)];
  return aiding.nis / std::max(1, aiding.rows_used);
}

std::string ReplaySummary::json() const {
  Json by_model;
  for (std::size_t i = 0; i < kModelCount; ++i) {
    by_model[to_string(model_at(i))] = {{"rows_used", models[i].rows_used},
                                        {"rows_gated", models[i].rows_gated}};
  }
  Json calibrated = Json::object();
  for (const CalibrationLine& line : calibration_lines(calibration)) {
    const CalibrationReport& c = line.report;
    calibrated[line.name] = {
        {"correction", c.value}, {"sigma", c.sigma}, {"verdict", to_string(c.observability)}};
  }
  Json counted = {{"imu_samples", counters.imu_samples}};
  for (const Irregular& i : irregular(*this)) counted[i.key] = i.count;
  const Vector3d& p = last_position;
  Json all = {
      {"verdict", health.verdict()},
      {"health", health.json()},
      {"scans", scans},
      {"updates", updates},
      {"initialised_by", initialised_by},
      {"update_ms", to_json(statistics(update_ms))},
      {"propagation_ms", to_json(statistics(propagation_ms))},
      {"realtime_factor", realtime_factor(*this)},
      {"duration_s", to_seconds(span)},
      {"models", by_model},
      {"calibration", calibrated},
      {"clones", clones},
      {"landmarks", landmarks},
      {"final_position_m", {p.x(), p.y(), p.z()}},
      {"first_to_last_m", (last_position - first_position).norm()},
      {"path_length_m", path_length},
      {"counters", counted},
  };
  if (height_offset) {
    all["barometer"] = {{"offset_m", height_offset->value[0]},
                        {"sigma_m", std::sqrt(height_offset->covariance(0, 0))},
                        {"nis", height_nis()}};
  }
  if (data) all["data"] = findings_json(*data);
  if (data && checked_seconds) all["data_checked_s"] = *checked_seconds;
  return json_line(all);
}

std::string ReplaySummary::text() const {
  const Statistics update = statistics(update_ms);
  const Statistics propagation = statistics(propagation_ms);
  std::string out = fmt::format(
      "{} scans, {} with an update; start: {}\n"
      "path {:.2f} m, first to last position {:.3f} m, end at [{} {} {}] m\n",
      scans, updates, initialised_by, path_length, (last_position - first_position).norm(),
      plot::fixed(last_position.x(), 3), plot::fixed(last_position.y(), 3),
      plot::fixed(last_position.z(), 3));
  for (std::size_t i = 0; i < kModelCount; ++i) {
    if (models[i].rows_used + models[i].rows_gated == 0) continue;
    out += fmt::format("{}: {} rows used, {} gated\n", to_string(model_at(i)), models[i].rows_used,
                       models[i].rows_gated);
  }
  if (height_offset) {
    out += fmt::format("barometer: offset {} +- {:.2f} m at the end, NIS {:.2f} a row\n",
                       plot::signed_fixed(height_offset->value[0], 2),
                       std::sqrt(height_offset->covariance(0, 0)), height_nis());
  }
  out += fmt::format(
      "update {:.3f} ms mean, {:.3f} p99, {:.3f} max; propagation {:.3f} ms mean; {:.0f} x real "
      "time\n",
      update.mean, update.p99, update.max, propagation.mean, realtime_factor(*this));

  for (const auto& [name, unit, scale, c, check] : calibration_lines(calibration)) {
    out += fmt::format("{}: {} {} +- {:.2f} (prior {:.2f}), {}\n", name,
                       plot::signed_fixed(scale * c.value, 2), unit, scale * c.sigma,
                       scale * c.prior_sigma, to_string(c.observability));
    if (!check.empty()) out += fmt::format("  check {}\n", check);
  }

  for (const auto& [key, what, count] : irregular(*this)) {
    if (count > 0) out += fmt::format("{} {}\n", count, what);
  }
  if (data && checked_seconds) {
    out += fmt::format("data: the first {:.0f} s are checked; `rio check` looks at all of it\n",
                       *checked_seconds);
  }
  if (data) out += findings_text(*data);
  out += fmt::format("verdict: {}\n", health.verdict());
  return out;
}

}  // namespace rio::tools
