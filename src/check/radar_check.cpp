// SPDX-License-Identifier: BSD-3-Clause
#include "check/radar_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "check/imu_check.hpp"
#include "check/numbers.hpp"
#include "check/order.hpp"
#include "rio/checks/stamp_guard.hpp"

namespace rio::check {

namespace {

/// First and last stamp of those in order.
template <typename Items>
std::pair<Time, Time> span_of(const Items& items) {
  const std::vector<std::size_t> order = in_order(items);
  return {items[order.front()].time, items[order.back()].time};
}

double duration(const Scans& scans) {
  const auto [begin, end] = span_of(scans);
  return std::max(1e-3, to_seconds(end - begin));
}

/// The longest interval between samples in order.
std::pair<Time, Time> longest_gap(const std::vector<ImuSample>& samples) {
  const std::vector<std::size_t> order = in_order(samples);
  std::pair<Time, Time> out;
  for (std::size_t i = 1; i < order.size(); ++i) {
    const Time from = samples[order[i - 1]].time;
    const Time to = samples[order[i]].time;
    if (to - from > out.second - out.first) out = {from, to};
  }
  return out;
}

/// Whether there are scans before and after an interval of some length, and none within.
bool is_silent(const Scans& scans, Time from, Time to) {
  constexpr double kPause = 0.25;  // two scans at least are missing [s]
  if (to_seconds(to - from) < kPause) return false;
  bool before = false;
  bool after = false;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const Time t = scans[i].time;
    if (t > from && t < to) return false;
    (t <= from ? before : after) = true;
  }
  return before && after;
}

/// The row of a file at which a scan begins: one per detection, or one for an empty scan.
std::size_t row_of(const Scans& scans, std::size_t scan) {
  std::size_t row = 0;
  for (std::size_t i = 0; i < scan; ++i)
    row += std::max<std::size_t>(1, scans[i].detections.size());
  return row;
}

Finding check_stamps(const Scans& scans, const io::RadarInfo& info, const Advice& advice,
                     const std::filesystem::path& csv) {
  constexpr double kNoScans = 0.5;  // no radar is that slow [s]
  if (const double grid = grid_of(scans); grid >= kNoScans) {
    return cut_stamps("radar stamps", grid,
                      advice.bag() ? "--radar-clock receive" : "write them in ns, with all digits");
  }
  std::vector<double> periods;
  const std::vector<std::size_t> order = in_order(scans);
  for (std::size_t i = 1; i < order.size(); ++i) {
    periods.push_back(to_seconds(scans[order[i]].time - scans[order[i - 1]].time));
  }
  const std::size_t unordered = scans.size() - order.size();
  if (periods.size() < 10) {
    return {
        Verdict::kWrong, "radar stamps",
        fmt::format("{} scans, {} of them not later than the one before", scans.size(), unordered),
        "record at least some seconds; a scan needs a stamp of its own"};
  }
  constexpr double kFastest = 1e-3;  // no radar scans at 1 kHz [s]
  if (median(periods) < kFastest) {
    return {Verdict::kWrong, "radar stamps",
            fmt::format("{} scans, half of them within {:.2g} ms of the one before", scans.size(),
                        1e3 * median(periods)),
            "all points of a scan must share its stamp, and be in one message"};
  }
  const double period = usual_period(periods, longest_usual(periods, std::nullopt));
  const double longest = *std::max_element(periods.begin(), periods.end());
  const double configured = advice.bag() ? 1.0 / period : info.rate_hz.value_or(1.0 / period);
  Finding out{Verdict::kOk, "radar stamps",
              fmt::format("{} scans, one each {:.1f} ms ({:.1f} Hz), longest gap {:.2f} s, {} not "
                          "in the order of time",
                          scans.size(), 1e3 * period, 1.0 / period, longest, unordered)};
  const Strays stray = strays(scans);
  const std::string place = stray.count > 0 ? place_of(csv, row_of(scans, stray.first)) : "";
  if (stray.count > 0) {
    out.text += fmt::format(", the first of them scan {} with the stamp {} ns", stray.first + 1,
                            scans[stray.first].time.count());
  }
  if (longest > kLongestSilence) {
    out.text +=
        fmt::format(", in which the IMU alone may run away by {:.1f} m/s", kFeigned * longest);
  }
  if (const Jump jump = jumps_back(scans); jump.count > 0) {
    out.judge(Verdict::kDoubtful, jump_text(jump), kSplitThere);
  } else if (unordered > 0) {
    out.judge(Verdict::kDoubtful, "",
              stray.count > 0 ? "put the scans in the order of their stamps, or correct the stamp"
                              : "a scan needs a stamp of its own");
    if (!place.empty()) out.change += "; see " + place;
  } else if (longest > kLongestSilence) {
    out.judge(Verdict::kDoubtful, "",
              "look for what silenced the radar; the estimate is uncertain meanwhile");
  } else if (std::abs(configured * period - 1.0) > 0.1) {
    out.judge(Verdict::kDoubtful, "",
              advice.sensor_line(fmt::format("rate_hz: {:.1f}", 1.0 / period)));
    const double grid = grid_of(scans);
    if (grid > 0.9 * period) out.change += fmt::format(", unless stamps are cut to {:g} s", grid);
  }
  return out;
}

Finding check_points(const Scans& scans, const std::vector<RadarSpeed>& speeds,
                     const Options& options, const Advice& advice) {
  constexpr double kMostSnr = 100.0;   // no radar has more [dB]
  constexpr double kEnough = 6.0;      // points a scan, of which three give a velocity
  constexpr double kNeighbours = 3.5;  // scans a second: three within 0.75 s (motion.cpp)
  std::vector<double> counts;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    counts.push_back(static_cast<double>(scans[i].detections.size()));
  }
  const auto snr = [&scans](double share) {
    return quantile_of(scans.points(), &Point::snr_db, share);
  };
  const auto is_flat = [](const Point& p) { return p.point_S.z() == 0.0; };
  const double usual_snr = snr(0.5);
  const double with = static_cast<double>(speeds.size()) / static_cast<double>(counts.size());
  const double rate = static_cast<double>(speeds.size()) / duration(scans);
  Finding out{
      Verdict::kOk, "points",
      fmt::format(
          "{:.0f} points a scan ({:.0f} to {:.0f} in nine of ten), SNR {:.0f} dB; "
          "{:.0f} % of the scans ({:.1f} a second) agree on a velocity, with {:.0f} % of "
          "their points",
          median(counts), quantile_of(&counts, 0.05), quantile_of(&counts, 0.95), usual_snr,
          100.0 * with, rate,
          speeds.empty() ? 0.0 : 100.0 * quantile_of(speeds, &RadarSpeed::inlier_share, 0.5))};
  const double most_snr = snr(0.999);
  const auto is_mark = [&](const Point& p) {
    return p.snr_db <= kMostSnr || p.snr_db == most_snr;  // of the driver: all the same
  };
  if (usual_snr <= kMostSnr && most_snr > kMostSnr &&
      std::ranges::all_of(scans.points(), is_mark)) {
    out.judge(Verdict::kDoubtful,
              fmt::format("; some have an SNR of {:.6g}: a mark of the driver for none", most_snr),
              "leave these points out, or give them no SNR, where they are recorded");
  } else if (usual_snr > kMostSnr || most_snr > 10.0 * kMostSnr) {
    double factor = 0.1;
    while (factor * most_snr > kMostSnr && factor > 1e-4) factor *= 0.1;
    const bool linear = most_snr > 100.0 * std::abs(usual_snr);
    out.judge(Verdict::kWrong,
              fmt::format("; an SNR of {:.0f} (up to {:.0f}) is not in dB{}", usual_snr, most_snr,
                          linear ? " but linear" : ""),
              advice.scale("snr", linear ? 0.0 : factor) + (linear ? ", which leaves it out" : ""));
  } else if (usual_snr < options.radar.min_snr_db) {
    out.judge(Verdict::kWrong, "", fmt::format("radar: {{min_snr_db: {:.0f}}}", snr(0.01) - 1.0));
  } else if (!scans.points().empty() && std::ranges::all_of(scans.points(), is_flat)) {
    out.judge(Verdict::kDoubtful,
              "; all points have z = 0: a radar without elevation, or a driver that drops it",
              "a radar that measures elevation: its Dopplers must show all three axes");
  } else if (rate * kSparseVelocities < 1.0) {
    out.verdict = Verdict::kDoubtful;
    const bool apart = static_cast<double>(counts.size()) < kNeighbours * duration(scans);
    const bool many = median(counts) >= kEnough;
    out.change = apart  ? "10 scans a second or more: farther apart they cannot confirm each other"
                 : many ? "most points move, or have another Doppler: record the detections, not "
                          "tracks, with clutter removal off and fewer moving objects"
                        : "more points a scan: lower the detection threshold of the radar (CFAR)";
  }
  return out;
}

/// Whether the points are where a radar sees, in metres.
Finding check_distances(const Scans& scans, const Options& options, const Advice& advice) {
  constexpr double kOtherUnit = 3.0;  // times the limit: the setting of no radar
  std::vector<double> ranges;
  const Point* before = nullptr;
  for (const Point& d : scans.points()) {  // a driver may fill its list with copies of one point
    if (before == nullptr || d.point_S != before->point_S) ranges.push_back(d.point_S.norm());
    before = &d;
  }
  const auto range = [&ranges](double share) { return quantile_of(&ranges, share); };
  const double nearest = range(0.01);
  const double usual = range(0.5);
  const double farthest = range(0.99);
  Finding out{Verdict::kOk, "distances",
              fmt::format("half of the points within {:.3g} m, nearly all from {:.2g} to {:.3g} m",
                          usual, nearest, farthest)};
  const double limit = options.radar.max_range;
  if (!(usual > limit)) return out;
  out.text += fmt::format(", dropped beyond {:.3g} m (radar.max_range)", limit);
  if (usual > kOtherUnit * limit) {
    out.verdict = Verdict::kWrong;
    const auto unlike_a_room = [usual](double factor) {
      constexpr double kRoom = 3.0;  // half of the points are within some metres
      return std::abs(std::log(factor * usual / kRoom));
    };
    const bool mm = unlike_a_room(1e-3) < unlike_a_room(1e-2);
    out.text += fmt::format(": not in metres; in mm half of them are within {:.3g} m, in cm {:.3g}",
                            1e-3 * usual, 1e-2 * usual);
    out.change =
        fmt::format("{}, y and z alike; {} if they are in {}", advice.scale("x", mm ? 1e-3 : 1e-2),
                    mm ? "0.01" : "0.001", mm ? "cm" : "mm");
  } else {
    out.judge(Verdict::kDoubtful, "",
              fmt::format("radar: {{max_range: {:.0f}}}", std::ceil(farthest)));
  }
  return out;
}

}  // namespace

double stamp_unit(const Scans& scans) {
  constexpr double kFastest = 1e-3;  // [s]
  std::vector<double> periods;
  std::vector<double> counts;
  for (std::size_t i = 1; i < scans.size(); ++i) {
    if (!is_stamp(scans[i].time) || !is_stamp(scans[i - 1].time)) continue;
    periods.push_back(to_seconds(scans[i].time - scans[i - 1].time));
    counts.push_back(static_cast<double>(scans[i].detections.size()));
  }
  const double period = quantile_of(&periods, 0.8);  // of scans that are there twice a whole one
  if (!(period > 0.0 && period < kFastest) || median(counts) < 2.0) return 1.0;
  return 1e3 * period > kFastest ? 1e3 : 1e6;
}

Finding check_clocks(const std::vector<ImuSample>& samples, const Scans& scans,
                     const Advice& advice) {
  const auto [imu_begin, imu_end] = span_of(samples);
  const auto [radar_begin, radar_end] = span_of(scans);
  const double imu = to_seconds(imu_end - imu_begin);
  const double radar = to_seconds(radar_end - radar_begin);
  if (const double unit = stamp_unit(scans); unit != 1.0) {
    return {
        Verdict::kWrong, "clocks",
        fmt::format("the stamps of the radar are in {}: {} scans in {:.4f} s",
                    unit > 1e3 ? "ms" : "us", scans.size(), radar),
        (advice.bag() ? "--radar-clock receive, or " : "") +
            fmt::format("multiply the stamps of the radar by {:.0f}: they must be in ns", unit)};
  }
  const double both =
      std::max(0.0, to_seconds(std::min(imu_end, radar_end) - std::max(imu_begin, radar_begin)));
  const double late = to_seconds(radar_begin - imu_begin);
  Finding out{Verdict::kOk, "clocks",
              fmt::format("the IMU runs for {:.1f} s, the radar for {:.1f} s from {:.3f} s after "
                          "its start, both for {:.1f} s",
                          imu, radar, late, both)};
  const double share = both / std::max(1e-3, std::min(imu, radar));
  if (share > 0.8) {
    if (const auto [from, to] = longest_gap(samples); is_silent(scans, from, to)) {
      out.judge(Verdict::kDoubtful,
                fmt::format("; both are silent for {:.3f} s, {:.1f} s after the begin",
                            to_seconds(to - from), to_seconds(from - imu_begin)),
                "if nothing was lost there the clock was set forward (NTP?): take that off all "
                "later stamps");
    }
    return out;
  }
  out.verdict = share < 0.1 ? Verdict::kWrong : Verdict::kDoubtful;
  out.change = "both sensors need one clock; if both began together, ";
  out.change += advice.bag()
                    ? fmt::format("--radar-offset \"{:.3f} s\", or --radar-clock receive", -late)
                    : fmt::format("add {} to the stamps of {}", (imu_begin - radar_begin).count(),
                                  advice.csv());
  return out;
}

Findings check_radar(const Scans& scans, const io::RadarInfo& info,
                     const std::vector<RadarSpeed>& speeds, const CheckedImu& imu,
                     const Options& options, const Advice& advice,
                     const std::filesystem::path& csv) {
  const Finding stamps = check_stamps(scans, info, advice, csv);
  if (stamps.verdict == Verdict::kWrong) return {stamps};
  return {stamps, check_points(scans, speeds, options, advice),
          check_distances(scans, options, advice), check_doppler(scans, imu, options, advice)};
}

}  // namespace rio::check
