// SPDX-License-Identifier: BSD-3-Clause
// `rio check`: do the data of a recording agree with the assumptions of an estimator?
#include "findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>

#include "estimator_options.hpp"
#include "recording.hpp"

namespace rio::tools {

namespace {

using check::Finding;
using check::Verdict;

void print(const Finding& finding) {
  fmt::print("{:<9} {}: {}.\n", to_string(finding.verdict), finding.subject, finding.text);
  if (!finding.change.empty()) fmt::print("          -> {}\n", finding.change);
}

}  // namespace

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
  for (const std::string_view head : {"radar: {", "start: {"}) {
    std::string all;
    for (const Finding& f : not_ok(findings)) {
      if (f.change.rfind(head, 0) != 0) continue;
      int depth = 1;
      std::size_t end = head.size();
      for (; end < f.change.size() && depth > 0; ++end) {
        depth += f.change[end] == '{' ? 1 : f.change[end] == '}' ? -1 : 0;
      }
      all += (all.empty() ? "" : ", ") + f.change.substr(head.size(), end - 1 - head.size());
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
  const auto [findings, notes, damage] = run_check(arguments);
  print_notes(notes);
  const std::string options = proposed_options(findings);
  if (arguments.json) {
    const nlohmann::ordered_json all = {{"verdict", to_string(worst(findings))},
                                        {"findings", findings_json(findings)},
                                        {"options", options}};
    fmt::print("{}\n", all.dump());
  } else {
    for (const Finding& finding : findings) print(finding);
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

}  // namespace rio::tools
