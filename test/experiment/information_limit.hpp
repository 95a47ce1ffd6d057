// SPDX-License-Identifier: BSD-3-Clause
// The information limit of a simulated flight: the covariance that an optimal estimator reaches on
// the same data, after the Cramer-Rao lower bound for a moving state.
//
// The recursion of the bound for linear dynamics with Gaussian noise is that of a Kalman filter's
// covariance with every Jacobian at the true state (Tichavsky, Muravchik and Nehorai 1998, sec. IV;
// Bar-Shalom, Li and Kirubarajan 2001, sec. 2.7). The reflector of each echo is known, echoes of
// anything but a static reflector are skipped, and every echo is used once, with range, two angles
// and Doppler. Where the simulated noise is not white Gaussian noise the limit is a model of it,
// not a bound in the strict sense:
//   - interference repeats while the radar moves less than some centimetres, here it is white;
//   - grids are uniform errors of variance grid^2 / 12;
//   - the wander of a scattering centre is white, too, with its variance on every axis.
#pragma once

#include <vector>

#include "rio/eval/pairing.hpp"
#include "rio/options.hpp"
#include "rio/sim/flight.hpp"
#include "rio/types.hpp"

namespace rio::experiment {

/// Prior knowledge before the first scan.
struct LimitPrior {
  Time time{0};  ///< earlier scans are skipped
  BodyCovariance covariance = BodyCovariance::Zero();
  CalibrationOptions calibration;  ///< priors of the radar
};

/// The limit at one scan: standard deviations.
struct LimitStep {
  Time time{0};                                    ///< of the measurement
  double distance = 0.0;                           ///< travelled since the first scan [m]
  Vector3d position = Vector3d::Zero();            ///< per axis of W [m]
  double heading = 0.0;                            ///< about the vertical [rad]
  double velocity = 0.0;                           ///< root of the trace of its covariance [m/s]
  double rmse() const { return position.norm(); }  ///< least RMS distance from the truth [m]
};

/// The state known after the static alignment with these options, and the calibration priors.
/// @throws std::runtime_error if the flight does not begin with a standstill
LimitPrior limit_prior(const sim::Flight& flight, const Options& options);

/// The limit at every scan. Options used: the densities of the IMU, the sigmas and grids of the
/// radar, and the time-out of landmarks: a reflector that was not seen for that long, or was
/// replaced when more than kMaxLandmarks were known, is a new one when it is seen again. So it is
/// the limit of an estimator with such a memory, not of one that keeps everything.
std::vector<LimitStep> information_limit(const sim::Flight& flight, const Options& options,
                                         const LimitPrior& prior);

/// RMSE of the last scan in percent of the distance travelled; NaN without any.
double limit_of_drift(const std::vector<LimitStep>& steps);

/// Poses in place of an estimate that are off by the mean of |error| on every axis, which is sqrt(2
/// / pi) sigma for a Gaussian error: their norm of MAE is comparable to that of an estimate.
std::vector<eval::PosePair> mean_errors_at_limit(const sim::Flight& flight,
                                                 const std::vector<LimitStep>& steps);

}  // namespace rio::experiment
