// SPDX-License-Identifier: BSD-3-Clause
// `rio compare`: runs of one recording side by side, as a table and as a page.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "evaluate.hpp"
#include "outputs.hpp"
#include "recording.hpp"
#include "replay.hpp"
#include "rio/bag/message_stream.hpp"
#include "rio/eval/alignment.hpp"
#include "rio/eval/metrics.hpp"
#include "rio/eval/pairing.hpp"
#include "rio/io/trajectory.hpp"
#include "view/page.hpp"

namespace rio::tools {

namespace {

/// One run: a recording with settings, or the file of another estimator.
struct Run {
  std::string name;
  eval::Trajectory poses;
  std::string verdict;  ///< of a replay
  std::string damage;   ///< of its recording
};

/// "KEY=1,2" as "KEY=1" and "KEY=2".
std::vector<std::string> settings_of(const std::string& vary) {
  const std::size_t equals = vary.find('=');
  if (equals == std::string::npos) {
    throw std::runtime_error("--vary " + vary + ": is not KEY=VALUE,VALUE,...");
  }
  std::vector<std::string> settings;
  int depth = 0;  // of brackets: the commas in them are of one value
  std::size_t begin = equals + 1;
  for (std::size_t at = begin; at <= vary.size(); ++at) {
    const char c = at < vary.size() ? vary[at] : ',';
    depth += c == '[' ? 1 : c == ']' ? -1 : 0;
    if (c != ',' || (depth > 0 && at < vary.size())) continue;
    settings.push_back(vary.substr(0, equals) + "=" + vary.substr(begin, at - begin));
    begin = at + 1;
  }
  return settings;
}

/// How the estimator runs: every combination of what is varied, each with its name.
std::vector<std::pair<std::string, EstimatorArguments>> variants_of(
    const CompareArguments& arguments) {
  std::vector<std::pair<std::string, EstimatorArguments>> all = {{"", arguments.estimator}};
  const auto multiply = [&all](const std::vector<std::string>& values, const auto& apply) {
    if (values.empty()) return;
    std::vector<std::pair<std::string, EstimatorArguments>> more;
    for (const auto& [name, estimator] : all) {
      for (const std::string& value : values) {
        more.emplace_back(name + (name.empty() ? "" : " ") + value, estimator);
        apply(&more.back().second, value);
      }
    }
    all = std::move(more);
  };
  multiply(arguments.presets, [](EstimatorArguments* e, const std::string& v) { e->preset = v; });
  multiply(arguments.backends, [](EstimatorArguments* e, const std::string& v) { e->backend = v; });
  for (const std::string& vary : arguments.vary) {
    multiply(settings_of(vary),
             [](EstimatorArguments* e, const std::string& v) { e->set.push_back(v); });
  }
  return all;
}

Run replay_of(const CompareArguments& arguments, const std::string& recording,
              const std::string& name, const EstimatorArguments& estimator) {
  ReplayArguments one;
  one.dataset = recording;
  one.how = arguments.how;
  one.estimator = estimator;
  one.init = arguments.init;
  one.findings = false;
  Run run{name, {}, {}, {}};
  ViewOutputs none({});
  const Replayed replayed = run_replay(one, &none, [&run](const Odometry& odometry) {
    const NavState& x = odometry.at_scan();
    if (run.poses.empty() || run.poses.back().time < x.time) {
      run.poses.push_back({x.time, x.p_WB, x.q_WB});
    }
  });
  run.verdict = replayed.summary.health.verdict();
  run.damage = replayed.damage;
  if (run.poses.empty()) throw std::runtime_error("no scan was used");
  return run;
}

bool is_recording(const std::string& path) {
  return io::is_dataset_folder(path) || bag::begins_as_recording(path);
}

std::vector<Run> runs_of(const CompareArguments& arguments) {
  std::vector<Run> runs;
  std::string failed;  // why the last one did
  const auto variants = variants_of(arguments);
  for (const auto& variant : variants) {  // before the first one flies
    std::vector<std::string> ignored;
    (void)io::flown_options(variant.second, {}, {}, &ignored);
  }
  std::map<std::string, eval::Trajectory> files;
  for (const std::string& path : arguments.runs) {
    if (!is_recording(path)) files[path] = io::read_trajectory(path);
  }
  const bool any = std::any_of(arguments.runs.begin(), arguments.runs.end(), is_recording);
  const EstimatorArguments& given = arguments.estimator;
  const bool flies = !variants.front().first.empty() || !given.config.empty() ||
                     !given.set.empty() || !arguments.init.empty() ||
                     arguments.how != RecordingArguments{};
  if (!any && flies) {
    throw std::runtime_error(
        "presets, back-ends, settings, starts and sensors need a recording among the runs");
  }
  const std::vector<std::string> labels = default_labels(arguments.runs);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const std::string& path = arguments.runs[i];
    if (!is_recording(path)) {
      runs.push_back({labels[i], files[path], {}, {}});
      continue;
    }
    for (const auto& [variant, estimator] : variants) {
      const bool alone =
          std::count_if(arguments.runs.begin(), arguments.runs.end(), is_recording) == 1;
      const std::string name = variant.empty() ? labels[i]
                               : alone         ? variant
                                               : labels[i] + " " + variant;
      fmt::print(stderr, "{} ...\n", name);
      try {
        runs.push_back(replay_of(arguments, path, name, estimator));
      } catch (const std::runtime_error& error) {
        failed = error.what();
        print_notes({name + " is left out: " + failed});
      }
    }
  }
  if (runs.empty()) throw std::runtime_error(failed);
  return runs;
}

/// The given truth, or that of the first recording that has one.
eval::Trajectory common_truth(const CompareArguments& arguments) {
  if (!arguments.truth.empty())
    return path_of(arguments.truth, arguments.truth_topic, io::Attitude::kOptional);
  std::string why;
  for (const std::string& path : arguments.runs) {
    if (!is_recording(path)) continue;
    try {
      return path_of(path, arguments.truth_topic, io::Attitude::kOptional);
    } catch (const std::runtime_error& error) {
      why = error.what();
    }
  }
  if (!arguments.truth_topic.empty()) {
    throw std::runtime_error(why.empty() ? "--truth-topic: no run is a recording" : why);
  }
  if (!why.empty()) print_notes({"no truth is known: " + why});
  return {};
}

/// Those of the truth, or of a run, at the times of another.
using PosesByTime = std::map<Time, eval::StampedPose>;
PosesByTime poses_of(const std::vector<eval::PosePair>& pairs) {
  PosesByTime poses;
  for (const eval::PosePair& pair : pairs) poses.emplace(pair.estimate.time, pair.truth);
  return poses;
}

constexpr auto kGap = std::chrono::milliseconds(1500);  // within it a run is interpolated

/// The run that lasts longest.
const eval::Trajectory& longest_of(const std::vector<Run>& runs) {
  const auto span = [](const Run& run) { return run.poses.back().time - run.poses.front().time; };
  return std::max_element(runs.begin(), runs.end(),
                          [&span](const Run& a, const Run& b) { return span(a) < span(b); })
      ->poses;
}

/// The runs as they are shown: paths, errors, and differences from the first.
view::Page page_of(const std::vector<Run>& runs, const eval::Trajectory& truth) {
  view::Page page;
  const eval::Trajectory& times = longest_of(runs);
  page.begin = times.front().time;
  const PosesByTime true_poses = poses_of(eval::associate(truth, times).pairs);
  const bool attitude = has_attitude(truth);
  std::vector<PosesByTime> there;  // of each run at those times
  const auto add = [&page](const eval::StampedPose& pose) {
    page.paths.back().add(to_seconds(pose.time - page.begin), pose.p, pose.q);
  };
  for (const Run& run : runs) {
    page.paths.push_back({run.name});
    for (const eval::StampedPose& pose : run.poses) add(pose);
    there.push_back(poses_of(eval::associate_interpolated(run.poses, times, kGap).pairs));
  }
  if (!truth.empty()) page.paths.push_back({"truth"});
  for (const auto& [time, pose] : true_poses) {
    page.paths.back().add(to_seconds(time - page.begin), pose.p);
  }

  for (const auto& [time, p, q] : times) {
    page.columns.start_row(to_seconds(time - page.begin));
    const auto known = true_poses.find(time);
    const auto first = there.front().find(time);
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const auto found = there[i].find(time);
      if (found == there[i].end()) continue;
      const eval::StampedPose& other = found->second;
      const std::string k = std::to_string(i);
      page.columns.set("z" + k, other.p.z());
      if (i > 0 && first != there.front().end()) {
        page.columns.set("d" + k, (other.p - first->second.p).norm());
        page.columns.set("y" + k, eval::yaw_error({first->second, other}));
      }
      if (known == true_poses.end()) continue;
      const eval::PosePair pair{known->second, other};
      page.columns.set("e" + k, (other.p - pair.truth.p).norm());
      if (!attitude) continue;
      page.columns.set("a" + k, eval::yaw_error(pair));
      page.columns.set("t" + k, eval::tilt_error(pair));
    }
  }
  const auto plot = [&](const std::string& title, const std::string& note, const char* column) {
    view::Plot out{"Over time", title, note, {}};
    for (std::size_t i = 0; i < runs.size(); ++i) {
      out.curves.push_back({runs[i].name, column + std::to_string(i)});
    }
    page.plots.push_back(std::move(out));
  };
  const std::string to_first = "from " + runs.front().name;
  plot("Position error [m]", "distance from the truth", "e");
  plot("Yaw error [deg]", "against the truth", "a");
  plot("Tilt error [deg]", "against the truth", "t");
  plot("Difference of position [m]", to_first, "d");
  plot("Difference of yaw [deg]", to_first, "y");
  plot("Height [m]", "", "z");
  return page;
}

/// Without a truth: what the runs say of themselves.
TextTable table_without_truth(const std::vector<Run>& runs) {
  TextTable rows = {
      {"run", "path [m]", "first to last [m]", "from the first run, at their last time [m]"}};
  for (const Run& run : runs) {
    double length = 0.0;
    for (std::size_t i = 1; i < run.poses.size(); ++i) {
      length += (run.poses[i].p - run.poses[i - 1].p).norm();
    }
    const auto both = eval::associate_interpolated(run.poses, runs.front().poses, kGap).pairs;
    rows.push_back(
        {run.name, fmt::format("{:.2f}", length),
         fmt::format("{:.3f}", (run.poses.back().p - run.poses.front().p).norm()),
         both.empty()
             ? "-"
             : fmt::format("{:.3f}", (both.back().truth.p - both.back().estimate.p).norm())});
  }
  return rows;
}

}  // namespace

std::vector<eval::PosePair> lay_over(const eval::Trajectory& truth, const std::string& align,
                                     eval::Trajectory* estimate) {
  std::vector<eval::PosePair> pairs = eval::associate(truth, *estimate).pairs;
  const Pose T = eval::find_alignment(pairs, *eval::alignment_kind(align)).transform;
  for (eval::StampedPose& pose : *estimate) pose = eval::transformed(T, pose);
  return eval::transformed(T, std::move(pairs));
}

void expect_common_time(const std::vector<NamedPath>& paths) {
  for (std::size_t i = 0; i < paths.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      const auto& [name_a, a] = paths[k];
      const auto& [name_b, b] = paths[i];
      if (std::max(a.front().time, b.front().time) <= std::min(a.back().time, b.back().time)) {
        continue;
      }
      throw std::runtime_error(fmt::format(
          "no time in common: {} is from {} s to {} s, {} from {} s to {} s; estimates of one "
          "recording in one clock can be compared",
          name_a, io::seconds_text(a.front().time), io::seconds_text(a.back().time), name_b,
          io::seconds_text(b.front().time), io::seconds_text(b.back().time)));
    }
  }
}

void compare(const CompareArguments& arguments) {
  std::vector<std::string> inputs = arguments.runs;
  inputs.push_back(arguments.truth);
  protect_inputs(inputs, {arguments.report});
  expect_folder(arguments.report);
  const eval::Trajectory truth = common_truth(arguments);
  std::vector<Run> runs = runs_of(arguments);
  std::vector<NamedPath> paths;
  for (const Run& run : runs) paths.emplace_back(run.name, run.poses);
  if (!truth.empty()) paths.emplace_back("the truth", truth);
  expect_common_time(paths);

  TextTable rows;
  if (truth.empty()) {
    rows = table_without_truth(runs);
  } else {
    eval::EvaluationOptions options;
    options.alignment = *eval::alignment_kind(arguments.align);
    std::vector<NamedEvaluation> all;
    for (Run& run : runs) {
      all.emplace_back(run.name, eval::evaluate(truth, run.poses, options));
      (void)lay_over(truth, arguments.align, &run.poses);
    }
    rows = comparison_table(all);
  }
  rows.front().emplace_back("verdict");
  for (std::size_t i = 0; i < runs.size(); ++i) rows[i + 1].push_back(runs[i].verdict);
  print_table(rows);
  if (!arguments.report.empty()) {
    view::Page page = page_of(runs, truth);
    page.title = "Comparison of " + std::to_string(runs.size()) + " runs";
    page.subtitle =
        truth.empty() ? "no truth is known" : "errors with alignment: " + arguments.align;
    page.tables.push_back({"Figures", rows});
    write_report(page, arguments.report);
  }
  for (const Run& run : runs) throw_damage(run.damage);
}

}  // namespace rio::tools
