// SPDX-License-Identifier: BSD-3-Clause
#include "calibrate/noise_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>

#include "calibrate/noise_probe.hpp"
#include "rio/pipeline.hpp"
#include "rio/propagate/imu_buffer.hpp"

namespace rio::calibrate {

namespace {

constexpr int kMaxRuns = 6;
constexpr double kUnchanged = 0.02;   // relative change of a sigma
constexpr std::size_t kFewest = 100;  // matches: a sigma to about 15 %
constexpr double kTruthGap = 0.1;     // no interpolation of the velocity across a longer gap [s]

/// Feeds the samples in the order of their stamps; a scan is processed once the IMU has passed it.
class Run {
 public:
  Run(const Recording& recording, const Options& options, Innovations* out)
      : recording_(recording),
        options_(options),
        pipeline_(options),
        imu_(options.timing, options.imu),
        aligner_(options.start, options.imu) {
    pipeline_.backend().connect(out, recording.truth);
    if (recording.start) begin(*recording.start);
  }

  void run() {
    for (const ImuSample& sample : recording_.imu) {
      const bool finite = sample.gyro_B.allFinite() && sample.accel_B.allFinite();
      if (finite && (imu_.empty() || sample.time > imu_.newest().time)) add(sample);
    }
    if (!running_) {
      throw std::runtime_error(
          "no start: the estimator found no standstill; `rio check` looks for the "
          "cause; or give a start with --init");
    }
  }

 private:
  void begin(const Start& start) {
    pipeline_.reset(start.state, start.covariance);
    last_scan_ = start.state.time;
    running_ = true;
  }

  void add(const ImuSample& sample) {
    if (imu_.full()) make_room();
    imu_.push_back(sample);
    if (!running_) {
      std::optional<Alignment> alignment;
      (void)aligner_.add(sample, &alignment);  // on motion it waits for the next standstill
      if (alignment) begin(*alignment);
      return;
    }
    while (next_ < recording_.scans.size() &&
           pipeline_.measured_at(recording_.scans[next_].time) <= sample.time) {
      process(recording_.scans[next_++]);
    }
  }

  void process(const RadarScan& scan) {
    if (scan.time <= last_scan_) return;  // before the start, late or duplicate
    last_scan_ = scan.time;
    filter_detections(scan, options_.radar, options_.frontend.max_detections, filtered_);
    (void)pipeline_.process(filtered_, imu_);  // a failed scan is skipped
    imu_.forget_before(pipeline_.estimate().nav.time);
  }

  /// A long silence of the radar: the estimate follows the IMU.
  void make_room() {
    if (running_) (void)pipeline_.propagate(imu_[1].time, imu_);
    imu_.forget_before(imu_[1].time);
  }

  const Recording& recording_;
  Options options_;
  Pipeline<NoiseProbe> pipeline_;
  ImuBuffer imu_;
  StaticAligner aligner_;
  DetectionList filtered_;
  Time last_scan_{0};
  std::size_t next_ = 0;  ///< next scan
  bool running_ = false;
};

/// Gates wide enough that sigmas configured too small do not hide the large innovations; matches
/// strict enough that few wrong ones, which are the nearest and look too good, are among them.
Options measuring_options(Options options) {
  options.backend = BackEnd::kEkf;
  options.update.use_landmarks = true;
  options.update.use_doppler = true;
  options.update.landmark_measurement = LandmarkMeasurement::kPoint;
  options.frontend.matching = Matching::kMahalanobis;
  options.frontend.match_probability = options.frontend.match_core = 0.997;
  options.frontend.match_margin = std::max(4.0, options.frontend.match_margin);
  // by that margin exp(4 / 2) times as likely as the next: right with a probability of 0.88
  options.update.match_trust = std::max(0.88, options.update.match_trust);
  options.update.gate_probability = 0.999;
  // these would explain a part of the noise that is sought
  options.ablation.direction_noise = false;
  options.ablation.elevation_walk = false;
  options.calibration.elevation_sigma = 0.0;
  options.frontend.ransac_sigmas = 1.5 * options.frontend.ransac_sigmas;
  return options;
}

/// A fifth of the standard deviation of a grid is four percent of its variance.
Eigen::Vector4d smallest_sigmas(const RadarOptions& radar) {
  constexpr double kShare = 0.2;
  constexpr double kWithoutGrid = 1e-4;  // far below any such radar [m, rad, m/s]
  const double root_12 = std::sqrt(12.0);
  const Eigen::Vector4d grids(radar.range_resolution, 0.0, 0.0, radar.doppler_resolution);
  return (kShare / root_12 * grids).cwiseMax(kWithoutGrid);
}

eval::RadarNoise noise_of(const RadarOptions& radar) {
  eval::RadarNoise noise;
  noise.sigma << radar.sigma_range, radar.sigma_azimuth, radar.sigma_elevation, radar.sigma_doppler;
  noise.weak_snr_db = radar.weak_snr_db;
  return noise;
}

}  // namespace

TruthAt interpolated_truth(std::vector<NavState> rows) {
  const bool has_velocity = std::any_of(rows.begin(), rows.end(),
                                        [](const NavState& row) { return !row.v_WB.isZero(0.0); });
  if (!has_velocity) return {};
  return [rows = std::move(rows)](Time time) -> std::optional<NavState> {
    const auto after = std::upper_bound(rows.begin(), rows.end(), time,
                                        [](Time t, const NavState& row) { return t < row.time; });
    if (after == rows.begin() || after == rows.end()) return std::nullopt;
    const NavState& before = *std::prev(after);
    const double span = to_seconds(after->time - before.time);
    if (span > kTruthGap) return std::nullopt;
    const double s = to_seconds(time - before.time) / span;
    NavState state = before;
    state.time = time;
    state.q_WB = before.q_WB.slerp(s, after->q_WB);
    state.p_WB += s * (after->p_WB - before.p_WB);
    state.v_WB += s * (after->v_WB - before.v_WB);
    return state;
  };
}

NoiseCalibration calibrate_noise(const Recording& recording, const Options& options,
                                 const std::function<void(const NoiseCalibration&)>& each) {
  Options now = measuring_options(options);
  NoiseCalibration result;
  while (result.runs < kMaxRuns && !result.converged) {
    if (std::string why; !now.validate(&why)) throw std::runtime_error(why);
    Innovations seen;
    Run(recording, now, &seen).run();
    ++result.runs;
    result.landmarks = seen.landmarks;
    result.dopplers = seen.dopplers;
    const std::size_t fewest = std::min(seen.landmarks, seen.dopplers);
    if (fewest < kFewest) {
      throw std::runtime_error("only " + std::to_string(fewest) + " matches, at least " +
                               std::to_string(kFewest) +
                               " are needed: fly longer, or see `rio check` for what hinders them");
    }
    const eval::RadarNoise configured = noise_of(now.radar);
    const std::optional<eval::NoiseFit> fit =
        eval::NoiseFitter(seen.samples).fit(configured, smallest_sigmas(now.radar));
    if (!fit) throw std::runtime_error("the innovations do not fix the sigmas: fly longer");
    const Eigen::Array4d change = (fit->noise.sigma.array() / configured.sigma.array()).log().abs();
    result.converged = (change < fit->relative_error.array().max(kUnchanged)).all();
    for (int k = 0; k < 4; ++k) {
      result.settled[static_cast<std::size_t>(k)] =
          result.runs > 1 && change[k] < fit->relative_error[k];
    }
    result.fit = *fit;
    now = with_noise(now, *fit);
    if (each) each(result);
  }
  return result;
}

Options with_noise(Options options, const eval::NoiseFit& fit) {
  options.radar.sigma_range = fit.noise.sigma[0];
  options.radar.sigma_azimuth = fit.noise.sigma[1];
  options.radar.sigma_elevation = fit.noise.sigma[2];
  options.radar.sigma_doppler = fit.noise.sigma[3];
  options.radar.weak_snr_db = fit.growth_seen ? fit.noise.weak_snr_db : kAllAlike;
  return options;
}

}  // namespace rio::calibrate
