// SPDX-License-Identifier: BSD-3-Clause
#include "rio/smoother/imu_factor.hpp"

#include <Eigen/LU>

namespace rio {

ImuFactor::ImuFactor(const Preintegration& imu, double gravity)
    : imu_(imu), gravity_W_(0.0, 0.0, -gravity), root_(imu.covariance()) {
  valid_ = imu.duration() > Time{0} && imu.finite() && root_.positive();
}

void ImuFactor::evaluate(const NavState& xi, const NavState& xj, Residual* r, Jacobian* J) const {
  evaluate_unwhitened(xi, xj, r, J);
  *r = root_.whitened(*r);
  if (J != nullptr) root_.L().triangularView<Eigen::Lower>().solveInPlace(*J);
}

void ImuFactor::evaluate_unwhitened(const NavState& xi, const NavState& xj, Residual* r,
                                    Jacobian* J) const {
  const double T = to_seconds(imu_.duration());
  const ImuIncrement d = imu_.corrected(xi.gyro_bias, xi.accel_bias);
  const Matrix3d R_i = xi.q_WB.toRotationMatrix();
  const Matrix3d R_ij = R_i.transpose() * xj.q_WB.toRotationMatrix();
  const Vector3d u_p = R_i.transpose() * (xj.p_WB - xi.p_WB - (xi.v_WB + 0.5 * T * gravity_W_) * T);
  const Vector3d u_v = R_i.transpose() * (xj.v_WB - xi.v_WB - gravity_W_ * T);
  const Vector3d r_phi = quaternion_log(d.delta_q.conjugate() * Quaternion(R_ij));
  *r << r_phi, u_p - d.delta_p, u_v - d.delta_v, xj.gyro_bias - xi.gyro_bias,
      xj.accel_bias - xi.accel_bias;
  if (J == nullptr) return;

  using namespace body;
  constexpr int kJ = kSize;  // first column of state j
  const BodyTransition& A = imu_.jacobians();
  const Matrix3d inverse_Jr = gamma(1, -r_phi).inverse();  // regular: |r_phi| <= pi
  const Vector3d c = imu_.rotation_correction(xi.gyro_bias);
  J->setZero();
  J->block<3, 3>(kAttitude, kAttitude) = -inverse_Jr * R_ij.transpose();  // (E2)
  J->block<3, 3>(kAttitude, kJ + kAttitude) = inverse_Jr;
  J->block<3, 3>(kAttitude, kGyroBias) =
      -inverse_Jr * gamma(0, -r_phi) * gamma(1, -c) * A.attitude_gyro;
  J->block<3, 3>(kPosition, kAttitude) = skew(u_p);  // (E3)
  J->block<3, 3>(kPosition, kPosition) = -R_i.transpose();
  J->block<3, 3>(kPosition, kVelocity) = -T * R_i.transpose();
  J->block<3, 3>(kPosition, kGyroBias) = -A.position_gyro;
  J->block<3, 3>(kPosition, kAccelBias) = -A.position_accel;
  J->block<3, 3>(kPosition, kJ + kPosition) = R_i.transpose();
  J->block<3, 3>(kVelocity, kAttitude) = skew(u_v);
  J->block<3, 3>(kVelocity, kVelocity) = -R_i.transpose();
  J->block<3, 3>(kVelocity, kGyroBias) = -A.velocity_gyro;
  J->block<3, 3>(kVelocity, kAccelBias) = -A.velocity_accel;
  J->block<3, 3>(kVelocity, kJ + kVelocity) = R_i.transpose();
  J->block<6, 6>(kGyroBias, kGyroBias) = -Eigen::Matrix<double, 6, 6>::Identity();
  J->block<6, 6>(kGyroBias, kJ + kGyroBias).setIdentity();
}

}  // namespace rio
