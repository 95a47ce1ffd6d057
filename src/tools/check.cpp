// SPDX-License-Identifier: BSD-3-Clause
// `rio check`: is a recording what an estimator takes it to be?
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "check/check.hpp"
#include "commands.hpp"
#include "recording.hpp"
#include "rio/io/options_yaml.hpp"

namespace rio::tools {

namespace {

using check::Finding;
using check::Verdict;

void print(const Finding& finding) {
  fmt::print("{:<9} {}: {}.\n", to_string(finding.verdict), finding.subject, finding.text);
  if (!finding.change.empty()) fmt::print("          -> {}\n", finding.change);
}

void print_json(const check::Findings& findings) {
  nlohmann::json list = nlohmann::json::array();
  for (const Finding& f : findings) {
    list.push_back({{"verdict", to_string(f.verdict)},
                    {"subject", f.subject},
                    {"text", f.text},
                    {"change", f.change}});
  }
  const nlohmann::json all = {{"verdict", to_string(worst(findings))}, {"findings", list}};
  fmt::print("{}\n", all.dump());
}

}  // namespace

void check_recording(const CheckArguments& arguments) {
  std::string damage;
  const io::Dataset dataset = read_any(arguments.dataset, arguments.how, &damage);
  Options options;
  io::apply_sensor_info(dataset, &options);
  if (!arguments.config.empty()) io::load_option_values(arguments.config, &options);
  const check::Source source =
      is_asl_folder(arguments.dataset) ? check::Source::kFolder : check::Source::kBag;
  const check::Findings findings = check::check_recording(dataset, options, source);
  if (arguments.json) {
    print_json(findings);
  } else {
    for (const Finding& finding : findings) print(finding);
  }
  throw_damage(damage);
  const auto wrong = std::count_if(findings.begin(), findings.end(),
                                   [](const Finding& f) { return f.verdict == Verdict::kWrong; });
  if (wrong > 0) throw WrongRecording(fmt::format("{}: {} wrong", arguments.dataset, wrong));
}

}  // namespace rio::tools
