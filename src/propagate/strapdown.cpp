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

/// What a step of constant w and a does to an error in the attitude or a bias at its begin.
struct ErrorGrowth {
  Matrix3d attitude_gyro;
  Matrix3d velocity_gyro, velocity_accel;
  Matrix3d position_gyro, position_accel;
  Vector3d velocity;  ///< -R Gamma_1 a dt: what turns with the attitude error
  Vector3d position;  ///< -R Gamma_2 a dt^2: same

  ErrorGrowth(const Matrix3d& R, const Vector3d& w, const Vector3d& a, double dt)
      : ErrorGrowth(R, w * dt, a, dt, GammaSeries((w * dt).squaredNorm())) {}
  ErrorGrowth(const Matrix3d& R, const Vector3d& phi, const Vector3d& a, double dt,
              const GammaSeries& S) {
    const Matrix3d gamma_1 = gamma(1, phi, S);
    attitude_gyro = -dt * gamma_1.transpose();  // Gamma_1(-phi)
    velocity_accel = -dt * (R * gamma_1);
    position_accel = -(dt * dt) * (R * gamma(2, phi, S));
    velocity_gyro = R * d_gamma_a_d_phi(1, phi, a, S) * -(dt * dt);
    position_gyro = R * d_gamma_a_d_phi(2, phi, a, S) * -(dt * dt * dt);
    velocity = velocity_accel * a;
    position = position_accel * a;
  }
};

/// The blocks of (E2) that are neither zero nor the identity; that of position by velocity is dt.
struct TransitionBlocks : ErrorGrowth {
  Matrix3d attitude_attitude, velocity_attitude, position_attitude;
  double dt;

  TransitionBlocks(const Matrix3d& R, const Vector3d& w, const Vector3d& a, double step)
      : ErrorGrowth(R, w, a, step),
        attitude_attitude(gamma(0, w * step).transpose()),
        velocity_attitude(skew(velocity) * R),  // R [Gamma a] = [R Gamma a] R
        position_attitude(skew(position) * R),
        dt(step) {}
};

/// M <- M Phi^T, M of any height: column by column, each from those that are still old.
template <class Matrix>
void postmultiply_transposed(const TransitionBlocks& F, Matrix& M) {
  using namespace body;
  for (int i = 0; i < 3; ++i) {
    auto position = M.col(kPosition + i);
    position += F.dt * M.col(kVelocity + i);
    for (int k = 0; k < 3; ++k) {
      position += F.position_attitude(i, k) * M.col(kAttitude + k) +
                  F.position_gyro(i, k) * M.col(kGyroBias + k) +
                  F.position_accel(i, k) * M.col(kAccelBias + k);
    }
  }
  for (int i = 0; i < 3; ++i) {
    auto velocity = M.col(kVelocity + i);
    for (int k = 0; k < 3; ++k) {
      velocity += F.velocity_attitude(i, k) * M.col(kAttitude + k) +
                  F.velocity_gyro(i, k) * M.col(kGyroBias + k) +
                  F.velocity_accel(i, k) * M.col(kAccelBias + k);
    }
  }
  auto attitude = M.template middleCols<3>(kAttitude);
  attitude = (attitude * F.attitude_attitude.transpose() +
              M.template middleCols<3>(kGyroBias) * F.attitude_gyro.transpose())
                 .eval();
}

}  // namespace

Matrix15d transition(const Matrix3d& R, const Vector3d& w, const Vector3d& a, double dt) {
  Matrix15d m = Matrix15d::Identity();
  postmultiply_transposed(TransitionBlocks(R, w, a, dt), m);
  return m.transpose();
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
    Q.block<3, 3>(row, column) += weight * a_row.lazyProduct(a_column.transpose());
  };
  // [u][v]^T of errors that turn with the attitude
  const auto add_turn = [&Q](int row, int column, const Vector3d& u, const Vector3d& v,
                             double weight) {
    Q.block<3, 3>(row, column) += weight * (u.dot(v) * Matrix3d::Identity() - v * u.transpose());
  };
  Vector3d velocity = Vector3d::Zero();  // sums over the nodes
  Vector3d position = Vector3d::Zero();
  for (std::size_t i = 0; i < kNodes.size(); ++i) {
    const double s = kNodes[i] * dt;
    const ErrorGrowth F(R * gamma(0, w * s), w, a, dt - s);
    const double gyro = kWeights[i] * dt * density.gyro;
    velocity += gyro * F.velocity;
    position += gyro * F.position;
    add_turn(kPosition, kPosition, F.position, F.position, gyro);
    add_turn(kVelocity, kPosition, F.velocity, F.position, gyro);
    add_turn(kVelocity, kVelocity, F.velocity, F.velocity, gyro);
    const double gyro_walk = kWeights[i] * dt * density.gyro_walk;
    add(kAttitude, kAttitude, F.attitude_gyro, F.attitude_gyro, gyro_walk);
    add(kPosition, kAttitude, F.position_gyro, F.attitude_gyro, gyro_walk);
    add(kPosition, kPosition, F.position_gyro, F.position_gyro, gyro_walk);
    add(kVelocity, kAttitude, F.velocity_gyro, F.attitude_gyro, gyro_walk);
    add(kVelocity, kPosition, F.velocity_gyro, F.position_gyro, gyro_walk);
    add(kVelocity, kVelocity, F.velocity_gyro, F.velocity_gyro, gyro_walk);
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
  // an attitude error of any time turns the body at the end: [u] R_s (R_s^T R_end) = [u] R_end
  const Matrix3d R_end = R * gamma(0, w * dt);
  Q.block<3, 3>(kPosition, kAttitude) += skew(position) * R_end;
  Q.block<3, 3>(kVelocity, kAttitude) += skew(velocity) * R_end;
  Q.diagonal().segment<3>(kAttitude).array() += density.gyro * dt;
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
         transposed_transition.allFinite() && noise.allFinite();
}

void Propagation::step(const ImuStep& step, const ImuOptions& options) {
  const double dt = to_seconds(step.end - step.begin);
  const Matrix3d R = state.q_WB.toRotationMatrix();
  const Vector3d w = step.gyro_B - state.gyro_bias;
  const Vector3d a = step.accel_B - state.accel_bias;
  const TransitionBlocks phi(R, w, a, dt);
  postmultiply_transposed(phi, transposed_transition);
  postmultiply_transposed(phi, noise);
  noise.transposeInPlace();
  postmultiply_transposed(phi, noise);
  noise += process_noise_covariance(R, w, a, dt, process_noise(options, step));
  integrate(step, options.gravity, state);
  gap = gap || step.gap > 0.0;
}

}  // namespace rio
