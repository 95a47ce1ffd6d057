// SPDX-License-Identifier: BSD-3-Clause
// `rio check`: do the data of a recording agree with the assumptions of an estimator?
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "check/finding.hpp"
#include "commands.hpp"
#include "estimator_options.hpp"
#include "findings.hpp"
#include "notes.hpp"
#include "recording.hpp"

namespace rio::tools {

namespace {

using check::Finding;
using check::Verdict;

void print(const Finding& finding) {
  fmt::print("{:<9} {}: {}.\n", to_string(finding.verdict), finding.subject, finding.text);
  if (!finding.change.empty()) fmt::print("          -> {}\n", finding.change);
}

void print_json(const check::Findings& findings) {
  const nlohmann::ordered_json all = {{"verdict", to_string(worst(findings))},
                                      {"findings", findings_json(findings)},
                                      {"options", proposed_options(findings)}};
  fmt::print("{}\n", all.dump());
}

}  // namespace

Checked run_check(const CheckArguments& arguments) {
  std::string damage;
  const io::Dataset dataset = read_any(arguments.dataset, arguments.how, &damage);
  Options options;
  std::vector<std::string> notes = io::tell_sensors_and_values(dataset, arguments.values, &options);
  notes.insert(notes.begin(), dataset.notes.begin(), dataset.notes.end());
  check::Findings findings = findings_of(arguments.dataset, dataset, options);
  if (!dataset.ground_truth.empty()) without_start(&findings);  // it starts there
  return {std::move(findings), std::move(notes), std::move(damage)};
}

void check_recording(const CheckArguments& arguments) {
  const auto [findings, notes, damage] = run_check(arguments);
  print_notes(notes);
  if (arguments.json) {
    print_json(findings);
  } else {
    for (const Finding& finding : findings) print(finding);
    const std::string options = proposed_options(findings);
    if (!options.empty()) fmt::print("As an option file, for --config:\n{}\n", options);
  }
  throw_damage(damage);
  const auto wrong = std::count_if(findings.begin(), findings.end(),
                                   [](const Finding& f) { return f.verdict == Verdict::kWrong; });
  if (wrong > 0) throw WrongRecording(fmt::format("{}: {} wrong", arguments.dataset, wrong));
}

}  // namespace rio::tools
