// SPDX-License-Identifier: BSD-3-Clause
#include "calibrate/noise_over_recordings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "calibrate/noise_calibration.hpp"

namespace rio::calibrate {

namespace {

constexpr double kKnown = 0.2;   // largest relative error of a known value
constexpr double kFactor = 1.5;  // ... by this factor, too: roughly right is better than wrong

/// Logarithm of a sigma from the whole of a recording and its halves, if determined.
struct Fitted {
  std::optional<Measured> whole;
  std::optional<Measured> first;
  std::optional<Measured> second;
};

/// (E3)
NoiseEstimate over(const std::vector<Fitted>& recordings) {
  NoiseEstimate out;
  out.relative_error = std::numeric_limits<double>::infinity();
  out.halves_apart = std::numeric_limits<double>::quiet_NaN();
  std::vector<Measured> whole;
  std::vector<Measured> halves;
  double factor = 1.0;
  for (const Fitted& fitted : recordings) {
    if (fitted.whole) whole.push_back(*fitted.whole);
    if (!fitted.first || !fitted.second) continue;
    halves.insert(halves.end(), {*fitted.first, *fitted.second});
    out.halves_apart = std::fmax(out.halves_apart, apart(*fitted.first, *fitted.second));
    factor = std::max(factor, std::exp(std::abs(fitted.first->value - fitted.second->value)));
  }
  if (whole.empty()) return out;
  const Combined mean = combine(whole);
  const Combined spread = combine(halves.empty() ? whole : halves);
  out.value = std::exp(mean.value);
  out.relative_error =
      mean.sigma * (spread.dof > 0 ? std::sqrt(std::max(1.0, spread.chi2 / spread.dof)) : 1.0);
  if (out.halves_apart > kFarApart && factor > kFactor) {
    out.verdict = Determination::kContradictory;
  } else if (out.relative_error < kKnown) {
    out.verdict = Determination::kDetermined;
  }
  return out;
}

/// The part of a recording from `start`.
Recording second_half(const Recording& recording, const Start& start) {
  Recording half;
  half.truth = recording.truth;
  half.start = start;
  for (std::size_t i = 0; i + 1 < recording.imu.size(); ++i) {  // from the last one before it
    if (recording.imu[i + 1].time > start.state.time) half.imu.push_back(recording.imu[i]);
  }
  for (const RadarScan& scan : recording.scans) {
    if (scan.time > start.state.time) half.scans.push_back(scan);
  }
  return half;
}
/// The part up to `end`.
Recording first_half(const Recording& recording, Time end) {
  Recording half = recording;
  std::erase_if(half.imu, [end](const ImuSample& s) { return s.time > end; });
  std::erase_if(half.scans, [end](const RadarScan& s) { return s.time > end; });
  return half;
}

using Fit = std::optional<NoiseCalibration>;

/// Empty, with a note, if the recording does not determine the noise.
Fit fit(const Recording& recording, const Options& options, const std::string& name,
        std::vector<std::string>* notes) {
  try {
    const NoiseCalibration c = calibrate_noise(recording, options);
    if (!c.converged) notes->push_back(name + ": not all of the radar's sigmas settle");
    return c;
  } catch (const std::runtime_error& error) {
    notes->push_back(name + ": noise of the radar: " + error.what());
    return std::nullopt;
  }
}

std::optional<Measured> fitted_by(const Fit& run, int k) {
  const auto i = static_cast<std::size_t>(k);
  if (!run || !(run->converged || run->settled[i]) || run->fit.at_bound[i]) return std::nullopt;
  return Measured{std::log(run->fit.noise.sigma[k]), run->fit.relative_error[k]};
}

/// (E1) (E2) of three axes between two times.
std::optional<Measured> rest_noise(const std::vector<ImuSample>& imu, Time begin, Time end,
                                   Vector3d ImuSample::*axes) {
  constexpr double kStretch = 0.05;  // [s]: a body at rest sways more slowly, engines turn faster
  constexpr int kFewestDifferences = 8;
  double squares = 0.0;
  int differences = 0;
  Vector3d sum = Vector3d::Zero();
  int count = 0;
  std::optional<Vector3d> last;
  Time stretch = begin;
  for (const ImuSample& sample : imu) {
    if (sample.time < begin || sample.time > end) continue;
    if (to_seconds(sample.time - stretch) >= kStretch && count > 0) {
      const Vector3d mean = sum / count;
      if (last) {
        squares += 0.5 * (mean - *last).squaredNorm() / 3.0;
        ++differences;
      }
      last = mean;
      sum.setZero();
      count = 0;
      stretch += from_seconds(kStretch);
    }
    sum += sample.*axes;
    ++count;
  }
  if (differences < kFewestDifferences || !(squares > 0.0)) return std::nullopt;
  return Measured{0.5 * std::log(kStretch * squares / differences),
                  1.0 / std::sqrt(4.0 * differences / 3.0)};
}

Fitted rest_noise_and_halves(const Recording& recording, Time end, double duration,
                             Vector3d ImuSample::*axes) {
  const Time begin = end - from_seconds(duration);
  const Time middle = begin + (end - begin) / 2;
  return {rest_noise(recording.imu, begin, end, axes),
          rest_noise(recording.imu, begin, middle, axes),
          rest_noise(recording.imu, middle, end, axes)};
}

}  // namespace

SensorNoise noise_over_recordings(const std::vector<Recording>& recordings,
                                  const std::vector<RecordingCalibration>& runs,
                                  const Options& options,
                                  const std::function<void(const std::string&)>& each) {
  SensorNoise out;
  std::array<std::vector<Fitted>, 4> radar;
  std::vector<Fitted> gyro;
  std::vector<Fitted> accel;
  std::vector<Measured> weak;
  bool growth_seen = true;
  std::vector<std::string> of_halves;
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    const std::string name = "recording " + std::to_string(i + 1);
    if (each) each(name + ": noise");
    Recording recording = recordings[i];
    if (runs[i].began_in_motion) recording.start = runs[i].begin;
    const Start& middle = runs[i].middle;
    const Fit whole = fit(recording, options, name, &out.notes);
    const Fit first = fit(first_half(recording, middle.state.time), options, name, &of_halves);
    const Fit second = fit(second_half(recording, middle), options, name, &of_halves);
    for (int k = 0; k < 4; ++k) {
      radar[static_cast<std::size_t>(k)].push_back(
          {fitted_by(whole, k), fitted_by(first, k), fitted_by(second, k)});
    }
    if (whole) {
      const eval::NoiseFit& noise = whole->fit;
      growth_seen = growth_seen && noise.growth_seen && noise.weak_error_db > 0.0;
      weak.push_back({noise.noise.weak_snr_db, std::max(noise.weak_error_db, 0.1)});
    }
    if (recording.start) continue;  // no certain standstill
    const double duration = options.start.duration;
    const Time begin = runs[i].begin.state.time;
    gyro.push_back(rest_noise_and_halves(recording, begin, duration, &ImuSample::gyro_B));
    accel.push_back(rest_noise_and_halves(recording, begin, duration, &ImuSample::accel_B));
  }
  for (std::size_t k = 0; k < 4; ++k) out.radar[k] = over(radar[k]);
  out.gyro = over(gyro);
  out.accel = over(accel);
  if (!weak.empty()) out.weak_snr_db = growth_seen ? combine(weak).value : kAllAlike;
  return out;
}

}  // namespace rio::calibrate
