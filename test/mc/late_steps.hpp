// SPDX-License-Identifier: BSD-3-Clause
// Either back-end, and what its estimates are worth from some time of a flight on.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "experiment/campaign.hpp"
#include "rio/eval/metrics.hpp"

namespace rio::experiment {

inline const Variants kBackEnds = {{"filter", "default"}, {"window", "default", use_smoother}};

/// Over the steps of any number of trials.
struct LateSteps {
  double tilt = 0.0;             ///< worst error [deg]
  double velocity = 0.0;         ///< same, axes W [m/s]
  double velocity_B = 0.0;       ///< same, axes B: whatever the heading [m/s]
  double position = 0.0;         ///< same [m]
  double position_sigmas = 0.0;  ///< same, over the root of the trace
  double heading_bias = 0.0;     ///< same, of the gyro bias about z, axes B [rad/s]
  BlockNees sum;
  int count = 0;

  void add(const Trial& trial, Time from) {
    for (const Step& step : trial.steps) {
      if (step.truth.time < from) continue;
      const Matrix3d P = step.covariance.block<3, 3>(body::kPosition, body::kPosition);
      const double off = (step.estimate.p_WB - step.truth.p_WB).norm();
      tilt = std::max(tilt, eval::tilt_error(step.estimate.q_WB, step.truth.q_WB));
      velocity = std::max(velocity, (step.estimate.v_WB - step.truth.v_WB).norm());
      const Vector3d v_B = step.estimate.q_WB.conjugate() * step.estimate.v_WB;
      velocity_B =
          std::max(velocity_B, (v_B - step.truth.q_WB.conjugate() * step.truth.v_WB).norm());
      position = std::max(position, off);
      position_sigmas = std::max(position_sigmas, off / std::sqrt(P.trace()));
      const Vector3d bias = step.estimate.gyro_bias - step.truth.gyro_bias;
      heading_bias = std::max(heading_bias, std::abs(bias.z()));
      const BlockNees nees = block_nees(step);
      sum.position += nees.position;
      sum.attitude += nees.attitude;
      ++count;
    }
  }
  void add_after(const Trial& trial, double seconds) {
    add(trial, trial.steps.front().truth.time + from_seconds(seconds));
  }
  double nees_attitude() const { return sum.attitude / count; }
  double nees_position() const { return sum.position / count; }
};

}  // namespace rio::experiment
