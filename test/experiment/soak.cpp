// SPDX-License-Identifier: BSD-3-Clause
// A flight of a day: does anything grow, drift or depend on the order of the calls?
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"
#include "experiment/soak_run.hpp"
#include "experiment/spread.hpp"
#include "rio/core/chi2.hpp"

namespace rio::experiment {

namespace {

constexpr double kRow = 600.0;          // [s]
constexpr double kComparison = 600.0;   // of the runs that must be the same [s]
constexpr std::size_t kTableRows = 24;  // of the report; the csv has all
constexpr double kDegree = 3.14159265358979323846 / 180.0;

double largest(const std::vector<SoakRow>& rows, double SoakRow::*value) {
  double most = 0.0;
  for (const SoakRow& row : rows) {
    // not max(), so that a NaN is reported
    if (!(row.*value <= most)) most = row.*value;
  }
  return most;
}

double mean(const std::vector<SoakRow>& rows, double SoakRow::*value) {
  double sum = 0.0;
  for (const SoakRow& row : rows) sum += row.*value;
  return rows.empty() ? std::numeric_limits<double>::quiet_NaN()
                      : sum / static_cast<double>(rows.size());
}

std::vector<std::string> cells(const SoakRow& row) {
  return {fmt::format("{:.2f}", row.time / 3600.0),
          fmt::format("{:.1f}", row.resident),
          fmt::format("{:.3f} / {:.3f}", row.position_error, row.position_sigma),
          fmt::format("{:.2f}", row.nees_position),
          fmt::format("{:.3f}", row.velocity_error),
          fmt::format("{:.2f}", row.nees_velocity),
          fmt::format("{:.3f}", row.tilt_error / kDegree),
          fmt::format("{:.2f}", row.nees_tilt),
          fmt::format("{:.2f}", row.calibration),
          fmt::format("{:.0e}", row.asymmetry),
          fmt::format("{:.0e}", row.norm_error),
          fmt::format("{:.2f} / {:.2f}", 1e3 * row.time_per_scan, 1e3 * row.longest_scan)};
}

std::string table_of(const std::vector<SoakRow>& rows) {
  MarkdownTable table({"time [h]", "memory [MB]", "position error / sigma [m]", "NEES",
                       "velocity error [m/s]", "NEES", "tilt error [deg]", "NEES",
                       "calibration NEES", "asymmetry of P", "norm of q, less 1",
                       "time a scan, mean / longest [ms]"});
  const std::size_t step = (rows.size() + kTableRows - 1) / kTableRows;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if ((i + 1) % step == 0 || i + 1 == rows.size()) table.add(cells(rows[i]));
  }
  return table.text();
}

std::string csv_of(const std::vector<SoakRow>& rows) {
  std::string text =
      "t_s,resident_mb,position_error,position_sigma,nees_position,velocity_error,nees_velocity,"
      "tilt_error,nees_tilt,nees_calibration,asymmetry,norm_error,lag,time_per_scan,longest_scan\n";
  for (const SoakRow& r : rows) {
    text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", r.time, r.resident,
                        r.position_error, r.position_sigma, r.nees_position, r.velocity_error,
                        r.nees_velocity, r.tilt_error, r.nees_tilt, r.calibration, r.asymmetry,
                        r.norm_error, r.lag, r.time_per_scan, r.longest_scan);
  }
  return text;
}

/// The rows of the verdict: criterion, value, and whether it held.
class Verdict {
 public:
  void add(const std::string& what, const std::string& found, const std::string& asked, bool held) {
    table_.add({what, found, asked, held ? "yes" : "NO"});
  }
  void below(const std::string& what, const char* format, double found, double bound,
             const char* asked) {
    add(what, fmt::format(fmt::runtime(format), found), fmt::format("below {}", asked),
        found < bound);
  }
  const std::string& text() const { return table_.text(); }

 private:
  MarkdownTable table_{{"", "found", "asked", "held"}};
};

void judge_constancy(const SoakRun& run, Verdict* verdict) {
  const std::vector<SoakRow>& rows = run.rows;
  // of the second row: the first includes the start
  const double grown =
      rows.back().resident - rows[std::min<std::size_t>(1, rows.size() - 1)].resident;
  verdict->below("growth of memory [MB]", "{:.2f}", grown, 1.0, "1");
  verdict->add("finite at every scan", run.finite ? "yes" : "no", "yes", run.finite);
  const double asymmetry = largest(rows, &SoakRow::asymmetry);
  verdict->add("asymmetry of P", fmt::format("{:.0e}", asymmetry), "0", asymmetry == 0.0);
  verdict->below("norm of q, less 1", "{:.0e}", largest(rows, &SoakRow::norm_error), 1e-14,
                 "1e-14");
  const double lag = largest(rows, &SoakRow::lag);
  verdict->add("now() off the newest sample [s]", fmt::format("{}", lag), "0", lag == 0.0);
  const Counters& c = run.counters;
  verdict->add("scans processed", fmt::format("{} of {}", c.scans, run.scans), "all",
               c.scans == run.scans);
  const std::uint64_t failed = c.updates_failed + c.velocity_resets + c.attitude_resets;
  verdict->add("updates failed, states replaced", fmt::format("{}", failed), "0", failed == 0);
  const auto part = static_cast<long>(std::max<std::size_t>(1, rows.size() / 4));
  const double first = mean({rows.begin(), rows.begin() + part}, &SoakRow::time_per_scan);
  const double last = mean({rows.end() - part, rows.end()}, &SoakRow::time_per_scan);
  verdict->below("time a scan, last quarter over first", "{:.2f}", last / first, 1.5, "1.5");
}

void judge_errors(const std::vector<SoakRow>& rows, Verdict* verdict) {
  const double bound = chi2_quantile(0.9999, 3.0) / 3.0;  // at any time of the run
  verdict->below("position: largest NEES of a row", "{:.2f}",
                 largest(rows, &SoakRow::nees_position), bound,
                 fmt::format("{:.1f}", bound).c_str());
  const auto mean_below = [&](const char* what, double SoakRow::*value) {
    verdict->below(what, "{:.2f}", mean(rows, value), 1.5, "1.5");
  };
  mean_below("velocity: mean NEES", &SoakRow::nees_velocity);
  mean_below("tilt: mean NEES", &SoakRow::nees_tilt);
  mean_below("calibration: mean NEES", &SoakRow::calibration);
}

void judge_order(const SoakSettings& settings, Verdict* verdict) {
  SoakSettings brief = settings;
  brief.seconds = std::min(settings.seconds, kComparison);
  const std::uint64_t hash = run_soak(brief).hash;
  const auto compare = [&](const char* what, Interleaving interleaving) {
    brief.interleaving = interleaving;
    const bool same = run_soak(brief).hash == hash;
    verdict->add(what, same ? "same bytes" : "other bytes", "same bytes", same);
  };
  compare("flown again", Interleaving::kScanFirst);
  compare("each sample before the scan", Interleaving::kImuFirst);
  compare("scans 0.2 s early: they wait", Interleaving::kEarly);
  compare("scans 0.1 s late", Interleaving::kLate);
}

}  // namespace

Result soak(const Settings& settings) {
  SoakSettings chosen;
  chosen.seconds = 3600.0 * settings.hours;
  chosen.every = std::min(kRow, chosen.seconds);
  chosen.backend = settings.smoother ? BackEnd::kSmoother : BackEnd::kEkf;
  const auto total = static_cast<std::size_t>(chosen.seconds / chosen.every);
  std::size_t done = 0;
  const SoakRun run = run_soak(chosen, [&](const SoakRow&) {
    if (settings.on_progress) settings.on_progress(++done, total);
  });
  Verdict verdict;
  judge_constancy(run, &verdict);
  judge_errors(run.rows, &verdict);
  judge_order(chosen, &verdict);
  const char* name = settings.smoother ? "smoother" : "filter";
  Result result;
  result.markdown = fmt::format(
      "`default`, {}, {:.2f} simulated hours in one go: every ten minutes from the ground and "
      "back, each time another way.\nTimes are of this machine. A row is at its time; NEES over "
      "its dimension, of velocity (body axes), tilt and calibration (each\nparameter by itself) "
      "the mean since the row before. The csv has a row every ten minutes.\n\n{}\n{}",
      name, settings.hours, table_of(run.rows), verdict.text());
  result.attachments.push_back(
      {settings.smoother ? "soak-smoother.csv" : "soak.csv", csv_of(run.rows)});
  return result;
}

}  // namespace rio::experiment
