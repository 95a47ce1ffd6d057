// SPDX-License-Identifier: BSD-3-Clause
// Every real recording of a folder with every preset and both back-ends, over seeds of the RANSAC:
// errors, and whether sigma and verdict tell the truth.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"
#include "experiment/recording.hpp"
#include "experiment/spread.hpp"
#include "experiment/trial.hpp"
#include "rio/eval/metrics.hpp"

namespace rio::experiment {

namespace {

constexpr int kSeeds = 8;
constexpr int kDraws = 18;             // of the random perturbations
constexpr double kHonestShare = 0.95;  // of the scans

const Variants& estimators() {
  const Change doppler_alone = [](Options& o) {
    o.update.use_landmarks = o.update.use_trails = false;
  };
  const Change mounting_unknown = [](Options& options) {
    options.backend = BackEnd::kSmoother;
    forget_mounting(options);
  };
  static const Variants all = {
      {"default, filter", "default"},
      {"default, smoother", "default", [](Options& o) { o.backend = BackEnd::kSmoother; }},
      {"default, Doppler alone", "default", doppler_alone},
      {"default, mounting unknown, filter", "default", forget_mounting},
      {"default, mounting unknown, smoother", "default", mounting_unknown},
      {"published-ekf", "published-ekf"},
      {"published-smoother", "published-smoother"},
      {"published-uncertainty", "published-uncertainty"},
      {"doppler-only", "doppler-only"}};
  return all;
}
constexpr std::size_t kOfDefault = 2;  // the first ones, by back-end

Variants of_default() {
  return {estimators().begin(), estimators().begin() + kOfDefault};
}

/// Of the finite values; NaN without any.
eval::Statistics statistics(std::vector<double> values) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  return eval::statistics(std::move(values));
}
double median(const std::vector<double>& values) {
  return statistics(values).median;
}
double largest(const std::vector<double>& values) {
  return statistics(values).max;
}

/// "median (largest)" of the finite values.
std::string over(const std::vector<double>& all, int decimals) {
  if (std::isnan(median(all))) return "-";
  return fmt::format("{} ({})", number(median(all), decimals), number(largest(all), decimals));
}

/// A member of the score over the seeds; NaN where it did not start.
template <class Member>
std::vector<double> of(const RealRun& run, const Member& value) {
  std::vector<double> values;
  for (const RealScore& s : run.scores) {
    values.push_back(s.started ? std::invoke(value, s) : std::nan(""));
  }
  return values;
}

bool dishonest(const RealScore& s) {
  return s.honest < kHonestShare;
}

std::string table_of_recordings(const std::vector<RealRun>& runs) {
  MarkdownTable table({"recording", "distance [m]", "estimator", "first to last [m]",
                       "horizontal [%]", "height [%]", "height beyond 3 sigma [% of scans]",
                       "height error / sigma, 2nd half: median", "largest", "healthy"});
  for (const RealRun& run : runs) {
    if (run.variant >= kOfDefault) continue;
    const auto healthy = std::count_if(run.scores.begin(), run.scores.end(),
                                       [](const RealScore& s) { return s.healthy; });
    const bool moves = !run.recording->stands();
    table.add({run.recording->name, number(run.scores.front().distance, 1),
               estimators()[run.variant].name, over(of(run, &RealScore::closure), 3),
               moves ? over(of(run, &RealScore::horizontal_share), 2) : "-",
               moves ? over(of(run, &RealScore::height_share), 2) : "-",
               over(of(run, &RealScore::dishonest_share), 1),
               over(of(run, &RealScore::sigmas_median), 2),
               over(of(run, &RealScore::sigmas_worst), 2),
               fmt::format("{} of {}", healthy, run.scores.size())});
  }
  return table.text();
}

/// The runs of `estimator`, all or of a group, each with its median over the seeds.
std::vector<std::string> summary(const std::vector<RealRun>& runs, std::size_t estimator,
                                 const std::string& group) {
  std::vector<double> closure, far, across, up, typical, worst, creep;
  int count = 0, honest = 0, deceiving = 0, started = 0;
  for (const RealRun& run : runs) {
    const Recording& recording = *run.recording;
    if (run.variant != estimator || (group != "all" && recording.group != group)) continue;
    ++count;
    started += run.scores.front().started ? 1 : 0;
    honest += std::none_of(run.scores.begin(), run.scores.end(), dishonest) ? 1 : 0;
    deceiving += std::any_of(run.scores.begin(), run.scores.end(),
                             [](const RealScore& s) { return dishonest(s) && s.healthy; })
                     ? 1
                     : 0;
    creep.push_back(median(of(run, &RealScore::creep)));
    if (recording.stands()) {
      far.push_back(largest(of(run, &RealScore::farthest)));
      continue;
    }
    across.push_back(median(of(run, &RealScore::horizontal_share)));
    up.push_back(median(of(run, &RealScore::height_share)));
    typical.push_back(median(of(run, &RealScore::sigmas_median)));
    worst.push_back(largest(of(run, &RealScore::sigmas_worst)));
    if (recording.reference.empty()) closure.push_back(median(of(run, &RealScore::closure)));
  }
  return {group,
          estimators()[estimator].name,
          fmt::format("{} of {}", started, count),
          over(across, 2),
          over(up, 2),
          fmt::format("{} of {}", honest, count),
          over(typical, 2),
          number(largest(worst), 2),
          fmt::format("{}", deceiving),
          over(closure, 3),
          over(creep, 3),
          over(far, 3)};
}

std::string table_of_groups(const std::vector<RealRun>& runs) {
  MarkdownTable table({"recordings", "estimator", "started", "horizontal [%]", "height [%]",
                       "honest in 95 % of the scans", "height error / sigma, 2nd half", "largest",
                       "healthy though dishonest", "first to last [m]", "creep [m]",
                       "standing: farthest [m]"});
  std::vector<std::string> groups;
  for (const RealRun& run : runs) {
    const std::string& group = run.recording->group;
    if (std::find(groups.begin(), groups.end(), group) == groups.end()) groups.push_back(group);
  }
  groups.emplace_back("all");
  for (const std::string& group : groups) {
    for (std::size_t e = 0; e < estimators().size(); ++e) {
      const bool flown = std::any_of(runs.begin(), runs.end(),
                                     [&](const RealRun& run) { return run.variant == e; });
      if (flown && (e < kOfDefault || group == "all")) table.add(summary(runs, e, group));
    }
  }
  return table.text();
}

/// Perturbed copies of the recordings that move: groups without a reference by their way back to
/// the start, the others by their honesty.
std::string table_of_copies(const std::vector<Recording>& recordings, const Settings& settings) {
  MarkdownTable table({"recordings", "estimator", "copies", "first to last [m]", "height [%]",
                       "honest in 95 % of the scans", "height error / sigma, 2nd half", "largest",
                       "healthy though dishonest"});
  std::map<std::string, std::vector<Recording>> groups;
  for (const Recording& recording : recordings) {
    if (recording.stands() || (!recording.reference.empty() && !recording.flat())) continue;
    for (Copy& copy : perturbed(recording, kDraws, 1)) {
      groups[recording.group].push_back(std::move(copy.recording));
    }
  }
  for (const auto& [group, copies] : groups) {
    const bool flat = copies.front().flat();
    const int seeds = flat ? 1 : settings.seeds_or(kSeeds);  // there are many drives
    const std::vector<RealRun> runs = replay_campaign(copies, of_default(), seeds, settings);
    for (std::size_t e = 0; e < kOfDefault; ++e) {
      std::vector<double> closure, height, typical, worst;
      int honest = 0, deceiving = 0;
      for (const RealRun& run : runs) {
        if (run.variant != e) continue;
        for (const RealScore& s : run.scores) {
          closure.push_back(s.closure);
          height.push_back(s.height_share());
          typical.push_back(s.sigmas_median);
          worst.push_back(s.sigmas_worst);
          honest += dishonest(s) ? 0 : 1;
          deceiving += dishonest(s) && s.healthy ? 1 : 0;
        }
      }
      table.add({group, estimators()[e].name, fmt::format("{}", closure.size()),
                 flat ? "-" : over(closure, 3), flat ? over(height, 2) : "-",
                 flat ? fmt::format("{} of {}", honest, closure.size()) : "-",
                 flat ? over(typical, 2) : "-", flat ? number(largest(worst), 2) : "-",
                 flat ? fmt::format("{}", deceiving) : "-"});
    }
  }
  return table.text();
}

}  // namespace

Result real(const Settings& settings) {
  if (settings.data.empty()) throw std::runtime_error("real needs --data, a folder of recordings");
  const std::vector<Recording> recordings = find_recordings(settings.data);
  const std::vector<Recording> drives = fused(recordings);
  const int seeds = settings.seeds_or(kSeeds);
  const std::vector<RealRun> runs = replay_campaign(recordings, estimators(), seeds, settings);
  const std::vector<RealRun> together = replay_campaign(drives, of_default(), seeds, settings);
  Result result;
  result.markdown = fmt::format(
      "Static start, no option set; seeds of the RANSAC: {}. RMS in % of the distance: horizontal\n"
      "against the reference, laid over it at the first scan (position and heading); height\n"
      "against the flat floor or the barometer. Creep: range of the height during the rest at the\n"
      "end. - = not known of this recording. Each recording, median (largest) of the seeds:\n\n"
      "{}\nTwo radars of one drive together:\n\n{}\nGroups; median (largest) over recordings of\n"
      "the median of their seeds, honest and the largest error by the worst seed:\n\n{}\n"
      "Two radars together:\n\n{}\nPerturbed copies (two seconds of rest before the start, every\n"
      "other scan, 30 % of the points dropped, mounting wrong by 3 deg, stamps wrong by 20 ms);\n"
      "of the karts with one seed:\n\n{}",
      seeds, table_of_recordings(runs), table_of_recordings(together), table_of_groups(runs),
      table_of_groups(together), table_of_copies(recordings, settings));
  return result;
}

}  // namespace rio::experiment
