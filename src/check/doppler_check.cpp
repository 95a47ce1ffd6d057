// SPDX-License-Identifier: BSD-3-Clause
#include "check/radar_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "check/motion.hpp"
#include "check/numbers.hpp"

namespace rio::check {

namespace {

double quantile_of_magnitudes(const Scans& scans, double share) {
  return quantile_of(
      scans.points(), [](const Point& d) { return std::abs(d.range_rate); }, share);
}

/// Approaching targets have a negative Doppler, but no detection has an SNR far below zero.
bool looks_exchanged(std::span<const Point> points) {
  constexpr double kShare = 0.1;
  const auto recedes_or_stands = [](const Point& d) { return !(d.range_rate < 0.0); };
  const auto weak =
      std::count_if(points.begin(), points.end(), [](const Point& d) { return d.snr_db < 0.0; });
  return static_cast<double>(weak) > kShare * static_cast<double>(points.size()) &&
         std::all_of(points.begin(), points.end(), recedes_or_stands);
}

constexpr double kFastestVehicle = 100.0;  // no vehicle [m/s]

/// The share of points whose Doppler is a mark of the driver for "none": few, beyond any vehicle,
/// and apart from all others. 0 if the fast ones are not that.
double share_of_marks(std::span<const Point> points) {
  constexpr double kMost = 0.2;  // of the points
  std::size_t beyond = 0;
  for (const Point& d : points) {
    const double speed = std::abs(d.range_rate);
    if (speed > 0.3 * kFastestVehicle && speed <= kFastestVehicle) return 0.0;
    beyond += speed > kFastestVehicle ? 1U : 0U;
  }
  const double share = static_cast<double>(beyond) / static_cast<double>(points.size());
  return share < kMost ? share : 0.0;
}

/// Whether the Dopplers of the IMU's way cannot all be zero.
bool moves(const CheckedImu& imu) {
  const ImuCheck& check = imu.check;
  return !check.integrable || movement_of(imu.good, check.gyro_unit, check.accel_unit) > kFlown;
}

/// The Doppler of all points at rest, from half a step of the grid on; 0 if it is none, or unknown.
double offset_at_rest(const Scans& scans, const Rest& rest, double gyro_unit, double grid) {
  constexpr std::size_t kFewest = 30;  // points
  constexpr double kAlike = 0.9;       // of the points; in motion it depends on their directions
  if (!(grid > 0.0) || !rest.is_quiet(gyro_unit)) return 0.0;
  std::vector<double> rates;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const ScanView scan = scans[i];
    if (scan.time < rest.begin || scan.time > rest.end) continue;
    for (const Point& d : scan.detections) rates.push_back(d.range_rate);
  }
  if (rates.size() < kFewest) return 0.0;
  const double usual = quantile_of(&rates, 0.5);
  const auto alike = std::count_if(
      rates.begin(), rates.end(), [&](double rate) { return std::abs(rate - usual) < 0.5 * grid; });
  const bool all = static_cast<double>(alike) > kAlike * static_cast<double>(rates.size());
  return all && std::abs(usual) > 0.4 * grid ? usual : 0.0;
}

}  // namespace

double fastest(const Scans& scans) {
  const double most = quantile_of_magnitudes(scans, 0.999);
  return std::isnan(most) ? 0.0 : most;
}

Finding check_doppler(const Scans& scans, const CheckedImu& imu, const Options& options,
                      const Advice& advice) {
  const std::span<const Point> points = scans.points();
  const auto count_if = [points](const auto& is_counted) {
    return static_cast<double>(std::count_if(points.begin(), points.end(), is_counted));
  };
  const double count = count_if([](const Point& d) { return std::isfinite(d.range_rate); });
  if (count == 0.0) return {Verdict::kWrong, "Doppler", "no scan has a point", "see `rio info`"};
  const double limit = options.radar.max_doppler;
  const double most = quantile_of_magnitudes(scans, 0.999);
  const double middle = quantile_of_magnitudes(scans, 0.5);
  const double still = count_if([](const Point& d) { return d.range_rate == 0.0; }) / count;
  const double grid = options.radar.doppler_resolution;
  Finding out{Verdict::kOk, "Doppler",
              fmt::format("up to {:.2f} m/s (half of them below {:.2f}), {:.0f} % exactly zero, {}",
                          most, middle, 100.0 * still,
                          grid > 0.0 ? fmt::format("grid of {:.3f} m/s", grid) : "no grid")};
  if (limit > 0.0) out.text += fmt::format(", folds at +-{:.2f} m/s", limit);
  if (looks_exchanged(points)) {
    out.judge(Verdict::kWrong, ", never negative, while the SNR is: the two are exchanged",
              advice.bag() ? "--field doppler=NAME --field snr=NAME, the other way round"
                           : "exchange the columns doppler and snr of " + advice.csv());
  } else if (const double marks = share_of_marks(points); marks > 0.0) {
    out.judge(Verdict::kDoubtful,
              fmt::format("; {:.2g} % of the points are beyond {:.0f} m/s and none is near: marks "
                          "of the driver for no velocity",
                          100.0 * marks, kFastestVehicle),
              "leave these points out where they are recorded; here they are outliers");
  } else if (most > kFastestVehicle) {
    const bool in_mm = 1e-2 * most > (limit > 0.0 ? 2.0 * limit : 30.0);
    out.judge(Verdict::kWrong, fmt::format(": not in m/s, but in {}", in_mm ? "mm/s" : "cm/s"),
              advice.scale("doppler", in_mm ? 1e-3 : 1e-2));
  } else if (still > 0.999 && moves(imu)) {
    out.judge(Verdict::kWrong, "",
              advice.bag() ? "--field doppler=NAME; `rio info` lists the fields"
                           : "fill the column doppler of " + advice.csv());
  } else if (const double offset = offset_at_rest(scans, imu.check.rest, imu.check.gyro_unit, grid);
             offset != 0.0) {
    out.judge(Verdict::kWrong,
              fmt::format(", {:+.3f} m/s at rest: off by {:+.1f} steps of its grid", offset,
                          offset / grid),
              fmt::format("subtract {:.4g} m/s from the Doppler: the driver numbers its bins "
                          "otherwise",
                          offset));
  } else if (limit > 0.0 && most > 1.05 * limit) {
    out.judge(Verdict::kWrong, ": a radar that folds there cannot say so",
              fmt::format("the unit of the Doppler (see \"Doppler scale\"), or radar: "
                          "{{max_doppler: {:.2f}}}",
                          most));
  } else if (limit > 0.0 && middle > 0.5 * limit) {
    out.judge(Verdict::kDoubtful, "", "much of it may be folded: a faster chirp, or slower flight");
  } else if (!(limit > 0.0)) {
    out.change = "if the radar folds below the speed flown, tell it: radar: {max_doppler: ...}";
  }
  return out;
}

}  // namespace rio::check
