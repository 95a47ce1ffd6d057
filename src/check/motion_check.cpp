// SPDX-License-Identifier: BSD-3-Clause
#include "check/motion_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>

#include "check/numbers.hpp"
#include "rio/frontend/mounting_search.hpp"

namespace rio::check {

namespace {

constexpr double kLeast = 10.0;  // in all windows together [s]
constexpr std::array kLengths = {kShortestWindow, 2.0 * kShortestWindow, 4.0 * kShortestWindow};

// The delay of the stamps of the radar, by the shift with which the motion of radar and IMU agrees
// best: every 20 ms up to 0.28 s to both sides of the configured delay, and up to ten seconds
// where these are not enough or the best of them is no small one.

constexpr double kShiftStep = 0.02;  // [s]
constexpr int kShifts = 14;          // to each side; below kMostShift

/// What the best_axes() explain with each shift.
std::vector<double> most_explained(const std::vector<Agreement>& shifts, const Options& options,
                                   DopplerSign sign) {
  std::vector<double> most;
  for (const Agreement& windows : shifts) {
    most.push_back(best_axes(windows, options, sign).explained);
  }
  return most;
}

/// The windows for every shift around `middle`, from the most negative on.
/// @param length of a window [s]
/// @param middle a shift besides the configured delay [s]
std::vector<Agreement> all_shifts(const MotionData& data, double length, const RadarOptions& radar,
                                  double middle = 0.0) {
  std::vector<RadarSpeed> moved = data.speeds;
  for (RadarSpeed& speed : moved) speed.time += from_seconds(middle);
  std::vector<double> shifts;  // [s]
  for (int i = -kShifts; i <= kShifts; ++i) shifts.push_back(kShiftStep * i);
  return agreements(moved, data.path(), length, radar, shifts);
}

/// The windows in which the axes are judged: at the configured delay, unless another shift is
/// significantly better with some axes.
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

/// The shift of the stamps with the least residual (E8).
struct Shift {
  double seconds = 0.0;
  double sure = 0.0;    ///< (E6), over the configured delay [sigmas]
  bool at_end = false;  ///< of those tested
};

Shift best_shift(const std::vector<Agreement>& shifts, const Matrix3d& R) {
  std::vector<double> explained;
  for (const Agreement& windows : shifts) {
    explained.push_back(1.0 - windows.residual(R) / shifts[kShifts].square(R));
  }
  const auto best = std::max_element(explained.begin(), explained.end());
  const auto index = static_cast<int>(std::distance(explained.begin(), best));
  Shift out{kShiftStep * (index - kShifts),
            significance(explained[kShifts], *best, shifts[kShifts].windows),
            std::abs(index - kShifts) == kShifts};
  if (out.at_end) return out;
  const double curvature = best[-1] - 2.0 * best[0] + best[1];  // parabola through three points
  if (curvature < 0.0) out.seconds += 0.5 * kShiftStep * (best[-1] - best[1]) / curvature;
  return out;
}

/// @param R axes of the radar as found
/// @param at_end whether the delay may be longer than all shifts
Finding check_delay(const std::vector<Agreement>& shifts, const Matrix3d& R, const Options& options,
                    const Advice& advice, bool* at_end) {
  constexpr double kNotable = 0.02;  // [s]
  constexpr double kWrong = 0.045;   // not corrected by an estimator with a prior of 30 ms [s]
  constexpr double kMaybe = 2.0;     // sigmas
  const double configured = options.radar.time_offset;
  const Shift shift = best_shift(shifts, R);
  *at_end = shift.at_end;
  Finding out{Verdict::kOk, "delay of the radar",
              fmt::format("radar and IMU agree best with the radar's stamps moved by {:+.0f} ms{}",
                          1e3 * shift.seconds, shift.at_end ? " or more" : "")};
  const double size = std::abs(shift.seconds);
  out.text += fmt::format(", by {:.1f} sigmas", shift.sure);
  if (size < kNotable || shift.sure < kMaybe) return out;
  out.verdict = size > kWrong && shift.sure > kSignificant ? Verdict::kWrong : Verdict::kDoubtful;
  if (shift.at_end) {
    out.change = "look at the clocks of both sensors: the delay is longer than tested, or varies";
    return out;
  }
  const double offset = configured - shift.seconds;
  out.change = advice.option(fmt::format("time_offset: {:.3f}", offset),
                             fmt::format("time_offset_s: {:.3f}", offset));
  return out;
}

/// A delay beyond those of check_delay(), with which radar and IMU agree at last; empty if there is
/// none, or it may be longer than all that are tested.
/// @param near explained with one of those, which it must beat
std::optional<Finding> check_far_delay(const MotionData& data, double length, double near,
                                       const Options& options, const Advice& advice) {
  constexpr double kFarthest = 10.0;                       // [s]
  constexpr double kCovered = 2.0 * kShifts * kShiftStep;  // by all_shifts() [s]
  constexpr double kSure = 5.0;                            // the best of 1000 [sigmas]
  BestAxes best{{}, kExplained};
  double delay = 0.0;
  for (double middle = -kFarthest; middle <= kFarthest; middle += kCovered) {
    const std::vector<Agreement> shifts = all_shifts(data, length, options.radar, middle);
    for (std::size_t i = 0; i < shifts.size(); ++i) {
      const double moved_by = middle + kShiftStep * (static_cast<double>(i) - kShifts);
      const BestAxes now = best_axes(shifts[i], options, data.doppler_sign);
      if (now.windows < kFewestWindows || now.explained <= best.explained ||
          std::abs(moved_by) < 0.5 * kCovered || now.better_than(near) < kSure) {
        continue;
      }
      best = now;
      delay = moved_by;
    }
  }
  if (delay == 0.0) return std::nullopt;
  // the largest share is near the least residual, which is that of the delay
  delay += best_shift(all_shifts(data, length, options.radar, delay), best.axes.R).seconds;
  if (std::abs(delay) > kFarthest) return std::nullopt;
  return Finding{Verdict::kWrong, "delay of the radar",
                 fmt::format("radar and IMU agree only with the radar's stamps moved by {:+.3f} s, "
                             "then in {:.0f} % of the movement",
                             delay, 100.0 * best.explained),
                 advice.bag()
                     ? fmt::format("--radar-offset \"{:+.3f} s\"", delay)
                     : fmt::format("add {:.0f} to the stamps of {}", 1e9 * delay, advice.csv())};
}

/// With the mounting that the motion shows, if it is unknown.
Options as_seen(const Options& options, const Agreement& windows) {
  Options out = options;
  if (MountingSearch::is_unknown(options.calibration) && windows.c > 0.0) {
    out.radar.T_BS.rotation = Quaternion(best_rotation(windows)).normalized();
  }
  return out;
}

/// (E5); R as found.
Finding check_scale(const Judge& judge, const Matrix3d& R) {
  const DopplerScale scale(judge.all, R);
  const auto [low, high] = scale;
  Finding out{
      Verdict::kOk, "Doppler scale",
      fmt::format("changes of velocity are {:.2f} to {:.2f} times those of the IMU", low, high)};
  if (scale.may_be_right(judge.data.scale_error)) return out;
  out.verdict = Verdict::kWrong;
  const double likely = low * std::cbrt(high / low);  // most of the noise is the radar's
  const auto off = [likely](const DopplerUnit& u) { return std::abs(std::log(u.scale / likely)); };
  const auto* const unit = std::ranges::min_element(kDopplerUnits, {}, off);
  double factor = 1.0 / likely;
  constexpr double kNear = 1.1;  // folds at a limit in another unit
  if (unit->scale > low / kNear && unit->scale < high * kNear) {
    factor = 1.0 / unit->scale;
    out.text += fmt::format(": the Doppler is {}", unit->name);
  }
  out.change = judge.advice.scale("doppler", factor);
  if (const auto range = other_range(judge, R)) {
    out.text += fmt::format("; with {:.4g} times the rates of the gyro its scale is right", *range);
    out.change += fmt::format(
        "; or multiply the rates of the gyro by {:.4g}, which fits as well: look at its range",
        *range);
    return out;
  }
  constexpr double kLittle = 0.4;  // less than any unit
  if (likely > kLittle) return out;
  const std::string change = out.change;
  out = compensated(judge, out.text + ": the Doppler shows little of the motion of the radar");
  if (out.verdict == Verdict::kWrong) out.change += "; if it is only in another unit, " + change;
  return out;
}

/// @param at_end of check_delay()
Findings check_in_windows(const Judge& judge, const std::vector<Agreement>& shifts, bool* at_end) {
  std::vector<Axes> alike;
  const Axes found = choose_axes(judge, &alike);
  if (const auto gyro = check_gyro_by_radar(judge, judge.all.explained(found.R))) return {*gyro};
  const Finding axes = check_axes(judge, found, alike);
  if (judge.all.explained(found.R) < kExplained) return {axes};
  const Finding scale = check_scale(judge, found.R);
  if (scale.subject != "Doppler scale") return {scale};  // the axes of what is left tell nothing
  return {axes, scale, check_delay(shifts, found.R, judge.options, judge.advice, at_end)};
}

}  // namespace

BestAxes best_axes(const Agreement& windows, const Options& options, DopplerSign sign) {
  const Matrix3d configured = options.radar.T_BS.rotation.toRotationMatrix();
  BestAxes best{{}, 0.0, windows.windows};
  for (const Axes& axes : candidates(options.radar.T_BS.rotation)) {
    const double explained = windows.explained(axes.R);
    if (explained <= best.explained || !allowed(axes, configured, sign)) continue;
    best.axes = axes;
    best.explained = explained;
  }
  return best;
}

Findings check_motion(const MotionData& data, const Options& options, const Advice& advice) {
  Findings first;  // of the shortest windows
  for (const double length : kLengths) {
    const std::vector<Agreement> shifts = all_shifts(data, length, options.radar);
    const Agreement& windows = windows_to_judge(shifts, options, data.doppler_sign);
    if (windows.windows < kFewestWindows ||
        static_cast<double>(windows.windows) * length < kLeast) {
      if (!first.empty()) break;
      return {{Verdict::kDoubtful, "motion",
               fmt::format("{} times two seconds with velocities of the radar and without a pause "
                           "of the IMU: axes, signs and delays cannot be told",
                           windows.windows),
               "fly for half a minute with changes of speed and turns"}};
    }
    const Options seen = as_seen(options, windows);
    bool at_end = false;
    Findings found = check_in_windows({data, windows, length, seen, advice}, shifts, &at_end);
    const bool told = found.size() > 1 || found.front().verdict == Verdict::kWrong;
    const bool unexplained = !told && found.front().verdict == Verdict::kDoubtful;
    // a delay may be a lesser maximum beside the right one
    const bool is_late = !at_end && told && found.back().subject == "delay of the radar" &&
                         found.back().verdict == Verdict::kWrong;
    if (at_end || is_late || (first.empty() && unexplained)) {
      const std::vector<double> most = most_explained(shifts, seen, data.doppler_sign);
      const double near = is_late ? std::ranges::max(most) : most[kShifts];
      if (const auto delay = check_far_delay(data, length, near, seen, advice)) return {*delay};
    }
    if (told) return found;
    if (first.empty()) first = found;
  }
  return first;
}

}  // namespace rio::check
