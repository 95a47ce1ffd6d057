// SPDX-License-Identifier: BSD-3-Clause
#include "rio/propagate/strapdown.hpp"

#include <algorithm>
#include <cmath>

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
  Matrix3d attitude_attitude, velocity_attitude, position_attitude;
  Matrix3d attitude_gyro, velocity_gyro, position_gyro;
  Matrix3d velocity_accel, position_accel;
  double dt;

  TransitionBlocks(const Matrix3d& R, const Vector3d& w, const Vector3d& a, double step)
      : dt(step) {
    const Vector3d phi = w * dt;
    const GammaSeries S(phi.squaredNorm());
    const Matrix3d gamma_1 = gamma(1, phi, S);
    attitude_attitude = gamma(0, phi, S).transpose();
    attitude_gyro = -dt * gamma_1.transpose();  // Gamma_1(-phi)
    velocity_accel = -dt * (R * gamma_1);
    velocity_attitude = skew(velocity_accel * a) * R;  // -R [Gamma_1 a] = -[R Gamma_1 a] R
    velocity_gyro = R * d_gamma_a_d_phi(1, phi, a, S) * -(dt * dt);
    position_accel = -(dt * dt) * (R * gamma(2, phi, S));
    position_attitude = skew(position_accel * a) * R;
    position_gyro = R * d_gamma_a_d_phi(2, phi, a, S) * -(dt * dt * dt);
  }
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

/// Q <- Phi Q Phi^T + q, both symmetric; the rows of the biases are those of the identity.
void add_noise_step(const TransitionBlocks& F, const Matrix15d& q, Matrix15d& Q) {
  constexpr int kNav = body::kGyroBias;
  constexpr int kBiases = body::kSize - kNav;
  postmultiply_transposed(F, Q);
  Q.transposeInPlace();
  auto moved = Q.topRows<kNav>();
  postmultiply_transposed(F, moved);
  Q.bottomLeftCorner<kBiases, kNav>() = Q.topRightCorner<kNav, kBiases>().transpose();
  Q += q;
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

namespace {

/// (E3) of a step that hardly turns: each integral over a force or an attitude that turns is that
/// of its value at the centroid of the weight. The walks take the centroids of the white noise.
Matrix15d noise_of_short_step(const Matrix3d& R, const Vector3d& w, const Vector3d& a, double t,
                              const ProcessNoise& density) {
  using namespace body;
  const Vector3d phi = t * w;
  const Matrix3d half_turn = gamma(0, Vector3d(0.5 * phi));
  const Matrix3d R_mid = R * half_turn;
  const Matrix3d R_end = R_mid * half_turn;
  const Vector3d f = R_mid * a;
  const Vector3d d = R_mid * phi.cross(a);  // change of the force over the step
  const Matrix3d turn = skew(phi);
  const auto square = [](const Vector3d& v) -> Matrix3d {  // [v] [v]^T
    return v.squaredNorm() * Matrix3d::Identity() - v * v.transpose();
  };
  const Matrix3d I = Matrix3d::Identity();
  const double t2 = t * t;
  const double t3 = t2 * t;
  const auto [gyro, accel, gyro_walk, accel_walk] = density;

  Matrix15d Q = Matrix15d::Zero();  // below the diagonal
  Q.block<3, 3>(kAttitude, kAttitude) = (gyro * t + gyro_walk * t3 / 3.0) * I;
  Q.block<3, 3>(kPosition, kAttitude) =
      -(gyro * t3 / 6.0 + gyro_walk * t3 * t2 / 30.0) * (skew(f) * R_end);
  Q.block<3, 3>(kVelocity, kAttitude) =
      -(gyro * t2 / 2.0 + gyro_walk * t2 * t2 / 8.0) * (skew(f + d / 6.0) * R_end);
  Q.block<3, 3>(kPosition, kPosition) =
      (accel * t3 / 3.0 + accel_walk * t3 * t2 / 20.0) * I +
      (gyro * t3 * t2 / 20.0 + gyro_walk * t3 * t3 * t / 252.0) * square(f - d / 18.0);
  Q.block<3, 3>(kVelocity, kPosition) = (accel * t2 / 2.0 + accel_walk * t2 * t2 / 8.0) * I +
                                        (gyro * t2 * t2 / 8.0 + gyro_walk * t3 * t3 / 72.0) *
                                            (skew(f + d / 10.0) * skew(f - d / 30.0).transpose());
  Q.block<3, 3>(kVelocity, kVelocity) =
      (accel * t + accel_walk * t3 / 3.0) * I +
      (gyro * t3 / 3.0 + gyro_walk * t3 * t2 / 20.0) * square(f + d / 8.0);
  Q.block<3, 3>(kGyroBias, kAttitude) = -(gyro_walk * t2 / 2.0) * (I + turn / 3.0);
  Q.block<3, 3>(kGyroBias, kPosition) =
      (gyro_walk * t2 * t2 / 24.0) * (skew(f + d / 10.0) * R_mid * (I - turn / 10.0)).transpose();
  Q.block<3, 3>(kGyroBias, kVelocity) =
      (gyro_walk * t3 / 6.0) * (skew(f + d / 4.0) * R_mid).transpose();
  Q.block<3, 3>(kGyroBias, kGyroBias) = (gyro_walk * t) * I;
  Q.block<3, 3>(kAccelBias, kPosition) = -(accel_walk * t3 / 6.0) * R_mid.transpose();
  Q.block<3, 3>(kAccelBias, kVelocity) =
      -(accel_walk * t2 / 2.0) * (R_mid * (I + turn / 6.0)).transpose();
  Q.block<3, 3>(kAccelBias, kAccelBias) = (accel_walk * t) * I;
  return Q.selfadjointView<Eigen::Lower>();
}

}  // namespace

Matrix15d process_noise_covariance(const Matrix3d& R, const Vector3d& w, const Vector3d& a,
                                   double dt, const ProcessNoise& density) {
  constexpr double kMostParts = 100.0;  // five radians in one step: much else is unknown
  constexpr double kShort = 0.05;       // [rad]: 2e-4 of a variance
  const double angle = w.norm() * dt;
  if (angle <= kShort) return noise_of_short_step(R, w, a, dt, density);
  const int parts = static_cast<int>(std::ceil(std::min(angle / kShort, kMostParts)));
  const double t = dt / parts;
  const Matrix3d turn = gamma(0, w * t);
  Matrix3d R_part = R;
  Matrix15d Q = Matrix15d::Zero();
  for (int i = 0; i < parts; ++i) {
    add_noise_step(TransitionBlocks(R_part, w, a, t), noise_of_short_step(R_part, w, a, t, density),
                   Q);
    R_part = R_part * turn;
  }
  return Q;
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
  add_noise_step(phi, process_noise_covariance(R, w, a, dt, process_noise(options, step)), noise);
  integrate(step, options.gravity, state);
  gap = gap || step.gap > 0.0;
}

}  // namespace rio
