// SPDX-License-Identifier: BSD-3-Clause
#include "check/motion_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

#include "check/axes.hpp"
#include "check/numbers.hpp"
#include "rio/core/so3.hpp"

namespace rio::check {

namespace {

/// The best axes with the rates multiplied by this.
struct Trial : BestAxes {
  Matrix3d factor = Matrix3d::Zero();
};

Agreement windows_with(const Judge& judge, const Matrix3d& factor) {
  const MotionData& data = judge.data;
  return agreements(data.speeds, data.path(factor), judge.length, judge.options.radar).front();
}

Trial with_rates(const Judge& judge, const Matrix3d& factor) {
  return {best_axes(windows_with(judge, factor), judge.options, DopplerSign::kUnknown), factor};
}

Trial scaled(const Judge& judge, double factor) {
  return with_rates(judge, factor * Matrix3d::Identity());
}

/// The best of some factors.
Trial best_scaled(const Judge& judge, const std::vector<double>& factors) {
  Trial best;
  for (const double factor : factors) {
    const Trial trial = scaled(judge, factor);
    if (trial.explained > best.explained) best = trial;
  }
  return best;
}

constexpr double kGain = 0.1;     // explained, by another range of the gyro
constexpr double kClearly = 4.0;  // sigmas, same

bool is_clear(const Trial& trial, double as_read) {
  return trial.axes.as_configured() && trial.explained > as_read + kGain &&
         trial.better_than(as_read) > kClearly;
}

/// What rates that are not in rad/s may be in. Counts of 16.4 to a deg/s are within 7 % of mrad/s.
constexpr std::array<Unit, 8> kRateUnits = {{{"deg/s", kDegree},
                                             {"mrad/s", 1e-3},
                                             {"mdeg/s", 1e-3 * kDegree},
                                             {"rpm", 6.0 * kDegree},
                                             {"0.1 deg/s", 0.1 * kDegree},
                                             {"counts of about 131 to a deg/s", kDegree / 131.0},
                                             {"counts of about 65 to a deg/s", kDegree / 65.5},
                                             {"counts of about 33 to a deg/s", kDegree / 32.8}}};

/// Whether the unit that the IMU alone suggests is another one.
std::optional<Finding> check_unit(const Judge& judge, double as_read) {
  const double suggested = judge.data.gyro_unit;
  if (suggested == 1.0) return std::nullopt;
  const Unit* unit = nullptr;
  Trial best;
  for (const Unit& other : kRateUnits) {
    const Trial trial = scaled(judge, other.factor / suggested);
    if (trial.explained <= best.explained) continue;
    best = trial;
    unit = &other;
  }
  if (unit == nullptr || unit->factor == suggested || !is_clear(best, as_read)) return std::nullopt;
  return Finding{Verdict::kWrong, "gyro unit",
                 fmt::format("the radar explains {:.0f} % of the movement the IMU measures, more "
                             "than in any other unit, if its rates are in {}",
                             100.0 * best.explained, unit->name),
                 judge.advice.gyro_in(unit->name, unit->factor)};
}

/// What to do with rates of another range, or with the Doppler if its scale seems wrong, too.
std::string multiplied(const Judge& judge, double factor) {
  std::string out =
      fmt::format("multiply the rates of the gyro by {:.4g}: look at its range", factor);
  const DopplerScale scale(judge.all, judge.configured);
  if (scale.may_be_right(judge.data.scale_error) || !(scale.low > 0.0)) return out;
  return out + fmt::format(
                   "; or the unit of the Doppler: with the rates as they are changes of "
                   "velocity are {:.2f} to {:.2f} times those of the IMU",
                   scale.low, scale.high);
}

/// Whether radar and IMU agree only with smaller rates, which the IMU alone did not show.
std::optional<Finding> check_too_large(const Judge& judge, double as_read) {
  constexpr double kSlow = 0.3;  // deg/s of a flying or driving vehicle are more [rad/s]
  const auto rate = [&judge](const ImuSample& s) { return judge.data.gyro_unit * s.gyro_B.norm(); };
  std::vector<double> factors = {0.5, 0.25};
  if (!(quantile_of(judge.data.imu.good, rate, 0.5) < kSlow)) factors.push_back(kDegree);
  const Trial best = best_scaled(judge, factors);
  const double unturned = scaled(judge, 0.0).explained;
  if (best.explained < kExplained || best.better_than(as_read) < kSignificant ||
      best.better_than(unturned) < kSignificant ||
      (as_read > kExplained && !is_clear(best, as_read))) {
    return std::nullopt;
  }
  Finding out{Verdict::kWrong, "gyro unit by the radar",
              fmt::format("the radar explains at most {:.0f} % of the movement the IMU measures, ",
                          100.0 * as_read),
              judge.advice.gyro_in("deg/s", kDegree)};
  const double factor = best.factor(0, 0);
  if (factor == kDegree) {
    out.text += fmt::format("with the rates taken as deg/s {:.0f} %", 100.0 * best.explained);
    return out;
  }
  out.text += fmt::format("with {:.4g} times the rates {:.0f} %", factor, 100.0 * best.explained);
  out.change = multiplied(judge, factor);
  return out;
}

/// Whether they agree better with larger rates. These turn both sides of (E1) of motion.hpp alike
/// and in the end explain everything: the configured axes must explain something before, and still
/// larger rates less.
std::optional<Finding> check_too_small(const Judge& judge, double as_read) {
  constexpr double kSomething = 0.4;
  if (as_read < kSomething) return std::nullopt;
  const Trial best = best_scaled(judge, {2.0, 4.0});
  const double factor = best.factor(0, 0);
  if (!is_clear(best, as_read) || scaled(judge, 2.0 * factor).explained > best.explained - kGain) {
    return std::nullopt;
  }
  return Finding{
      Verdict::kWrong, "gyro unit by the radar",
      fmt::format("the radar explains {:.0f} % of the movement the IMU measures, with {:.0f} times "
                  "the rates {:.0f} %",
                  100.0 * as_read, factor, 100.0 * best.explained),
      multiplied(judge, factor)};
}

/// All axes exchanged or of the other sign, but these two: as they are, and all of the other sign.
std::vector<Matrix3d> other_axes() {
  std::vector<Matrix3d> list;
  for (const Matrix3d& P : right_angles()) {
    for (const double sign : {1.0, -1.0}) {
      if (!P.isIdentity()) list.push_back(sign * P);
    }
  }
  // those with other signs alone first
  std::stable_partition(list.begin(), list.end(), [](const Matrix3d& M) { return M.isDiagonal(); });
  return list;
}

/// "negate x and z of the gyro", "take the rates of the gyro in the order (y, -z, x)".
std::string rates_text(const Matrix3d& M) {
  std::string negated;
  std::string rates;
  for (int row = 0; row < 3; ++row) {
    int axis = 0;
    M.row(row).cwiseAbs().maxCoeff(&axis);
    const bool minus = M(row, axis) < 0.0;
    if (minus) negated += fmt::format("{}{}", negated.empty() ? "" : " and ", "xyz"[row]);
    rates += fmt::format("{}{}{}", rates.empty() ? "" : ", ", minus ? "-" : "", "xyz"[axis]);
  }
  if (!M.isDiagonal()) return "take the rates of the gyro in the order (" + rates + ")";
  return fmt::format("negate {} of the gyro", M.trace() < -2.0 ? "all axes" : negated);
}

Finding mirrored_imu(const Judge& judge, const Trial& best, double as_read) {
  const Matrix3d of_body = best.axes.R * judge.configured.transpose();
  const std::string how =
      mirror_text(of_body, "the IMU").value_or("an odd number of axes of the IMU is mirrored");
  const char* where = judge.advice.bag() ? "the driver of the IMU, or the file of `rio convert`"
                                         : "the columns of gyro and accelerometer of imu0/data.csv";
  return {Verdict::kWrong, "axes of the IMU",
          fmt::format("the radar explains at most {:.0f} % of the movement the IMU measures, with "
                      "the axes of the IMU mirrored {:.0f} %: {}",
                      100.0 * as_read, 100.0 * best.explained, how),
          fmt::format("{}, in {}", how, where)};
}

/// Whether radar and IMU agree only with other axes or signs of the rates: of the gyro alone, of
/// the accelerometer alone, or with mirrored axes of the IMU, in which rates have the wrong sign
/// and the radar also appears mirrored.
std::optional<Finding> check_axes_of_rates(const Judge& judge, double as_read) {
  constexpr double kMuchLess = 0.75;  // of the best
  constexpr double kAlike = 0.005;    // explained
  const Trial all = with_rates(judge, -Matrix3d::Identity());
  Trial best = all;
  for (const Matrix3d& M : other_axes()) {
    if (as_read > kExplained && !M.isDiagonal()) break;  // by exchanged axes it would be less
    const Trial trial = with_rates(judge, M);
    const double lead = trial.explained - best.explained;
    if (lead > (best.axes.as_configured() ? kAlike : 0.0) ||
        (trial.axes.as_configured() && lead > -kAlike)) {
      best = trial;
    }
  }
  if (best.explained < kExplained || best.better_than(as_read) < kSignificant) return std::nullopt;
  const bool is_mirrored = all.axes.doppler_flipped && all.explained > kExplained &&
                           all.better_than(as_read) > kSignificant &&
                           best.better_than(all.explained) < kSignificant;
  const std::string rates = rates_text(best.factor);
  if (is_mirrored) {
    Finding mirrored = mirrored_imu(judge, all, as_read);
    if (best.axes.as_configured()) {
      mirrored.text += ", or of the gyro alone";
      mirrored.change += "; if only of the gyro, " + rates;
    }
    return mirrored;
  }
  if (as_read > kMuchLess * best.explained) return std::nullopt;
  return Finding{
      Verdict::kWrong, "axes of the IMU",
      fmt::format(
          "the radar explains at most {:.0f} % of the movement the IMU measures; {}, and it "
          "explains {:.0f} %",
          100.0 * as_read, rates, 100.0 * best.explained),
      (best.axes.as_configured() ? rates + " where it is recorded: it" : std::string("the gyro")) +
          " needs the axes of the accelerometer"};
}

}  // namespace

std::optional<double> other_range(const Judge& judge, const Matrix3d& R) {
  constexpr double kAcross = 0.3;  // of the rate about the vertical: gravity shows the range
  const Vector3d up = judge.data.imu.check.rest.accel.normalized();
  double vertical = 0.0;
  double across = 0.0;
  for (const ImuSample& s : judge.data.imu.good) {
    vertical += s.gyro_B.dot(up) * s.gyro_B.dot(up);
    across += s.gyro_B.cross(up).squaredNorm();
  }
  if (across > kAcross * kAcross * vertical) return std::nullopt;
  double most = kExplained;
  std::optional<double> best;
  for (const double factor : {0.5, 2.0, 0.25, 4.0}) {
    const Agreement all = windows_with(judge, factor * Matrix3d::Identity());
    const double explained = all.explained(R);
    if (explained <= most || !DopplerScale(all, R).may_be_right(judge.data.scale_error)) continue;
    most = explained;
    best = factor;
  }
  return best;
}

std::optional<Finding> check_gyro_by_radar(const Judge& judge, double as_read) {
  constexpr double kWell = 0.9;  // explained: nothing can do much better
  if (as_read > kWell) return std::nullopt;
  if (auto unit = check_unit(judge, as_read)) return unit;
  if (auto axes = check_axes_of_rates(judge, as_read)) return axes;
  if (auto large = check_too_large(judge, as_read)) return large;
  return check_too_small(judge, as_read);
}

}  // namespace rio::check
