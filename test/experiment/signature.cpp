// SPDX-License-Identifier: BSD-3-Clause
#include "experiment/signature.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <utility>

namespace rio::experiment {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

constexpr double kSame = 0.1;  // two observations of one point [m]

double ratio(double part, double whole) {
  return whole > 0.0 ? part / whole : kNaN;
}

/// Median distance of neighbours [s].
template <class Stamped>
double median_interval(const std::vector<Stamped>& all) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < all.size(); ++i) {
    intervals.push_back(to_seconds(all[i].time - all[i - 1].time));
  }
  return Quantiles::of(std::move(intervals)).median;
}

/// Samples of a window of the spectrum.
std::size_t window(double rate_hz) {
  constexpr double kWindow = 0.64;  // [s]
  return static_cast<std::size_t>(std::lround(kWindow * rate_hz));
}

/// (E1), to the rounding of a file of six digits.
bool on_line(double before, double value, double after) {
  constexpr double kRelative = 2e-5;
  constexpr double kAbsolute = 2e-7;
  const double scale = std::max(std::abs(before), std::abs(after));
  return std::abs(before - 2.0 * value + after) <= kAbsolute + kRelative * scale;
}
bool is_interpolated(const ImuSample& before, const ImuSample& sample, const ImuSample& after) {
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (!on_line(before.gyro_B[axis], sample.gyro_B[axis], after.gyro_B[axis])) return false;
    if (!on_line(before.accel_B[axis], sample.accel_B[axis], after.accel_B[axis])) return false;
  }
  return true;
}

void count_losses(const std::vector<ImuSample>& imu, ImuSignature* s) {
  const double period = 1.0 / s->rate_hz;
  double missing = 0.0;
  double interpolated = 0.0;
  double runs = 0.0;
  bool last = false;
  for (std::size_t i = 1; i < imu.size(); ++i) {
    const double gone =
        std::max(0.0, std::round(to_seconds(imu[i].time - imu[i - 1].time) / period) - 1.0);
    missing += gone;
    runs += gone > 0.0 ? 1.0 : 0.0;
    const bool now = i + 1 < imu.size() && is_interpolated(imu[i - 1], imu[i], imu[i + 1]);
    interpolated += now ? 1.0 : 0.0;
    runs += now && !last ? 1.0 : 0.0;
    last = now;
  }
  const auto present = static_cast<double>(imu.size());
  s->missing = missing / (present + missing);
  s->interpolated = interpolated / present;
  s->run = ratio(missing + interpolated, runs);
}

/// Samples of an interval.
std::vector<Vector3d> samples_between(const std::vector<ImuSample>& imu, Time begin, Time end,
                                      Vector3d ImuSample::*value) {
  std::vector<Vector3d> samples;
  for (const ImuSample& sample : imu) {
    if (sample.time >= begin && sample.time < end) samples.push_back(sample.*value);
  }
  return samples;
}

/// Mean and trend removed, times a Hann window.
std::vector<double> windowed(const std::vector<Vector3d>& samples, std::size_t first, std::size_t n,
                             Eigen::Index axis) {
  const double middle = 0.5 * static_cast<double>(n - 1);
  double mean = 0.0;
  double slope = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = static_cast<double>(i) - middle;
    mean += samples[first + i][axis] / static_cast<double>(n);
    slope += x * samples[first + i][axis];
    squares += x * x;
  }
  slope /= squares;
  std::vector<double> result;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = static_cast<double>(i) - middle;
    const double w = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * (static_cast<double>(i) + 0.5) /
                                          static_cast<double>(n));
    result.push_back(w * (samples[first + i][axis] - mean - slope * x));
  }
  return result;
}

double line_power(const std::vector<double>& x, std::size_t k) {
  std::complex<double> sum = 0.0;
  const double step =
      2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    sum += std::polar(x[i], -step * static_cast<double>(i));
  }
  constexpr double kHann = 3.0 / 8.0;  // mean of w^2
  const auto n = static_cast<double>(x.size());
  return 2.0 * std::norm(sum) / (n * n * kHann);
}

std::size_t band_of(double frequency) {
  const auto above = std::upper_bound(kBandEdges.begin(), kBandEdges.end(), frequency);
  return static_cast<std::size_t>(above - kBandEdges.begin()) - 1;
}

void look_at_points(const io::Dataset& data, Time begin, Time end, RadarSignature* s) {
  std::vector<double> points;
  std::vector<double> speed;
  std::vector<double> range;
  std::vector<double> azimuth;
  std::vector<double> elevation;
  std::vector<double> snr;
  for (const RadarScan& scan : data.scans) {
    points.push_back(static_cast<double>(scan.detections.size()));
    for (const RadarDetection& d : scan.detections) {
      range.push_back(d.point_S.norm());
      azimuth.push_back(std::atan2(d.point_S.y(), d.point_S.x()));
      elevation.push_back(std::asin(d.point_S.z() / range.back()));
      snr.push_back(d.snr_db);
      if (scan.time >= begin && scan.time <= end) speed.push_back(std::abs(d.range_rate));
    }
  }
  const double n = static_cast<double>(range.size());
  double mean_log = 0.0;
  double mean_snr = 0.0;
  for (std::size_t i = 0; i < range.size(); ++i) {
    mean_log += std::log10(range[i]) / n;
    mean_snr += snr[i] / n;
  }
  double covariance = 0.0;
  double variance = 0.0;
  for (std::size_t i = 0; i < range.size(); ++i) {
    const double x = std::log10(range[i]) - mean_log;
    covariance += x * (snr[i] - mean_snr);
    variance += x * x;
  }
  s->snr_range = ratio(covariance, variance);
  s->empty = ratio(static_cast<double>(std::count(points.begin(), points.end(), 0.0)),
                   static_cast<double>(points.size()));
  s->mean_points = n / static_cast<double>(points.size());
  s->points = Quantiles::of(std::move(points));
  s->speed = Quantiles::of(std::move(speed));
  s->range = Quantiles::of(std::move(range));
  s->azimuth = Quantiles::of(std::move(azimuth));
  s->elevation = Quantiles::of(std::move(elevation));
  std::sort(snr.begin(), snr.end());
  s->snr_floor_db = snr.empty() ? kNaN : snr[snr.size() / 100];
  s->snr_db = Quantiles::of(std::move(snr));
}

bool has_near(const std::vector<RadarDetection>& detections, const Vector3d& point_S,
              double distance) {
  return std::any_of(detections.begin(), detections.end(), [&](const RadarDetection& d) {
    return (d.point_S - point_S).norm() < distance;
  });
}

/// Share of the points of an interval that the next scan has within a distance.
double found_again(const io::Dataset& data, Time begin, Time end, double distance) {
  double all = 0.0;
  double found = 0.0;
  for (std::size_t i = 0; i + 1 < data.scans.size(); ++i) {
    if (data.scans[i].time < begin || data.scans[i + 1].time > end) continue;
    for (const RadarDetection& d : data.scans[i].detections) {
      all += 1.0;
      found += has_near(data.scans[i + 1].detections, d.point_S, distance) ? 1.0 : 0.0;
    }
  }
  return ratio(found, all);
}

/// In scans with motion of most of their points, if the scan half a second later has it, too.
void look_at_companions(const io::Dataset& data, RadarSignature* s) {
  constexpr double kLater = 0.5;  // [s]
  const auto still = [&](const RadarDetection& d) {
    return std::abs(d.range_rate) < still_bound(s->doppler_grid);
  };
  const auto moves = [&](const RadarScan& scan) {
    const auto count = std::count_if(scan.detections.begin(), scan.detections.end(), still);
    return scan.detections.size() >= 3 &&
           2 * static_cast<std::size_t>(count) < scan.detections.size();
  };
  double all = 0.0;
  double companions = 0.0;
  std::size_t later = 0;
  for (const RadarScan& scan : data.scans) {
    while (later < data.scans.size() && to_seconds(data.scans[later].time - scan.time) < kLater) {
      ++later;
    }
    if (later == data.scans.size()) break;
    if (!moves(scan) || !moves(data.scans[later])) continue;
    for (const RadarDetection& d : scan.detections) {
      all += 1.0;
      companions +=
          still(d) && has_near(data.scans[later].detections, d.point_S, kSame) ? 1.0 : 0.0;
    }
  }
  s->rides_along = ratio(companions, all);
}

void look_at_rest(const io::Dataset& data, Time end, RadarSignature* s) {
  double all = 0.0;
  double still = 0.0;
  for (const RadarScan& scan : data.scans) {
    if (scan.time >= end) break;
    for (const RadarDetection& d : scan.detections) {
      all += 1.0;
      still += std::abs(d.range_rate) < still_bound(s->doppler_grid) ? 1.0 : 0.0;
    }
  }
  s->still_at_rest = ratio(still, all);
}

/// How unsteady the vibration is, and how far from Gaussian.
void look_at_shocks(const std::vector<Vector3d>& accel, ImuSignature* s) {
  const std::size_t n = window(s->rate_hz);
  std::vector<double> rms;
  double squares = 0.0;
  double fourths = 0.0;
  double count = 0.0;
  for (std::size_t first = 0; first + n < accel.size(); first += n) {
    double sum = 0.0;
    for (std::size_t i = first; i < first + n; ++i) {
      const Vector3d change = accel[i + 1] - accel[i];
      sum += change.squaredNorm();
      fourths += change.array().pow(4).sum();
    }
    squares += sum;
    count += 3.0 * static_cast<double>(n);
    rms.push_back(std::sqrt(sum));
  }
  const Quantiles quantiles = Quantiles::of(std::move(rms));
  s->unsteadiness = ratio(quantiles.high, quantiles.low);
  s->kurtosis = ratio(fourths * count, squares * squares);
}

}  // namespace

Quantiles Quantiles::of(std::vector<double> values) {
  if (values.empty()) return {kNaN, kNaN, kNaN};
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    const double place = share * static_cast<double>(values.size() - 1);
    return values[static_cast<std::size_t>(std::lround(place))];
  };
  return {at(0.1), at(0.5), at(0.9)};
}

double rms_from(const Bands& bands, std::size_t first) {
  double sum = 0.0;
  for (std::size_t i = first; i < bands.size(); ++i) sum += bands[i] * bands[i];
  return std::sqrt(sum);
}

Bands spectrum(const std::vector<Vector3d>& samples, double rate_hz) {
  const std::size_t n = window(rate_hz);
  Bands bands{};
  double windows = 0.0;
  for (std::size_t first = 0; first + n <= samples.size(); first += n / 2) {
    windows += 1.0;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const std::vector<double> x = windowed(samples, first, n, axis);
      for (std::size_t k = 1; k <= n / 2; ++k) {
        const double frequency = static_cast<double>(k) * rate_hz / static_cast<double>(n);
        if (frequency < kBandEdges.front()) continue;
        const double sides = 2 * k == n ? 0.5 : 1.0;  // the Nyquist line has no mirror image
        bands[band_of(frequency)] += sides * line_power(x, k) / 3.0;
      }
    }
  }
  for (double& band : bands) band = windows > 0.0 ? std::sqrt(band / windows) : kNaN;
  return bands;
}

ImuSignature imu_signature(const io::Dataset& data, const Motion& motion) {
  const Time start = data.imu.front().time;
  ImuSignature s;
  s.rate_hz = 1.0 / median_interval(data.imu);
  count_losses(data.imu, &s);
  const auto bands = [&](Time begin, Time end, Vector3d ImuSample::*value) {
    return spectrum(samples_between(data.imu, begin, end, value), s.rate_hz);
  };
  const Time rest = motion.begin - kBeforeMotion;
  s.gyro_rest = bands(start, rest, &ImuSample::gyro_B);
  s.accel_rest = bands(start, rest, &ImuSample::accel_B);
  s.gyro_moving = bands(motion.begin, motion.end, &ImuSample::gyro_B);
  s.accel_moving = bands(motion.begin, motion.end, &ImuSample::accel_B);
  look_at_shocks(samples_between(data.imu, motion.begin, motion.end, &ImuSample::accel_B), &s);
  return s;
}

RadarSignature radar_signature(const io::Dataset& data, const Motion& motion) {
  constexpr double kLate = 1.5;
  RadarSignature s;
  const double interval = median_interval(data.scans);
  s.rate_hz = 1.0 / interval;
  for (std::size_t i = 1; i < data.scans.size(); ++i) {
    const double now = to_seconds(data.scans[i].time - data.scans[i - 1].time);
    s.late += now > kLate * interval ? 1.0 / static_cast<double>(data.scans.size() - 1) : 0.0;
  }
  s.doppler_grid = data.radar_info.doppler_resolution.value_or(0.0);
  look_at_points(data, motion.begin, motion.end, &s);
  look_at_companions(data, &s);
  look_at_rest(data, motion.begin - kBeforeMotion, &s);
  const Time start = data.scans.front().time;
  s.repeated_at_rest = found_again(data, start, motion.begin - kBeforeMotion, kSame);
  s.repeated_moving = found_again(data, motion.begin, motion.end, kSame + s.speed.high * interval);
  return s;
}

}  // namespace rio::experiment
