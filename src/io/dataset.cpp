// SPDX-License-Identifier: BSD-3-Clause
#include "rio/io/dataset.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "dataset_layout.hpp"
#include "decimal.hpp"
#include "doppler_grid.hpp"
#include "rio/io/csv.hpp"
#include "rio/io/scan_folder.hpp"
#include "sensor_rows.hpp"

namespace rio::io {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kEurocColumns = 17;  ///< of the ground truth

NavState truth_at(const CsvReader& rows) {
  NavState state;
  state.time = Time(rows.integer(0));
  state.p_WB = vector_at(rows, 1);
  const auto q = unit_quaternion(rows.number(4), rows.number(5), rows.number(6), rows.number(7));
  if (!q) rows.fail("not a unit quaternion");
  state.q_WB = *q;
  if (rows.columns() >= 11) state.v_WB = vector_at(rows, 8);
  if (rows.columns() == kEurocColumns) {  // the columns of a states file are its covariance here
    state.gyro_bias = vector_at(rows, 11);
    state.accel_bias = vector_at(rows, 14);
  }
  if (!(state.p_WB + state.v_WB + state.gyro_bias + state.accel_bias).allFinite()) {
    rows.fail("a value is not finite");
  }
  return state;
}

/// All of it is checked.
/// @param replay if given, what Truth::kStart keeps for it: the first state within the span of its
/// IMU, else the last one
std::vector<NavState> read_truth_file(const fs::path& path, std::size_t min_columns,
                                      const RecordingOutline* replay = nullptr) {
  CsvReader rows(path);
  rows.expect_names({"timestamp", "px", "py", "pz", "qw", "qx", "qy", "qz"});
  std::vector<NavState> states;
  std::optional<Time> last;
  bool within = false;
  while (rows.next()) {
    if (rows.columns() < min_columns) {
      rows.fail(fmt::format("has {} columns, {} are needed", rows.columns(), min_columns));
    }
    const NavState state = truth_at(rows);
    if (last && state.time <= *last) rows.fail("time does not increase");
    last = state.time;
    if (within) continue;
    if (replay != nullptr) {
      states.clear();
      within = state.time >= replay->imu_begin && state.time <= replay->imu_end;
    }
    states.push_back(state);
  }
  if (states.empty()) throw std::runtime_error(path.string() + ": holds no states");
  return states;
}

/// A file whose last line is cut is used up to there.
void note_cut(const std::string& cut, Dataset* sensors) {
  if (cut.empty()) return;
  sensors->damage += (sensors->damage.empty() ? "" : "\n") + cut;
}

/// @param back of them are stamped before the one above
void require_order(const fs::path& path, std::size_t stamps, std::size_t back) {
  if (back < 10 || 4 * back < stamps) return;
  throw std::runtime_error(
      fmt::format("{}: {} of {} stamps are before the one above: sort the rows by their stamps, "
                  "as with sort -s -t, -k1,1n",
                  path.string(), back, stamps));
}

/// Samples that are not finite are kept as recorded, and the first is noted. The span of the stamps
/// leaves out a corrupt first or last one, hours from its neighbour.
void survey_imu(const fs::path& path, RecordingOutline* outline) {
  ImuRows rows(path);
  ImuSample sample;
  int bad = 0;
  std::size_t back = 0;
  std::string first;
  Time before{0};
  constexpr double kCorrupt = 3600.0;  // [s]
  constexpr double kOdd = 0.05;        // [s]
  while (rows.next(&sample)) {
    const std::size_t earlier = outline->imu_samples++;
    const bool apart = std::abs(to_seconds(sample.time) - to_seconds(before)) > kCorrupt;
    if (earlier == 0 || (earlier == 1 && apart)) outline->imu_begin = sample.time;
    if (earlier <= 1) outline->imu_end = sample.time;
    if (!apart) outline->imu_end = std::max(outline->imu_end, sample.time);
    const bool odd =
        sample.time < before || std::abs(to_seconds(sample.time) - to_seconds(before)) > kOdd;
    outline->imu_odd = outline->imu_odd || (earlier > 0 && odd);
    back += earlier > 0 && sample.time < before ? 1 : 0;
    before = sample.time;
    if ((sample.gyro_B + sample.accel_B).allFinite()) continue;
    if (++bad == 1) first = rows.place();
  }
  note_cut(rows.cut(), &outline->sensors);
  if (outline->imu_samples == 0) throw std::runtime_error(path.string() + ": holds no samples");
  require_order(path, outline->imu_samples, back);
  if (bad > 0) {
    outline->sensors.notes.push_back(
        fmt::format("{}: not finite, the first of {} such samples", first, bad));
  }
}

/// The stamps of the scans.
std::vector<Time> survey_radar(const fs::path& path, DopplerGrid* grid, Dataset* sensors) {
  RadarRows rows(path);
  std::vector<Time> times;
  RadarScan scan;
  std::size_t back = 0;
  while (rows.next(&scan)) {
    back += !times.empty() && scan.time < times.back() ? 1 : 0;
    times.push_back(scan.time);
    grid->add(scan);
  }
  note_cut(rows.cut(), sensors);
  if (times.empty()) throw std::runtime_error(path.string() + ": holds no scans");
  require_order(path, times.size(), back);
  return times;
}

void survey_baro(const fs::path& path, RecordingOutline* outline) {
  BaroRows rows(path);
  BaroSample sample;
  while (rows.next(&sample)) ++outline->baro_samples;
  note_cut(rows.cut(), &outline->sensors);
}

/// Those behind a number that is missing, and those that are too many.
/// @param used their number
void note_radars_left_out(const fs::path& root, std::size_t used, std::vector<std::string>* notes) {
  constexpr std::size_t kNumbers = 10;
  const std::string why =
      used <= Options::kMaxOtherRadars
          ? "there is no " + radar_folder(used) + "; number the radars without a gap"
          : fmt::format("at most {} radars are used", used);
  for (std::size_t r = used; r < kNumbers; ++r) {
    const fs::path folder = root / radar_folder(r);
    if (fs::exists(folder)) notes->push_back(folder.string() + " is not read: " + why);
  }
}

/// A file cut between two rows looks complete to its reader; the other sensor reveals it.
void note_if_cut_short(const fs::path& root, RecordingOutline* outline) {
  // not of the difference, which may overflow
  const double ahead = to_seconds(outline->imu_end) - to_seconds(outline->scan_times[0].back());
  if (std::abs(ahead) < 1.0) return;
  outline->sensors.notes.push_back(fmt::format("{} ends {:.1f} s before {}",
                                               (root / (ahead > 0.0 ? kRadar : kImu)).string(),
                                               std::abs(ahead), ahead > 0.0 ? kImu : kRadar));
}

/// Found from the data, if the sensor file does not have it.
void survey_doppler_grid(const fs::path& folder, DopplerGrid* grid, RadarInfo* info,
                         std::vector<std::string>* notes) {
  std::optional<double>& step = info->doppler_resolution;
  if (step) return;
  step = grid->step([&folder](const auto& use) {
    RadarRows rows(folder / kData);
    RadarScan scan;
    while (rows.next(&scan) && use(scan)) {
    }
  });
  if (!step) return;
  notes->push_back(fmt::format("{}: no doppler_resolution_mps; the data has steps of {:.4f} m/s",
                               (folder / kSensor).string(), *step));
}

}  // namespace

RecordingOutline survey(const fs::path& root, Truth truth) {
  if (!fs::exists(root / kImu)) {
    throw std::runtime_error(root.string() +
                             ": a folder without a recording: no bag, and no imu0/data.csv and "
                             "radar0/data.csv, as CSV files are named (data/README.md)");
  }
  RecordingOutline outline;
  Dataset& sensors = outline.sensors;
  DopplerGrid grid;
  survey_imu(root / kImu / kData, &outline);
  outline.scan_times.push_back(survey_radar(root / kRadar / kData, &grid, &sensors));
  if (fs::exists(root / kBaro)) survey_baro(root / kBaro / kData, &outline);
  if (fs::exists(root / kTruth)) {
    sensors.ground_truth = read_truth_file(root / kTruth / kData, kEurocColumns,
                                           truth == Truth::kStart ? &outline : nullptr);
  }
  read_imu_info(root / kImu / kSensor, &sensors);
  read_radar_info(root / kRadar / kSensor, &sensors.radar_info, &sensors.notes);
  for (std::size_t r = 1; r <= Options::kMaxOtherRadars; ++r) {
    const fs::path folder = root / radar_folder(r);
    if (!fs::exists(folder)) break;
    DopplerGrid own_grid;
    outline.scan_times.push_back(survey_radar(folder / kData, &own_grid, &sensors));
    RadarInfo& info = sensors.other_radars.emplace_back().info;
    read_radar_info(folder / kSensor, &info, &sensors.notes);
    survey_doppler_grid(folder, &own_grid, &info, &sensors.notes);
  }
  note_radars_left_out(root, 1 + sensors.other_radars.size(), &sensors.notes);
  note_if_cut_short(root, &outline);
  survey_doppler_grid(root / kRadar, &grid, &sensors.radar_info, &sensors.notes);
  return outline;
}

bool is_asl_folder(const fs::path& path) {
  return fs::exists(path / kImu) || fs::exists(path / "mav0");
}

bool is_dataset_folder(const fs::path& path) {
  return is_asl_folder(path) || is_scan_folder(path);
}

Dataset read_dataset(const fs::path& path, Truth truth) {
  return collect(open_dataset(path, truth).get());
}

std::vector<NavState> read_ground_truth(const fs::path& path) {
  return read_truth_file(fs::is_directory(path) ? dataset_root(path) / kTruth / kData : path, 8);
}

}  // namespace rio::io
