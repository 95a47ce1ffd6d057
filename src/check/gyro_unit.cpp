// SPDX-License-Identifier: BSD-3-Clause
// The unit of the gyro, by the direction of the specific force that it carries.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "check/advice.hpp"
#include "check/imu_check.hpp"
#include "check/numbers.hpp"
#include "rio/core/so3.hpp"

namespace rio::check {

namespace {

/// Nothing if it is not known.
std::string to_degrees(const char* what, double error) {
  return std::isnan(error) ? "" : fmt::format("{} to {:.1f} deg", what, error / kDegree);
}

/// (E1) in radians; NaN with fewer than ten pairs.
double turning_error(const std::vector<ImuSample>& samples, double factor) {
  constexpr double kSpan = 0.5;  // [s]
  constexpr double kMean = 0.1;  // [s]
  std::vector<double> angles;
  Vector3d before = Vector3d::Zero();       // mean at the beginning of the span, rotated to now
  Vector3d mean = samples.front().accel_B;  // of the last kMean
  for (std::size_t i = 1, begin = 0; i < samples.size(); ++i) {
    const double dt = to_seconds(samples[i].time - samples[i - 1].time);
    before = quaternion_exp(-factor * dt * samples[i].gyro_B) * before;
    mean += (samples[i].accel_B - mean) * std::min(1.0, dt / kMean);
    if (to_seconds(samples[i].time - samples[begin].time) < kSpan) continue;
    const double cosine = before.dot(mean.normalized());
    if (begin > 0) angles.push_back(std::acos(std::clamp(cosine, -1.0, 1.0)));
    before = mean.normalized();
    begin = i;
  }
  return angles.size() < 10 ? std::numeric_limits<double>::quiet_NaN() : median(angles);
}

}  // namespace

Finding check_gyro(const std::vector<ImuSample>& samples, Source source, ImuCheck* found) {
  const Rest& rest = found->rest;
  double* const unit = &found->gyro_unit;
  constexpr double kAnywhere = 25.0 * kDegree;  // beyond any tilt change in half a second
  constexpr double kFastest = 6.3;  // a turn a second half of the time: no flight is so [rad/s]
  const auto rate = [](const ImuSample& s) { return s.gyro_B.norm(); };
  const double usual = quantile_of(samples, rate, 0.5);
  const double most = quantile_of(samples, rate, 1.0);
  const double as_given = turning_error(samples, 1.0);
  const bool smaller = usual * kDegree > kFastest;  // than deg/s
  const double scaled = turning_error(samples, kDegree);
  Finding out{
      Verdict::kOk, "gyro unit",
      fmt::format("rates of {:.3g} rad/s (median) to {:.3g} rad/s, {:.3g} rad/s in the "
                  "stillest second{}",
                  usual, most, rest.gyro.norm(),
                  to_degrees("; they carry the direction of the specific force over half a second",
                             as_given))};
  // at rest no gyro measures rates like these, nor is a vehicle so fast half of the time
  const bool never_rests = rest.spread < 0.01 && usual > 1.5 &&
                           std::hypot(rest.gyro.norm(), rest.turning) > 0.2 &&
                           scaled < 0.25 * as_given;
  const bool nonsense = never_rests || (as_given > kAnywhere && scaled < 0.5 * as_given);
  if (nonsense || usual > kFastest) {
    *unit = kDegree;
    if (smaller && !found->integrable) {
      out.judge(Verdict::kWrong, ": with the accelerometer in no unit, both seem to be raw counts",
                "multiply both by the sensitivities of the data sheet of the IMU");
    } else if (smaller) {
      *unit = 1e-3 * usual > kFastest ? 1e-3 * kDegree : 1e-3;
      const char* name = *unit == 1e-3 ? "mrad/s" : "mdeg/s";
      out.judge(Verdict::kWrong, fmt::format(": they are in {}", name),
                Advice{source}.gyro_in(name, *unit));
    } else {
      out.judge(Verdict::kWrong, to_degrees(", taken as deg/s", scaled) + ": they are in deg/s",
                Advice{source}.gyro_in("deg/s", kDegree));
    }
  } else if (rest.gyro.norm() > 0.1 && rest.spread < 0.05 &&
             rest.turning < 0.2 * rest.gyro.norm()) {
    out.judge(Verdict::kDoubtful, "",
              "a bias of more than 6 deg/s at rest: let the gyro warm up, or begin at rest");
  }
  return out;
}

}  // namespace rio::check
