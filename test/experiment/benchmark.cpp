// SPDX-License-Identifier: BSD-3-Clause
// Every recording found below a folder with both back-ends, one row each, as the field prints it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"
#include "experiment/parallel.hpp"
#include "experiment/recording.hpp"
#include "experiment/spread.hpp"
#include "rio/bag/dataset_presets.hpp"
#include "rio/bag/message_stream.hpp"
#include "rio/eval/evaluation.hpp"
#include "rio/eval/nees.hpp"
#include "rio/io/options_yaml.hpp"
#include "rio/io/trajectory.hpp"

namespace rio::experiment {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBackEnds = 2;
constexpr const char* kNames[kBackEnds] = {"filter", "smoother"};

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

std::vector<fs::path> recordings_below(const fs::path& folder) {
  if (!fs::is_directory(folder)) throw std::runtime_error(folder.string() + " is not a folder");
  if (is_recording(folder)) return {folder};
  std::vector<fs::path> found;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (is_recording(entry.path())) {
      found.push_back(entry.path());
    } else if (entry.is_directory()) {
      const std::vector<fs::path> below = recordings_below(entry.path());
      found.insert(found.end(), below.begin(), below.end());
    }
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
  io::Dataset data = io::is_dataset_folder(path) ? io::read_dataset(path)
                                                 : bag::read_recording(path, request).dataset;
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

std::vector<std::string> failure(const std::string& name, const std::string& estimator,
                                 std::string why) {
  std::replace(why.begin(), why.end(), '\n', ' ');
  std::replace(why.begin(), why.end(), '|', '/');
  return {name, estimator, "-", "-", "-", "-", "-", "-", "-", "failed: " + why};
}

std::vector<std::string> row(const std::string& name, const char* estimator,
                             const eval::Trajectory& truth, const Replay& replay) {
  if (replay.steps.empty()) return failure(name, estimator, "did not start");
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
  const bool judged = e.associated > 0;
  const double per_scan = 1e3 * replay.seconds / static_cast<double>(replay.steps.size());
  return {name,
          estimator,
          number(to_seconds(poses.back().time - poses.front().time), 1),
          number(e.path_length, 1),
          number(e.ape_yaw.translation.rmse, 3),
          number(e.rpe[1].drift.rmse, 2),
          number(e.final_drift * e.path_length / 100.0, 3),
          number(judged ? nees_of_position(truth, replay, poses) : eval::kNan, 2),
          number(per_scan, 3),
          verdict};
}

using Rows = std::vector<std::vector<std::string>>;

Rows rows_of(const fs::path& path, const std::string& name, const std::string& dataset) {
  Rows rows;
  try {
    const io::Dataset data = read(path, dataset);
    const eval::Trajectory truth = truth_of(path, data);
    Options options;
    io::apply_sensor_info(data, &options);
    const fs::path file = beside(path, {"options.yaml"}, {"_options.yaml"});
    if (!file.empty()) io::load_options(file, &options);
    for (const BackEnd back_end : {BackEnd::kEkf, BackEnd::kSmoother}) {
      options.backend = back_end;
      rows.push_back(row(name, kNames[rows.size()], truth, replay(data, options)));
    }
  } catch (const std::runtime_error& error) {
    while (rows.size() < kBackEnds) {
      rows.push_back(failure(name, kNames[rows.size()], error.what()));
    }
  }
  return rows;
}

}  // namespace

Result benchmark(const Settings& settings) {
  if (settings.data.empty()) throw std::runtime_error("benchmark needs --data, a folder");
  if (!settings.dataset.empty()) (void)bag::dataset_preset(settings.dataset);
  const fs::path folder = settings.data;
  const std::vector<fs::path> found = recordings_below(folder);
  if (found.empty()) throw std::runtime_error(settings.data + ": no recording below it");
  std::vector<Rows> rows(found.size());
  parallel_for(found.size(), settings.threads, settings.on_progress, [&](std::size_t i) {
    const std::string name =
        found[i] == folder ? folder.filename().string() : fs::relative(found[i], folder).string();
    rows[i] = rows_of(found[i], name, settings.dataset);
  });
  MarkdownTable table({"recording", "back-end", "time [s]", "distance [m]", "ATE [m]",
                       "RPE over 10 m [%]", "final error [m]", "NEES of position",
                       "time per scan [ms]", "verdict"});
  for (const Rows& of_recording : rows) {
    for (const std::vector<std::string>& each : of_recording) table.add(each);
  }
  Result result;
  result.markdown = fmt::format(
      "Preset default, static start. ATE (RMSE) and final error after alignment of yaw and\n"
      "position; RPE: RMSE in % of the distance; NEES of the position over 3, the start laid over\n"
      "the truth: 1 is consistent; time per scan with its IMU samples, {} at a time. - = no "
      "truth.\n"
      "\n{}",
      settings.threads, table.text());
  return result;
}

}  // namespace rio::experiment
