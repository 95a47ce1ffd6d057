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
#include "check/delay_check.hpp"
#include "check/numbers.hpp"
#include "check/units.hpp"
#include "rio/core/so3.hpp"

namespace rio::check {

namespace {

constexpr double kLeast = 10.0;                   // in all windows together [s]
constexpr std::array kLengths = {2.0, 4.0, 8.0};  // of the windows [s]

struct Judge {
  const MotionData& data;
  const Agreements& windows;
  double length;  ///< of a window [s]
  const Options& options;
  const Advice& advice;
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
             significance(judge.all.explained(axes.R), explained, judge.windows.size()) <
                 kSignificant;
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
        (judge.all.explained(axes.R) > enough && judge.doubt(axes.R, best->R) < kSignificant)) {
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
  constexpr double kMuch = 0.1;     // [m/s]
  constexpr double kClear = 2.0;    // times the noise
  constexpr double kNothing = 1.5;  // times the noise
  constexpr double kChance = 0.1;   // explained
  constexpr double kFlown = 0.2;    // changes of velocity that are no error of an IMU [m/s]
  const double movement = judge.all.movement();
  const double of_imu = judge.all.movement_of_imu();
  const double of_speeds = noise(judge.data.speeds);
  out->text += fmt::format(
      ", at best {:.0f} % with any other; the velocity of the radar changes by {:.2f} m/s (rms, "
      "noise {:.2f})",
      100.0 * best, movement, of_speeds);
  const bool unseen = best < kChance && movement < kNothing * of_speeds;
  if (unseen && of_imu > kFlown && of_imu > kClear * of_speeds) {
    out->verdict = Verdict::kWrong;
    out->text += fmt::format(
        ", that of the IMU by {:.2f}: the Doppler does not show the motion of the radar", of_imu);
    out->change =
        "record the measured Doppler: the driver subtracts the motion of the vehicle from it, or "
        "fills in zeros";
    return;
  }
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
    out.verdict = judge.doubt(judge.configured, found.R) > kSignificant ? Verdict::kWrong
                                                                        : Verdict::kDoubtful;
  }
  out.text += fmt::format(", and {:.0f} % if {}", 100.0 * best, describe(judge.configured, found));
  for (std::size_t i = 1; i < std::min<std::size_t>(alike.size(), 4); ++i) {
    out.text += ", or as well if " + describe(judge.configured, alike[i]);
  }
  out.change = change_of(judge.configured, found, judge.options, judge.advice);
  return out;
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
  if (most < kExplained || significance(as_read, most, judge.windows.size()) < kSignificant) {
    return std::nullopt;
  }
  return Finding{
      Verdict::kWrong, "gyro unit by the radar",
      fmt::format("the radar explains at most {:.0f} % of the movement the IMU measures, "
                  "with the rates taken as deg/s {:.0f} %",
                  100.0 * as_read, 100.0 * most),
      judge.advice.gyro_in_degrees()};
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
      significance(as_read, most, mirrored.size()) < kSignificant) {
    return std::nullopt;
  }
  const Matrix3d of_body = best->R * judge.configured.transpose();
  const std::string how =
      mirror_text(of_body, "the IMU").value_or("an odd number of axes of the IMU is mirrored");
  const char* where = judge.advice.bag() ? "the driver of the IMU, or the file of `rio convert`"
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
  out.change = judge.advice.scale("doppler", factor);
  return out;
}

Findings check_in_windows(const Judge& judge, const std::vector<Agreements>& shifts) {
  if (const auto unit = check_gyro_unit(judge)) return {*unit};
  if (const auto mirrored = check_handedness(judge)) return {*mirrored};
  const Finding axes = check_axes(judge);
  std::vector<Axes> alike;
  const Axes found = choose(judge, hypotheses(judge), &alike);
  if (judge.all.explained(found.R) < kExplained) return {axes};
  return {axes, check_scale(judge, found.R),
          check_delay(shifts, found.R, judge.options, judge.advice)};
}

}  // namespace

Findings check_motion(const MotionData& data, const Options& options, const Advice& advice) {
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
    Findings found = check_in_windows({data, windows, length, options, advice}, shifts);
    const bool told = found.size() > 1 || found.front().verdict == Verdict::kWrong;
    const bool unexplained = !told && found.front().verdict == Verdict::kDoubtful;
    if (first.empty() && (unexplained || ends_at_the_best(shifts, options))) {
      if (const auto delay = check_far_delay(data, kLengths[0], options, advice)) return {*delay};
    }
    if (told) return found;
    if (first.empty()) first = found;
  }
  return first;
}

}  // namespace rio::check
