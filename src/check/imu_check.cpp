// SPDX-License-Identifier: BSD-3-Clause
#include "check/imu_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "check/advice.hpp"
#include "check/numbers.hpp"
#include "check/order.hpp"
#include "rio/propagate/static_alignment.hpp"

namespace rio::check {

namespace {

Rest stillest(const std::vector<ImuSample>& samples) {
  constexpr double kFewest = 5.0;  // samples in a second
  Rest best;
  for (std::size_t begin = 0, end = 0; begin < samples.size(); begin = end) {
    Rest now;
    double squares = 0.0;
    double rates = 0.0;
    while (end < samples.size() && samples[end].time < samples[begin].time + from_seconds(1.0)) {
      now.accel += samples[end].accel_B;
      now.gyro += samples[end].gyro_B;
      squares += samples[end].accel_B.squaredNorm();
      rates += samples[end].gyro_B.squaredNorm();
      ++end;
    }
    const auto n = static_cast<double>(end - begin);
    now.accel /= n;
    now.gyro /= n;
    const double variance = std::max(0.0, squares / n - now.accel.squaredNorm());
    now.spread = std::sqrt(variance) / now.accel.norm();
    now.turning = std::sqrt(std::max(0.0, rates / n - now.gyro.squaredNorm()));
    now.begin = samples[begin].time;
    now.end = samples[end - 1].time;
    now.least = std::min(best.least, now.accel.norm());
    if (n >= kFewest && now.spread < best.spread) best = now;
    best.least = now.least;
  }
  return best;
}

/// Orientation of the IMU; not an error, the alignment finds it.
Finding check_up(const Rest& rest) {
  const Vector3d up = rest.accel.normalized();
  int axis = 0;
  up.cwiseAbs().maxCoeff(&axis);
  std::string text =
      fmt::format("up is the {}{} axis of the IMU, to {:.0f} deg", up[axis] < 0.0 ? "-" : "+",
                  "xyz"[axis], std::acos(std::min(1.0, std::abs(up[axis]))) / kDegree);
  if (axis == 2 && up[axis] < 0.0) text += " (as in FRD; it is found by the alignment at rest)";
  return {Verdict::kOk, "imu upright", text};
}

/// A saturated sensor repeats the same largest value; one without noise is none.
Finding check_saturation(const Usable& usable) {
  const std::vector<ImuSample>& samples = usable.good();
  std::size_t at_end = 0;
  std::size_t frozen = 0;
  std::string still;
  const auto count_at_end = [&](const std::string& name, const auto& value) {
    double most = 0.0;
    for (const ImuSample& s : samples) most = std::max(most, std::abs(value(s)));
    std::size_t n = 0;
    for (const ImuSample& s : samples) n += std::abs(value(s)) == most ? 1U : 0U;
    const double first = value(samples.front());
    if (std::all_of(samples.begin(), samples.end(),
                    [&](const ImuSample& s) { return value(s) == first; })) {
      still += (still.empty() ? "" : ", ") + name;
    } else if (n > 5) {
      at_end = std::max(at_end, n);
    }
  };
  for (int axis = 0; axis < 3; ++axis) {
    const std::string name(1, "xyz"[axis]);
    count_at_end("gyro " + name, [axis](const ImuSample& s) { return s.gyro_B[axis]; });
    count_at_end("accelerometer " + name, [axis](const ImuSample& s) { return s.accel_B[axis]; });
  }
  for (std::size_t i = 1; i < samples.size(); ++i) {
    frozen += same_values(samples[i], samples[i - 1]) ? 1U : 0U;
  }
  const auto n = static_cast<double>(samples.size());
  const double end = 100.0 * static_cast<double>(at_end) / n;
  const double same = 100.0 * static_cast<double>(frozen) / n;
  Finding out{Verdict::kOk, "imu saturation",
              fmt::format("{:.2f} % of an axis at its largest value, {:.2f} % of the samples equal "
                          "the one before",
                          end, same)};
  if (usable.spikes() > 0) {
    out.text += fmt::format("; {} single ones are all zero or beyond the range, and left out",
                            usable.spikes());
  }
  if (!still.empty()) {
    out.judge(Verdict::kDoubtful, "; never changes: " + still,
              "every axis of an IMU has noise: find out why the driver does not fill these in");
  } else if (end > 0.1 || same > 1.0) {
    out.judge(Verdict::kDoubtful, "",
              "widen the ranges of the IMU and mount it softer; read it as often as it measures");
  } else if (100 * usable.spikes() > samples.size()) {
    out.judge(Verdict::kDoubtful, "", "look for damaged reads in the driver of the IMU");
  }
  return out;
}

/// At rest, but farther from gravity than the alignment allows (static_alignment.cpp).
bool is_off_gravity(const ImuCheck& check, const Options& options) {
  const double f = check.accel_unit * check.rest.accel.norm();
  return check.rest.is_quiet(check.gyro_unit) &&
         std::abs(f - options.imu.gravity) > 10.0 * options.start.sigma_accel_bias;
}

}  // namespace

Usable::Usable(const std::vector<ImuSample>& all) : all_(all) {
  constexpr double kMost = 1e9;  // in no unit of an IMU; sums of larger ones would lose the others
  const ImuOptions limits;
  const auto is_finite = [kMost](const ImuSample& s) {
    return (s.gyro_B.array().abs() < kMost).all() && (s.accel_B.array().abs() < kMost).all();
  };
  const auto is_odd = [&](const ImuSample& s) {
    return s.gyro_B.cwiseAbs().maxCoeff() >= limits.max_rate ||
           s.accel_B.cwiseAbs().maxCoeff() >= limits.max_accel ||
           (s.gyro_B.isZero(0.0) && s.accel_B.isZero(0.0));
  };
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!is_finite(all[i])) continue;
    const bool alone = i > 0 && i + 1 < all.size() && !is_odd(all[i - 1]) && !is_odd(all[i + 1]);
    if (alone && is_odd(all[i])) {
      ++spikes_;
    } else {
      kept.push_back(i);
    }
  }
  std::vector<ImuSample> some;
  if (kept.size() < all.size()) {
    for (const std::size_t i : kept) some.push_back(all[i]);
  }
  const std::vector<ImuSample>& finite = kept.size() < all.size() ? some : all;
  const std::vector<std::size_t> order = in_order(finite);
  if (order.size() == all.size()) return;
  fewer_.emplace();
  for (const std::size_t i : order) fewer_->push_back(finite[i]);
}

ImuCheck check_imu(const Usable& usable, const io::ImuInfo& info, Source source,
                   const std::filesystem::path& csv) {
  const std::vector<ImuSample>& samples = usable.all();
  const std::vector<ImuSample>& good = usable.good();
  ImuCheck out;
  constexpr double kFine = 1e-3;  // less is the rounding of a driver [s]
  const Repeated same_stamp = repeated(samples);
  if (const double grid = grid_of(samples);
      good.size() > 1 && grid >= kFine &&
      3 * (same_stamp.count - same_stamp.twice) > samples.size()) {
    out.findings.push_back(cut_stamps(
        "imu stamps", grid,
        source == Source::kBag ? "--imu-clock receive" : "write them in ns, with all digits"));
    return out;
  }
  if (good.size() < 100) {
    out.findings.push_back({Verdict::kWrong, "imu stamps",
                            fmt::format("{} of {} samples are finite and in the order of time",
                                        good.size(), samples.size()),
                            samples.size() < 100 ? "record at least some seconds"
                            : source == Source::kBag
                                ? "--imu-clock receive, if the stamps do not rise"
                                : "correct the stamps: each must be later than the one before"});
    return out;
  }
  out.rest = stillest(good);
  out.findings.push_back(check_stamps(usable, info, source, csv, &out));
  if (out.stamp_unit != 1.0) return out;
  out.findings.push_back(check_accel(good, source, &out));
  if (out.exchanged) return out;
  if (std::isfinite(out.rest.spread)) out.findings.push_back(check_up(out.rest));
  out.findings.push_back(check_gyro(good, source, &out));
  out.findings.push_back(check_saturation(usable));
  return out;
}

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
    out.judge(Verdict::kDoubtful, ": at rest the accelerometer is too far off gravity",
              "calibrate its scale and bias; start.sigma_accel_bias allows ten times itself");
  } else if (options.start.max_wait > 0.0) {
    out.text += fmt::format("; start.max_wait is {:.3g} s", options.start.max_wait);
  } else if (!start || waited > kLate + options.start.duration) {
    out.judge(Verdict::kDoubtful, start ? ", and dropped" : ": the estimator does not start",
              "start: {max_wait: 3}, which starts in motion after 3 s; better, record two seconds "
              "at rest first");
  }
  return out;
}

}  // namespace rio::check
