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
#include "rio/eval/metrics.hpp"

namespace rio::experiment {

namespace {

constexpr int kSeeds = 8;
constexpr int kDraws = 18;             // of the random perturbations
constexpr double kHonestShare = 0.95;  // of the scans

const Variants& estimators() {
  static const Variants all = {
      {"default, filter", "default"},
      {"default, smoother", "default", use_smoother},
      {"default, Doppler alone", "default",
       [](Options& o) { o.update.use_landmarks = o.update.use_trails = false; }},
      {"default, mounting unknown, filter", "default", forget_mounting},
      {"default, mounting unknown, smoother", "default",
       [](Options& o) {
         use_smoother(o);
         forget_mounting(o);
       }},
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

/// The drives recorded by two radars, NAME_A and NAME_B on one clock, as NAME_AB with both.
std::vector<Recording> fused(const std::vector<Recording>& recordings) {
  std::vector<Recording> drives;
  for (std::size_t i = 0; i + 1 < recordings.size(); ++i) {
    const Recording& a = recordings[i];
    const Recording& b = recordings[i + 1];
    const std::string drive = a.name.substr(0, a.name.size() - 1);
    if (a.name != drive + "A" || b.name != drive + "B" || a.group != b.group) continue;
    Recording both = a;
    both.name = drive + "AB";
    both.data.other_radars.push_back({b.data.scans, b.data.radar_info});
    drives.push_back(std::move(both));
  }
  return drives;
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

/// A member of the score over the seeds.
template <class Member>
std::vector<double> of(const RealRun& run, const Member& value) {
  std::vector<double> values;
  for (const RealScore& s : run.scores) values.push_back(std::invoke(value, s));
  return values;
}

bool dishonest(const RealScore& s) {
  return s.honest < kHonestShare;
}
bool deceiving(const RealScore& s) {
  return dishonest(s) && s.healthy;
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
  int count = 0, honest = 0, deceptive = 0, started = 0;
  for (const RealRun& run : runs) {
    const Recording& recording = *run.recording;
    if (run.variant != estimator || (group != "all" && recording.group != group)) continue;
    ++count;
    started += run.scores.front().started ? 1 : 0;
    honest += std::none_of(run.scores.begin(), run.scores.end(), dishonest) ? 1 : 0;
    deceptive += std::any_of(run.scores.begin(), run.scores.end(), deceiving) ? 1 : 0;
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
          fmt::format("{}", deceptive),
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
  const std::size_t flown = runs.empty() ? 0 : runs.back().variant + 1;
  for (const std::string& group : groups) {
    const std::size_t shown = group == "all" ? flown : std::min(flown, kOfDefault);
    for (std::size_t e = 0; e < shown; ++e) table.add(summary(runs, e, group));
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
    std::vector<Recording>& group = groups[recording.group];
    for (Copy& copy : perturbed(recording, kDraws, 1)) {
      if (recording.flat()) copy.recording.first_seed += static_cast<int>(group.size()) % kSeeds;
      group.push_back(std::move(copy.recording));
    }
  }
  for (const auto& [group, copies] : groups) {
    const bool flat = copies.front().flat();
    const int seeds = flat ? 1 : settings.seeds_or(kSeeds);  // flat ones take turns with the seeds
    const std::vector<RealRun> runs = replay_campaign(copies, of_default(), seeds, settings);
    for (std::size_t e = 0; e < kOfDefault; ++e) {
      RealRun all{&copies.front(), e};
      for (const RealRun& run : runs) {
        if (run.variant != e) continue;
        all.scores.insert(all.scores.end(), run.scores.begin(), run.scores.end());
      }
      const std::vector<RealScore>& s = all.scores;
      const auto honest = std::count_if(s.begin(), s.end(), std::not_fn(dishonest));
      const auto deceptive = std::count_if(s.begin(), s.end(), deceiving);
      table.add({group, estimators()[e].name, fmt::format("{}", s.size()),
                 flat ? "-" : over(of(all, &RealScore::closure), 3),
                 flat ? over(of(all, &RealScore::height_share), 2) : "-",
                 flat ? fmt::format("{} of {}", honest, s.size()) : "-",
                 flat ? over(of(all, &RealScore::sigmas_median), 2) : "-",
                 flat ? number(largest(of(all, &RealScore::sigmas_worst)), 2) : "-",
                 flat ? fmt::format("{}", deceptive) : "-"});
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
  return {fmt::format(
      "Static start, no option set; seeds of the RANSAC: {}. RMS in % of the distance: horizontal\n"
      "against the reference, laid over it at the first scan (position and heading); height\n"
      "against the flat floor or the barometer. Creep: range of the height during the rest at the\n"
      "end. - = not known of this recording. Each recording, median (largest) of the seeds:\n\n"
      "{}\nTwo radars of one drive together:\n\n{}\nGroups; median (largest) over recordings of\n"
      "the median of their seeds, honest and the largest error by the worst seed:\n\n{}\n"
      "Two radars together:\n\n{}\nPerturbed copies (two seconds of rest before the start, every\n"
      "other scan, 30 % of the points dropped, mounting wrong by 3 deg, stamps wrong by 20 ms);\n"
      "of the karts each with the next of eight seeds:\n\n{}",
      seeds, table_of_recordings(runs), table_of_recordings(together), table_of_groups(runs),
      table_of_groups(together), table_of_copies(recordings, settings))};
}

}  // namespace rio::experiment
