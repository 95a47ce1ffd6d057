// SPDX-License-Identifier: BSD-3-Clause
#include "check/motion_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "check/judge.hpp"
#include "check/units.hpp"
#include "rio/frontend/mounting_search.hpp"

namespace rio::check {

namespace {

constexpr double kLeast = 10.0;  // in all windows together [s]
constexpr std::array kLengths = {kShortestWindow, 2.0 * kShortestWindow, 4.0 * kShortestWindow};

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
  const Eigen::Map<const Eigen::Matrix<double, 9, 1>> r(R.data());
  const double low = judge.all.b.dot(r) / judge.all.c;
  const double high = r.dot(judge.all.A * r) / judge.all.b.dot(r);
  Finding out{
      Verdict::kOk, "Doppler scale",
      fmt::format("changes of velocity are {:.2f} to {:.2f} times those of the IMU", low, high)};
  const double right = judge.data.scale_error;
  if (low < right && high > 1.0 / right) return out;
  out.verdict = Verdict::kWrong;
  const double likely = low * std::cbrt(high / low);  // most of the noise is the radar's
  const auto off = [likely](const DopplerUnit& u) { return std::abs(std::log(u.scale / likely)); };
  const auto* const unit = std::min_element(
      kDopplerUnits.begin(), kDopplerUnits.end(),
      [&off](const DopplerUnit& a, const DopplerUnit& b) { return off(a) < off(b); });
  double factor = 1.0 / likely;
  constexpr double kNear = 1.1;  // folds at a limit in another unit
  if (unit->scale > low / kNear && unit->scale < high * kNear) {
    factor = 1.0 / unit->scale;
    out.text += fmt::format(": the Doppler is {}", unit->name);
  }
  out.change = judge.advice.scale("doppler", factor);
  constexpr double kLittle = 0.4;  // less than any unit
  if (likely > kLittle) return out;
  const std::string change = out.change;
  out = compensated(judge, out.text + ": the Doppler shows little of the motion of the radar");
  if (out.verdict == Verdict::kWrong) out.change += "; if it is only in another unit, " + change;
  return out;
}

Findings check_in_windows(const Judge& judge, const std::vector<Agreement>& shifts) {
  std::vector<Axes> alike;
  const Axes found = choose_axes(judge, &alike);
  if (const auto gyro = check_gyro_by_radar(judge, judge.all.explained(found.R))) return {*gyro};
  const Finding axes = check_axes(judge, found, alike);
  if (judge.all.explained(found.R) < kExplained) return {axes};
  const Finding scale = check_scale(judge, found.R);
  if (scale.subject != "Doppler scale") return {scale};  // the axes of what is left tell nothing
  return {axes, scale, check_delay(shifts, found.R, judge.options, judge.advice)};
}

}  // namespace

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
    Findings found = check_in_windows({data, windows, length, seen, advice}, shifts);
    const bool told = found.size() > 1 || found.front().verdict == Verdict::kWrong;
    const bool unexplained = !told && found.front().verdict == Verdict::kDoubtful;
    if (first.empty() && (unexplained || ends_at_the_best(shifts, seen, data.doppler_sign))) {
      if (const auto delay = check_far_delay(
              data, kLengths[0], most_explained(windows, seen, data.doppler_sign), seen, advice))
        return {*delay};
    }
    if (told) return found;
    if (first.empty()) first = found;
  }
  return first;
}

}  // namespace rio::check
