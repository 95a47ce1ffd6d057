// SPDX-License-Identifier: BSD-3-Clause
// Changes of axes against rotation matrices written down from the names of the axes, and
// covariances against samples of the error state.
#include "rio/mavlink/axes.hpp"

#include <gtest/gtest.h>

#include "rio/core/so3.hpp"
#include "rio/sim/random.hpp"
#include "support/measured.hpp"
#include "support/symmetric.hpp"

namespace rio::mavlink::test {
namespace {

/// Axes of `to` as rows, written in those of `from`: (front, left, up) or (east, north, up).
Matrix3d rows(const Vector3d& x, const Vector3d& y, const Vector3d& z) {
  Matrix3d R;
  R << x.transpose(), y.transpose(), z.transpose();
  return R;
}
const Vector3d kFront(1, 0, 0), kLeft(0, 1, 0), kEast(1, 0, 0), kNorth(0, 1, 0), kUp(0, 0, 1);
Matrix3d R_frd_flu() {
  return rows(kFront, -kLeft, -kUp);
}
Matrix3d R_ned_enu() {
  return rows(kNorth, kEast, -kUp);
}

Quaternion some_attitude(sim::Random* random) {
  return quaternion_exp(2.0 * random->normal3());
}

/// Positive definite, every correlation present.
template <int n>
Eigen::Matrix<double, n, n> some_covariance(sim::Random* random) {
  Eigen::Matrix<double, n, n> A;
  for (int i = 0; i < n * n; ++i) A(i) = random->normal();
  return A * A.transpose() / n;
}

TEST(MavlinkAxes, VectorsAgainstTheNamesOfTheAxes) {
  sim::Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Vector3d v = random.normal3();
    EXPECT_EQ(flu_to_frd(v), R_frd_flu() * v);
    EXPECT_EQ(enu_to_ned(v), R_ned_enu() * v);
    EXPECT_EQ(frd_to_flu(flu_to_frd(v)), v);
    EXPECT_EQ(ned_to_enu(enu_to_ned(v)), v);
  }
}

TEST(MavlinkAxes, AttitudesAgainstRotationMatrices) {
  sim::Random random(2);
  for (int i = 0; i < 100; ++i) {
    const Quaternion q = some_attitude(&random);
    const Matrix3d R = q.toRotationMatrix();
    const Matrix3d frd = R_frd_flu() * R * R_frd_flu().transpose();
    const Matrix3d ned = R_ned_enu() * R * R_frd_flu().transpose();
    EXPECT_LT((attitude_flu_to_frd(q).toRotationMatrix() - frd).norm(), 1e-14);
    EXPECT_LT((attitude_enu_to_ned(q).toRotationMatrix() - ned).norm(), 1e-14);
    EXPECT_LT((attitude_frd_to_flu(attitude_flu_to_frd(q)).coeffs() - q.coeffs()).norm(), 1e-14);
    const Matrix3d back = attitude_ned_to_enu(attitude_enu_to_ned(q)).toRotationMatrix();
    EXPECT_LT((back - R).norm(), 1e-14);
  }
}

TEST(MavlinkAxes, CovariancesAgainstTheCongruence) {
  sim::Random random(3);
  Eigen::Matrix<double, 6, 6> F = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 6> N = F;
  F.topLeftCorner<3, 3>() = F.bottomRightCorner<3, 3>() = R_frd_flu();
  N.topLeftCorner<3, 3>() = N.bottomRightCorner<3, 3>() = R_ned_enu();
  for (int i = 0; i < 20; ++i) {
    const Matrix6d c = some_covariance<6>(&random);
    EXPECT_LT((covariance_flu_to_frd(c) - F * c * F.transpose()).norm(), 1e-14);
    EXPECT_LT((covariance_enu_to_ned(c) - N * c * N.transpose()).norm(), 1e-14);
    EXPECT_EQ(covariance_frd_to_flu(covariance_flu_to_frd(c)), c);
    EXPECT_EQ(covariance_ned_to_enu(covariance_enu_to_ned(c)), c);
  }
}

TEST(MavlinkAxes, UpperTriangleRowByRow) {
  Matrix6d c;
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) {
      c(row, column) = 10 * std::min(row, column) + std::max(row, column);
    }
  }
  const UpperTriangle expected = {0,  1,  2,  3,  4,  5,  11, 12, 13, 14, 15,
                                  22, 23, 24, 25, 33, 34, 35, 44, 45, 55};
  EXPECT_EQ(upper_triangle(c), expected);
  EXPECT_EQ(from_upper_triangle(expected), c);
}

/// Largest deviation of a covariance from that of samples, in the sigmas of the states.
double deviation(const Matrix6d& c, const Matrix6d& sampled) {
  const Eigen::Matrix<double, 6, 1> sigma = c.diagonal().cwiseSqrt();
  return (c - sampled).cwiseQuotient(sigma * sigma.transpose()).cwiseAbs().maxCoeff();
}

/// The true pose and twist of samples of the error state around an estimate, in axes FRD.
TEST(MavlinkAxes, CovariancesAgainstSamplesOfTheErrorState) {
  constexpr int kSamples = 100000;
  constexpr double kGyroSigma = 0.004;
  sim::Random random(4);
  for (int n = 0; n < 3; ++n) {
    const NavState state{.q_WB = some_attitude(&random),
                         .p_WB = 10.0 * random.normal3(),
                         .v_WB = 3.0 * random.normal3()};
    const BodyCovariance P = 1e-4 * some_covariance<body::kSize>(&random);
    const Matrix3d D = R_frd_flu();
    const Matrix3d R = state.q_WB.toRotationMatrix();
    const Vector3d v_B = R.transpose() * state.v_WB;
    const Eigen::MatrixXd L = rio::test::root_of(P);
    Matrix6d pose = Matrix6d::Zero();
    Matrix6d twist = Matrix6d::Zero();
    for (int k = 0; k < kSamples; ++k) {
      Eigen::Matrix<double, body::kSize, 1> e;
      for (int i = 0; i < body::kSize; ++i) e[i] = random.normal();
      e = (L * e).eval();
      const Matrix3d R_true = R * gamma(0, e.segment<3>(body::kAttitude));
      const Vector3d v_true = state.v_WB + e.segment<3>(body::kVelocity);
      Eigen::Matrix<double, 6, 1> dx;
      // the turn in local FRD axes that takes the estimated attitude to the true one
      const Matrix3d turn = D * R_true * D.transpose() * (D * R * D.transpose()).transpose();
      dx << D * e.segment<3>(body::kPosition), quaternion_log(Quaternion(turn));
      pose += dx * dx.transpose() / kSamples;
      const Vector3d rate = -e.segment<3>(body::kGyroBias) - kGyroSigma * random.normal3();
      dx << D * (R_true.transpose() * v_true - v_B), D * rate;
      twist += dx * dx.transpose() / kSamples;
    }
    const double off_pose = deviation(covariance_flu_to_frd(pose_covariance(state.q_WB, P)), pose);
    const double off_twist =
        deviation(covariance_flu_to_frd(twist_covariance(state, P, kGyroSigma)), twist);
    rio::test::expect_below("pose, off by (correlations)", off_pose, 0.02);
    rio::test::expect_below("twist, off by (correlations)", off_twist, 0.02);
  }
}

}  // namespace
}  // namespace rio::mavlink::test
