// SPDX-License-Identifier: BSD-3-Clause
#include "rio/smoother/imu_factor.hpp"

#include <Eigen/LU>

namespace rio {

InertialState::InertialState(const NavState& x)
    : T_WB(x.q_WB.toRotationMatrix(), x.p_WB),
      v_WB(x.v_WB),
      gyro_bias(x.gyro_bias),
      accel_bias(x.accel_bias) {}

InertialState retract(const InertialState& x, const Eigen::Matrix<double, body::kSize, 1>& error) {
  static_assert(body::kAttitude == 0 && body::kPosition == 3);  // as in PoseBlock
  InertialState out = x;
  out.T_WB = PoseBlock::retract(x.T_WB, error.head<PoseBlock::kDof>());
  out.v_WB += error.segment<3>(body::kVelocity);
  out.gyro_bias += error.segment<3>(body::kGyroBias);
  out.accel_bias += error.segment<3>(body::kAccelBias);
  return out;
}

ImuFactor::ImuFactor(const Preintegration& imu, double gravity)
    : imu_(imu), gravity_W_(0.0, 0.0, -gravity), root_(imu.covariance()) {
  valid_ = imu.duration() > Time{0} && imu.finite() && root_.positive();
}

void ImuFactor::evaluate(const InertialState& xi, const InertialState& xj, Residual* r,
                         Jacobian* J) const {
  evaluate_unwhitened(xi, xj, r, J);
  *r = root_.whitened(*r);
  if (J != nullptr) root_.L().triangularView<Eigen::Lower>().solveInPlace(*J);
}

void ImuFactor::evaluate_unwhitened(const InertialState& xi, const InertialState& xj, Residual* r,
                                    Jacobian* J) const {
  const double T = to_seconds(imu_.duration());
  const ImuIncrement d = imu_.corrected(xi.gyro_bias, xi.accel_bias);
  const Matrix3d R_ij = xi.T_WB.R.transpose() * xj.T_WB.R;
  const Vector3d u_p =
      xi.T_WB.R.transpose() * (xj.T_WB.p - xi.T_WB.p - (xi.v_WB + 0.5 * T * gravity_W_) * T);
  const Vector3d u_v = xi.T_WB.R.transpose() * (xj.v_WB - xi.v_WB - gravity_W_ * T);
  const Vector3d r_phi = quaternion_log(d.delta_q.conjugate() * Quaternion(R_ij));
  *r << r_phi, u_p - d.delta_p, u_v - d.delta_v, xj.gyro_bias - xi.gyro_bias,
      xj.accel_bias - xi.accel_bias;
  if (J == nullptr) return;
  J->setZero();
  differentiate_attitude(R_ij, r_phi, imu_.rotation_correction(xi.gyro_bias), J);
  differentiate_motion(xi.T_WB.R, u_p, u_v, T, J);
  J->block<6, 6>(body::kGyroBias, body::kGyroBias) = -Eigen::Matrix<double, 6, 6>::Identity();
  J->block<6, 6>(body::kGyroBias, kJ + body::kGyroBias).setIdentity();
}

void ImuFactor::differentiate_attitude(const Matrix3d& R_ij, const Vector3d& r_phi,
                                       const Vector3d& c, Jacobian* J) const {
  using namespace body;
  const Matrix3d inverse_Jr = gamma(1, -r_phi).inverse();  // regular: |r_phi| <= pi
  J->block<3, 3>(kAttitude, kAttitude) = -inverse_Jr * R_ij.transpose();
  J->block<3, 3>(kAttitude, kJ + kAttitude) = inverse_Jr;
  J->block<3, 3>(kAttitude, kGyroBias) =
      -inverse_Jr * gamma(0, -r_phi) * gamma(1, -c) * imu_.jacobians().attitude_gyro;
}

void ImuFactor::differentiate_motion(const Matrix3d& R_i, const Vector3d& u_p, const Vector3d& u_v,
                                     double T, Jacobian* J) const {
  using namespace body;
  J->block<3, 3>(kPosition, kAttitude) = skew(u_p);
  J->block<3, 3>(kPosition, kPosition) = -R_i.transpose();
  J->block<3, 3>(kPosition, kVelocity) = -T * R_i.transpose();
  J->block<3, 3>(kPosition, kGyroBias) = -imu_.jacobians().position_gyro;
  J->block<3, 3>(kPosition, kAccelBias) = -imu_.jacobians().position_accel;
  J->block<3, 3>(kPosition, kJ + kPosition) = R_i.transpose();
  J->block<3, 3>(kVelocity, kAttitude) = skew(u_v);
  J->block<3, 3>(kVelocity, kVelocity) = -R_i.transpose();
  J->block<3, 3>(kVelocity, kGyroBias) = -imu_.jacobians().velocity_gyro;
  J->block<3, 3>(kVelocity, kAccelBias) = -imu_.jacobians().velocity_accel;
  J->block<3, 3>(kVelocity, kJ + kVelocity) = R_i.transpose();
}

}  // namespace rio
