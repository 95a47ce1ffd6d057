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

namespace {

/// The blocks of (E2) that are neither zero nor the identity; that of position by velocity is dt.
struct TransitionBlocks {
  Matrix3d attitude_attitude, attitude_gyro;
  Matrix3d velocity_attitude, velocity_gyro, velocity_accel;
  Matrix3d position_attitude, position_gyro, position_accel;
  double dt;

  TransitionBlocks(const Matrix3d& R, const Vector3d& w, const Vector3d& a, double step);
};

TransitionBlocks::TransitionBlocks(const Matrix3d& R, const Vector3d& w, const Vector3d& a,
                                   double step)
    : dt(step) {
  const Vector3d phi = w * dt;
  const Matrix3d gamma_1 = gamma(1, phi);
  const Matrix3d R_gamma_1 = R * gamma_1;
  const Matrix3d R_gamma_2 = R * gamma(2, phi);
  attitude_attitude = gamma(0, phi).transpose();
  attitude_gyro = -dt * gamma_1.transpose();  // Gamma_1(-phi)
  velocity_accel = -dt * R_gamma_1;
  position_accel = -(dt * dt) * R_gamma_2;
  velocity_gyro = R * d_gamma_a_d_phi(1, phi, a) * -(dt * dt);
  position_gyro = R * d_gamma_a_d_phi(2, phi, a) * -(dt * dt * dt);
  // R [Gamma a] = [R Gamma a] R
  velocity_attitude = skew(R_gamma_1 * a * -dt) * R;
  position_attitude = skew(R_gamma_2 * a * -(dt * dt)) * R;
}

/// M <- Phi M, M of any width.
template <class Matrix>
void premultiply(const TransitionBlocks& F, Matrix& M) {
  using namespace body;
  for (Eigen::Index c = 0; c < M.cols(); ++c) {
    auto m = M.col(c);
    const Vector3d attitude = m.template segment<3>(kAttitude);
    const Vector3d velocity = m.template segment<3>(kVelocity);
    const Vector3d gyro = m.template segment<3>(kGyroBias);
    const Vector3d accel = m.template segment<3>(kAccelBias);
    m.template segment<3>(kAttitude) = F.attitude_attitude * attitude + F.attitude_gyro * gyro;
    m.template segment<3>(kVelocity) +=
        F.velocity_attitude * attitude + F.velocity_gyro * gyro + F.velocity_accel * accel;
    m.template segment<3>(kPosition) += F.position_attitude * attitude + F.dt * velocity +
                                        F.position_gyro * gyro + F.position_accel * accel;
  }
}

}  // namespace

Matrix15d transition(const Matrix3d& R, const Vector3d& w, const Vector3d& a, double dt) {
  Matrix15d m = Matrix15d::Identity();
  premultiply(TransitionBlocks(R, w, a, dt), m);
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
  Matrix15d Q = Matrix15d::Zero();
  const auto add = [&Q](int row, int column, const Matrix3d& a_row, const Matrix3d& a_column,
                        double weight) {
    Q.block<3, 3>(row, column) += weight * (a_row * a_column.transpose());
  };
  const auto add_rate = [&add](const Matrix3d& attitude, const Matrix3d& position,
                               const Matrix3d& velocity, double weight) {
    add(kAttitude, kAttitude, attitude, attitude, weight);
    add(kPosition, kAttitude, position, attitude, weight);
    add(kPosition, kPosition, position, position, weight);
    add(kVelocity, kAttitude, velocity, attitude, weight);
    add(kVelocity, kPosition, velocity, position, weight);
    add(kVelocity, kVelocity, velocity, velocity, weight);
  };
  for (std::size_t i = 0; i < kNodes.size(); ++i) {
    const double s = kNodes[i] * dt;
    const TransitionBlocks F(R * gamma(0, w * s), w, a, dt - s);
    const double gyro_walk = kWeights[i] * dt * density.gyro_walk;
    add_rate(F.attitude_attitude, F.position_attitude, F.velocity_attitude,
             kWeights[i] * dt * density.gyro);
    add_rate(F.attitude_gyro, F.position_gyro, F.velocity_gyro, gyro_walk);
    Q.block<3, 3>(kGyroBias, kAttitude) += gyro_walk * F.attitude_gyro.transpose();
    Q.block<3, 3>(kGyroBias, kPosition) += gyro_walk * F.position_gyro.transpose();
    Q.block<3, 3>(kGyroBias, kVelocity) += gyro_walk * F.velocity_gyro.transpose();
    const double accel_walk = kWeights[i] * dt * density.accel_walk;
    add(kPosition, kPosition, F.position_accel, F.position_accel, accel_walk);
    add(kVelocity, kPosition, F.velocity_accel, F.position_accel, accel_walk);
    add(kVelocity, kVelocity, F.velocity_accel, F.velocity_accel, accel_walk);
    Q.block<3, 3>(kAccelBias, kPosition) += accel_walk * F.position_accel.transpose();
    Q.block<3, 3>(kAccelBias, kVelocity) += accel_walk * F.velocity_accel.transpose();
  }
  // of the accelerometer the integral is exact
  Q.diagonal().segment<3>(kPosition).array() += density.accel * dt * dt * dt / 3.0;
  Q.block<3, 3>(kVelocity, kPosition).diagonal().array() += density.accel * dt * dt / 2.0;
  Q.diagonal().segment<3>(kVelocity).array() += density.accel * dt;
  Q.diagonal().segment<3>(kGyroBias).array() += density.gyro_walk * dt;
  Q.diagonal().segment<3>(kAccelBias).array() += density.accel_walk * dt;
  return Q.selfadjointView<Eigen::Lower>();
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
  const TransitionBlocks phi(R, w, a, dt);
  premultiply(phi, transition);
  premultiply(phi, noise);
  noise.transposeInPlace();
  premultiply(phi, noise);
  noise += process_noise_covariance(R, w, a, dt, process_noise(options, step));
  integrate(step, options.gravity, state);
  gap = gap || step.gap > 0.0;
}

}  // namespace rio
