// SPDX-License-Identifier: BSD-3-Clause
#include "experiment/campaign.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <stdexcept>

#include "rio/eval/metrics.hpp"
#include "rio/sim/catalogue.hpp"
#include "rio/sim/flight.hpp"

namespace rio::experiment {

std::vector<Case> cases_of(const std::string& name, int count, std::uint64_t first) {
  std::vector<Case> cases;
  for (int i = 0; i < count; ++i) {
    Case c{name, {}};
    if (!sim::scenario(name, &c.scenario)) {
      throw std::runtime_error("no such scenario: \"" + name + "\"");
    }
    c.scenario.seed = first + static_cast<std::uint64_t>(i);
    cases.push_back(c);
  }
  return cases;
}

Options options_of(const sim::Flight& flight, const Variant& variant) {
  Options options = options_for(flight, variant.preset);
  if (variant.change) variant.change(options);
  return options;
}

std::vector<Outcome> run_campaign(const std::vector<Case>& cases,
                                  const std::vector<Variant>& variants, const Settings& settings,
                                  const EachTrial& each) {
  std::vector<Outcome> runs(cases.size() * variants.size());
  std::mutex mutex;
  parallel_for(cases.size(), settings.threads, settings.on_progress, [&](std::size_t i) {
    const Case& c = cases[i];
    const sim::Flight flight = sim::simulate_flight(c.scenario);
    for (std::size_t k = 0; k < variants.size(); ++k) {
      const Trial trial = fly(flight, options_of(flight, variants[k]));
      runs[i * variants.size() + k] = {c.group, c.scenario.seed, variants[k].name, score(trial)};
      const std::lock_guard lock(mutex);
      if (each) each(c, variants[k], trial);
    }
  });
  return runs;
}

double median_time_per_scan(const sim::Flight& flight, const Variant& variant) {
  Options options = options_of(flight, variant);
  options.timing.clock = &steady_now;
  std::vector<double> times;
  fly(flight, options, [&times](const UpdateReport& report) {
    times.push_back(1e3 * to_seconds(report.propagation_time + report.update_time));
  });
  return eval::statistics(times).median;
}

std::vector<Score> select(const std::vector<Outcome>& runs, std::string_view group,
                          std::string_view variant) {
  std::vector<Score> scores;
  for (const Outcome& run : runs) {
    if (run.group == group && run.variant == variant) scores.push_back(run.score);
  }
  return scores;
}

int count_lost(const std::vector<Score>& scores) {
  return static_cast<int>(
      std::count_if(scores.begin(), scores.end(), [](const Score& s) { return s.lost; }));
}

std::string outcomes_as_csv(const std::vector<Outcome>& runs) {
  std::string text = "group,seed,variant,complete,lost";
  for (const Figure& figure : kFigures) {
    text += fmt::format(",{}{}", figure.name,
                        *figure.unit == '\0' ? "" : fmt::format(" [{}]", figure.unit));
  }
  text += '\n';
  for (const Outcome& run : runs) {
    text += fmt::format("{},{},{},{:d},{:d}", run.group, run.seed, run.variant, run.score.complete,
                        run.score.lost);
    for (const Figure& figure : kFigures) text += fmt::format(",{:.6g}", run.score.*figure.value);
    text += '\n';
  }
  return text;
}

}  // namespace rio::experiment
