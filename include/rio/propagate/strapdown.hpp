// SPDX-License-Identifier: BSD-3-Clause
// Stage 1: strapdown integration over a step of constant rate and specific force: mean, error-state
// transition and process noise, all in closed form.
//
// With w = gyro - b_g, a = accel - b_a, phi = w dt, g = (0, 0, -gravity) and Gamma_m of
// core/so3.hpp: (E1) R+ = R Gamma_0(phi),  v+ = v + R Gamma_1(phi) a dt + g dt,
//      p+ = p + v dt + R Gamma_2(phi) a dt^2 + g dt^2 / 2
// (E2) Phi: the exact derivative of (E1) in the error of namespace body
// (E3) Q = int_0^dt Phi(dt, s) G Q_c G^T Phi(dt, s)^T ds, three-point Gauss-Legendre
// Reference: Michalczyk et al. 2023, eq. 2 and 6 (with the sign of gravity corrected: W is z up).
#pragma once

#include <array>

#include "rio/core/so3.hpp"
#include "rio/options.hpp"
#include "rio/propagate/imu_buffer.hpp"
#include "rio/types.hpp"

namespace rio {

using Matrix15d = Eigen::Matrix<double, body::kSize, body::kSize>;

/// (E1) over dt seconds [rad/s, m/s^2]; does not touch state.time.
inline void integrate(const Vector3d& gyro_B, const Vector3d& accel_B, double dt, double gravity,
                      NavState& state) {
  const Vector3d phi = (gyro_B - state.gyro_bias) * dt;
  const Vector3d a = accel_B - state.accel_bias;
  const Matrix3d R = state.q_WB.toRotationMatrix();
  const Vector3d g(0.0, 0.0, -gravity);
  state.p_WB += state.v_WB * dt + (R * (gamma(2, phi) * a) + 0.5 * g) * dt * dt;
  state.v_WB += (R * (gamma(1, phi) * a) + g) * dt;
  state.q_WB = (state.q_WB * quaternion_exp(phi)).normalized();
}

/// (E1) over one step, stamp included.
inline void integrate(const ImuStep& step, double gravity, NavState& state) {
  integrate(step.gyro_B, step.accel_B, to_seconds(step.end - step.begin), gravity, state);
  state.time = step.end;
}

/// (E2) from a state with attitude R over dt seconds at constant w [rad/s] and a [m/s^2].
inline Matrix15d transition(const Matrix3d& R, const Vector3d& w, const Vector3d& a, double dt) {
  using namespace body;
  const Vector3d phi = w * dt;
  const Matrix3d gamma_1 = gamma(1, phi);
  const Matrix3d gamma_2 = gamma(2, phi);
  Matrix15d m = Matrix15d::Identity();
  m.block<3, 3>(kAttitude, kAttitude) = gamma(0, phi).transpose();
  m.block<3, 3>(kAttitude, kGyroBias) = -gamma(1, -phi) * dt;
  m.block<3, 3>(kVelocity, kAttitude) = -R * skew(gamma_1 * a * dt);
  m.block<3, 3>(kVelocity, kGyroBias) = -R * d_gamma_a_d_phi(1, phi, a) * (dt * dt);
  m.block<3, 3>(kVelocity, kAccelBias) = -R * gamma_1 * dt;
  m.block<3, 3>(kPosition, kAttitude) = -R * skew(gamma_2 * a * (dt * dt));
  m.block<3, 3>(kPosition, kVelocity) = Matrix3d::Identity() * dt;
  m.block<3, 3>(kPosition, kGyroBias) = -R * d_gamma_a_d_phi(2, phi, a) * (dt * dt * dt);
  m.block<3, 3>(kPosition, kAccelBias) = -R * gamma_2 * (dt * dt);
  return m;
}

/// Spectral densities of the four noises that drive the body error.
struct ProcessNoise {
  double gyro = 0.0;        ///< [(rad/s)^2/Hz]
  double accel = 0.0;       ///< [(m/s^2)^2/Hz]
  double gyro_walk = 0.0;   ///< [(rad/s^2)^2/Hz]
  double accel_walk = 0.0;  ///< [(m/s^3)^2/Hz]
};

/// Densities of a step. Inside a gap the motion between the two samples is unknown: a constant
/// error of the mean rate (acceleration) of sigma adds up over the gap T as the density sigma^2 T
/// does, however the gap is cut into steps. A jitter delta_i of the stamps adds delta_i (a_{i-1} -
/// a_{i+1}) / 2 to the trapezoidal sum of samples a_i: once a step, small unless something
/// vibrates.
inline ProcessNoise process_noise(const ImuOptions& o, const ImuStep& step) {
  ProcessNoise n{
      o.gyro_noise_density * o.gyro_noise_density, o.accel_noise_density * o.accel_noise_density,
      o.gyro_random_walk * o.gyro_random_walk, o.accel_random_walk * o.accel_random_walk};
  n.gyro += o.gap_rate_sigma * o.gap_rate_sigma * step.gap;
  n.accel += o.gap_accel_sigma * o.gap_accel_sigma * step.gap;
  const double jitter = o.stamp_sigma * o.stamp_sigma / (3.0 * step.sample_interval);
  n.gyro += jitter * step.gyro_change_B.squaredNorm();
  n.accel += jitter * step.accel_change_B.squaredNorm();
  return n;
}

/// (E3). The sensor noises are isotropic, so each enters by three columns of Phi: attitude (gyro),
/// velocity (accelerometer), and the two biases.
inline Matrix15d process_noise_covariance(const Matrix3d& R, const Vector3d& w, const Vector3d& a,
                                          double dt, const ProcessNoise& density) {
  using namespace body;
  constexpr double kNode = 0.38729833462074170;  // sqrt(3/5) / 2
  constexpr std::array<double, 3> kNodes = {0.5 - kNode, 0.5, 0.5 + kNode};
  constexpr std::array<double, 3> kWeights = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
  const std::array<std::pair<int, double>, 4> sources = {{{kAttitude, density.gyro},
                                                          {kVelocity, density.accel},
                                                          {kGyroBias, density.gyro_walk},
                                                          {kAccelBias, density.accel_walk}}};
  Matrix15d Q = Matrix15d::Zero();
  for (std::size_t i = 0; i < kNodes.size(); ++i) {
    const double s = kNodes[i] * dt;
    const Matrix15d phi = transition(R * gamma(0, w * s), w, a, dt - s);
    for (const auto& [column, psd] : sources) {
      const Eigen::Matrix<double, body::kSize, 3> columns = phi.middleCols<3>(column);
      Q += (kWeights[i] * dt * psd * columns).lazyProduct(columns.transpose());
    }
  }
  return Q;
}

/// F P F^T.
inline Matrix15d congruence(const Matrix15d& F, const Matrix15d& P) {
  const Matrix15d FP = F * P;
  return FP * F.transpose();
}

/// Mean, transition and noise accumulated over several steps, to be applied to a covariance once.
struct Propagation {
  NavState state;
  Matrix15d transition = Matrix15d::Identity();
  Matrix15d noise = Matrix15d::Zero();
  bool gap = false;

  bool finite() const {
    return state.p_WB.allFinite() && state.v_WB.allFinite() && state.q_WB.coeffs().allFinite() &&
           transition.allFinite() && noise.allFinite();
  }

  void step(const ImuStep& step, const ImuOptions& options) {
    const double dt = to_seconds(step.end - step.begin);
    const Matrix3d R = state.q_WB.toRotationMatrix();
    const Vector3d w = step.gyro_B - state.gyro_bias;
    const Vector3d a = step.accel_B - state.accel_bias;
    const Matrix15d phi = rio::transition(R, w, a, dt);
    transition = phi * transition;
    noise = congruence(phi, noise);
    noise += process_noise_covariance(R, w, a, dt, process_noise(options, step));
    integrate(step, options.gravity, state);
    gap = gap || step.gap > 0.0;
  }
};

}  // namespace rio
