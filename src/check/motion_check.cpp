// SPDX-License-Identifier: BSD-3-Clause
#include "check/motion_check.hpp"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <string>

#include "check/axes.hpp"
#include "check/numbers.hpp"
#include "check/units.hpp"
#include "rio/core/so3.hpp"

namespace rio::check {

namespace {

constexpr double kSure = 3.0;       // sigmas, of (E6) of motion.hpp
constexpr double kExplained = 0.5;  // of the movement: not reached by chance
constexpr std::size_t kFewestWindows = 3;
constexpr double kLeast = 10.0;                   // in all windows together [s]
constexpr std::array kLengths = {2.0, 4.0, 8.0};  // of the windows [s]
constexpr double kShiftStep = 0.02;               // [s]
constexpr int kShifts = 14;                       // to each side; below kMostShift

struct Judge {
  const MotionData& data;
  const Agreements& windows;
  double length;  ///< of a window [s]
  const Options& options;
  Source source;
  std::size_t radar;
  Matrix3d configured = options.radar.T_BS.rotation.toRotationMatrix();
  Agreement all = windows.total();

  double doubt(const Matrix3d& worse, const Matrix3d& better) const {
    return significance(all.explained(worse), all.explained(better), windows.size());
  }
};

/// The mountings at any angle, without and with the Doppler flipped, that maximise b^T r of (E4)
/// (Wahba's problem), if they are far from all right angles and clearly better.
void append_any_angle(const Judge& judge, std::vector<Axes>* list) {
  constexpr double kFar = 20.0 * kDegree;
  const Eigen::JacobiSVD<Matrix3d> svd(Eigen::Map<const Matrix3d>(judge.all.b.data()),
                                       Eigen::ComputeFullU | Eigen::ComputeFullV);
  const std::vector<Axes> right = *list;
  for (const double sign : {1.0, -1.0}) {
    const Matrix3d UV = svd.matrixU() * svd.matrixV().transpose();
    const Vector3d signs(1.0, 1.0, sign * UV.determinant());
    const Matrix3d R = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
    const double explained = judge.all.explained(R);
    const bool better = std::none_of(right.begin(), right.end(), [&](const Axes& axes) {
      const Matrix3d turn = axes.R.transpose() * R;
      return (turn.determinant() > 0.0 && quaternion_log(Quaternion(turn)).norm() < kFar) ||
             significance(judge.all.explained(axes.R), explained, judge.windows.size()) < kSure;
    });
    if (!better || explained < kExplained) continue;
    list->push_back({R, sign < 0.0, angle_between(judge.configured, sign * R)});
  }
}

bool mirrors_the_points(const Judge& judge, const Axes& axes) {
  return mirror_text(judge.configured.transpose() * axes.R, "the points").has_value();
}

/// All candidates that the sign of the Doppler allows.
std::vector<Axes> hypotheses(const Judge& judge) {
  std::vector<Axes> list = candidates(judge.options.radar.T_BS.rotation);
  append_any_angle(judge, &list);
  std::erase_if(list, [&judge](const Axes& axes) {
    switch (judge.data.doppler_sign) {
      case DopplerSign::kAsConfigured:
        return axes.doppler_flipped && !mirrors_the_points(judge, axes);
      case DopplerSign::kOpposite:
        return !axes.doppler_flipped;
      case DopplerSign::kUnknown:
        break;
    }
    return false;
  });
  return list;
}

/// The best of the candidates; the first of those that it does not beat significantly.
Axes choose(const Judge& judge, const std::vector<Axes>& list, std::vector<Axes>* alike) {
  const Axes* best = &list.front();
  for (const Axes& axes : list) {
    if (judge.all.explained(axes.R) > judge.all.explained(best->R)) best = &axes;
  }
  const double enough = 0.9 * judge.all.explained(best->R);
  for (const Axes& axes : list) {
    const bool known = std::any_of(alike->begin(), alike->end(),
                                   [&](const Axes& a) { return (a.R - axes.R).norm() < 1e-6; });
    if (known) continue;
    if (&axes == best ||
        (judge.all.explained(axes.R) > enough && judge.doubt(axes.R, best->R) < kSure)) {
      alike->push_back(axes);
    }
  }
  // the same matrix up to a tilt of the mounting; mirrored points are the more likely error
  const bool strange = alike->front().doppler_flipped && alike->front().turn > 1e-6 &&
                       judge.data.doppler_sign != DopplerSign::kOpposite;
  const auto mirrored = std::find_if(alike->begin(), alike->end(), [&judge](const Axes& axes) {
    return mirrors_the_points(judge, axes);
  });
  if (strange && mirrored != alike->end()) std::iter_swap(alike->begin(), mirrored);
  return alike->front();
}

/// The best explains little: is there no movement to explain, or another error?
void say_nothing_explains(const Judge& judge, double best, Finding* out) {
  constexpr double kMuch = 0.1;   // [m/s]
  constexpr double kClear = 2.0;  // times the noise
  const double movement = judge.all.movement();
  const double of_speeds = noise(judge.data.speeds);
  out->text += fmt::format(
      ", at best {:.0f} % with any other; the velocity of the radar changes by {:.2f} m/s (rms, "
      "noise {:.2f})",
      100.0 * best, movement, of_speeds);
  if (movement < kMuch || movement < kClear * of_speeds) {
    out->text += ": the motion does not tell";
    return;
  }
  out->verdict = Verdict::kDoubtful;
  out->text += ": no mounting explains it";
  out->change =
      "look at the axes of the IMU (swapped columns, a left-handed axis), the clocks, and the "
      "fields of the points";
}

Finding check_axes(const Judge& judge) {
  const double as_configured = judge.all.explained(judge.configured);
  std::vector<Axes> alike;
  const Axes found = choose(judge, hypotheses(judge), &alike);
  const double best = judge.all.explained(found.R);
  Finding out{
      Verdict::kOk, "axes and Doppler sign",
      fmt::format("with mounting and Doppler as configured the radar explains {:.0f} % of the "
                  "movement the IMU measures",
                  100.0 * as_configured),
      ""};
  const bool is_configured = !found.doppler_flipped && found.turn < 1e-6;
  if (best < kExplained) {
    say_nothing_explains(judge, best, &out);
    return out;
  }
  if (is_configured) {
    out.text += alike.size() == 1
                    ? ", clearly more than with any other axes"
                    : fmt::format("; {} other axes would do as well", alike.size() - 1);
    return out;
  }
  if (as_configured > 0.8 * best) {
    out.verdict = Verdict::kDoubtful;
  } else {
    out.verdict =
        judge.doubt(judge.configured, found.R) > kSure ? Verdict::kWrong : Verdict::kDoubtful;
  }
  out.text += fmt::format(", and {:.0f} % if {}", 100.0 * best, describe(judge.configured, found));
  for (std::size_t i = 1; i < std::min<std::size_t>(alike.size(), 4); ++i) {
    out.text += ", or as well if " + describe(judge.configured, alike[i]);
  }
  out.change = change_of(judge.configured, found, judge.options, judge.source, judge.radar);
  return out;
}

/// The best of all candidates.
double most_explained(const Agreements& windows, const Options& options) {
  const Agreement& all = windows.total();
  double most = 0.0;
  for (const Axes& axes : candidates(options.radar.T_BS.rotation)) {
    most = std::max(most, all.explained(axes.R));
  }
  return most;
}

/// Whether radar and IMU agree only with the gyro in deg/s, which the IMU alone did not show. Not
/// the reverse: rates that are too large turn both sides of (E1) alike, and seem to explain
/// everything.
std::optional<Finding> check_gyro_unit(const Judge& judge) {
  constexpr double kSlow = 0.3;  // deg/s of a flying or driving vehicle are more [rad/s]
  const auto& [samples, speeds, gyro_unit, accel_unit, sign] = judge.data;
  std::vector<double> rates;
  rates.reserve(samples.size());
  for (const ImuSample& s : samples) rates.push_back(gyro_unit * s.gyro_B.norm());
  const double as_read = most_explained(judge.windows, judge.options);
  if (as_read > kExplained || quantile_of(&rates, 0.5) < kSlow) return std::nullopt;
  const RadarOptions& radar = judge.options.radar;
  const ImuPath path(samples, kDegree * gyro_unit, accel_unit);
  const double most = most_explained(
      agreements(speeds, path, judge.length, radar.T_BS.translation, {-radar.time_offset}).front(),
      judge.options);
  if (most < kExplained || significance(as_read, most, judge.windows.size()) < kSure) {
    return std::nullopt;
  }
  return Finding{
      Verdict::kWrong, "gyro unit by the radar",
      fmt::format("the radar explains at most {:.0f} % of the movement the IMU measures, "
                  "with the rates taken as deg/s {:.0f} %",
                  100.0 * as_read, 100.0 * most),
      judge.source == Source::kBag
          ? "--gyro-unit deg/s"
          : "multiply the first three columns after the stamp of imu0/data.csv by "
            "0.0174533"};
}

/// Whether radar and IMU agree only with the rates negated: mirrored axes of the IMU, in which
/// rates have the wrong sign and the radar also appears mirrored.
std::optional<Finding> check_handedness(const Judge& judge) {
  double as_read = 0.0;
  for (const Axes& axes : hypotheses(judge)) {
    as_read = std::max(as_read, judge.all.explained(axes.R));
  }
  const RadarOptions& radar = judge.options.radar;
  const ImuPath path(judge.data.samples, -judge.data.gyro_unit, judge.data.accel_unit);
  const Agreements mirrored = agreements(judge.data.speeds, path, judge.length,
                                         radar.T_BS.translation, {-radar.time_offset})
                                  .front();
  const Agreement& all = mirrored.total();
  const std::vector<Axes> list = candidates(radar.T_BS.rotation);
  const auto best = std::max_element(list.begin(), list.end(), [&](const Axes& a, const Axes& b) {
    return all.explained(a.R) < all.explained(b.R);
  });
  const double most = all.explained(best->R);
  if (most < kExplained || !best->doppler_flipped ||
      significance(as_read, most, mirrored.size()) < kSure) {
    return std::nullopt;
  }
  const Matrix3d of_body = best->R * judge.configured.transpose();
  const std::string how =
      mirror_text(of_body, "the IMU").value_or("an odd number of axes of the IMU is mirrored");
  const char* where = judge.source == Source::kBag
                          ? "the driver of the IMU, or the file of `rio convert`"
                          : "the columns of gyro and accelerometer of imu0/data.csv";
  return Finding{Verdict::kWrong, "axes of the IMU",
                 fmt::format("the radar explains at most {:.0f} % of the movement the IMU "
                             "measures, with the axes of the IMU mirrored {:.0f} %: {}",
                             100.0 * as_read, 100.0 * most, how),
                 fmt::format("{}, in {}", how, where)};
}

/// (E5); R as found.
Finding check_scale(const Judge& judge, const Matrix3d& R) {
  const Eigen::Map<const Eigen::Matrix<double, 9, 1>> r(R.data());
  const double low = judge.all.b.dot(r) / judge.all.c;
  const double high = r.dot(judge.all.A * r) / judge.all.b.dot(r);
  Finding out{
      Verdict::kOk, "Doppler scale",
      fmt::format("changes of velocity are {:.2f} to {:.2f} times those of the IMU", low, high),
      ""};
  constexpr double kNotable = 1.25;
  if (low < kNotable && high > 1.0 / kNotable) return out;
  out.verdict = Verdict::kWrong;
  const double middle = std::sqrt(low * high);
  const auto off = [middle](const DopplerUnit& u) { return std::abs(std::log(u.scale / middle)); };
  const auto* const unit = std::min_element(
      kDopplerUnits.begin(), kDopplerUnits.end(),
      [&off](const DopplerUnit& a, const DopplerUnit& b) { return off(a) < off(b); });
  double factor = 1.0 / middle;
  if (off(*unit) < std::max(0.05, std::log(high / middle))) {
    factor = 1.0 / unit->scale;
    out.text += fmt::format(": the Doppler is {}", unit->name);
  }
  out.change =
      judge.source == Source::kBag
          ? fmt::format("--field doppler=NAME*{:.4g}", factor)
          : fmt::format("multiply the column doppler of radar0/data.csv by {:.4g}", factor);
  return out;
}

/// The windows for every shift, from the most negative on.
std::vector<Agreements> all_shifts(const MotionData& data, double length,
                                   const RadarOptions& radar) {
  const ImuPath path(data.samples, data.gyro_unit, data.accel_unit);
  std::vector<double> shifts;
  for (int i = -kShifts; i <= kShifts; ++i) shifts.push_back(kShiftStep * i - radar.time_offset);
  return agreements(data.speeds, path, length, radar.T_BS.translation, shifts);
}

/// The windows in which the axes are judged: at the configured delay, unless another shift is
/// significantly better with some axes.
const Agreements& windows_to_judge(const std::vector<Agreements>& shifts, const Options& options) {
  std::vector<double> most;
  for (const Agreements& windows : shifts) most.push_back(most_explained(windows, options));
  const auto best = std::max_element(most.begin(), most.end()) - most.begin();
  const Agreements& configured = shifts[kShifts];
  return significance(most[kShifts], most[static_cast<std::size_t>(best)], configured.size()) >
                 kSure
             ? shifts[static_cast<std::size_t>(best)]
             : configured;
}

/// The shift of the stamps that explains the most.
struct Shift {
  double seconds = 0.0;
  double explained = 0.0;
};

Shift best_shift(const std::vector<Agreements>& shifts, const Matrix3d& R) {
  std::vector<double> explained;
  for (const Agreements& windows : shifts) explained.push_back(windows.total().explained(R));
  const auto best = std::max_element(explained.begin(), explained.end());
  const auto index = static_cast<int>(std::distance(explained.begin(), best));
  Shift out{kShiftStep * (index - kShifts), *best};
  if (best != explained.begin() && best + 1 != explained.end()) {  // parabola through three points
    const double curvature = best[-1] - 2.0 * best[0] + best[1];
    if (curvature < 0.0) out.seconds += 0.5 * kShiftStep * (best[-1] - best[1]) / curvature;
  }
  return out;
}

Finding check_delay(const Judge& judge, const std::vector<Agreements>& shifts, const Matrix3d& R) {
  constexpr double kNotable = 0.02;  // [s]
  constexpr double kMaybe = 2.0;     // sigmas
  constexpr double kWrong = 0.045;   // not corrected by an estimator with a prior of 30 ms [s]
  const RadarOptions& radar = judge.options.radar;
  const Shift shift = best_shift(shifts, R);
  const double sure =
      significance(shifts[kShifts].total().explained(R), shift.explained, judge.windows.size());
  Finding out{Verdict::kOk, "delay of the radar",
              fmt::format("radar and IMU agree best with the radar's stamps moved by {:+.0f} ms",
                          1e3 * shift.seconds),
              ""};
  const double size = std::abs(shift.seconds);
  out.text += fmt::format(", by {:.1f} sigmas", sure);
  if (size < kNotable || sure < kMaybe) return out;
  out.verdict = size > kWrong && sure > kSure ? Verdict::kWrong : Verdict::kDoubtful;
  const double offset = radar.time_offset - shift.seconds;
  out.change = judge.radar == 0
                   ? fmt::format("radar: {{time_offset: {:.3f}}}", offset)
                   : fmt::format("radar{}/sensor.yaml: time_offset_s: {:.3f}", judge.radar, offset);
  if (judge.source == Source::kBag) {
    out.change += fmt::format(", or --radar-offset \"{:+.0f} ms\"", 1e3 * shift.seconds);
  }
  return out;
}

/// Whether the first or the last shift explains the motion best.
bool ends_at_the_best(const std::vector<Agreements>& shifts, const Options& options) {
  std::vector<double> most;
  for (const Agreements& windows : shifts) most.push_back(most_explained(windows, options));
  const auto best = std::max_element(most.begin(), most.end());
  return *best > kExplained && (best == most.begin() || best + 1 == most.end());
}

/// A delay beyond those of check_delay(), with which radar and IMU agree at last.
std::optional<Finding> check_far_delay(const MotionData& data, const Options& options,
                                       Source source) {
  constexpr double kFarthest = 4.0;                        // [s]
  constexpr double kCovered = 2.0 * kShifts * kShiftStep;  // by all_shifts() [s]
  double most = kExplained;
  double delay = 0.0;
  std::vector<RadarSpeed> moved = data.speeds;
  for (double middle = -kFarthest; middle <= kFarthest; middle += kCovered) {
    for (std::size_t i = 0; i < moved.size(); ++i) {
      moved[i].time = data.speeds[i].time + from_seconds(middle);
    }
    const MotionData there{data.samples, moved, data.gyro_unit, data.accel_unit};
    const std::vector<Agreements> shifts = all_shifts(there, kLengths[0], options.radar);
    for (std::size_t i = 0; i < shifts.size(); ++i) {
      const Agreements& windows = shifts[i];
      const double explained = most_explained(windows, options);
      if (windows.size() < kFewestWindows || explained <= most) continue;
      most = explained;
      delay = middle + kShiftStep * (static_cast<double>(i) - kShifts);
    }
  }
  if (delay == 0.0) return std::nullopt;
  return Finding{Verdict::kWrong, "delay of the radar",
                 fmt::format("radar and IMU agree only with the radar's stamps moved by {:+.2f} s, "
                             "then in {:.0f} % of the movement",
                             delay, 100.0 * most),
                 source == Source::kBag
                     ? fmt::format("--radar-offset \"{:+.2f} s\"", delay)
                     : fmt::format("add {:.0f} to the stamps of radar0/data.csv", 1e9 * delay)};
}

Findings check_in_windows(const Judge& judge, const std::vector<Agreements>& shifts) {
  if (const auto unit = check_gyro_unit(judge)) return {*unit};
  if (const auto mirrored = check_handedness(judge)) return {*mirrored};
  const Finding axes = check_axes(judge);
  std::vector<Axes> alike;
  const Axes found = choose(judge, hypotheses(judge), &alike);
  if (judge.all.explained(found.R) < kExplained) return {axes};
  return {axes, check_scale(judge, found.R), check_delay(judge, shifts, found.R)};
}

}  // namespace

Findings check_motion(const MotionData& data, const Options& options, Source source,
                      std::size_t radar) {
  Findings first;  // of the shortest windows
  for (const double length : kLengths) {
    const std::vector<Agreements> shifts = all_shifts(data, length, options.radar);
    const Agreements& windows = windows_to_judge(shifts, options);
    if (windows.size() < kFewestWindows || static_cast<double>(windows.size()) * length < kLeast) {
      if (!first.empty()) break;
      return {{Verdict::kDoubtful, "motion",
               fmt::format("{} times two seconds with velocities of the radar and without a pause "
                           "of the IMU: axes, signs and delays cannot be told",
                           windows.size()),
               "fly for half a minute with changes of speed and turns"}};
    }
    Findings found = check_in_windows({data, windows, length, options, source, radar}, shifts);
    const bool told = found.size() > 1 || found.front().verdict == Verdict::kWrong;
    const bool unexplained = !told && found.front().verdict == Verdict::kDoubtful;
    if (first.empty() && (unexplained || ends_at_the_best(shifts, options))) {
      if (const auto delay = check_far_delay(data, options, source)) return {*delay};
    }
    if (told) return found;
    if (first.empty()) first = found;
  }
  return first;
}

}  // namespace rio::check
