// SPDX-License-Identifier: BSD-3-Clause
#include "check/imu_check.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <string>

#include "rio/propagate/static_alignment.hpp"

namespace rio::check {

namespace {

/// At rest, but farther from gravity than the alignment allows (static_alignment.cpp).
bool is_off_gravity(const ImuCheck& check, const Options& options) {
  const double f = check.accel_unit * check.rest.accel.norm();
  return check.rest.is_quiet(check.gyro_unit) &&
         std::abs(f - options.imu.gravity) > 10.0 * options.start.sigma_accel_bias;
}

}  // namespace

Finding check_start(const CheckedImu& imu, const Scans& scans, const Options& options) {
  constexpr double kLate = 5.0;  // [s]
  const std::vector<ImuSample>& samples = imu.good;
  StaticAligner aligner(options.start, options.imu);
  std::optional<Alignment> start;
  Time at = samples.back().time;
  for (const ImuSample& s : samples) {
    (void)aligner.add({s.time, imu.check.gyro_unit * s.gyro_B, imu.check.accel_unit * s.accel_B},
                      &start);
    if (!start) continue;
    at = s.time;
    break;
  }
  std::size_t before = 0;  // scans
  for (std::size_t i = 0; i < scans.size(); ++i) before += scans[i].time < at ? 1 : 0;
  const double waited = to_seconds(at - samples.front().time);
  const std::string rest = fmt::format("standstill of {:.3g} s", options.start.duration);
  Finding out{Verdict::kOk, "start",
              start ? fmt::format("the first {} ends after {:.1f} s; {} of {} scans are before it",
                                  rest, waited, before, scans.size())
                    : fmt::format("no {} in {:.1f} s", rest, waited)};
  if (!start && is_off_gravity(imu.check, options)) {
    out.verdict = Verdict::kDoubtful;
    out.text += ": at rest the accelerometer is too far off gravity";
    out.change = "calibrate its scale and bias; start.sigma_accel_bias allows ten times itself";
  } else if (options.start.max_wait > 0.0) {
    out.text += fmt::format("; start.max_wait is {:.3g} s", options.start.max_wait);
  } else if (!start || waited > kLate + options.start.duration) {
    out.verdict = Verdict::kDoubtful;
    out.text += start ? ", and dropped" : ": the estimator does not start";
    out.change =
        "start: {max_wait: 3}, which starts in motion after 3 s; better, record two seconds at "
        "rest first";
  }
  return out;
}

}  // namespace rio::check
