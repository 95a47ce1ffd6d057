// SPDX-License-Identifier: BSD-3-Clause
#include "rio/propagate/steady_motion.hpp"

namespace rio {

namespace {

constexpr double kRotors = 0.05;      // m of (E2): rotors are faster, bodies slower [s]
constexpr double kVehicles = 2.0;     // T of (E3): speeding up, braking, a turn [s]
constexpr double kKnown = 0.5;        // sigma of a velocity that scans have measured [m/s]
constexpr double kAccelBound = 25.0;  // square of five sigmas: with three, an aliased tone passes
constexpr double kRateBound = 16.0;   // square of four sigmas: a tone of the rotors passes less

/// The part of a vector that noise of the mean square `noise` cannot explain.
Vector3d beyond_noise(const Vector3d& vector, double noise) {
  const double square = vector.squaredNorm();
  if (!(square > noise)) return Vector3d::Zero();
  return (1.0 - noise / square) * vector;
}

}  // namespace

void SteadyMotionFilter::add(const Vector3d& change_W, double seconds) {
  const double sum = kRotors + seconds;
  once_W_ += (change_W - seconds * once_W_) / sum;
  twice_W_ += seconds / sum * (once_W_ - twice_W_);
}

void SteadyMotionFilter::advance(const NavState& before, const NavState& after,
                                 const Vector3d& rate_B, double seconds, double accel_density,
                                 double rate_variance, double velocity_variance) {
  motion_.accel_W = beyond_noise(twice_W_, kAccelBound * 3.0 * accel_density / (4.0 * kRotors));
  const double pull = seconds / (kVehicles + seconds);
  Vector3d v_W = before.q_WB * motion_.v_B;
  const bool unknown = velocity_variance > kKnown * kKnown;
  if (unknown || unknown_) v_W = before.v_WB;
  unknown_ = unknown;
  v_W += seconds * motion_.accel_W + pull * (before.v_WB - v_W);  // (E3)
  motion_.v_B = after.q_WB.conjugate() * v_W;
  motion_.rate_B +=
      beyond_noise(rate_B - motion_.rate_B, kRateBound * 3.0 * rate_variance);  // (E4)
  motion_.rate_B += pull * (rate_B - motion_.rate_B);
}

}  // namespace rio
