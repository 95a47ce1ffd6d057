// SPDX-License-Identifier: BSD-3-Clause
// What happens to a model's rows on their way into the update: whitening against the Cholesky
// factor of Eigen, and the derivative of a state stepped back against central differences.
#include "rio/update/linearize.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "rio/sim/random.hpp"

namespace rio {
namespace {

const Vector3d kOnes = Vector3d::Ones();

template <int kRows, int kCols>
Eigen::Matrix<double, kRows, kCols> random_matrix(sim::Random& random) {
  Eigen::Matrix<double, kRows, kCols> m;
  for (int i = 0; i < kRows; ++i) {
    for (int j = 0; j < kCols; ++j) m(i, j) = random.normal();
  }
  return m;
}

TEST(Whiten, IsTheInverseOfTheCholeskyFactor) {
  constexpr int kDim = 4;
  constexpr int kDof = 7;
  sim::Random random(3);
  for (int i = 0; i < 20; ++i) {
    const auto root = random_matrix<kDim, kDim>(random);
    const JacobianOf<kDim, kDim> R = root * root.transpose() + JacobianOf<kDim, kDim>::Identity();
    ResidualOf<kDim> r = random_matrix<kDim, 1>(random);
    JacobianOf<kDim, kDof> J = random_matrix<kDim, kDof>(random);
    const Eigen::MatrixXd L = Eigen::MatrixXd(R).llt().matrixL();
    const Eigen::VectorXd expected_r = L.inverse() * r;
    const Eigen::MatrixXd expected_J = L.inverse() * J;
    whiten<kDim, kDof>(R, &r, &J);
    EXPECT_LT((Eigen::VectorXd(r) - expected_r).norm(), 1e-12);
    EXPECT_LT((Eigen::MatrixXd(J) - expected_J).norm(), 1e-12);
  }
}

/// A body in motion, and the errors that it is looked at with: [dphi dp dv db_g].
struct Motion {
  NavState nav;
  Vector3d gyro_B;
  Vector3d accel_B;

  explicit Motion(sim::Random& random)
      : gyro_B(2.0 * random.in_box(-kOnes, kOnes)), accel_B(4.0 * random.in_box(-kOnes, kOnes)) {
    nav.q_WB = quaternion_exp(2.0 * random.in_box(-kOnes, kOnes));
    nav.p_WB = 5.0 * random.in_box(-kOnes, kOnes);
    nav.v_WB = 3.0 * random.in_box(-kOnes, kOnes);
    nav.gyro_bias = 0.1 * random.in_box(-kOnes, kOnes);
  }

  LinearizationPoint stepped_back(const Eigen::VectorXd& error, double seconds) const {
    static const Estimate kEstimate;
    NavState x = nav;
    x.q_WB = x.q_WB * quaternion_exp(error.segment<3>(0));
    x.p_WB += error.segment<3>(3);
    x.v_WB += error.segment<3>(6);
    x.gyro_bias += error.segment<3>(9);
    LinearizationPoint point(kEstimate, x, gyro_B, x.q_WB * accel_B);
    point.step_back(seconds);
    return point;
  }
};

TEST(StepBack, HasTheDerivativeItSays) {
  constexpr double kSeconds = 0.1;
  constexpr double kStep = 1e-5;
  sim::Random random(4);
  for (int i = 0; i < 20; ++i) {
    const Motion motion(random);
    const LinearizationPoint at = motion.stepped_back(Eigen::VectorXd::Zero(12), kSeconds);
    Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(9, 12);  // (E2)
    expected.block<3, 3>(0, 0) = at.step.attitude;
    expected.block<3, 3>(0, 9) = at.step.bias;
    expected.block<3, 3>(3, 3).setIdentity();
    expected.block<3, 3>(3, 6) = -at.step.seconds * Matrix3d::Identity();
    expected.block<3, 3>(6, 0) = at.step.velocity;
    expected.block<3, 3>(6, 6).setIdentity();
    for (int k = 0; k < 12; ++k) {
      const Eigen::VectorXd error = kStep * Eigen::VectorXd::Unit(12, k);
      const LinearizationPoint plus = motion.stepped_back(error, kSeconds);
      const LinearizationPoint minus = motion.stepped_back(-error, kSeconds);
      Eigen::VectorXd difference(9);
      difference << quaternion_log(Quaternion(Matrix3d(minus.T_WB.R.transpose() * plus.T_WB.R))),
          plus.T_WB.p - minus.T_WB.p, plus.v_WB - minus.v_WB;
      // kStep squared times third derivatives, and rounding 1e-15 / kStep
      EXPECT_LT((difference / (2.0 * kStep) - expected.col(k)).norm(), 1e-8) << k;
    }
  }
}

}  // namespace
}  // namespace rio
