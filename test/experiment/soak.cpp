// SPDX-License-Identifier: BSD-3-Clause
// A flight of a day: does anything grow, drift or depend on the order of the calls?
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "experiment/experiment.hpp"
#include "experiment/soak_run.hpp"
#include "rio/core/chi2.hpp"

namespace rio::experiment {

namespace {

constexpr double kRow = 600.0;          // [s]
constexpr double kComparison = 600.0;   // of the runs that must be the same [s]
constexpr std::size_t kTableRows = 24;  // of the report; the csv has all

std::vector<std::string> cells(const SoakRow& row) {
  return {fmt::format("{:.2f}", row.time / 3600.0),
          fmt::format("{:.1f}", row.resident),
          fmt::format("{:.3f} / {:.3f}", row.position_error.norm(), row.position_sigma),
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
      "t_s,resident_mb,error_x,error_y,error_z,position_sigma,nees_position,velocity_error,"
      "nees_velocity,tilt_error,nees_tilt,nees_calibration,asymmetry,norm_error,lag,time_per_scan,"
      "longest_scan\n";
  for (const SoakRow& r : rows) {
    text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", r.time, r.resident,
                        fmt::join(r.position_error, ","), r.position_sigma, r.nees_position,
                        r.velocity_error, r.nees_velocity, r.tilt_error, r.nees_tilt, r.calibration,
                        r.asymmetry, r.norm_error, r.lag, r.time_per_scan, r.longest_scan);
  }
  return text;
}

/// The rows of the verdict: criterion, value, and whether it held.
class Verdict {
 public:
  void add(const std::string& what, const std::string& found, const std::string& asked, bool held) {
    table_.add({what, found, asked, held ? "yes" : "NO"});
  }
  void below(const std::string& what, const char* format, double found, double bound) {
    add(what, fmt::format(fmt::runtime(format), found), fmt::format("below {}", bound),
        found < bound);
  }
  void zero(const std::string& what, const char* format, double found) {
    add(what, fmt::format(fmt::runtime(format), found), "0", found == 0.0);
  }
  const std::string& text() const { return table_.text(); }

 private:
  MarkdownTable table_{{"", "found", "asked", "held"}};
};

void judge_constancy(const SoakRun& run, Verdict* verdict) {
  const std::vector<SoakRow>& rows = run.rows;
  // of the second row: the first includes the start
  const double before = rows[std::min<std::size_t>(1, rows.size() - 1)].resident;
  verdict->below("growth of memory [MB]", "{:.2f}", rows.back().resident - before, 1.0);
  verdict->add("finite at every scan", run.finite ? "yes" : "no", "yes", run.finite);
  verdict->zero("asymmetry of P", "{:.0e}", Spread::of(rows, &SoakRow::asymmetry).worst);
  verdict->below("norm of q, less 1", "{:.0e}", Spread::of(rows, &SoakRow::norm_error).worst,
                 1e-14);
  verdict->zero("now() off the newest sample [s]", "{}", Spread::of(rows, &SoakRow::lag).worst);
  const Counters& c = run.counters;
  verdict->add("scans processed", fmt::format("{} of {}", c.scans, run.scans), "all",
               c.scans == run.scans);
  verdict->zero("updates failed, states replaced", "{}",
                static_cast<double>(c.updates_failed + c.velocity_resets + c.attitude_resets));
  const auto part = static_cast<long>(std::max<std::size_t>(1, rows.size() / 4));
  const auto time_of = [](std::vector<SoakRow>::const_iterator begin, long count) {
    return Spread::of(std::vector<SoakRow>(begin, begin + count), &SoakRow::time_per_scan).mean;
  };
  verdict->below("time a scan, last quarter over first", "{:.2f}",
                 time_of(rows.end() - part, part) / time_of(rows.begin(), part), 1.5);
}

void judge_errors(const std::vector<SoakRow>& rows, Verdict* verdict) {
  const double bound = chi2_quantile(0.9999, 3.0) / 3.0;  // at any time of the run
  const double position = Spread::of(rows, &SoakRow::nees_position).worst;
  verdict->add("position: largest NEES of a row", fmt::format("{:.2f}", position),
               fmt::format("below {:.1f}", bound), position < bound);
  verdict->below("velocity: mean NEES", "{:.2f}", Spread::of(rows, &SoakRow::nees_velocity).mean,
                 1.5);
  verdict->below("tilt: mean NEES", "{:.2f}", Spread::of(rows, &SoakRow::nees_tilt).mean, 1.5);
  verdict->below("calibration: mean NEES", "{:.2f}", Spread::of(rows, &SoakRow::calibration).mean,
                 1.5);
}

void judge_order(SoakSettings brief, Verdict* verdict) {
  constexpr std::pair<const char*, Interleaving> kOrders[] = {
      {"flown again", Interleaving::kScanFirst},
      {"each sample before the scan", Interleaving::kImuFirst},
      {"scans 0.2 s early: they wait", Interleaving::kEarly},
      {"scans 0.1 s late", Interleaving::kLate}};
  brief.seconds = std::min(brief.seconds, kComparison);
  const std::uint64_t hash = run_soak(brief).hash;
  for (const auto& [what, interleaving] : kOrders) {
    brief.interleaving = interleaving;
    const bool same = run_soak(brief).hash == hash;
    verdict->add(what, same ? "same bytes" : "other bytes", "same bytes", same);
  }
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
  const std::string text = fmt::format(
      "`default`, {}, {:.2f} simulated hours in one go: every ten minutes from the ground and "
      "back, each time another way.\nTimes are of this machine. A row is at its time; NEES over "
      "its dimension, of velocity (body axes), tilt and calibration (each\nparameter by itself) "
      "the mean since the row before. The csv has a row every ten minutes.\n\n{}\n{}",
      settings.smoother ? "smoother" : "filter", settings.hours, table_of(run.rows),
      verdict.text());
  return {text, {{settings.smoother ? "soak-smoother.csv" : "soak.csv", csv_of(run.rows)}}};
}

}  // namespace rio::experiment
