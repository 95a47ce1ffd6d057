// SPDX-License-Identifier: BSD-3-Clause
// Every operation on P, and H P H^T from its gathered part, against the same with dense matrices.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>

#include "rio/update/covariance.hpp"
#include "rio/update/gathered_covariance.hpp"
#include "support/covariance_case.hpp"

namespace rio::test {
namespace {

using CovarianceTest = CovarianceCase;

TEST_F(CovarianceTest, PropagationEqualsTheDenseProduct) {
  MatrixXd F = MatrixXd::Identity(covariance_.size(), covariance_.size());
  F.topLeftCorner<15, 15>() = random_transition();
  MatrixXd expected = F * dense() * F.transpose();
  expected.topLeftCorner<15, 15>() += noise();
  covariance_.propagate(F.topLeftCorner<15, 15>(), noise());
  expect_equal(expected, 1e-12);
}

// As if the velocity had had that variance at the beginning, and the position had followed it.
TEST_F(CovarianceTest, ReopenedVelocityTakesThePositionAlong) {
  MatrixXd G = MatrixXd::Zero(covariance_.size(), 3);
  G.middleRows<3>(body::kPosition) = 0.2 * Matrix3d::Identity();
  G.middleRows<3>(body::kVelocity) = Matrix3d::Identity();
  const MatrixXd expected = dense() + 7.0 * G * G.transpose();
  covariance_.inflate_velocity(7.0, 0.2);
  expect_equal(expected, 1e-12);
}

TEST_F(CovarianceTest, MeasuredVelocityIsAKalmanUpdate) {
  const Vector3d residual(0.3, -0.2, 0.1);
  const Matrix3d noise = Vector3d(0.1, 0.2, 0.3).asDiagonal();
  const MatrixXd P = dense();
  const MatrixXd P_v = P.middleRows<3>(body::kVelocity);
  const Matrix3d S = P_v.middleCols<3>(body::kVelocity) + noise;
  const MatrixXd K = P_v.transpose() * S.inverse();
  Eigen::VectorXd dx = Eigen::VectorXd::Zero(P.rows());
  covariance_.measure_velocity(residual, noise, &dx);
  EXPECT_LT((dx.head(P.rows()) - K * residual).norm(), 1e-12 * (1.0 + dx.norm()));
  expect_equal(P - K * P_v, 1e-12);
}

TEST_F(CovarianceTest, BlocksEnterAsLinearFunctionsOfTheState) {
  const int n = covariance_.size();
  const auto expect_block = [this](int at, const MatrixXd& H, const MatrixXd& noise) {
    const MatrixXd before = dense();
    MatrixXd M = MatrixXd::Identity(before.rows(), before.cols());
    M.middleRows(at, H.rows()) = H;
    MatrixXd expected = M * before * M.transpose();
    expected.block(at, at, H.rows(), H.rows()) += noise;
    return expected;
  };
  const std::array<LinearRow, 6> clone = clone_rows();
  const MatrixXd with_clone =
      expect_block(layout_.clone(1), dense_rows(clone, n).H, MatrixXd::Zero(6, 6));
  covariance_.assign_clone(1, clone);
  expect_equal(with_clone, 1e-12);

  const std::array<LinearRow, 3> landmark = landmark_rows();
  const Matrix3d noise = Vector3d(0.1, 0.2, 0.3).asDiagonal();
  MatrixXd H = MatrixXd::Zero(n + 3, n);
  H.topRows(n).setIdentity();
  H.bottomRows(3) = dense_rows(landmark, n).H;
  MatrixXd with_landmark = H * dense() * H.transpose();
  with_landmark.bottomRightCorner(3, 3) += noise;
  covariance_.add_landmark(2, landmark, noise);
  expect_equal(with_landmark, 1e-12);
}

TEST_F(CovarianceTest, CloneWithoutTimeOffsetIsAnExactCopy) {
  covariance_.assign_clone(
      1, linear_rows<6>(Eigen::Matrix<double, 6, 6>::Identity(), BlockList<BodyPose>{},
                        {body::kAttitude}, Eigen::Matrix<double, 6, 1>::Zero(), -1));
  const int at = layout_.clone(1);
  EXPECT_EQ(dense().middleRows(at, 6), dense().topRows(6));
  EXPECT_EQ(dense().block(at, at, 6, 6), dense().topLeftCorner(6, 6));
}

// Of a landmark, and of each parameter at its own rate.
TEST_F(CovarianceTest, RandomWalksReachTheirOwnStates) {
  MatrixXd expected = dense();
  expected.diagonal().tail(3) += Vector3d(0.25, 0.5, 0.75);
  covariance_.add_landmark_noise(1, {0.25, 0.5, 0.75});
  expect_equal(expected, 0.0);
  const VectorXd walk = VectorXd::LinSpaced(layout_.clone(0) - body::kSize, 0.1, 0.9);
  expected.diagonal().segment(body::kSize, walk.size()) += 2.0 * walk;
  covariance_.add_parameter_noise(walk, 2.0);
  expect_equal(expected, 0.0);
}

TEST_F(CovarianceTest, RemovedLandmarkIsReplacedByTheLast) {
  const int n = covariance_.size();
  MatrixXd select = MatrixXd::Identity(n - 3, n);  // drops the last three ...
  select.block(layout_.landmark(0), layout_.landmark(0), 3, 3).setZero();
  select.block(layout_.landmark(0), layout_.landmark(1), 3, 3)
      .setIdentity();  // ... after moving them
  const MatrixXd expected = select * dense() * select.transpose();
  covariance_.remove_landmark(0);
  expect_equal(expected, 0.0);
  covariance_.remove_landmark(0);
  expect_equal(expected.topLeftCorner(n - 6, n - 6), 0.0);
}

class GatheredCovarianceTest : public CovarianceCase {
 protected:
  GatheredCovarianceTest() { gathered_.begin(covariance_); }

  template <std::size_t kRows>
  void expect_product(const std::array<LinearRow, kRows>& rows) {
    const MatrixXd H = dense_rows(rows, covariance_.size()).H;
    const MatrixXd expected = H * dense() * H.transpose();
    EXPECT_LE((gathered_.product(rows) - expected).cwiseAbs().maxCoeff(), 1e-12 * expected.norm());
  }
  /// Of the pose and one landmark.
  std::array<LinearRow, 3> rows_of_landmark(int landmark) {
    return linear_rows<3>(random_matrix(random_, 3, 9), BlockList<BodyPose, Landmark>{},
                          {body::kAttitude, layout_.landmark(landmark)},
                          random_matrix(random_, 3, 1), layout_.time_offset());
  }
  template <class A, class B>
  static std::array<LinearRow, 6> three_of_each(const A& a, const B& b) {
    std::array<LinearRow, 6> rows;
    std::copy_n(a.begin(), 3, rows.begin());
    std::copy_n(b.begin(), 3, rows.begin() + 3);
    return rows;
  }

  GatheredCovariance gathered_;
};

// What two sets of rows share is gathered once.
TEST_F(GatheredCovarianceTest, FromLandmarkToLandmarkAndBack) {
  for (const int landmark : {0, 1, 1, 0}) expect_product(rows_of_landmark(landmark));
  expect_product(clone_rows());
  expect_product(rows_of_landmark(1));
}

TEST_F(GatheredCovarianceTest, RowsOfDifferentColumns) {
  expect_product(three_of_each(rows_of_landmark(1), clone_rows()));
}

// Pose, velocity, three clones, calibration: they are multiplied one by one.
TEST_F(GatheredCovarianceTest, RowsOfMoreColumnsThanAreGathered) {
  RowBatch batch(10);
  fill(random_, layout_, covariance_.size(), {3}, &batch);
  expect_product(three_of_each(landmark_rows(), batch.rows()));
  expect_product(landmark_rows());
}

TEST_F(GatheredCovarianceTest, AnotherCovarianceIsGatheredAnew) {
  expect_product(landmark_rows());
  covariance_.propagate(random_transition(), noise());
  gathered_.begin(covariance_);
  expect_product(landmark_rows());
}

TEST_F(GatheredCovarianceTest, InnovationCovarianceOfABlock) {
  RowBatch batch(20);
  const DenseRows d = fill(random_, layout_, covariance_.size(), {2, 5}, &batch);
  for (std::size_t b = 0; b < 2; ++b) {
    const RowBlock& block = batch.blocks()[b];
    const auto at = static_cast<Eigen::Index>(block.first);
    const auto m = static_cast<Eigen::Index>(block.count);
    GatheredCovariance::BlockMatrix S;
    gathered_.innovation_covariance(batch, block, &S);
    const MatrixXd H = d.H.middleRows(at, m);
    const MatrixXd expected = H * dense() * H.transpose() + d.R.block(at, at, m, m);
    EXPECT_LT((S - expected).cwiseAbs().maxCoeff(), 1e-11) << b;
  }
}

}  // namespace
}  // namespace rio::test
