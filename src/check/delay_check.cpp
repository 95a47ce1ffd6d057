// SPDX-License-Identifier: BSD-3-Clause
#include "check/judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "check/axes.hpp"

namespace rio::check {

namespace {

constexpr double kShiftStep = 0.02;  // [s]
constexpr int kShifts = 14;          // to each side; below kMostShift
constexpr double kWrong = 0.045;     // not corrected by an estimator with a prior of 30 ms [s]

/// Around the configured delay [s].
std::vector<double> tested_shifts(const RadarOptions& radar) {
  std::vector<double> shifts;
  for (int i = -kShifts; i <= kShifts; ++i) shifts.push_back(kShiftStep * i - radar.time_offset);
  return shifts;
}

std::vector<double> most_explained(const std::vector<Agreement>& shifts, const Options& options,
                                   DopplerSign sign) {
  std::vector<double> most;
  for (const Agreement& windows : shifts) most.push_back(most_explained(windows, options, sign));
  return most;
}

/// The shift of the stamps that explains the most.
struct Shift {
  double seconds = 0.0;
  double explained = 0.0;
};

Shift best_shift(const std::vector<Agreement>& shifts, const Matrix3d& R) {
  std::vector<double> explained;
  for (const Agreement& windows : shifts) explained.push_back(windows.explained(R));
  const auto best = std::max_element(explained.begin(), explained.end());
  const auto index = static_cast<int>(std::distance(explained.begin(), best));
  Shift out{kShiftStep * (index - kShifts), *best};
  if (best != explained.begin() && best + 1 != explained.end()) {  // parabola through three points
    const double curvature = best[-1] - 2.0 * best[0] + best[1];
    if (curvature < 0.0) out.seconds += 0.5 * kShiftStep * (best[-1] - best[1]) / curvature;
  }
  return out;
}

}  // namespace

double most_explained(const Agreement& windows, const Options& options, DopplerSign sign) {
  const Matrix3d configured = options.radar.T_BS.rotation.toRotationMatrix();
  double most = 0.0;
  for (const Axes& axes : candidates(options.radar.T_BS.rotation)) {
    if (!allowed(axes, configured, sign)) continue;
    most = std::max(most, windows.explained(axes.R));
  }
  return most;
}

std::vector<Agreement> all_shifts(const MotionData& data, double length,
                                  const RadarOptions& radar) {
  const ImuPath path(data.samples, data.gyro_unit, data.accel_unit);
  return agreements(data.speeds, path, length, radar.T_BS.translation, tested_shifts(radar));
}

const Agreement& windows_to_judge(const std::vector<Agreement>& shifts, const Options& options,
                                  DopplerSign sign) {
  const std::vector<double> most = most_explained(shifts, options, sign);
  const auto best = std::max_element(most.begin(), most.end()) - most.begin();
  const Agreement& configured = shifts[kShifts];
  return significance(most[kShifts], most[static_cast<std::size_t>(best)], configured.windows) >
                 kSignificant
             ? shifts[static_cast<std::size_t>(best)]
             : configured;
}

Finding check_delay(const std::vector<Agreement>& shifts, const Matrix3d& R, const Options& options,
                    const Advice& advice) {
  constexpr double kNotable = 0.02;  // [s]
  constexpr double kMaybe = 2.0;     // sigmas
  const double configured = options.radar.time_offset;
  const Shift shift = best_shift(shifts, R);
  const double sure =
      significance(shifts[kShifts].explained(R), shift.explained, shifts[kShifts].windows);
  Finding out{Verdict::kOk, "delay of the radar",
              fmt::format("radar and IMU agree best with the radar's stamps moved by {:+.0f} ms",
                          1e3 * shift.seconds)};
  const double size = std::abs(shift.seconds);
  out.text += fmt::format(", by {:.1f} sigmas", sure);
  if (size < kNotable || sure < kMaybe) return out;
  out.verdict = size > kWrong && sure > kSignificant ? Verdict::kWrong : Verdict::kDoubtful;
  const double offset = configured - shift.seconds;
  out.change = advice.option(fmt::format("time_offset: {:.3f}", offset),
                             fmt::format("time_offset_s: {:.3f}", offset));
  return out;
}

bool ends_at_the_best(const std::vector<Agreement>& shifts, const Options& options,
                      DopplerSign sign) {
  const std::vector<double> most = most_explained(shifts, options, sign);
  const auto best = std::max_element(most.begin(), most.end());
  return *best > kExplained && (best == most.begin() || best + 1 == most.end());
}

std::optional<Finding> check_far_delay(const MotionData& data, double length, double near,
                                       const Options& options, const Advice& advice) {
  constexpr double kFarthest = 4.0;                        // [s]
  constexpr double kCovered = 2.0 * kShifts * kShiftStep;  // by all_shifts() [s]
  constexpr double kSure = 5.0;                            // the best of 400 [sigmas]
  double most = kExplained;
  double delay = 0.0;
  std::vector<RadarSpeed> moved = data.speeds;
  for (double middle = -kFarthest; middle <= kFarthest; middle += kCovered) {
    for (std::size_t i = 0; i < moved.size(); ++i) {
      moved[i].time = data.speeds[i].time + from_seconds(middle);
    }
    const MotionData there{data.samples, moved, data.gyro_unit, data.accel_unit};
    const std::vector<Agreement> shifts = all_shifts(there, length, options.radar);
    for (std::size_t i = 0; i < shifts.size(); ++i) {
      const Agreement& windows = shifts[i];
      const double moved_by = middle + kShiftStep * (static_cast<double>(i) - kShifts);
      const double explained = most_explained(windows, options, data.doppler_sign);
      if (windows.windows < kFewestWindows || explained <= most ||
          std::abs(moved_by) < 0.5 * kCovered ||
          significance(near, explained, windows.windows) < kSure) {
        continue;
      }
      most = explained;
      delay = moved_by;
    }
  }
  if (delay == 0.0) return std::nullopt;
  return Finding{Verdict::kWrong, "delay of the radar",
                 fmt::format("radar and IMU agree only with the radar's stamps moved by {:+.2f} s, "
                             "then in {:.0f} % of the movement",
                             delay, 100.0 * most),
                 advice.bag()
                     ? fmt::format("--radar-offset \"{:+.2f} s\"", delay)
                     : fmt::format("add {:.0f} to the stamps of {}", 1e9 * delay, advice.csv())};
}

}  // namespace rio::check
