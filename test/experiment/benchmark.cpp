// SPDX-License-Identifier: BSD-3-Clause
// Every recording found below a folder with both back-ends, one row each, as the field prints it.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"
#include "experiment/recording.hpp"
#include "rio/bag/dataset_presets.hpp"
#include "rio/bag/message_stream.hpp"
#include "rio/eval/evaluation.hpp"
#include "rio/eval/nees.hpp"
#include "rio/io/csv.hpp"
#include "rio/io/options_yaml.hpp"
#include "rio/io/trajectory.hpp"

namespace rio::experiment {

namespace {

namespace fs = std::filesystem;

constexpr std::pair<BackEnd, const char*> kBackEnds[] = {{BackEnd::kEkf, "filter"},
                                                         {BackEnd::kSmoother, "smoother"}};

/// A folder of files, a bag, or a folder of the parts of one bag.
bool is_recording(const fs::path& path) {
  if (io::is_dataset_folder(path)) return true;
  if (!bag::begins_as_recording(path)) return false;
  if (!fs::is_directory(path)) return true;
  const auto bags = std::count_if(fs::directory_iterator(path), {}, [](const auto& entry) {
    return entry.is_regular_file() && bag::begins_as_recording(entry.path());
  });
  if (bags < 2) return false;  // it is found by itself
  try {
    return bag::open_messages(path) != nullptr;
  } catch (const std::runtime_error&) {
    return false;  // holds several
  }
}

/// The path itself, or those below it, sorted.
std::vector<fs::path> recordings_below(const fs::path& path) {
  if (is_recording(path)) return {path};
  if (!fs::is_directory(path)) return {};
  std::vector<fs::path> found;
  for (const fs::directory_entry& entry : fs::directory_iterator(path)) {
    const std::vector<fs::path> below = recordings_below(entry.path());
    found.insert(found.end(), below.begin(), below.end());
  }
  std::sort(found.begin(), found.end());
  return found;
}

/// `name` inside of the recording, or beside it with its name before, as flight_1.tum.
fs::path beside(const fs::path& recording, const std::vector<std::string>& names,
                const std::vector<std::string>& ends) {
  const fs::path folder = fs::is_directory(recording) ? recording : recording.parent_path();
  for (const std::string& end : ends) {
    fs::path file = recording.parent_path() / (recording.stem().string() + end);
    if (fs::is_regular_file(file)) return file;
  }
  for (const std::string& name : names) {
    if (fs::is_regular_file(folder / name)) return folder / name;
  }
  return {};
}

eval::Trajectory truth_of(const fs::path& path, const io::Dataset& data) {
  const fs::path file =
      beside(path, {"truth.tum", "reference.tum", "gt_odom.txt", "utm50r_T_xt32.txt"},
             {".tum", ".txt", ".csv", "_gt.csv", "_pseudo_ground_truth.csv"});
  if (!file.empty()) return io::read_trajectory(file, io::TumOrder::kSorted);
  if (fs::exists(path / "groundtruth")) return io::read_trajectory(path);
  eval::Trajectory truth;
  for (const NavState& s : data.ground_truth) truth.push_back({s.time, s.p_WB, s.q_WB});
  return truth;
}

io::Dataset read(const fs::path& path, const std::string& dataset) {
  bag::RecordingRequest request;
  if (!dataset.empty()) request = bag::request_of(bag::dataset_preset(dataset));
  request.truth = true;
  io::Dataset data =
      io::is_dataset_folder(path) ? io::read_dataset(path) : bag::read_recording(path, request);
  if (!dataset.empty()) bag::take_mounting(bag::dataset_preset(dataset), &data.radar_info);
  return data;
}

/// Mean over the scans of the NEES of the position over 3, the start laid over the truth.
double nees_of_position(const eval::Trajectory& truth, const Replay& replay,
                        const eval::Trajectory& poses) {
  const std::vector<eval::PosePair> pairs = eval::associate(truth, poses).pairs;
  if (pairs.empty()) return eval::kNan;
  const eval::PosePair& first = pairs.front();
  const double yaw = eval::yaw_error(first) / eval::kDegreesPerRadian;
  const Matrix3d R = quaternion_exp(Vector3d(0.0, 0.0, -yaw)).toRotationMatrix();
  double sum = 0.0;
  std::size_t step = 0;
  for (const eval::PosePair& pair : pairs) {
    while (replay.steps[step].state.time < pair.estimate.time) ++step;
    const Vector3d error =
        R * (pair.estimate.p - first.estimate.p) - (pair.truth.p - first.truth.p);
    sum += eval::nees(error, R * replay.steps[step].P_position * R.transpose()) / 3.0;
  }
  return sum / static_cast<double>(pairs.size());
}

/// The cells behind recording and back-end.
using Cells = std::vector<std::string>;

Cells failure(std::string why) {
  std::replace(why.begin(), why.end(), '\n', ' ');
  std::replace(why.begin(), why.end(), '|', '/');
  return {"-", "-", "-", "-", "-", "-", "-", "failed: " + why};
}

Cells cells_of(const eval::Trajectory& truth, const Replay& replay) {
  if (replay.steps.empty()) return failure("did not start");
  const eval::Trajectory poses = poses_of(replay);
  eval::Evaluation e;
  e.path_length = eval::kNan;
  std::string verdict = replay.healthy ? "healthy" : "doubtful";
  if (replay.state == HealthState::kLost) verdict = "lost";
  try {
    if (!truth.empty()) e = eval::evaluate(truth, poses, {.alignment = eval::AlignmentKind::kYaw});
  } catch (const std::runtime_error& error) {
    verdict += std::string("; truth: ") + error.what();
  }
  const double nees = e.associated > 0 ? nees_of_position(truth, replay, poses) : eval::kNan;
  return {number(to_seconds(poses.back().time - poses.front().time), 1),
          number(e.path_length, 1),
          number(e.ape_yaw.translation.rmse, 3),
          number(e.rpe[1].drift.rmse, 2),
          number(e.final_drift * e.path_length / 100.0, 3),
          number(nees, 2),
          number(1e3 * replay.seconds / static_cast<double>(replay.steps.size()), 3),
          verdict};
}

/// For each back-end.
std::vector<Cells> rows_of(const fs::path& path, const std::string& dataset) {
  std::vector<Cells> rows;
  try {
    const io::Dataset data = read(path, dataset);
    const eval::Trajectory truth = truth_of(path, data);
    Options options;
    io::apply_sensor_info(data, &options);
    const fs::path file = beside(path, {"options.yaml"}, {"_options.yaml"});
    if (!file.empty()) io::parse_options(io::read_text(file), file.string(), &options);
    for (const auto& [back_end, name] : kBackEnds) {
      options.backend = back_end;
      rows.push_back(cells_of(truth, replay(data, options)));
    }
  } catch (const std::runtime_error& error) {
    rows.resize(std::size(kBackEnds), failure(error.what()));
  }
  return rows;
}

}  // namespace

Result benchmark(const Settings& settings) {
  if (settings.data.empty()) throw std::runtime_error("benchmark needs --data, a folder");
  if (!settings.dataset.empty()) (void)bag::dataset_preset(settings.dataset);
  const fs::path folder = settings.data;
  if (!fs::is_directory(folder)) throw std::runtime_error(settings.data + " is not a folder");
  const std::vector<fs::path> found = recordings_below(folder);
  if (found.empty()) throw std::runtime_error(settings.data + ": no recording below it");
  std::vector<std::vector<Cells>> rows(found.size());
  parallel_for(found.size(), settings.threads, settings.on_progress,
               [&](std::size_t i) { rows[i] = rows_of(found[i], settings.dataset); });
  MarkdownTable table({"recording", "back-end", "time [s]", "distance [m]", "ATE [m]",
                       "RPE over 10 m [%]", "final error [m]", "NEES of position",
                       "time per scan [ms]", "verdict"});
  for (std::size_t i = 0; i < found.size(); ++i) {
    const fs::path name = found[i] == folder ? folder.filename() : fs::relative(found[i], folder);
    for (std::size_t k = 0; k < rows[i].size(); ++k) {
      Cells row = {name.string(), kBackEnds[k].second};
      row.insert(row.end(), rows[i][k].begin(), rows[i][k].end());
      table.add(row);
    }
  }
  return {fmt::format(
      "Preset default, static start. ATE (RMSE) and final error after alignment of yaw and\n"
      "position; RPE: RMSE in % of the distance; NEES of the position over 3, the start laid over\n"
      "the truth: 1 is consistent; time per scan with its IMU samples, {} at a time. - = no "
      "truth.\n"
      "\n{}",
      settings.threads, table.text())};
}

}  // namespace rio::experiment
