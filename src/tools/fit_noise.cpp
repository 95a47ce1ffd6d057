// SPDX-License-Identifier: BSD-3-Clause
// `rio fit-noise`: the noise of the radar from a recording, as an option file.
#include <fmt/format.h>

#include <cstddef>
#include <string>
#include <utility>

#include "calibrate/noise_calibration.hpp"
#include "commands.hpp"
#include "estimator_options.hpp"
#include "findings.hpp"
#include "recording.hpp"
#include "replay_feed.hpp"
#include "rio/eval/metrics.hpp"
#include "rio/io/dataset.hpp"

namespace rio::tools {

namespace {

double degrees(double angle) {
  return eval::kDegreesPerRadian * angle;
}

void print_run(const calibrate::NoiseCalibration& c) {
  const Eigen::Vector4d& s = c.fit.noise.sigma;
  fmt::print(stderr,
             "run {}: {} matches, {} Dopplers: range {:.4f} m, azimuth {:.2f} deg, elevation "
             "{:.2f} deg, Doppler {:.4f} m/s\n",
             c.runs, c.landmarks, c.dopplers, s[0], degrees(s[1]), degrees(s[2]), s[3]);
}

std::string error_text(const eval::NoiseFit& fit, int k) {
  if (fit.at_bound[static_cast<std::size_t>(k)]) return "or less: its grid hides it";
  return fmt::format("+- {:.1f} %", 100.0 * fit.relative_error[k]);
}

std::string not_converged(const calibrate::NoiseCalibration& c) {
  return fmt::format("the sigmas still change after {} runs; start nearer by --config", c.runs);
}

void print_options(const FitNoiseArguments& arguments, const calibrate::NoiseCalibration& c) {
  const Eigen::Vector4d& s = c.fit.noise.sigma;
  fmt::print(
      "# Noise of the radar, fitted to {} by `rio fit-noise`: {} matches, {} Dopplers,\n"
      "# {} runs; one standard error of each. The grids of the radar are not in it.\n",
      arguments.dataset, c.landmarks, c.dopplers, c.runs);
  if (!c.converged) fmt::print("# Not converged: {}.\n", not_converged(c));
  if (!arguments.values.config.empty()) {
    fmt::print("# To be merged into {}, which was read.\n", arguments.values.config);
  }
  fmt::print(
      "radar:\n"
      "  sigma_range: {:.5f}  # [m] {}\n"
      "  sigma_azimuth: \"{:.3f} deg\"  # {}\n"
      "  sigma_elevation: \"{:.3f} deg\"  # {}\n"
      "  sigma_doppler: {:.5f}  # [m/s] {}\n",
      s[0], error_text(c.fit, 0), degrees(s[1]), error_text(c.fit, 1), degrees(s[2]),
      error_text(c.fit, 2), s[3], error_text(c.fit, 3));
  if (c.fit.growth_seen) {
    fmt::print("  weak_snr_db: {:.1f}  # [dB] +- {:.1f}\n", c.fit.noise.weak_snr_db,
               c.fit.weak_error_db);
  } else {
    fmt::print("  weak_snr_db: -200  # weak echoes are like strong ones\n");
  }
}

}  // namespace

void fit_noise(const FitNoiseArguments& arguments) {
  io::Dataset dataset = read_any(arguments.dataset, arguments.how);
  const Options options = options_of(dataset, arguments.values);
  take_out_clock_steps(options, &dataset);
  print_notes(dataset.notes);
  print_wrong(findings_of(arguments.dataset, dataset, options));
  calibrate::Recording recording;
  recording.start = make_start(
      arguments.init, dataset.ground_truth, dataset.imu.front().time, dataset.imu.back().time,
      [&dataset, i = std::size_t{0}](ImuSample* sample) mutable {
        if (i == dataset.imu.size()) return false;
        *sample = dataset.imu[i++];
        return true;
      },
      options);
  recording.imu = std::move(dataset.imu);
  recording.scans = std::move(dataset.scans);
  if (!arguments.no_truth) recording.truth = calibrate::interpolated_truth(dataset.ground_truth);
  const calibrate::NoiseCalibration c = calibrate::calibrate_noise(recording, options, print_run);
  print_options(arguments, c);
  throw_damage(dataset.damage);
  if (!c.converged) throw WrongResult(not_converged(c));
}

}  // namespace rio::tools
