// SPDX-License-Identifier: BSD-3-Clause
// Findings of `rio check` for recordings with a fault, and for those without.
#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "check/check.hpp"
#include "check/faults.hpp"
#include "experiment/experiment.hpp"
#include "experiment/recording.hpp"
#include "rio/io/simulation.hpp"
#include "rio/sim/catalogue.hpp"
#include "support/short_flight.hpp"

namespace rio::experiment {

namespace {

using check::Finding;
using check::Findings;
using check::Verdict;

Recording flown(const std::string& name, double length) {
  sim::Scenario scenario = test::scenario_named(name);
  scenario.path.length = length;
  return {name, "", io::dataset_of(sim::simulate_flight(scenario)), {}};
}

Findings checked(const io::Dataset& data) {
  Options options;
  io::apply_sensor_info(data, &options);
  return check::check_recording(data, options, check::Source::kBag);
}

/// The verdict that names the fault; else the other findings, in brackets.
std::string said_of(io::Dataset data, const check::Fault& fault) {
  fault.make(&data);
  const Findings findings = checked(data);
  const Finding* said = check::naming(findings, fault);
  if (said != nullptr) return to_string(said->verdict);
  for (const Finding& f : findings) {
    if (f.verdict == worst(findings) && f.verdict != Verdict::kOk) return "(" + f.subject + ")";
  }
  return "-";
}

/// The findings that are not ok, or "ok".
std::string said_of(const io::Dataset& data) {
  std::string text;
  for (const Finding& f : checked(data)) {
    if (f.verdict == Verdict::kOk) continue;
    text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", to_string(f.verdict), f.subject);
  }
  return text.empty() ? "ok" : text;
}

}  // namespace

Result checks(const Settings& settings) {
  // two flights and the real recordings are damaged, the flights of the catalogue are not
  std::vector<Recording> recordings = {flown("indoor-1", 50.0), flown("aggressive", 120.0)};
  if (!settings.data.empty()) {
    for (Recording& r : find_recordings(settings.data)) recordings.push_back(std::move(r));
  }
  const std::size_t columns = recordings.size();
  for (const sim::CatalogueEntry& entry : sim::catalogue()) {
    recordings.push_back(flown(entry.name, 40.0));
    recordings.back().name += ", 40 m";
  }
  const std::vector<check::Fault>& faults = check::faults();
  const std::size_t damaged = faults.size() * columns;
  std::vector<std::string> said(damaged + recordings.size());
  parallel_for(said.size(), settings.threads, settings.on_progress, [&](std::size_t i) {
    said[i] = i < damaged ? said_of(recordings[i % columns].data, faults[i / columns])
                          : said_of(recordings[i - damaged].data);
  });

  std::vector<std::string> head = {"fault"};
  for (std::size_t k = 0; k < columns; ++k) head.push_back(recordings[k].name);
  MarkdownTable table(head);
  std::string csv = "fault,recording,said\n";
  std::vector<std::size_t> named(columns);
  for (std::size_t f = 0; f < faults.size(); ++f) {
    std::vector<std::string> row = {faults[f].meaning};
    for (std::size_t k = 0; k < columns; ++k) {
      row.push_back(said[f * columns + k]);
      named[k] += row.back() == "wrong" || row.back() == "doubtful" ? 1U : 0U;
      csv += fmt::format("{},{},{}\n", faults[f].name, recordings[k].name, row.back());
    }
    table.add(row);
  }
  std::vector<std::string> sums = {"named"};
  for (const std::size_t n : named) sums.push_back(fmt::format("{} of {}", n, faults.size()));
  table.add(sums);
  MarkdownTable without({"recording", "verdict"});
  std::size_t fine = 0;
  for (std::size_t k = 0; k < recordings.size(); ++k) {
    const std::string& verdict = said[damaged + k];
    csv += fmt::format("none,{},{}\n", recordings[k].name, verdict);
    if (verdict != "ok") without.add({recordings[k].name, verdict});
    fine += verdict == "ok" ? 1U : 0U;
  }
  without.add({fmt::format("the other {}", fine), "ok"});
  const std::string text = fmt::format(
      "The verdict where it names the fault and proposes the right change; in brackets what else "
      "was not ok; - = nothing was.\n\n{}\nWithout a fault:\n\n{}",
      table.text(), without.text());
  return {text, {{"checks.csv", csv}}};
}

}  // namespace rio::experiment
