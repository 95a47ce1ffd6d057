// SPDX-License-Identifier: BSD-3-Clause
// Recordings against their simulated twins: where is the simulator easier than reality?
//
// A twin takes from its recording the directly measurable properties: rates, lost samples, rms of
// the vibration, grids, mounting, points a scan, the rest at both ends, and the path if there is a
// reference. Everything else is from the scenario: noise, surroundings, moving objects.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"
#include "experiment/recording.hpp"
#include "experiment/signature.hpp"
#include "experiment/spread.hpp"
#include "experiment/twin.hpp"
#include "experiment/witness.hpp"

namespace rio::experiment {

namespace {

constexpr const char* kScenario = "rough-ground";
constexpr double kDegrees = 180.0 / std::numbers::pi;

/// All compared figures.
struct Facts {
  ImuSignature imu;
  RadarSignature radar;
  Testimony seen;
};

Facts facts_of(const io::Dataset& data, const Motion& motion) {
  return {imu_signature(data, motion), radar_signature(data, motion), testimony(data, motion)};
}

/// Meaning of a larger value.
enum class Larger { kHarder, kKinder, kNeither };

/// One row of the table.
struct Row {
  std::string name;
  int decimals;
  Larger larger;
  std::function<double(const Facts&)> value;
};

void add_spectrum(const std::string& name, int decimals, double scale, Bands ImuSignature::*bands,
                  std::vector<Row>* rows) {
  rows->push_back({name, decimals, Larger::kHarder,
                   [=](const Facts& f) { return scale * rms_from(f.imu.*bands, 0); }});
  for (std::size_t i = 0; i < kBandEdges.size(); ++i) {
    const std::string band =
        i + 1 < kBandEdges.size()
            ? fmt::format("... {:.0f} to {:.0f} Hz", kBandEdges[i], kBandEdges[i + 1])
            : fmt::format("... above {:.0f} Hz", kBandEdges[i]);
    rows->push_back({band, decimals, Larger::kHarder,
                     [=](const Facts& f) { return scale * (f.imu.*bands)[i]; }});
  }
}

void add_quantiles(const std::string& name, int decimals, double scale, Larger larger,
                   Quantiles RadarSignature::*quantiles, std::vector<Row>* rows) {
  rows->push_back({name + ", 10 %", decimals, larger,
                   [=](const Facts& f) { return scale * (f.radar.*quantiles).low; }});
  rows->push_back({"... median", decimals, larger,
                   [=](const Facts& f) { return scale * (f.radar.*quantiles).median; }});
  rows->push_back({"... 90 %", decimals, larger,
                   [=](const Facts& f) { return scale * (f.radar.*quantiles).high; }});
}

std::vector<Row> rows_of_imu() {
  std::vector<Row> rows = {
      {"IMU rate [Hz]", 1, Larger::kKinder, [](const Facts& f) { return f.imu.rate_hz; }},
      {"samples missing [%]", 1, Larger::kHarder,
       [](const Facts& f) { return 100.0 * f.imu.missing; }},
      {"samples interpolated [%]", 1, Larger::kHarder,
       [](const Facts& f) { return 100.0 * f.imu.interpolated; }}};
  add_spectrum("accelerometer at rest, rms [m/s^2]", 3, 1.0, &ImuSignature::accel_rest, &rows);
  add_spectrum("accelerometer in motion, rms [m/s^2]", 2, 1.0, &ImuSignature::accel_moving, &rows);
  rows.push_back({"... rms of windows, 90 % over 10 %", 2, Larger::kHarder,
                  [](const Facts& f) { return f.imu.unsteadiness; }});
  rows.push_back({"... kurtosis of its changes", 1, Larger::kHarder,
                  [](const Facts& f) { return f.imu.kurtosis; }});
  add_spectrum("gyroscope at rest, rms [mrad/s]", 2, 1e3, &ImuSignature::gyro_rest, &rows);
  add_spectrum("gyroscope in motion, rms [mrad/s]", 1, 1e3, &ImuSignature::gyro_moving, &rows);
  return rows;
}

std::vector<Row> rows_of_radar() {
  std::vector<Row> rows = {
      {"radar rate [Hz]", 1, Larger::kKinder, [](const Facts& f) { return f.radar.rate_hz; }},
      {"scans late or lost [%]", 1, Larger::kHarder,
       [](const Facts& f) { return 100.0 * f.radar.late; }},
      {"empty scans [%]", 1, Larger::kHarder,
       [](const Facts& f) { return 100.0 * f.radar.empty; }}};
  add_quantiles("points a scan", 0, 1.0, Larger::kKinder, &RadarSignature::points, &rows);
  rows.push_back({"Doppler grid [m/s]", 3, Larger::kHarder,
                  [](const Facts& f) { return f.radar.doppler_grid; }});
  const Larger neither = Larger::kNeither;
  add_quantiles("Doppler in motion [m/s]", 2, 1.0, neither, &RadarSignature::speed, &rows);
  add_quantiles("range [m]", 2, 1.0, neither, &RadarSignature::range, &rows);
  add_quantiles("azimuth [deg]", 0, kDegrees, neither, &RadarSignature::azimuth, &rows);
  add_quantiles("elevation [deg]", 0, kDegrees, neither, &RadarSignature::elevation, &rows);
  add_quantiles("SNR [dB]", 1, 1.0, Larger::kKinder, &RadarSignature::snr_db, &rows);
  rows.push_back({"SNR over range [dB a decade]", 1, neither,
                  [](const Facts& f) { return f.radar.snr_range; }});
  rows.push_back({"Doppler zero at rest [% of points]", 1, Larger::kKinder,
                  [](const Facts& f) { return 100.0 * f.radar.still_at_rest; }});
  rows.push_back({"point found again at rest [%]", 1, Larger::kKinder,
                  [](const Facts& f) { return 100.0 * f.radar.repeated_at_rest; }});
  rows.push_back({"... in motion [%]", 1, Larger::kKinder,
                  [](const Facts& f) { return 100.0 * f.radar.repeated_moving; }});
  rows.push_back({"point of the vehicle itself [% of points in motion]", 1, Larger::kHarder,
                  [](const Facts& f) { return 100.0 * f.radar.rides_along; }});
  return rows;
}

std::vector<Row> rows_of_estimator() {
  return {
      {"scans with a consensus [%]", 1, Larger::kKinder,
       [](const Facts& f) { return 100.0 * f.seen.consensus; }},
      {"inliers [% of points]", 1, Larger::kKinder,
       [](const Facts& f) { return 100.0 * f.seen.inlier_share; }},
      {"Doppler innovation, rms [m/s]", 3, Larger::kHarder,
       [](const Facts& f) { return f.seen.doppler_rms; }},
      {"... NIS", 2, Larger::kHarder, [](const Facts& f) { return f.seen.doppler.mean_nis(); }},
      {"... gated [%]", 1, Larger::kHarder,
       [](const Facts& f) { return 100.0 * f.seen.doppler.gated_share(); }},
      {"... correlation from scan to scan", 2, Larger::kHarder,
       [](const Facts& f) { return f.seen.doppler_lag; }},
      {"... correlation of neighbours in a scan", 2, Larger::kHarder,
       [](const Facts& f) { return f.seen.neighbours; }},
      {"landmark matches a scan", 2, Larger::kKinder,
       [](const Facts& f) { return f.seen.landmarks_a_scan; }},
      {"... NIS", 2, Larger::kHarder, [](const Facts& f) { return f.seen.landmarks.mean_nis(); }},
      {"... after a pause of 1 s [%]", 2, Larger::kNeither,
       [](const Facts& f) { return 100.0 * f.seen.found_again_share; }},
      {"... NIS of these", 2, Larger::kHarder,
       [](const Facts& f) { return f.seen.found_again.mean_nis(); }},
      {"life of a landmark, median [s]", 2, Larger::kKinder,
       [](const Facts& f) { return f.seen.landmark_life; }},
      {"velocity replaced", 1, Larger::kHarder,
       [](const Facts& f) { return static_cast<double>(f.seen.velocity_resets); }}};
}

/// A recording and the figures of its twins, one per seed.
struct Pair {
  Facts recording;
  std::vector<Facts> twins;
};

/// Over the twins that have the figure.
double mean(const std::vector<Facts>& twins, const Row& row) {
  double sum = 0.0;
  double count = 0.0;
  for (const Facts& facts : twins) {
    const double value = row.value(facts);
    if (!std::isfinite(value)) continue;
    sum += value;
    count += 1.0;
  }
  return sum / count;
}

/// The twins against the recordings: by the median of the quotients.
std::string verdict(const std::vector<Pair>& pairs, const Row& row) {
  constexpr double kAlike = 1.25;
  if (row.larger == Larger::kNeither) return "";
  std::vector<double> quotients;
  for (const Pair& pair : pairs) {
    const double a = row.value(pair.recording);
    const double b = mean(pair.twins, row);
    const double q = a == b ? 1.0 : b / a;
    if (std::isfinite(a) && std::isfinite(b) && q >= 0.0) quotients.push_back(q);
  }
  const double q = Quantiles::of(quotients).median;
  if (std::isnan(q) || (q < kAlike && q > 1.0 / kAlike)) return "";
  return (q > 1.0) == (row.larger == Larger::kKinder) ? "kinder" : "harder";
}

std::string table_of(const std::vector<Recording>& recordings, const std::vector<Pair>& pairs,
                     const std::vector<Row>& rows) {
  std::vector<std::string> head = {"recording / twin"};
  for (const Recording& recording : recordings) head.push_back(recording.name);
  head.emplace_back("twin is");
  MarkdownTable table(head);
  for (const Row& row : rows) {
    std::vector<std::string> cells = {row.name};
    for (const Pair& pair : pairs) {
      cells.push_back(fmt::format("{} / {}", number(row.value(pair.recording), row.decimals),
                                  number(mean(pair.twins, row), row.decimals)));
    }
    cells.push_back(verdict(pairs, row));
    table.add(cells);
  }
  return table.text();
}

}  // namespace

Result twins(const Settings& settings) {
  std::vector<Recording> recordings;
  const auto add = [&recordings](const std::string& folder) {
    for (Recording& r : find_recordings(folder)) recordings.push_back(std::move(r));
  };
  if (!settings.data.empty()) add(settings.data);
  for (const std::string& folder : settings.recordings) add(folder);
  if (recordings.empty()) throw std::runtime_error("twins needs recordings: folders, or --data");
  const sim::Scenario base = scenario_of(settings.scenario.empty() ? kScenario : settings.scenario);

  std::vector<Pair> pairs(recordings.size());
  const auto seeds = static_cast<std::size_t>(std::max(1, settings.seeds));
  parallel_for(recordings.size(), settings.threads, settings.on_progress, [&](std::size_t i) {
    pairs[i].recording = facts_of(recordings[i].data, motion_of(recordings[i].data));
    for (std::size_t seed = 1; seed <= seeds; ++seed) {
      sim::Scenario scenario = base;
      scenario.seed = seed;
      const Twin twin = twin_of(recordings[i], scenario);
      pairs[i].twins.push_back(facts_of(twin.data, twin.motion));
    }
  });
  Result result;
  result.markdown = fmt::format(
      "Each cell: the recording / its twin in the scenario `{}`, which has the recording's rates, "
      "losses, vibration, grids,\nmounting and points a scan. Kinder, harder: by the median "
      "quotient "
      "over the recordings, beyond 1.25.\n\nIMU; rms per axis above 1 "
      "Hz:\n\n{}\nRadar:\n\n{}\nWhat "
      "the filter of `default` makes of it in motion:\n\n{}",
      settings.scenario.empty() ? kScenario : settings.scenario,
      table_of(recordings, pairs, rows_of_imu()), table_of(recordings, pairs, rows_of_radar()),
      table_of(recordings, pairs, rows_of_estimator()));
  return result;
}

}  // namespace rio::experiment
