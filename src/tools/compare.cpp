// SPDX-License-Identifier: BSD-3-Clause
// `rio compare`: runs of one recording side by side, as a table and as a page.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "compare_page.hpp"
#include "evaluate.hpp"
#include "outputs.hpp"
#include "recording.hpp"
#include "replay.hpp"
#include "rio/bag/message_stream.hpp"
#include "rio/bag/messages.hpp"
#include "rio/eval/alignment.hpp"
#include "rio/eval/pairing.hpp"
#include "rio/io/trajectory.hpp"

namespace rio::tools {

namespace {

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

/// Whether a path is to be flown. A bag without an IMU, as `rio replay --mcap` writes it for
/// viewers, holds the poses of an estimate.
bool is_recording(const std::string& path) {
  if (io::is_dataset_folder(path)) return true;
  if (!bag::begins_as_recording(path)) return false;
  const auto stream = bag::open_messages(path);
  for (bag::Message message; stream->next(&message);) {
    if (bag::is_imu(stream->topics()[message.topic].type)) return true;
  }
  return false;
}

/// Of the runs, those that are to be flown.
using Recordings = std::set<std::string>;
Recordings recordings_of(const std::vector<std::string>& runs) {
  Recordings recordings;
  std::copy_if(runs.begin(), runs.end(), std::inserter(recordings, recordings.end()), is_recording);
  return recordings;
}

std::vector<Run> runs_of(const CompareArguments& arguments, const Recordings& recordings) {
  std::vector<Run> runs;
  std::string failed;  // why the last one did
  const auto variants = variants_of(arguments);
  for (const auto& variant : variants) {  // before the first one flies
    std::vector<std::string> ignored;
    (void)io::flown_options(variant.second, {}, {}, &ignored);
  }
  std::map<std::string, eval::Trajectory> files;
  for (const std::string& path : arguments.runs) {
    if (recordings.count(path) == 0) files[path] = path_of(path, {});
  }
  const EstimatorArguments& given = arguments.estimator;
  const bool flies = !variants.front().first.empty() || !given.config.empty() ||
                     !given.set.empty() || !arguments.init.empty() ||
                     arguments.how != RecordingArguments{};
  if (recordings.empty() && flies) {
    throw std::runtime_error(
        "presets, back-ends, settings, starts and sensors need a recording among the runs");
  }
  const std::vector<std::string> labels = default_labels(arguments.runs);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const std::string& path = arguments.runs[i];
    if (recordings.count(path) == 0) {
      runs.push_back({labels[i], files[path], {}, {}});
      continue;
    }
    for (const auto& [variant, estimator] : variants) {
      const std::string name = variant.empty()          ? labels[i]
                               : recordings.size() == 1 ? variant
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
eval::Trajectory common_truth(const CompareArguments& arguments, const Recordings& recordings) {
  if (!arguments.truth.empty())
    return path_of(arguments.truth, arguments.truth_topic, io::Attitude::kOptional);
  std::string why;
  for (const std::string& path : arguments.runs) {
    if (recordings.count(path) == 0) continue;
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
  const Recordings recordings = recordings_of(arguments.runs);
  const eval::Trajectory truth = common_truth(arguments, recordings);
  std::vector<Run> runs = runs_of(arguments, recordings);
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
