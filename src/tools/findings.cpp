// SPDX-License-Identifier: BSD-3-Clause
// `rio check`: do the data of a recording agree with the assumptions of an estimator?
#include "findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>

#include "estimator_options.hpp"
#include "json_line.hpp"
#include "progress.hpp"
#include "recording.hpp"
#include "replay_feed.hpp"

namespace rio::tools {

namespace {

using check::Finding;
using check::Verdict;

void add_notes(const check::ClockSteps& steps, const char* way_out,
               std::vector<std::string>* notes) {
  const auto add = [&](const std::vector<check::ClockStep>& of, const std::string& sensor,
                       const char* item) {
    for (const check::ClockStep& step : of) {
      notes->push_back(fmt::format(
          "the clock of {} steps by {:+.3f} s at {} {}: taken out of its later stamps{}", sensor,
          to_seconds(step.size), item, step.first + 1, way_out));
    }
  };
  add(steps.imu, "the IMU", "sample");
  for (std::size_t r = 0; r < steps.radars.size(); ++r) {
    add(steps.radars[r], fmt::format("radar{}", r), "scan");
  }
}

}  // namespace

check::Findings edits_of_converted(check::Findings findings) {
  for (Finding& f : findings) {
    const bool edits = f.change.find("/data.csv") != std::string::npos;
    if (edits && !f.change.starts_with("radar: {")) f.change.insert(0, "`rio convert`, then ");
  }
  return findings;
}

nlohmann::ordered_json findings_json(const check::Findings& findings) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Finding& f : findings) {
    list.push_back({{"verdict", to_string(f.verdict)},
                    {"subject", f.subject},
                    {"text", f.text},
                    {"change", f.change}});
  }
  return list;
}

std::string proposed_options(const check::Findings& findings) {
  std::string lines;
  for (const std::string_view head : {"radar: {", "start: {", "calibration: {"}) {
    std::string all;
    for (const Finding& f : not_ok(findings)) {
      const std::size_t at = f.change.find(head);
      // a mounting comes with the sigma of its prior, in the same sentence
      const bool with_mounting = at != std::string::npos && f.change.starts_with("radar: {T_BS");
      if (at != 0 && !with_mounting) continue;
      int depth = 1;
      const std::size_t begin = at + head.size();
      std::size_t end = begin;
      for (; end < f.change.size() && depth > 0; ++end) {
        depth += f.change[end] == '{' ? 1 : f.change[end] == '}' ? -1 : 0;
      }
      all += (all.empty() ? "" : ", ") + f.change.substr(begin, end - 1 - begin);
    }
    if (!all.empty()) lines += (lines.empty() ? "" : "\n") + std::string(head) + all + "}";
  }
  return lines;
}

void without_start(check::Findings* findings) {
  std::erase_if(*findings, [](const Finding& f) { return f.subject == "start"; });
}

check::Findings not_ok(check::Findings findings) {
  std::erase_if(findings, [](const Finding& f) { return f.verdict == Verdict::kOk; });
  return findings;
}

std::string findings_text(const check::Findings& findings) {
  std::string text;
  for (const Finding& f : findings) {
    text +=
        fmt::format("data {}: {}: {} -> {}\n", to_string(f.verdict), f.subject, f.text, f.change);
  }
  return text.empty() ? "data: nothing found\n" : text;
}

void print_wrong(check::Findings findings) {
  std::erase_if(findings, [](const Finding& f) { return f.verdict != Verdict::kWrong; });
  if (!findings.empty()) fmt::print(stderr, "{}", findings_text(findings));
}

Checked run_check(const CheckArguments& arguments) {
  const io::Dataset dataset = read_any(arguments.dataset, arguments.how);
  Options options;
  std::vector<std::string> notes = io::tell_sensors_and_values(dataset, arguments.values, &options);
  notes.insert(notes.begin(), dataset.notes.begin(), dataset.notes.end());
  check::Findings findings = findings_of(arguments.dataset, dataset, options);
  if (!dataset.ground_truth.empty()) without_start(&findings);  // it starts there
  return {std::move(findings), std::move(notes), dataset.damage};
}

void check_recording(const CheckArguments& arguments) {
  const auto [findings, notes, damage] = [&] {
    const Busy busy("checking");
    return run_check(arguments);
  }();
  print_notes(notes);
  const std::string options = proposed_options(findings);
  if (arguments.json) {
    const nlohmann::ordered_json all = {{"verdict", to_string(worst(findings))},
                                        {"findings", findings_json(findings)},
                                        {"options", options}};
    fmt::print("{}\n", json_line(all));
  } else {
    for (const Finding& f : findings) {
      fmt::print("{:<9} {}: {}.\n", to_string(f.verdict), f.subject, f.text);
      if (!f.change.empty()) fmt::print("          -> {}\n", f.change);
    }
    if (!options.empty()) fmt::print("As an option file, for --config:\n{}\n", options);
  }
  throw_damage(damage);
  const auto wrong = std::count_if(findings.begin(), findings.end(),
                                   [](const Finding& f) { return f.verdict == Verdict::kWrong; });
  if (wrong > 0) throw WrongResult(fmt::format("{}: {} wrong", arguments.dataset, wrong));
}

std::string no_start_text(const std::optional<check::Findings>& data) {
  std::string text =
      "no start: the estimator found no standstill, and start.max_wait or --init says nothing else";
  text += data ? "\n" + findings_text(*data) : "; `rio check` looks for the cause\n";
  text.pop_back();  // the end of its last line
  return text;
}

CheckedPart read_checked_part(io::RecordingStream* stream, const io::Dataset& sensors) {
  constexpr double kLongest = 600.1;              // ten minutes, and the error of a clock [s]
  constexpr double kPause = 1.0;                  // of the IMU, not counted [s]
  constexpr std::size_t kMostBytes = 20'000'000;  // of samples and scans
  CheckedPart part{{sensors, {}, {}}, std::nullopt};
  // reserved at once: a growing vector exists twice; untouched memory costs nothing
  part.data.imu.reserve(std::min(stream->outline().imu_samples, kMostBytes / sizeof(ImuSample)));
  for (const std::vector<Time>& stamps : stream->outline().scan_times) {
    part.data.radars.emplace_back().reserve(stamps.size(), kMostBytes / sizeof(check::Point));
  }
  std::size_t bytes = 0;
  double seconds = 0.0;
  const auto full = [&] { return bytes > kMostBytes || seconds > kLongest; };
  ReplayFeed feed(stream);
  while (!full()) {
    const ImuSample* sample = feed.imu();
    const std::optional<Time> due = feed.due();
    if (sample == nullptr && !due) break;
    if (due && (sample == nullptr || *due < sample->time)) {
      std::size_t radar = 0;
      const RadarScan& scan = feed.take_scan(&radar);
      bytes += check::Scans::bytes(scan);
      if (!full()) part.data.radars[radar].push_back(scan);
    } else {
      if (!part.data.imu.empty()) {
        const double step = to_seconds(sample->time) - to_seconds(part.data.imu.back().time);
        if (step > 0.0 && step < kPause) seconds += step;
      }
      bytes += sizeof(ImuSample);
      if (!full()) part.data.imu.push_back(*sample);
      feed.pass_imu();
    }
  }
  if (full()) part.seconds = seconds;
  stream->rewind();  // closes the files
  return part;
}

check::ClockSteps find_clock_steps(io::RecordingStream* stream, const io::Dataset& sensors,
                                   const Options& options, std::vector<std::string>* notes) {
  const io::RecordingOutline& outline = stream->outline();
  if (!outline.imu_odd && std::ranges::all_of(outline.scan_times, [](const auto& stamps) {
        return check::possible_steps(stamps).empty();
      })) {
    return {};
  }
  const CheckedPart part = read_checked_part(stream, sensors);
  check::ClockSteps steps =
      check::find_clock_steps(part.data.imu, part.data.radars, sensors.imu_info, options);
  add_notes(steps, " (--no-check flies them as recorded)", notes);
  return steps;
}

void take_out_clock_steps(const Options& options, io::Dataset* dataset) {
  std::vector<std::vector<RadarScan>*> radars = {&dataset->scans};
  for (io::Dataset::OtherRadar& other : dataset->other_radars) radars.push_back(&other.scans);
  std::vector<check::Scans> scans;
  for (const std::vector<RadarScan>* of : radars) scans.emplace_back(*of);
  const check::ClockSteps steps =
      check::find_clock_steps(dataset->imu, scans, dataset->imu_info, options);
  dataset->imu = check::without_steps(std::move(dataset->imu), steps.imu);
  for (std::size_t r = 0; r < radars.size(); ++r) {
    for (std::size_t i = 0; i < radars[r]->size(); ++i) {
      Time& stamp = (*radars[r])[i].time;
      stamp = check::without_steps(stamp, steps.radars[r], i);
    }
  }
  add_notes(steps, "", &dataset->notes);
}

}  // namespace rio::tools
