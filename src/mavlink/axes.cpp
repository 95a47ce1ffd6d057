// SPDX-License-Identifier: BSD-3-Clause
#include "rio/mavlink/axes.hpp"

#include <cmath>

#include "rio/core/so3.hpp"

namespace rio::mavlink {
namespace {

const Matrix3d kFrdFlu = Vector3d(1.0, -1.0, -1.0).asDiagonal();
const Matrix3d kNedEnu = (Matrix3d() << 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0).finished();

/// C with diag(R, R) on both sides.
Matrix6d rotated(const Matrix6d& c, const Matrix3d& R) {
  Matrix6d result;
  for (int row = 0; row < 6; row += 3) {
    for (int column = 0; column < 6; column += 3) {
      result.block<3, 3>(row, column) = R * c.block<3, 3>(row, column) * R.transpose();
    }
  }
  return result;
}

}  // namespace

/// A turn about x by pi on both sides: (0,1,0,0) q (0,-1,0,0).
Quaternion attitude_flu_to_frd(const Quaternion& q) {
  return {q.w(), q.x(), -q.y(), -q.z()};
}

/// (0,1,1,0)/sqrt(2) q (0,1,0,0), up to the sign.
Quaternion attitude_enu_to_ned(const Quaternion& q) {
  const double s = std::sqrt(0.5);
  return {s * (q.w() + q.z()), s * (q.x() + q.y()), s * (q.x() - q.y()), s * (q.w() - q.z())};
}

Matrix6d covariance_flu_to_frd(const Matrix6d& c) {
  return rotated(c, kFrdFlu);
}

Matrix6d covariance_enu_to_ned(const Matrix6d& c) {
  return rotated(c, kNedEnu);
}

Matrix6d pose_covariance(const Quaternion& q_WB, const BodyCovariance& P) {
  Eigen::Matrix<double, 6, body::kSize> J = Eigen::Matrix<double, 6, body::kSize>::Zero();
  J.block<3, 3>(0, body::kPosition).setIdentity();
  J.block<3, 3>(3, body::kAttitude) = q_WB.toRotationMatrix();
  return J * P * J.transpose();
}

Matrix6d twist_covariance(const NavState& state, const BodyCovariance& P, double gyro_sigma) {
  const Matrix3d R_BW = state.q_WB.toRotationMatrix().transpose();
  Eigen::Matrix<double, 6, body::kSize> J = Eigen::Matrix<double, 6, body::kSize>::Zero();
  J.block<3, 3>(0, body::kVelocity) = R_BW;
  J.block<3, 3>(0, body::kAttitude) = skew(R_BW * state.v_WB);
  J.block<3, 3>(3, body::kGyroBias) = -Matrix3d::Identity();
  Matrix6d covariance = J * P * J.transpose();
  covariance.bottomRightCorner<3, 3>().diagonal().array() += gyro_sigma * gyro_sigma;
  return covariance;
}

UpperTriangle upper_triangle(const Matrix6d& c) {
  UpperTriangle triangle{};
  std::size_t at = 0;
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column)
      triangle[at++] = static_cast<float>(c(row, column));
  }
  return triangle;
}

Matrix6d from_upper_triangle(const UpperTriangle& triangle) {
  Matrix6d c;
  std::size_t at = 0;
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) {
      c(row, column) = c(column, row) = static_cast<double>(triangle[at++]);
    }
  }
  return c;
}

}  // namespace rio::mavlink
