// SPDX-License-Identifier: BSD-3-Clause
#include "rio/propagate/strapdown.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace rio {

void integrate(const Vector3d& gyro_B, const Vector3d& accel_B, double dt, double gravity,
               NavState& state) {
  const Vector3d phi = (gyro_B - state.gyro_bias) * dt;
  const Vector3d a = accel_B - state.accel_bias;
  const Matrix3d R = state.q_WB.toRotationMatrix();
  const Vector3d g(0.0, 0.0, -gravity);
  state.p_WB += state.v_WB * dt + (R * (gamma(2, phi) * a) + 0.5 * g) * dt * dt;
  state.v_WB += (R * (gamma(1, phi) * a) + g) * dt;
  state.q_WB = (state.q_WB * quaternion_exp(phi)).normalized();
}

void integrate(const ImuStep& step, double gravity, NavState& state) {
  integrate(step.gyro_B, step.accel_B, to_seconds(step.end - step.begin), gravity, state);
  state.time = step.end;
}

Matrix15d transition(const Matrix3d& R, const Vector3d& w, const Vector3d& a, double dt) {
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

ProcessNoise process_noise(const ImuOptions& o, const ImuStep& step) {
  ProcessNoise n{
      o.gyro_noise_density * o.gyro_noise_density, o.accel_noise_density * o.accel_noise_density,
      o.gyro_random_walk * o.gyro_random_walk, o.accel_random_walk * o.accel_random_walk};
  if (o.measure_noise) {
    n.gyro = std::max(n.gyro, step.measured.gyro);
    n.accel = std::max(n.accel, step.measured.accel);
  }
  n.gyro += o.gap_rate_sigma * o.gap_rate_sigma * step.gap;
  n.accel += o.gap_accel_sigma * o.gap_accel_sigma * step.gap;
  const double jitter = o.stamp_sigma * o.stamp_sigma / (3.0 * step.sample_interval);
  n.gyro += jitter * step.gyro_change_B.squaredNorm();
  n.accel += jitter * step.accel_change_B.squaredNorm();
  return n;
}

Matrix15d process_noise_covariance(const Matrix3d& R, const Vector3d& w, const Vector3d& a,
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

Matrix15d congruence(const Matrix15d& F, const Matrix15d& P) {
  const Matrix15d FP = F * P;
  return FP * F.transpose();
}

bool Propagation::finite() const {
  return state.p_WB.allFinite() && state.v_WB.allFinite() && state.q_WB.coeffs().allFinite() &&
         transition.allFinite() && noise.allFinite();
}

void Propagation::step(const ImuStep& step, const ImuOptions& options) {
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

}  // namespace rio
