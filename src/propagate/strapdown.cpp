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

ImuIncrements imu_increments(Time from, Time to, const NavState& biases, const ImuBuffer& imu) {
  NavState moved;
  moved.gyro_bias = biases.gyro_bias;
  moved.accel_bias = biases.accel_bias;
  imu.for_each_step(from, to, [&](const ImuStep& step) { integrate(step, 0.0, moved); });
  return {to_seconds(to - from), moved.q_WB.toRotationMatrix(), moved.v_WB, moved.p_WB};
}

namespace {

/// [v]x M.
Matrix3d crossed(const Vector3d& v, const Matrix3d& M) {
  Matrix3d out;
  for (int i = 0; i < 3; ++i) out.col(i) = v.cross(M.col(i));
  return out;
}

}  // namespace

BodyTransition::BodyTransition(const Matrix3d& R, const Vector3d& w, const Vector3d& a, double step)
    : dt(step) {
  const Vector3d phi = w * dt;
  const GammaSeries S(phi.squaredNorm());
  const Matrix3d gamma_1 = gamma(1, phi, S);
  attitude_attitude = gamma(0, phi, S).transpose();
  attitude_gyro = -dt * gamma_1.transpose();  // Gamma_1(-phi)
  velocity_accel = -dt * (R * gamma_1);
  velocity_attitude = crossed(velocity_accel * a, R);  // -R [Gamma_1 a] = -[R Gamma_1 a] R
  velocity_gyro = R * d_gamma_a_d_phi(1, phi, a, S) * -(dt * dt);
  position_accel = -(dt * dt) * (R * gamma(2, phi, S));
  position_attitude = crossed(position_accel * a, R);
  position_gyro = R * d_gamma_a_d_phi(2, phi, a, S) * -(dt * dt * dt);
}

void BodyTransition::advance(const BodyTransition& F) {
  position_attitude += F.dt * velocity_attitude + F.position_attitude * attitude_attitude;
  position_gyro += F.dt * velocity_gyro + F.position_attitude * attitude_gyro + F.position_gyro;
  position_accel += F.dt * velocity_accel + F.position_accel;
  velocity_attitude += F.velocity_attitude * attitude_attitude;
  velocity_gyro += F.velocity_attitude * attitude_gyro + F.velocity_gyro;
  velocity_accel += F.velocity_accel;
  attitude_gyro = (F.attitude_attitude * attitude_gyro + F.attitude_gyro).eval();
  attitude_attitude = (F.attitude_attitude * attitude_attitude).eval();
  dt += F.dt;
}

Matrix15d BodyTransition::matrix() const {
  using namespace body;
  Matrix15d m = Matrix15d::Identity();
  m.block<3, 3>(kAttitude, kAttitude) = attitude_attitude;
  m.block<3, 3>(kAttitude, kGyroBias) = attitude_gyro;
  m.block<3, 3>(kPosition, kAttitude) = position_attitude;
  m.block<3, 3>(kPosition, kVelocity) = dt * Matrix3d::Identity();
  m.block<3, 3>(kPosition, kGyroBias) = position_gyro;
  m.block<3, 3>(kPosition, kAccelBias) = position_accel;
  m.block<3, 3>(kVelocity, kAttitude) = velocity_attitude;
  m.block<3, 3>(kVelocity, kGyroBias) = velocity_gyro;
  m.block<3, 3>(kVelocity, kAccelBias) = velocity_accel;
  return m;
}

void BodyNoise::advance(const BodyTransition& F, const BodyNoise& q) {
  const double dt = F.dt;
  // columns of the biases of F Q
  const Matrix3d ag = F.attitude_attitude * attitude_gyro + gyro * F.attitude_gyro;
  const Matrix3d pg = position_gyro + dt * velocity_gyro + F.position_attitude * attitude_gyro +
                      gyro * F.position_gyro;
  const Matrix3d vg = velocity_gyro + F.velocity_attitude * attitude_gyro + gyro * F.velocity_gyro;
  const Matrix3d pa = position_accel + dt * velocity_accel + accel * F.position_accel;
  const Matrix3d va = velocity_accel + accel * F.velocity_accel;
  // other columns of F Q, as far as the blocks below the diagonal need them
  const Matrix3d aa = F.attitude_attitude * attitude + F.attitude_gyro * attitude_gyro.transpose();
  const Matrix3d p_a = position_attitude + dt * velocity_attitude + F.position_attitude * attitude +
                       F.position_gyro * attitude_gyro.transpose();
  const Matrix3d v_a = velocity_attitude + F.velocity_attitude * attitude +
                       F.velocity_gyro * attitude_gyro.transpose();
  const Matrix3d pp =
      position + dt * velocity_position + F.position_attitude * position_attitude.transpose() +
      F.position_gyro * position_gyro.transpose() + F.position_accel * position_accel.transpose();
  const Matrix3d pv = velocity_position.transpose() + dt * velocity +
                      F.position_attitude * velocity_attitude.transpose() +
                      F.position_gyro * velocity_gyro.transpose() +
                      F.position_accel * velocity_accel.transpose();
  const Matrix3d vp = velocity_position + F.velocity_attitude * position_attitude.transpose() +
                      F.velocity_gyro * position_gyro.transpose() +
                      F.velocity_accel * position_accel.transpose();
  const Matrix3d vv = velocity + F.velocity_attitude * velocity_attitude.transpose() +
                      F.velocity_gyro * velocity_gyro.transpose() +
                      F.velocity_accel * velocity_accel.transpose();
  // F Q F^T + q
  attitude = q.attitude + aa * F.attitude_attitude.transpose() + ag * F.attitude_gyro.transpose();
  position_attitude = q.position_attitude + p_a * F.attitude_attitude.transpose() +
                      pg * F.attitude_gyro.transpose();
  velocity_attitude = q.velocity_attitude + v_a * F.attitude_attitude.transpose() +
                      vg * F.attitude_gyro.transpose();
  position = q.position + pp + dt * pv + p_a * F.position_attitude.transpose() +
             pg * F.position_gyro.transpose() + pa * F.position_accel.transpose();
  velocity_position = q.velocity_position + vp + dt * vv + v_a * F.position_attitude.transpose() +
                      vg * F.position_gyro.transpose() + va * F.position_accel.transpose();
  velocity = q.velocity + vv + v_a * F.velocity_attitude.transpose() +
             vg * F.velocity_gyro.transpose() + va * F.velocity_accel.transpose();
  attitude_gyro = q.attitude_gyro + ag;
  position_gyro = q.position_gyro + pg;
  velocity_gyro = q.velocity_gyro + vg;
  position_accel = q.position_accel + pa;
  velocity_accel = q.velocity_accel + va;
  gyro += q.gyro;
  accel += q.accel;
}

Matrix15d BodyNoise::matrix() const {
  using namespace body;
  Matrix15d m = Matrix15d::Zero();  // filled below the diagonal only
  m.block<3, 3>(kAttitude, kAttitude) = attitude;
  m.block<3, 3>(kPosition, kAttitude) = position_attitude;
  m.block<3, 3>(kVelocity, kAttitude) = velocity_attitude;
  m.block<3, 3>(kPosition, kPosition) = position;
  m.block<3, 3>(kVelocity, kPosition) = velocity_position;
  m.block<3, 3>(kVelocity, kVelocity) = velocity;
  m.block<3, 3>(kGyroBias, kAttitude) = attitude_gyro.transpose();
  m.block<3, 3>(kGyroBias, kPosition) = position_gyro.transpose();
  m.block<3, 3>(kGyroBias, kVelocity) = velocity_gyro.transpose();
  m.block<3, 3>(kAccelBias, kPosition) = position_accel.transpose();
  m.block<3, 3>(kAccelBias, kVelocity) = velocity_accel.transpose();
  m.diagonal().segment<3>(kGyroBias).setConstant(gyro);
  m.diagonal().segment<3>(kAccelBias).setConstant(accel);
  return m.selfadjointView<Eigen::Lower>();
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

/// (E3) for a small rotation: in each integral the rotating force or attitude is replaced by its
/// value at the centroid of the weight. The random walks use the centroids of the white noise.
BodyNoise noise_of_short_step(const Matrix3d& R, const Vector3d& w, const Vector3d& a, double t,
                              const ProcessNoise& density) {
  const Vector3d phi = t * w;
  const Matrix3d half_turn = gamma(0, Vector3d(0.5 * phi));
  const Matrix3d R_mid = R * half_turn;
  const Matrix3d R_end = R_mid * half_turn;
  const Vector3d f = R_mid * a;
  const Vector3d d = R_mid * phi.cross(a);                  // change of the force over the step
  const Matrix3d R_mid_turn = crossed(R_mid * phi, R_mid);  // R_mid [phi]
  const auto square = [](const Vector3d& v) -> Matrix3d {   // [v] [v]^T
    return v.squaredNorm() * Matrix3d::Identity() - v * v.transpose();
  };
  const Matrix3d I = Matrix3d::Identity();
  const double t2 = t * t;
  const double t3 = t2 * t;
  const auto [gyro, accel, gyro_walk, accel_walk] = density;

  BodyNoise Q;
  Q.attitude = (gyro * t + gyro_walk * t3 / 3.0) * I;
  Q.position_attitude = -(gyro * t3 / 6.0 + gyro_walk * t3 * t2 / 30.0) * crossed(f, R_end);
  Q.velocity_attitude =
      -(gyro * t2 / 2.0 + gyro_walk * t2 * t2 / 8.0) * crossed(f + d / 6.0, R_end);
  Q.position = (accel * t3 / 3.0 + accel_walk * t3 * t2 / 20.0) * I +
               (gyro * t3 * t2 / 20.0 + gyro_walk * t3 * t3 * t / 252.0) * square(f - d / 18.0);
  const Vector3d early = f + d / 10.0;
  const Vector3d late = f - d / 30.0;  // [early] [late]^T
  Q.velocity_position = (accel * t2 / 2.0 + accel_walk * t2 * t2 / 8.0) * I +
                        (gyro * t2 * t2 / 8.0 + gyro_walk * t3 * t3 / 72.0) *
                            (early.dot(late) * I - late * early.transpose());
  Q.velocity = (accel * t + accel_walk * t3 / 3.0) * I +
               (gyro * t3 / 3.0 + gyro_walk * t3 * t2 / 20.0) * square(f + d / 8.0);
  Q.attitude_gyro = -(gyro_walk * t2 / 2.0) * (I - skew(phi) / 3.0);
  Q.position_gyro = (gyro_walk * t2 * t2 / 24.0) * crossed(early, R_mid - R_mid_turn / 10.0);
  Q.velocity_gyro = (gyro_walk * t3 / 6.0) * crossed(f + d / 4.0, R_mid);
  Q.position_accel = -(accel_walk * t3 / 6.0) * R_mid;
  Q.velocity_accel = -(accel_walk * t2 / 2.0) * (R_mid + R_mid_turn / 6.0);
  Q.gyro = gyro_walk * t;
  Q.accel = accel_walk * t;
  return Q;
}

}  // namespace

BodyNoise process_noise_covariance(const Matrix3d& R, const Vector3d& w, const Vector3d& a,
                                   double dt, const ProcessNoise& density) {
  constexpr double kMostParts = 100.0;  // five radians in one step: other errors dominate
  constexpr double kShort = 0.05;       // [rad]; relative error of a variance: 2e-4
  const double angle = w.norm() * dt;
  if (angle <= kShort) return noise_of_short_step(R, w, a, dt, density);
  const int parts = static_cast<int>(std::ceil(std::min(angle / kShort, kMostParts)));
  const double t = dt / parts;
  const Matrix3d turn = gamma(0, w * t);
  Matrix3d R_part = R;
  BodyNoise Q;
  for (int i = 0; i < parts; ++i) {
    Q.advance(BodyTransition(R_part, w, a, t), noise_of_short_step(R_part, w, a, t, density));
    R_part = R_part * turn;
  }
  return Q;
}

Matrix15d congruence(const Matrix15d& F, const Matrix15d& P) {
  Matrix15d FP = Matrix15d::Zero();
  Matrix15d out = Matrix15d::Zero();
  for (int c = 0; c < body::kSize; ++c) {
    for (int k = 0; k < body::kSize; ++k) FP.col(c) += P(k, c) * F.col(k);
  }
  for (int c = 0; c < body::kSize; ++c) {
    for (int k = 0; k < body::kSize; ++k) out.col(c) += F(c, k) * FP.col(k);
  }
  return out;
}

bool Propagation::finite() const {
  return state.p_WB.allFinite() && state.v_WB.allFinite() && state.q_WB.coeffs().allFinite() &&
         transition().allFinite() && noise().allFinite();
}

void Propagation::step(const ImuStep& step, const ImuOptions& options) {
  const double dt = to_seconds(step.end - step.begin);
  const Matrix3d R = state.q_WB.toRotationMatrix();
  const Vector3d w = step.gyro_B - state.gyro_bias;
  const Vector3d a = step.accel_B - state.accel_bias;
  const BodyTransition phi(R, w, a, dt);
  from_start.advance(phi);
  added.advance(phi, process_noise_covariance(R, w, a, dt, process_noise(options, step)));
  integrate(step, options.gravity, state);
  gap = gap || step.gap > 0.0;
}

}  // namespace rio
