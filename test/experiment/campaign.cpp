// SPDX-License-Identifier: BSD-3-Clause
#include "experiment/campaign.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>

#include "rio/sim/catalogue.hpp"
#include "rio/sim/flight.hpp"
#include "support/short_flight.hpp"

namespace rio::experiment {

namespace {

/// As a cell of a csv file.
std::string quoted(const std::string& text) {
  return text.find(',') == std::string::npos ? text : '"' + text + '"';
}

}  // namespace

Cases cases_of(const std::string& name, int count, std::uint64_t first) {
  Cases cases;
  for (int i = 0; i < count; ++i) cases.push_back({name, test::scenario_named(name, first++)});
  return cases;
}

Cases indoor_cases(int each) {
  Cases all;
  for (std::size_t i = 1; i <= sim::kIcraLengths.size(); ++i) {
    const Cases cases = cases_of(fmt::format("indoor-{}", i), each);
    all.insert(all.end(), cases.begin(), cases.end());
  }
  return all;
}

Options options_of(const sim::Flight& flight, const Variant& variant) {
  Options options = options_for(flight, variant.preset);
  if (variant.change) variant.change(options);
  return options;
}

Outcomes run_campaign(const Cases& cases, const Variants& variants, const Settings& settings,
                      const EachTrial& each) {
  Outcomes runs(cases.size() * variants.size());
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

Scores select(const Outcomes& runs, std::string_view group, std::string_view variant) {
  Scores scores;
  for (const Outcome& run : runs) {
    if (run.group.starts_with(group) && run.variant == variant) scores.push_back(run.score);
  }
  return scores;
}

int count_lost(const Scores& scores) {
  return static_cast<int>(
      std::count_if(scores.begin(), scores.end(), [](const Score& s) { return s.lost; }));
}

std::string outcomes_as_csv(const Outcomes& runs) {
  std::string text = "group,seed,variant,complete,lost";
  for (const Figure& figure : kFigures) {
    text += fmt::format(",{}{}", figure.name,
                        *figure.unit == '\0' ? "" : fmt::format(" [{}]", figure.unit));
  }
  text += '\n';
  for (const Outcome& run : runs) {
    text += fmt::format("{},{},{},{:d},{:d}", quoted(run.group), run.seed, quoted(run.variant),
                        run.score.complete, run.score.lost);
    for (const Figure& figure : kFigures) text += fmt::format(",{:.6g}", run.score.*figure.value);
    text += '\n';
  }
  return text;
}

Column spread_of(const std::string& head, double Score::*value, int decimals) {
  return {head, [=](const Scores& scores, const Scores&) {
            return Spread::of(scores, value).text(decimals);
          }};
}

Column mean_of(const std::string& head, double Score::*value, int decimals) {
  return {head, [=](const Scores& scores, const Scores&) {
            return number(Spread::of(scores, value).mean, decimals);
          }};
}

Column change_of(const std::string& head, double Score::*value, int decimals) {
  return {head, [=](const Scores& scores, const Scores& reference) {
            std::vector<double> differences;
            for (std::size_t i = 0; i < scores.size(); ++i) {
              differences.push_back(scores[i].*value - reference[i].*value);
            }
            return mean_with_error(differences, decimals);
          }};
}

Column nees_of(const std::string& head, int decimals) {
  return {head, [=](const Scores& scores, const Scores&) {
            const auto mean = [&](double Score::*value) {
              return number(Spread::of(scores, value).mean, decimals);
            };
            return fmt::format("{} / {} / {}", mean(&Score::nees_position),
                               mean(&Score::nees_heading), mean(&Score::nees_velocity));
          }};
}

Column lost_of(const std::string& head) {
  return {head, [](const Scores& scores, const Scores&) {
            return fmt::format("{}", count_lost(scores));
          }};
}

std::vector<std::string> row_of(std::vector<std::string> names, const std::vector<Column>& columns,
                                const Scores& scores, const Scores& reference) {
  for (const Column& column : columns) names.push_back(column.cell(scores, reference));
  return names;
}

std::vector<std::string> head_of(std::vector<std::string> names,
                                 const std::vector<Column>& columns) {
  for (const Column& column : columns) names.push_back(column.head);
  return names;
}

}  // namespace rio::experiment
