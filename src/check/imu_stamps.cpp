// SPDX-License-Identifier: BSD-3-Clause
#include "check/imu_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>

#include "check/advice.hpp"
#include "check/numbers.hpp"
#include "check/order.hpp"

namespace rio::check {

namespace {

/// Error of the estimate if lost samples are bridged by linear motion between their neighbours,
/// measured over intervals of the same length where samples are present.
struct Bridged {
  double velocity = 0.0;  ///< rms of the longest gap [m/s]
  double angle = 0.0;     ///< rms of the sum over all [rad]
};

/// Mean squares of the integrals of rate and specific force over n periods, minus the interpolation
/// from both ends; empty if no part of the recording is that long.
std::optional<Bridged> mean_squares(const std::vector<ImuSample>& samples, std::size_t n,
                                    double period) {
  Bridged sum;
  double count = 0.0;
  Vector3d gyro = Vector3d::Zero();  // sums over the samples between the ends
  Vector3d accel = Vector3d::Zero();
  for (std::size_t end = 1; end < samples.size(); ++end) {
    if (end >= n) {
      const ImuSample& first = samples[end - n];
      const ImuSample& last = samples[end];
      if (to_seconds(last.time - first.time) < (static_cast<double>(n) + 0.5) * period) {
        const double inside = static_cast<double>(n - 1);
        sum.angle += (gyro - 0.5 * inside * (first.gyro_B + last.gyro_B)).squaredNorm();
        sum.velocity += (accel - 0.5 * inside * (first.accel_B + last.accel_B)).squaredNorm();
        count += 1.0;
      }
      gyro -= samples[end - n + 1].gyro_B;
      accel -= samples[end - n + 1].accel_B;
    }
    gyro += samples[end].gyro_B;
    accel += samples[end].accel_B;
  }
  if (count == 0.0) return std::nullopt;
  return Bridged{period * period / count * sum.velocity, period * period / count * sum.angle};
}

/// @param usual in longer intervals samples are lost [s]
std::optional<Bridged> cost_of_gaps(const std::vector<ImuSample>& samples, double period,
                                    double usual) {
  std::map<std::size_t, double> gaps;  // number of gaps by length in periods
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const double dt = to_seconds(samples[i].time - samples[i - 1].time);
    const auto n = static_cast<std::size_t>(std::min(1e9, std::round(dt / period)));
    if (n > 1 && dt > usual) gaps[n] += 1.0;
  }
  Bridged out;
  for (const auto& [n, count] : gaps) {
    const auto squares = mean_squares(samples, n, period);
    if (!squares) return std::nullopt;
    out.angle += count * squares->angle;
    out.velocity = std::sqrt(squares->velocity);  // the last one is the longest
  }
  out.angle = std::sqrt(out.angle);
  return out;
}

/// What the stamps are like.
struct StampCounts {
  Repeated repeated;
  Strays stray;
  double usual = 0.0;    ///< in longer intervals samples are lost [s]
  double period = 0.0;   ///< [s]
  double mean = 0.0;     ///< interval [s]
  double longest = 0.0;  ///< interval [s]
  double lost = 0.0;     ///< samples
  double batches = 0.0;  ///< if samples come together
};

/// @param known period, if it is configured [s]
StampCounts count_stamps(const Usable& samples, std::optional<double> known) {
  const std::vector<ImuSample>& all = samples.all();
  const std::vector<ImuSample>& good = samples.good();
  StampCounts out;
  out.repeated = repeated(all);
  out.stray = strays(all);
  std::vector<double> periods;
  periods.reserve(good.size());
  for (std::size_t i = 1; i < good.size(); ++i) {
    periods.push_back(to_seconds(good[i].time - good[i - 1].time));
  }
  out.usual = longest_usual(periods, known);
  out.period = usual_period(periods, out.usual);
  out.mean = to_seconds(good.back().time - good.front().time) / static_cast<double>(periods.size());
  out.longest = *std::max_element(periods.begin(), periods.end());
  out.batches = 1.0;
  for (const double p : periods) {
    out.lost += p <= out.usual ? 0.0 : std::max(0.0, std::round(p / out.period) - 1.0);
    out.batches += p > out.mean ? 1.0 : 0.0;
  }
  return out;
}

}  // namespace

Repeated repeated(const std::vector<ImuSample>& samples) {
  Repeated out;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    if (samples[i].time != samples[i - 1].time) continue;
    ++out.count;
    out.twice += same_values(samples[i], samples[i - 1]) ? 1U : 0U;
  }
  return out;
}

Finding check_stamps(const Usable& samples, const io::ImuInfo& info, Source source,
                     const std::filesystem::path& csv, ImuCheck* found) {
  const std::vector<ImuSample>& all = samples.all();
  const std::vector<ImuSample>& good = samples.good();
  const bool known = source == Source::kFolder && info.rate_hz.has_value();
  const StampCounts n =
      count_stamps(samples, known ? std::optional(1.0 / *info.rate_hz) : std::nullopt);
  const double period = n.period;
  const Strays& stray = n.stray;
  const double share = n.lost / (n.lost + static_cast<double>(good.size()));
  Finding out{
      Verdict::kOk, "imu stamps",
      fmt::format("{} samples in {:.1f} s, one each {:.2f} ms ({:.0f} Hz), {:.1f} % lost, "
                  "longest gap {:.0f} ms, {} repeated, {} out of order",
                  all.size(), to_seconds(good.back().time - good.front().time), 1e3 * period,
                  1.0 / period, 100.0 * share, 1e3 * n.longest, n.repeated.count, stray.count)};
  const std::optional<Bridged> bridged = cost_of_gaps(good, period, n.usual);
  if (n.lost > 0.0 && bridged) {
    out.text += fmt::format(", bridged at {:.2f} m/s for the longest and {:.1f} deg for all",
                            bridged->velocity, bridged->angle / kDegree);
  }
  const std::string place = stray.count > 0 ? place_of(csv, stray.first) : "";
  if (stray.count > 0) {
    out.text += fmt::format(", the first of them sample {} with the stamp {} ns", stray.first + 1,
                            all[stray.first].time.count());
    if (!place.empty()) out.text += fmt::format(" ({})", place);
  }
  constexpr double kFastest = 1e-4;  // no IMU samples at 10 kHz [s]
  constexpr double kSlowest = 0.05;  // too slow an IMU for integration in flight [s]
  const double configured =
      source == Source::kBag ? 1.0 / period : info.rate_hz.value_or(1.0 / period);
  const Jump jump = jumps_back(all);
  constexpr double kBatch = 3.0;  // mean over usual interval, where samples come together
  if (period < kFastest && n.mean > kBatch * period) {
    out.judge(Verdict::kWrong,
              fmt::format(": they come in batches of {:.0f}, stamped when they arrived",
                          static_cast<double>(good.size()) / n.batches),
              (source == Source::kBag ? "--imu-clock receive, or " : "") +
                  std::string("stamp each sample by itself in its driver"));
  } else if (period < kFastest) {
    const bool micro = 1e3 * period > kFastest;
    found->stamp_unit = micro ? 1e3 : 1e6;
    out.judge(Verdict::kWrong, fmt::format(": the stamps are in {}", micro ? "us" : "ms"), "");
  } else if (period > kSlowest) {
    out.judge(Verdict::kWrong, "", "record the IMU at 100 Hz or more");
  } else if (jump.count > 0) {
    out.judge(Verdict::kDoubtful, jump_text(jump), kSplitThere);
  } else if (static_cast<double>(n.repeated.count) + static_cast<double>(stray.count) >
             0.01 * static_cast<double>(all.size())) {
    if (2 * n.repeated.twice > n.repeated.count) {
      out.judge(Verdict::kDoubtful,
                fmt::format(", {} of them with the values of the one before", n.repeated.twice),
                "look for two publishers of one topic, or two recordings of it joined");
    } else {
      out.judge(Verdict::kDoubtful, "",
                "look for two publishers of one topic, or samples stamped on arrival");
    }
  } else if (!bridged || bridged->velocity > kMostVelocity || bridged->angle > kMostTilt) {
    out.judge(Verdict::kDoubtful, "",
              "record with less load; the gaps are bridged, at a loss of accuracy");
  } else if (std::abs(configured * period - 1.0) > 0.1) {
    out.judge(Verdict::kDoubtful, "",
              fmt::format("imu0/sensor.yaml: rate_hz: {:.0f}", 1.0 / period));
  } else if (stray.count > 0) {
    out.judge(Verdict::kDoubtful, "",
              place.empty() ? "leave these samples out" : "remove the line " + place);
  }
  return out;
}

}  // namespace rio::check
