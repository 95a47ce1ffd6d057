// SPDX-License-Identifier: BSD-3-Clause
#include "check/clock_steps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "check/imu_check.hpp"
#include "check/motion.hpp"
#include "check/motion_check.hpp"
#include "check/numbers.hpp"
#include "rio/checks/stamp_guard.hpp"
#include "rio/frontend/mounting_search.hpp"

namespace rio::check {

namespace {

/// Velocities of the scans [first, end).
std::vector<RadarSpeed> speeds_of(const Scans& scans, std::size_t first, std::size_t end,
                                  const Options& options) {
  Scans part;
  for (std::size_t i = first; i < end; ++i) part.push_back(scans.get(i));
  return radar_speeds(part, options);
}

/// The windows with the stamps of the radar moved by `shift`.
/// @param samples that can be integrated
Agreement agreement(std::vector<RadarSpeed> speeds, Time shift,
                    const std::vector<ImuSample>& samples, const ImuCheck& check,
                    const Options& options) {
  constexpr double kLength = 2.0;  // of a window [s]
  for (RadarSpeed& speed : speeds) speed.time += shift;
  const ImuPath path(samples, check.gyro_unit, check.accel_unit);
  return agreements(speeds, path, kLength, options.radar).front();
}

/// Whether the windows without a step agree significantly better than those with it. They must not
/// be fewer, but by one cut at the step: a part without one of the sensors explains nothing.
bool is_step(const Agreement& with, const Agreement& without, const Options& options) {
  const Matrix3d R = options.radar.T_BS.rotation.toRotationMatrix();
  const double explained = without.explained(R);
  return without.windows >= kFewestWindows && without.windows + 1 >= with.windows &&
         explained > kExplained &&
         significance(with.explained(R), explained, without.windows) > kSignificant;
}

template <class Items>
std::vector<ClockStep> possible_steps_of(const Items& items) {
  std::vector<Time> stamps;
  for (std::size_t i = 0; i < items.size(); ++i) stamps.push_back(items[i].time);
  return possible_steps(stamps);
}

std::vector<ClockStep> radar_steps(const std::vector<ImuSample>& samples, const ImuCheck& check,
                                   const Scans& scans, const Options& options) {
  const std::vector<ClockStep> possible = possible_steps_of(scans);
  if (possible.empty()) return {};
  std::vector<std::vector<RadarSpeed>> speeds;  // after each
  for (std::size_t k = 0; k < possible.size(); ++k) {
    const std::size_t end = k + 1 < possible.size() ? possible[k + 1].first : scans.size();
    speeds.push_back(speeds_of(scans, possible[k].first, end, options));
  }
  std::vector<ClockStep> steps;
  Time moved{0};
  for (std::size_t k = 0; k < possible.size(); ++k) {
    std::vector<RadarSpeed> after;
    for (std::size_t i = k; i < speeds.size(); ++i) {
      after.insert(after.end(), speeds[i].begin(), speeds[i].end());
    }
    const auto with_moved = [&](Time by) { return agreement(after, -by, samples, check, options); };
    if (!possible[k].certain &&
        !is_step(with_moved(moved), with_moved(moved + possible[k].size), options)) {
      continue;
    }
    moved += possible[k].size;
    steps.push_back(possible[k]);
  }
  return steps;
}

std::vector<ClockStep> imu_steps(const std::vector<ImuSample>& samples, const ImuCheck& check,
                                 const Scans& scans, const Options& options) {
  const std::vector<ClockStep> possible = possible_steps_of(samples);
  if (possible.empty()) return {};
  const std::vector<RadarSpeed> speeds = radar_speeds(scans, options);
  std::vector<ClockStep> steps;
  const auto with_stamps_of = [&](const std::vector<ImuSample>& stamped) {
    return agreement(speeds, Time{0}, Usable(stamped).good(), check, options);
  };
  Agreement with = with_stamps_of(samples);
  for (const ClockStep& step : possible) {
    steps.push_back(step);
    const Agreement without = with_stamps_of(without_steps(samples, steps));
    if (step.certain || is_step(with, without, options)) {
      with = without;
    } else {
      steps.pop_back();
    }
  }
  return steps;
}

}  // namespace

std::vector<ClockStep> possible_steps(const std::vector<Time>& stamps) {
  constexpr double kSmallest = 0.05;  // less is a delay that an estimator finds [s]
  constexpr double kRepaired = 0.05;  // a corrupt stamp is off by this at most after it [s]
  constexpr std::size_t kMost = 8;
  std::vector<double> intervals;  // NaN beside what is no stamp
  std::vector<double> known;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    const bool both = is_stamp(stamps[i - 1]) && is_stamp(stamps[i]);
    intervals.push_back(both ? to_seconds(stamps[i] - stamps[i - 1])
                             : std::numeric_limits<double>::quiet_NaN());
    if (both) known.push_back(intervals.back());
  }
  const double usual = median(known);
  const auto stays_back = [&](std::size_t i) {
    constexpr std::size_t kStays = 20;  // intervals to both sides
    if (!(intervals[i] < 0.0) || i < kStays || i + kStays >= intervals.size()) return false;
    for (std::size_t k = i - kStays; k <= i + kStays; ++k) {
      const bool returns = intervals[k] > -0.5 * intervals[i];
      if (k != i && (intervals[k] < 0.0 || returns)) return false;
    }
    return true;
  };
  // batches whose stamps overlap go back by little at each
  const bool only = std::ranges::count_if(intervals, [](double s) { return s < 0.0; }) == 1;
  std::vector<ClockStep> out;
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    const double step = intervals[i] - usual;
    const bool certain = stays_back(i);
    if (!(std::abs(step) > kSmallest) && !(certain && only)) continue;
    const bool corrupt = !certain && i + 1 < intervals.size() &&
                         std::abs(step + intervals[i + 1] - usual) < kRepaired;
    if (!corrupt) out.push_back({i + 1, from_seconds(step), certain});
    if (corrupt) ++i;
  }
  if (out.size() <= kMost) return out;
  std::ranges::nth_element(
      out, out.begin() + kMost, std::ranges::greater{},
      [](const ClockStep& s) { return std::pair(s.certain, std::abs(to_seconds(s.size))); });
  out.resize(kMost);
  std::ranges::sort(out, std::ranges::less{}, &ClockStep::first);
  return out;
}

ClockSteps find_clock_steps(const std::vector<ImuSample>& samples, const std::vector<Scans>& radars,
                            const io::ImuInfo& info, const Options& options) {
  ClockSteps steps{{}, std::vector<std::vector<ClockStep>>(radars.size())};
  const bool none =
      possible_steps_of(samples).empty() && std::ranges::all_of(radars, [](const Scans& scans) {
        return possible_steps_of(scans).empty();
      });
  if (none || MountingSearch::is_unknown(options.calibration)) return steps;
  const ImuCheck check = check_imu(Usable(samples), info, Source::kFolder, {});
  if (check.stamp_unit != 1.0 || !check.integrable || check.exchanged) return steps;
  steps.imu = imu_steps(samples, check, radars[0], options);
  const std::vector<ImuSample> moved = without_steps(samples, steps.imu);
  const Usable usable(moved);
  for (std::size_t r = 0; r < radars.size() && r < options.radars(); ++r) {
    steps.radars[r] = radar_steps(usable.good(), check, radars[r], options.seen_by(r));
  }
  return steps;
}

Time without_steps(Time stamp, const std::vector<ClockStep>& steps, std::size_t item) {
  for (const ClockStep& step : steps) {
    if (step.first <= item && is_stamp(stamp)) stamp -= step.size;
  }
  return stamp;
}

Scans without_steps(const Scans& scans, const std::vector<ClockStep>& steps) {
  return changed(scans, [&steps](std::size_t i, RadarScan* scan) {
    scan->time = without_steps(scan->time, steps, i);
  });
}

std::vector<ImuSample> without_steps(std::vector<ImuSample> samples,
                                     const std::vector<ClockStep>& steps) {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i].time = without_steps(samples[i].time, steps, i);
  }
  return samples;
}

}  // namespace rio::check
