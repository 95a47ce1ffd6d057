// SPDX-License-Identifier: BSD-3-Clause
// Every real recording of a folder with every preset and both back-ends, unchanged and perturbed,
// its mounting as given and as calibrated from the recording itself.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"
#include "experiment/recording.hpp"
#include "experiment/spread.hpp"

namespace rio::experiment {

namespace {

constexpr int kDraws = 18;  // of the random perturbations

/// One estimator.
struct Estimator {
  std::string name;
  std::string preset;
  BackEnd backend;
  bool doppler_alone = false;
};

std::vector<Estimator> estimators() {
  return {{"default, filter", "default", BackEnd::kEkf},
          {"default, smoother", "default", BackEnd::kSmoother},
          {"default, Doppler alone", "default", BackEnd::kEkf, true},
          {"published-ekf", "published-ekf", BackEnd::kEkf},
          {"published-smoother", "published-smoother", BackEnd::kSmoother},
          {"published-uncertainty", "published-uncertainty", BackEnd::kSmoother}};
}

Options options_for(const Recording& recording, const Estimator& estimator) {
  Options options;
  if (!preset(estimator.preset, &options)) throw std::runtime_error("no such preset");
  io::apply_sensor_info(recording.data, &options);
  options.backend = estimator.backend;
  if (estimator.doppler_alone) {
    options.update.use_landmarks = false;
    options.update.use_trails = false;
  }
  return options;
}

/// A replay to be run, and its result.
struct Run {
  const Recording* recording;
  std::size_t original;   ///< index of its source recording
  std::size_t estimator;  ///< index
  std::string kind;       ///< of the perturbation, empty = none
  bool calibrated = false;
  RealScore score{};
};

/// The recording with the mounting and the stamps that the filter of `default` finds in it.
Recording calibrated(const Recording& recording) {
  const Replay found = replay(recording.data, options_for(recording, estimators().front()));
  Recording copy = recording;
  if (found.steps.empty()) return copy;
  copy.data.radar_info.T_BS = found.T_BS;
  for (RadarScan& scan : copy.data.scans) scan.time -= from_seconds(found.time_offset);
  return copy;
}

/// Median and worst; replays that did not start have no value and are counted.
std::string summary(const std::vector<const Run*>& runs,
                    const std::function<double(const RealScore&)>& value, int decimals) {
  std::vector<double> values;
  for (const Run* run : runs) {
    const double v = run->score.started ? value(run->score) : std::nan("");
    if (std::isfinite(v)) values.push_back(v);
  }
  if (values.empty()) return "-";
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  const double median = 0.5 * (values[(n - 1) / 2] + values[n / 2]);
  return fmt::format("{} ({})", number(median, decimals), number(values.back(), decimals));
}

double percent(double length, const RealScore& score) {
  return 100.0 * length / score.distance;
}

std::vector<std::string> summary_cells(const std::vector<const Run*>& runs) {
  const auto started =
      std::count_if(runs.begin(), runs.end(), [](const Run* r) { return r->score.started; });
  return {
      fmt::format("{} of {}", started, runs.size()),
      summary(  // without other references: the sensor was returned to its start
          runs,
          [](const RealScore& s) { return std::isnan(s.horizontal) ? s.closure : std::nan(""); },
          3),
      summary(
          runs, [](const RealScore& s) { return percent(s.horizontal, s); }, 2),
      summary(
          runs, [](const RealScore& s) { return percent(s.height, s); }, 2),
      summary(
          runs, [](const RealScore& s) { return 100.0 * (1.0 - s.honest); }, 1),
      summary(
          runs, [](const RealScore& s) { return s.creep; }, 3)};
}

const std::vector<std::string> kSummaryHead = {"started",
                                               "first to last [m]",
                                               "horizontal [%]",
                                               "height [%]",
                                               "height beyond 3 sigma [% of scans]",
                                               "creep [m]"};

std::vector<std::string> with_front(const std::vector<std::string>& front,
                                    const std::vector<std::string>& rest) {
  std::vector<std::string> all = front;
  all.insert(all.end(), rest.begin(), rest.end());
  return all;
}

std::string table_of_recordings(const std::vector<Recording>& recordings,
                                const std::vector<Run>& runs) {
  MarkdownTable table({"recording", "distance [m]", "estimator", "first to last [m]",
                       "horizontal [%]", "height [%]", "height [m]",
                       "height beyond 3 sigma [% of scans]", "creep [m]", "creep / sigma"});
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    for (const Run& run : runs) {
      if (run.original != i || run.estimator > 1 || !run.kind.empty() || run.calibrated) continue;
      const RealScore& s = run.score;
      table.add({recordings[i].name, number(s.distance, 1),
                 fmt::format("{}{}", estimators()[run.estimator].name,
                             s.started ? "" : ": did not start"),
                 number(s.closure, 3), number(percent(s.horizontal, s), 2),
                 number(percent(s.height, s), 2), number(s.height, 3),
                 number(100.0 * (1.0 - s.honest), 1), number(s.creep, 3),
                 number(s.creep_sigmas, 2)});
    }
  }
  return table.text();
}

/// Recordings NAME_A and NAME_B are of one drive: their end positions must agree.
std::string table_of_pairs(const std::vector<Recording>& recordings, const std::vector<Run>& runs) {
  MarkdownTable table({"drive", "estimator", "ends of A and B apart [% of the distance]"});
  for (std::size_t i = 0; i + 1 < recordings.size(); ++i) {
    const std::string& a = recordings[i].name;
    if (a.size() < 2 || a.substr(a.size() - 2) != "_A") continue;
    const std::string drive = a.substr(0, a.size() - 2);
    if (recordings[i + 1].name != fmt::format("{}_B", drive)) continue;
    for (std::size_t e = 0; e < 2; ++e) {
      std::array<const Run*, 2> pair{};
      for (const Run& run : runs) {
        if (run.estimator != e || !run.kind.empty() || run.calibrated) continue;
        if (run.original == i) pair[0] = &run;
        if (run.original == i + 1) pair[1] = &run;
      }
      const double apart = (pair[0]->score.end - pair[1]->score.end).norm();
      table.add({drive, estimators()[e].name, number(100.0 * apart / pair[0]->score.distance, 2)});
    }
  }
  return table.text();
}

}  // namespace

Result real(const Settings& settings) {
  if (settings.data.empty()) throw std::runtime_error("real needs --data, a folder of recordings");
  const std::vector<Recording> recordings = find_recordings(settings.data);
  std::vector<Recording> calibrated_ones(recordings.size());
  parallel_for(recordings.size(), settings.threads, {},
               [&](std::size_t i) { calibrated_ones[i] = calibrated(recordings[i]); });
  std::vector<std::vector<Copy>> copies;
  for (const Recording& recording : recordings) {
    copies.push_back(perturbed(recording, settings.seeds > 0 ? settings.seeds : kDraws, 1));
  }
  std::vector<Run> runs;
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    for (std::size_t e = 0; e < estimators().size(); ++e) {
      runs.push_back({&recordings[i], i, e, {}});
      runs.push_back({&calibrated_ones[i], i, e, {}, true});
    }
    for (const Copy& copy : copies[i]) {
      for (const std::size_t e : {0U, 1U}) runs.push_back({&copy.recording, i, e, copy.kind});
    }
  }
  parallel_for(runs.size(), settings.threads, settings.on_progress, [&](std::size_t i) {
    const Options options = options_for(*runs[i].recording, estimators()[runs[i].estimator]);
    runs[i].score = judge(*runs[i].recording, replay(runs[i].recording->data, options));
  });
  const auto chosen = [&runs](const std::function<bool(const Run&)>& wanted) {
    std::vector<const Run*> some;
    for (const Run& run : runs) {
      if (wanted(run)) some.push_back(&run);
    }
    return some;
  };

  MarkdownTable presets(with_front({"estimator", "mounting"}, kSummaryHead));
  for (std::size_t e = 0; e < estimators().size(); ++e) {
    for (const bool own : {false, true}) {
      presets.add(with_front({estimators()[e].name, own ? "as calibrated" : "as given"},
                             summary_cells(chosen([&](const Run& run) {
                               return run.estimator == e && run.kind.empty() &&
                                      run.calibrated == own;
                             }))));
    }
  }
  MarkdownTable perturbations(with_front({"copies", "estimator"}, kSummaryHead));
  std::vector<std::string> kinds;
  for (const Copy& copy : copies.front()) {
    if (std::find(kinds.begin(), kinds.end(), copy.kind) == kinds.end()) kinds.push_back(copy.kind);
  }
  kinds.emplace_back();  // all of them
  for (const std::string& kind : kinds) {
    for (const std::size_t e : {0U, 1U}) {
      perturbations.add(with_front({kind.empty() ? "all" : kind, estimators()[e].name},
                                   summary_cells(chosen([&](const Run& run) {
                                     return run.estimator == e && !run.kind.empty() &&
                                            (kind.empty() || run.kind == kind);
                                   }))));
    }
  }
  Result result;
  result.markdown = fmt::format(
      "Static start, no option set. RMS in % of the distance: horizontal against the reference,\n"
      "laid over it at the first scan (position and heading); height against the flat floor or\n"
      "the barometer. Creep: range of the height during the rest at the end. - = not known of\n"
      "this recording.\n\n{}\nTwo radars of one drive:\n\n{}\nAll recordings, median (worst); as "
      "calibrated: mounting and stamps as the filter of `default` finds them in the same\n"
      "recording:\n\n{}\nPerturbed copies, median (worst):\n\n{}",
      table_of_recordings(recordings, runs), table_of_pairs(recordings, runs), presets.text(),
      perturbations.text());
  return result;
}

}  // namespace rio::experiment
