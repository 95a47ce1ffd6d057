// SPDX-License-Identifier: BSD-3-Clause
#include "rio/propagate/steady_motion.hpp"

namespace rio {

namespace {

constexpr double kRotors = 0.05;      // m of (E2): rotors are faster, bodies slower [s]
constexpr double kVehicles = 1.0;     // T of (E3): speeding up, braking [s]
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
  const double pull = seconds / (kVehicles + seconds);
  const Vector3d known_B = before.q_WB.conjugate() * before.v_WB;
  const bool unknown = velocity_variance > kKnown * kKnown;
  Vector3d v_B = unknown || unknown_ ? known_B : motion_.v_B;
  unknown_ = unknown;
  v_B += pull * (known_B - v_B);
  const Vector3d v_W = before.q_WB * v_B;
  Vector3d turning_W = Vector3d::Zero();
  if (seconds > 0.0) turning_W = (after.q_WB * v_B - v_W) / seconds;
  const double noise = kAccelBound * 3.0 * accel_density / (4.0 * kRotors);
  motion_.accel_W = turning_W + beyond_noise(twice_W_ - turning_W, noise);
  motion_.v_B = after.q_WB.conjugate() * (v_W + seconds * motion_.accel_W);  // (E3)
  motion_.rate_B +=
      beyond_noise(rate_B - motion_.rate_B, kRateBound * 3.0 * rate_variance);  // (E4)
  motion_.rate_B += pull * (rate_B - motion_.rate_B);
}

}  // namespace rio
