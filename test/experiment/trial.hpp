// SPDX-License-Identifier: BSD-3-Clause
// One trial: a simulated flight through the odometry API, and its evaluation.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "rio/eval/pairing.hpp"
#include "rio/options.hpp"
#include "rio/report.hpp"
#include "rio/rio.hpp"
#include "rio/sim/flight.hpp"

namespace rio::experiment {

/// A preset with the sensors of a flight: noises, grids, turn-on biases where they are larger than
/// the preset expects, and the configured mounting.
/// @throws std::runtime_error if there is no such preset
Options options_for(const sim::Flight& flight, const std::string& preset);

/// As `mounting: unknown` without T_BS in sensor.yaml: of no radar anything is known of its pose.
void forget_mounting(Options& options);

/// Selects the other back-end.
inline void use_smoother(Options& options) {
  options.backend = BackEnd::kSmoother;
}

/// Every value is a number.
bool is_finite(const NavState& x);

/// Estimate, truth and covariance at one processed scan.
struct Step {
  NavState estimate;
  NavState truth;
  BodyCovariance covariance;
};

struct Trial {
  std::vector<Step> steps;                        ///< one per processed scan
  std::array<ModelReport, kModelCount> models{};  ///< sums of rows used and NIS over the flight
  Counters counters;
  int doubted = 0;           ///< steps whose health was worse than ok
  Time propagation_time{0};  ///< summed over the scans, if Options::timing.clock is given
  Time update_time{0};
  /// Every estimate and covariance is finite, no update failed, and no 2 s without a processed scan
  /// except for silence of the radar.
  bool complete = false;
};

/// @throws std::runtime_error if the options are invalid
std::unique_ptr<Odometry> create_odometry(const Options& options);

/// Called with the report of every processed scan.
using EachReport = std::function<void(const UpdateReport&)>;

/// Feeds all samples to an estimator in the order of arrival; a barometer: 0.1 m at 25 Hz.
Trial replay(const sim::Flight& flight, Odometry& odometry, const EachReport& each = {},
             bool with_barometer = false);

/// The same with a new estimator of these options, with static alignment, or with the wrong start
/// of the scenario; with a barometer if the options declare HeightOffset.
/// @throws std::runtime_error if the options are invalid
Trial fly(const sim::Flight& flight, const Options& options, const EachReport& each = {});

/// The trial with a true start drawn from the prior, position and heading, instead of the exact one
/// from the simulator: the estimator sees no difference, and its prior is consistent.
Trial with_drawn_start(const Trial& trial, const StartOptions& start, std::uint64_t seed);

/// For Options::timing.clock.
Time steady_now();

/// True and estimated poses of the steps.
std::vector<eval::PosePair> pose_pairs(const Trial& trial);

/// NEES of the blocks at one step, each divided by its dimension.
struct BlockNees {
  double position = 0.0;
  double attitude = 0.0;
  double heading = 0.0;  ///< the attitude error about the vertical, one dimension
  double velocity = 0.0;
};
BlockNees block_nees(const Step& step);

}  // namespace rio::experiment
