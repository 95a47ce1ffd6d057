// SPDX-License-Identifier: BSD-3-Clause
#include "check/clock_steps.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "check/motion.hpp"
#include "check/motion_data.hpp"
#include "check/numbers.hpp"
#include "rio/frontend/mounting_search.hpp"

namespace rio::check {

namespace {

/// Velocities of the scans [first, end).
std::vector<RadarSpeed> speeds_of(const Scans& scans, std::size_t first, std::size_t end,
                                  const Options& options) {
  Scans part;
  RadarScan scan;
  for (std::size_t i = first; i < end; ++i) {
    scans.get(i, &scan);
    part.push_back(scan);
  }
  return radar_speeds(part, options);
}

/// The windows with the stamps moved by `shift`.
Agreement agreement(std::vector<RadarSpeed> speeds, Time shift, const CheckedImu& imu,
                    const Options& options) {
  constexpr double kLength = 2.0;  // of a window [s]
  for (RadarSpeed& speed : speeds) speed.time += shift;
  const ImuPath path(imu.good, imu.check.gyro_unit, imu.check.accel_unit);
  return agreements(speeds, path, kLength, options.radar.T_BS.translation,
                    {-options.radar.time_offset})[0];
}

}  // namespace

std::vector<ClockStep> possible_steps(const std::vector<Time>& stamps) {
  constexpr double kSmallest = 0.1;   // less is a delay that an estimator finds [s]
  constexpr double kRepaired = 0.05;  // a corrupt stamp is off by this at most after it [s]
  constexpr std::size_t kMost = 8;
  std::vector<double> intervals;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    intervals.push_back(to_seconds(stamps[i] - stamps[i - 1]));
  }
  const double usual = median(intervals);
  std::vector<ClockStep> out;
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    const double step = intervals[i] - usual;
    if (!(std::abs(step) > kSmallest)) continue;
    const bool corrupt =
        i + 1 < intervals.size() && std::abs(step + intervals[i + 1] - usual) < kRepaired;
    if (!corrupt) out.push_back({i + 1, from_seconds(step)});
    if (corrupt) ++i;
  }
  if (out.size() <= kMost) return out;
  std::ranges::nth_element(out, out.begin() + kMost, std::ranges::greater{},
                           [](const ClockStep& s) { return std::abs(to_seconds(s.size)); });
  out.resize(kMost);
  std::ranges::sort(out, std::ranges::less{}, &ClockStep::scan);
  return out;
}

std::vector<ClockStep> clock_steps(const CheckedImu& imu, const Scans& scans,
                                   const Options& options) {
  std::vector<Time> stamps;
  for (std::size_t i = 0; i < scans.size(); ++i) stamps.push_back(scans[i].time);
  const std::vector<ClockStep> possible = possible_steps(stamps);
  if (possible.empty() || MountingSearch::is_unknown(options.calibration)) return {};
  std::vector<std::vector<RadarSpeed>> speeds;  // after each
  for (std::size_t k = 0; k < possible.size(); ++k) {
    const std::size_t end = k + 1 < possible.size() ? possible[k + 1].scan : scans.size();
    speeds.push_back(speeds_of(scans, possible[k].scan, end, options));
  }
  const Matrix3d R = options.radar.T_BS.rotation.toRotationMatrix();
  std::vector<ClockStep> steps;
  Time moved{0};
  for (std::size_t k = 0; k < possible.size(); ++k) {
    std::vector<RadarSpeed> after;
    for (std::size_t i = k; i < speeds.size(); ++i) {
      after.insert(after.end(), speeds[i].begin(), speeds[i].end());
    }
    const double as_is = agreement(after, -moved, imu, options).explained(R);
    const Agreement windows = agreement(after, -moved - possible[k].size, imu, options);
    const double without = windows.explained(R);
    if (windows.windows < kFewestWindows || without < kExplained ||
        significance(as_is, without, windows.windows) < kSignificant) {
      continue;
    }
    moved += possible[k].size;
    steps.push_back(possible[k]);
  }
  return steps;
}

std::vector<ClockStep> clock_steps(const CheckedData& data, const Options& options,
                                   std::size_t radar) {
  const std::optional<std::vector<ImuSample>> fewer = usable_if_not_all(data.imu);
  const std::vector<ImuSample>& good = fewer ? *fewer : data.imu;
  const ImuCheck check = check_imu(data.imu, good, data.sensors.imu_info, Source::kFolder, {});
  if (data.imu.empty() || !check.stamped || !check.integrable || check.exchanged) return {};
  return clock_steps({data.imu, good, check}, data.radars[radar],
                     radar == 0 ? options : options.seen_by(radar));
}

Time offset_at(const std::vector<ClockStep>& steps, std::size_t scan) {
  Time offset{0};
  for (const ClockStep& step : steps) {
    if (step.scan <= scan) offset += step.size;
  }
  return offset;
}

Scans without_steps(const Scans& scans, const std::vector<ClockStep>& steps) {
  Scans out;
  out.reserve(scans.size(), scans.points().size());
  RadarScan scan;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    scans.get(i, &scan);
    scan.time -= offset_at(steps, i);
    out.push_back(scan);
  }
  return out;
}

}  // namespace rio::check
