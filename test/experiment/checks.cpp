// SPDX-License-Identifier: BSD-3-Clause
// Findings of `rio check` for recordings with a fault, and for those without.
#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "check/check.hpp"
#include "check/faults.hpp"
#include "experiment/experiment.hpp"
#include "experiment/recording.hpp"
#include "rio/io/flight_dataset.hpp"
#include "rio/sim/catalogue.hpp"
#include "rio/sim/flight.hpp"

namespace rio::experiment {

namespace {

using check::Finding;
using check::Findings;
using check::Verdict;

struct Healthy {
  std::string name;
  io::Dataset data;
};

Healthy flown(const std::string& name, double length) {
  sim::Scenario scenario;
  if (!sim::scenario(name, &scenario)) throw std::runtime_error("no such scenario: " + name);
  scenario.path.length = length;
  return {name, io::dataset_of(sim::simulate_flight(scenario))};
}

Findings checked(const io::Dataset& data) {
  Options options;
  io::apply_sensor_info(data, &options);
  return check::check_recording(data, options, check::Source::kBag);
}

/// Two flights, and every real recording.
std::vector<Healthy> to_damage(const std::string& folder) {
  std::vector<Healthy> all;
  all.push_back(flown("indoor-1", 50.0));
  all.push_back(flown("aggressive", 120.0));
  if (folder.empty()) return all;
  for (Recording& recording : find_recordings(folder)) {
    all.push_back({recording.name, std::move(recording.data)});
  }
  return all;
}

/// The verdict that names the fault; else the other findings, in brackets.
std::string said_of(const Healthy& healthy, const check::Fault& fault) {
  io::Dataset damaged = healthy.data;
  fault.make(&damaged);
  const Findings findings = checked(damaged);
  const Finding* said = check::naming(findings, fault);
  if (said != nullptr) return to_string(said->verdict);
  for (const Finding& f : findings) {
    if (f.verdict == worst(findings) && f.verdict != Verdict::kOk) return "(" + f.subject + ")";
  }
  return "-";
}

/// The findings that are not ok, or "ok".
std::string said_of(const Healthy& healthy) {
  std::string text;
  for (const Finding& f : checked(healthy.data)) {
    if (f.verdict == Verdict::kOk) continue;
    text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", to_string(f.verdict), f.subject);
  }
  return text.empty() ? "ok" : text;
}

}  // namespace

Result checks(const Settings& settings) {
  const std::vector<Healthy> recordings = to_damage(settings.data);
  const std::vector<check::Fault>& faults = check::faults();
  const std::vector<sim::CatalogueEntry>& catalogue = sim::catalogue();
  const std::size_t columns = recordings.size();
  const std::size_t damaged = faults.size() * columns;
  std::vector<std::string> said(damaged + columns + catalogue.size());
  parallel_for(said.size(), settings.threads, settings.on_progress, [&](std::size_t i) {
    if (i < damaged) {
      said[i] = said_of(recordings[i % columns], faults[i / columns]);
    } else if (i < damaged + columns) {
      said[i] = said_of(recordings[i - damaged]);
    } else {
      said[i] = said_of(flown(catalogue[i - damaged - columns].name, 40.0));
    }
  });

  std::vector<std::string> head = {"fault"};
  for (const Healthy& healthy : recordings) head.push_back(healthy.name);
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
  for (std::size_t i = damaged; i < said.size(); ++i) {
    const std::string name = i < damaged + columns
                                 ? recordings[i - damaged].name
                                 : std::string(catalogue[i - damaged - columns].name) + ", 40 m";
    csv += fmt::format("none,{},{}\n", name, said[i]);
    if (said[i] != "ok") without.add({name, said[i]});
    fine += said[i] == "ok" ? 1U : 0U;
  }
  without.add({fmt::format("the other {}", fine), "ok"});
  Result result;
  result.markdown = fmt::format(
      "The verdict where it names the fault and proposes the right change; in brackets what else "
      "was not ok; - = nothing was.\n\n{}\nWithout a fault:\n\n{}",
      table.text(), without.text());
  result.attachments.push_back({"checks.csv", csv});
  return result;
}

}  // namespace rio::experiment
