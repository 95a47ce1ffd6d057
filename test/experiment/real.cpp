// SPDX-License-Identifier: BSD-3-Clause
// Every real recording of a folder with every preset and both back-ends, over seeds of the RANSAC:
// errors, and whether sigma and verdict tell the truth.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"
#include "experiment/recording.hpp"
#include "experiment/spread.hpp"
#include "experiment/trial.hpp"

namespace rio::experiment {

namespace {

constexpr int kSeeds = 8;
constexpr int kDraws = 18;             // of the random perturbations
constexpr double kHonestShare = 0.95;  // of the scans

/// One estimator.
struct Estimator {
  std::string name;
  std::string preset;
  BackEnd backend;
  void (*change)(Options&) = nullptr;
};

void doppler_alone(Options& options) {
  options.update.use_landmarks = false;
  options.update.use_trails = false;
}

std::vector<Estimator> estimators() {
  return {{"default, filter", "default", BackEnd::kEkf},
          {"default, smoother", "default", BackEnd::kSmoother},
          {"default, Doppler alone", "default", BackEnd::kEkf, &doppler_alone},
          {"default, mounting unknown, filter", "default", BackEnd::kEkf, &forget_mounting},
          {"default, mounting unknown, smoother", "default", BackEnd::kSmoother, &forget_mounting},
          {"published-ekf", "published-ekf", BackEnd::kEkf},
          {"published-smoother", "published-smoother", BackEnd::kSmoother},
          {"published-uncertainty", "published-uncertainty", BackEnd::kSmoother},
          {"doppler-only", "doppler-only", BackEnd::kEkf}};
}
constexpr std::size_t kOfDefault = 2;  // the first ones, by back-end

Options options_for(const Recording& recording, const Estimator& estimator, int seed) {
  Options options;
  if (!preset(estimator.preset, &options)) throw std::runtime_error("no such preset");
  io::apply_sensor_info(recording.data, &options);
  options.backend = estimator.backend;
  options.frontend.ransac_seed = seed;
  if (estimator.change != nullptr) estimator.change(options);
  return options;
}

std::vector<double> finite(std::vector<double> values) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  std::sort(values.begin(), values.end());
  return values;
}

/// A recording with one estimator, a score for each seed.
struct Run {
  const Recording* recording;
  std::size_t estimator;  ///< index
  std::vector<RealScore> scores{};

  /// Median and largest over the seeds; NaN without values.
  double median(const std::function<double(const RealScore&)>& value) const {
    std::vector<double> values = sorted(value);
    if (values.empty()) return std::nan("");
    return 0.5 * (values[(values.size() - 1) / 2] + values[values.size() / 2]);
  }
  double largest(const std::function<double(const RealScore&)>& value) const {
    const std::vector<double> values = sorted(value);
    return values.empty() ? std::nan("") : values.back();
  }
  bool dishonest() const {
    return std::any_of(scores.begin(), scores.end(),
                       [](const RealScore& s) { return s.honest < kHonestShare; });
  }
  bool healthy_though_dishonest() const {
    return std::any_of(scores.begin(), scores.end(),
                       [](const RealScore& s) { return s.honest < kHonestShare && s.healthy; });
  }

 private:
  std::vector<double> sorted(const std::function<double(const RealScore&)>& value) const {
    std::vector<double> values;
    for (const RealScore& s : scores) values.push_back(s.started ? value(s) : std::nan(""));
    return finite(std::move(values));
  }
};

double horizontal(const RealScore& s) {
  return 100.0 * s.horizontal / s.distance;
}
double height(const RealScore& s) {
  return 100.0 * s.height / s.distance;
}
double dishonest_share(const RealScore& s) {
  return 100.0 * (1.0 - s.honest);
}

/// "median (largest)" over runs.
std::string over(const std::vector<double>& all, int decimals) {
  const std::vector<double> values = finite(all);
  if (values.empty()) return "-";
  const double median = 0.5 * (values[(values.size() - 1) / 2] + values[values.size() / 2]);
  return fmt::format("{} ({})", number(median, decimals), number(values.back(), decimals));
}

std::string of_seeds(const Run& run, const std::function<double(const RealScore&)>& value,
                     int decimals) {
  const double median = run.median(value);
  if (!std::isfinite(median)) return "-";
  return fmt::format("{} ({})", number(median, decimals), number(run.largest(value), decimals));
}

std::string table_of_recordings(const std::vector<Run>& runs) {
  MarkdownTable table({"recording", "distance [m]", "estimator", "first to last [m]",
                       "horizontal [%]", "height [%]", "height beyond 3 sigma [% of scans]",
                       "height error / sigma, 2nd half: median", "largest", "healthy"});
  for (const Run& run : runs) {
    if (run.estimator >= kOfDefault) continue;
    const auto healthy = std::count_if(run.scores.begin(), run.scores.end(),
                                       [](const RealScore& s) { return s.healthy; });
    const bool moves = !run.recording->stands();
    const auto moving = [&](double (*share)(const RealScore&)) {
      return moves ? of_seeds(run, share, 2) : std::string("-");
    };
    table.add({run.recording->name, number(run.scores.front().distance, 1),
               estimators()[run.estimator].name,
               of_seeds(
                   run, [](const RealScore& s) { return s.closure; }, 3),
               moving(&horizontal), moving(&height), of_seeds(run, &dishonest_share, 1),
               of_seeds(
                   run, [](const RealScore& s) { return s.sigmas_median; }, 2),
               of_seeds(
                   run, [](const RealScore& s) { return s.sigmas_worst; }, 2),
               fmt::format("{} of {}", healthy, run.scores.size())});
  }
  return table.text();
}

/// The runs of `estimator`, all or of a group, each with its median over the seeds.
std::vector<std::string> summary(const std::vector<Run>& runs, std::size_t estimator,
                                 const std::string& group) {
  std::vector<double> closure, far, across, up, beyond, typical, worst, creep;
  int count = 0, honest = 0, deceiving = 0, started = 0;
  for (const Run& run : runs) {
    const Recording& recording = *run.recording;
    if (run.estimator != estimator || (!group.empty() && recording.group != group)) continue;
    ++count;
    started += run.scores.front().started ? 1 : 0;
    honest += run.dishonest() ? 0 : 1;
    deceiving += run.healthy_though_dishonest() ? 1 : 0;
    beyond.push_back(run.largest(&dishonest_share));
    creep.push_back(run.median([](const RealScore& s) { return s.creep; }));
    if (recording.stands()) {
      far.push_back(run.largest([](const RealScore& s) { return s.farthest; }));
      continue;
    }
    across.push_back(run.median(&horizontal));
    up.push_back(run.median(&height));
    typical.push_back(run.median([](const RealScore& s) { return s.sigmas_median; }));
    worst.push_back(run.largest([](const RealScore& s) { return s.sigmas_worst; }));
    if (recording.reference.empty()) {
      closure.push_back(run.median([](const RealScore& s) { return s.closure; }));
    }
  }
  worst = finite(std::move(worst));
  return {fmt::format("{} of {}", started, count),
          over(across, 2),
          over(up, 2),
          fmt::format("{} of {}", honest, count),
          over(typical, 2),
          worst.empty() ? "-" : number(worst.back(), 2),
          fmt::format("{}", deceiving),
          over(closure, 3),
          over(creep, 3),
          over(far, 3)};
}

const std::vector<std::string> kSummaryHead = {"started",
                                               "horizontal [%]",
                                               "height [%]",
                                               "honest in 95 % of the scans",
                                               "height error / sigma, 2nd half",
                                               "largest",
                                               "healthy though dishonest",
                                               "first to last [m]",
                                               "creep [m]",
                                               "standing: farthest [m]"};

std::vector<std::string> with_front(std::vector<std::string> front,
                                    const std::vector<std::string>& rest) {
  front.insert(front.end(), rest.begin(), rest.end());
  return front;
}

std::string table_of_groups(const std::vector<Run>& runs) {
  MarkdownTable table(with_front({"recordings", "estimator"}, kSummaryHead));
  std::vector<std::string> groups;
  for (const Run& run : runs) {
    const std::string& group = run.recording->group;
    if (std::find(groups.begin(), groups.end(), group) == groups.end()) groups.push_back(group);
  }
  groups.emplace_back();  // all
  for (const std::string& group : groups) {
    for (std::size_t e = 0; e < estimators().size(); ++e) {
      const bool flown =
          std::any_of(runs.begin(), runs.end(), [&](const Run& run) { return run.estimator == e; });
      if (!flown || (e >= kOfDefault && !group.empty())) continue;
      table.add(with_front({group.empty() ? "all" : group, estimators()[e].name},
                           summary(runs, e, group)));
    }
  }
  return table.text();
}

/// Every recording with every estimator and seed.
std::vector<Run> replayed(const std::vector<Recording>& recordings, std::size_t with,
                          const Settings& settings) {
  std::vector<Run> runs;
  for (const Recording& recording : recordings) {
    for (std::size_t e = 0; e < with; ++e) runs.push_back({&recording, e});
  }
  const auto seeds = static_cast<std::size_t>(settings.seeds > 0 ? settings.seeds : kSeeds);
  for (Run& run : runs) run.scores.resize(seeds);
  parallel_for(runs.size() * seeds, settings.threads, settings.on_progress, [&](std::size_t i) {
    Run& run = runs[i / seeds];
    const int seed = static_cast<int>(i % seeds) + 1;
    const Options options = options_for(*run.recording, estimators()[run.estimator], seed);
    run.scores[i % seeds] = judge(*run.recording, replay(run.recording->data, options));
  });
  return runs;
}

/// Perturbed copies of the recordings that come back to their start.
std::string table_of_copies(const std::vector<Recording>& recordings, const Settings& settings) {
  MarkdownTable table({"recording", "estimator", "copies", "first to last [m]"});
  for (const Recording& recording : recordings) {
    if (!recording.reference.empty()) continue;
    std::vector<Recording> copies;
    for (Copy& copy : perturbed(recording, kDraws, 1)) copies.push_back(std::move(copy.recording));
    const std::vector<Run> runs = replayed(copies, kOfDefault, settings);
    for (std::size_t e = 0; e < kOfDefault; ++e) {
      std::vector<double> closures;
      for (const Run& run : runs) {
        if (run.estimator != e) continue;
        for (const RealScore& s : run.scores) closures.push_back(s.closure);
      }
      table.add({recording.name, estimators()[e].name, fmt::format("{}", closures.size()),
                 over(closures, 3)});
    }
  }
  return table.text();
}

}  // namespace

Result real(const Settings& settings) {
  if (settings.data.empty()) throw std::runtime_error("real needs --data, a folder of recordings");
  const std::vector<Recording> recordings = find_recordings(settings.data);
  const std::vector<Recording> drives = fused(recordings);
  const std::vector<Run> runs = replayed(recordings, estimators().size(), settings);
  const std::vector<Run> together = replayed(drives, kOfDefault, settings);
  Result result;
  result.markdown = fmt::format(
      "Static start, no option set; seeds of the RANSAC: {}. RMS in % of the distance: horizontal\n"
      "against the reference, laid over it at the first scan (position and heading); height\n"
      "against the flat floor or the barometer. Creep: range of the height during the rest at the\n"
      "end. - = not known of this recording. Each recording, median (largest) of the seeds:\n\n"
      "{}\nTwo radars of one drive together:\n\n{}\nGroups; median (largest) over recordings of\n"
      "the median of their seeds, honest and the largest error by the worst seed:\n\n{}\n"
      "Two radars together:\n\n{}\nPerturbed copies (two seconds of rest before the start, every\n"
      "other scan, 30 % of the points dropped, mounting wrong by 3 deg, stamps wrong by 20 ms):\n"
      "\n{}",
      runs.front().scores.size(), table_of_recordings(runs), table_of_recordings(together),
      table_of_groups(runs), table_of_groups(together), table_of_copies(recordings, settings));
  return result;
}

}  // namespace rio::experiment
