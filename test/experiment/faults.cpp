// SPDX-License-Identifier: BSD-3-Clause
// Every fault of the catalogue in several flights with both back-ends: which promises are kept,
// which final states are wrong, and whether the estimator reports it.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"
#include "experiment/survival.hpp"
#include "support/short_flight.hpp"

namespace rio::experiment {

namespace {

constexpr std::array kFlights = {"indoor-1", "outdoor", "hover"};
constexpr std::array kBackEnds = {BackEnd::kEkf, BackEnd::kSmoother};
constexpr double kLongest = 120.0;  // of the passing faults [s]

/// One flight with a fault.
struct Run {
  const Fault* fault;
  const sim::Flight* flight;  ///< without the fault
  const char* flight_name;
  BackEnd backend;
  Survival survival{};
};
using Runs = std::vector<Run>;

const char* name_of(BackEnd backend) {
  return backend == BackEnd::kEkf ? "filter" : "smoother";
}

/// Long enough for the longest fault.
sim::Scenario scenario_of(const char* name, std::uint64_t seed, double duration) {
  sim::Scenario scenario = test::scenario_named(name, seed);
  scenario.max_duration = duration;
  if (scenario.path.length <= 0.0) scenario.path.duration = kFaultBegins + kLongest + kJudgedAfter;
  return scenario;
}

/// A flight with other sensors is simulated separately.
Survival fly(const Run& run) {
  const sim::Flight* flight = run.flight;
  sim::Flight other;
  if (run.fault->sensors) {
    sim::Scenario scenario =
        scenario_of(run.flight_name, flight->scenario.seed, kFaultBegins + kJudgedAfter);
    run.fault->sensors(scenario);
    other = sim::simulate_flight(scenario);
    flight = &other;
  }
  Options options = options_for(*flight, "default");
  options.backend = run.backend;
  return survive(*flight, options, *run.fault);
}

/// The largest of a member, at least 0; NaN if one is.
template <class Member>
double worst(const Runs& runs, const Member& value) {
  std::vector<double> values = {0.0};
  for (const Run& run : runs) values.push_back(std::invoke(value, run.survival));
  return Spread::of(values).worst;
}

template <class Member>
long count(const Runs& runs, const Member& holds) {
  return std::count_if(runs.begin(), runs.end(),
                       [&](const Run& run) { return std::invoke(holds, run.survival); });
}

bool is_wrong(const Survival& s) {
  return s.last.wrong();
}

/// The names of a set of states, Survival::states.
std::string states_text(std::uint32_t states) {
  std::vector<std::string> names;
  for (std::uint32_t i = 0; states >> i != 0; ++i) {
    if ((states >> i & 1U) != 0) names.emplace_back(to_string(static_cast<HealthState>(i)));
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

/// Worst tilt, speed, position and sigmas at the end.
void add_deviations(const Runs& runs, std::vector<std::string>* row) {
  const auto add = [&](double Deviation::*value, int decimals) {
    row->push_back(
        number(worst(runs, [value](const Survival& s) { return s.last.*value; }), decimals));
  };
  add(&Deviation::tilt, 2);
  add(&Deviation::speed, 2);
  add(&Deviation::position, 2);
  add(&Deviation::position_sigmas, 1);
}

std::string table_of_faults(const Runs& runs) {
  MarkdownTable table({"fault", "promise", "kept", "wrong at the end", "of these reported",
                       "tilt [deg]", "velocity [m/s]", "position [m]", "position [sigma]",
                       "wrong until [s]", "beyond 3 sigma unreported [s]", "states"});
  const auto reported = [](const Survival& s) { return is_wrong(s) && s.reported_last; };
  for (const Fault& fault : faults()) {
    Runs some;
    std::uint32_t states = 0;
    for (const Run& run : runs) {
      if (run.fault != &fault) continue;
      some.push_back(run);
      states |= run.survival.states;
    }
    std::vector<std::string> row = {
        fault.name, promise_text(fault),
        fmt::format("{} of {}", count(some, &Survival::kept), some.size()),
        fmt::format("{}", count(some, is_wrong)), fmt::format("{}", count(some, reported))};
    add_deviations(some, &row);
    row.push_back(number(worst(some, &Survival::wrong_until), 1));
    row.push_back(number(worst(some, &Survival::outside_unreported), 1));
    row.push_back(states_text(states));
    table.add(row);
  }
  return table.text();
}

std::string table_of_wrong(const Runs& wrong) {
  MarkdownTable table({"fault", "flight", "seed", "back-end", "wrong", "tilt [deg]",
                       "velocity [m/s]", "position [m]", "position [sigma]", "reported"});
  for (const Run& run : wrong) {
    std::vector<std::string> row = {run.fault->name, run.flight_name,
                                    fmt::format("{}", run.flight->scenario.seed),
                                    name_of(run.backend), run.survival.last.why()};
    add_deviations({run}, &row);
    row.emplace_back(run.survival.reported_last ? "yes" : "no");
    table.add(row);
  }
  return table.text();
}

std::string as_csv(const Runs& runs) {
  std::string text =
      "fault,promise,flight,seed,backend,kept,wrong,reported,always_finite,always_covariance,"
      "tilt [deg],velocity [m/s],position [m],tilt [sigma],velocity [sigma],position [sigma],"
      "wrong_until [s],longest_wrong_unreported [s],beyond_3_sigma_unreported [s],states\n";
  for (const Run& run : runs) {
    const Survival& s = run.survival;
    text += fmt::format(
        "\"{}\",{},{},{},{},{:d},\"{}\",{:d},{:d},{:d},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},"
        "{:.4g},{:.4g},{:.4g},\"{}\"\n",
        run.fault->name, promise_text(*run.fault), run.flight_name, run.flight->scenario.seed,
        name_of(run.backend), s.kept, s.last.why(), s.reported_last, s.always_finite,
        s.always_covariance, s.last.tilt, s.last.speed, s.last.position, s.last.tilt_sigmas,
        s.last.velocity_sigmas, s.last.position_sigmas, s.wrong_until, s.longest_unreported,
        s.outside_unreported, states_text(s.states));
  }
  return text;
}

/// The first flight of a seed with both back-ends; one more, flight and back-end in turn.
Runs runs_of(const std::vector<sim::Flight>& flights) {
  Runs runs;
  for (std::size_t f = 0; f < faults().size(); ++f) {
    for (std::size_t first = 0; first < flights.size(); first += kFlights.size()) {
      const auto add = [&](std::size_t kind, BackEnd backend) {
        runs.push_back({&faults()[f], &flights[first + kind], kFlights[kind], backend});
      };
      for (const BackEnd backend : kBackEnds) add(0, backend);
      const std::size_t turn = f + first / kFlights.size();
      add(1 + turn % 2, kBackEnds[turn / 2 % 2]);
    }
  }
  return runs;
}

std::string totals(const Runs& all, const Runs& wrong) {
  return fmt::format(
      "Wrong at the end: {} of {} ({:.1f} %); of these reported while wrong: {}. Promises kept: {} "
      "of {}. At any time\nnot finite: {}, covariance indefinite: {}; reported before the fault, "
      "when all was well: {}.\n",
      wrong.size(), all.size(),
      100.0 * static_cast<double>(wrong.size()) / static_cast<double>(all.size()),
      count(wrong, &Survival::reported_last), count(all, &Survival::kept), all.size(),
      count(all, [](const Survival& s) { return !s.always_finite; }),
      count(all, [](const Survival& s) { return s.always_finite && !s.always_covariance; }),
      count(all, &Survival::reported_before));
}

}  // namespace

Result fault_campaign(const Settings& settings) {
  const std::size_t seeds = static_cast<std::size_t>(std::max(1, settings.seeds));
  std::vector<sim::Flight> flights(kFlights.size() * seeds);
  parallel_for(flights.size(), settings.threads, {}, [&](std::size_t i) {
    flights[i] =
        sim::simulate_flight(scenario_of(kFlights[i % kFlights.size()], 1 + i / kFlights.size(),
                                         kFaultBegins + kLongest + kJudgedAfter));
  });
  Runs runs = runs_of(flights);
  parallel_for(runs.size(), settings.threads, settings.on_progress,
               [&](std::size_t i) { runs[i].survival = fly(runs[i]); });

  Runs wrong = runs;
  std::erase_if(wrong, [](const Run& run) { return !is_wrong(run.survival); });
  const std::string text = fmt::format(
      "A fault begins {:.0f} s after the first sample of a good flight ({}) and is judged {:.0f} s "
      "after its end, a lasting one\nafter its begin. Wrong: not finite, covariance not positive "
      "semi-definite, tilt > 3 deg, velocity > 0.5 m/s off (body\naxes), position > 0.5 m and > 5 "
      "sigma off, or an estimate of more than a second ago. Promises: ignored = never wrong,\n"
      "nothing reset; bridged = never wrong; honest = degraded, never beyond 5 sigma, not wrong in "
      "the end; recovered = not\nwrong from so long after its end on; reported = may be wrong, but "
      "says so within a second. Errors are those at the end,\nthe worst of the runs; wrong until: "
      "last time after the end of the fault.\n\n{}\n{}\nWhat ends wrong:\n\n{}",
      kFaultBegins, fmt::join(kFlights, ", "), kJudgedAfter, totals(runs, wrong),
      table_of_faults(runs), table_of_wrong(wrong));
  return {text, {{"faults.csv", as_csv(runs)}}};
}

}  // namespace rio::experiment
