// SPDX-License-Identifier: BSD-3-Clause
// H P H^T from the gathered part of P against the dense product.
#include "rio/update/gathered_covariance.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/covariance_case.hpp"

namespace rio::test {
namespace {

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

  GatheredCovariance gathered_;
};

// What two sets of rows share is gathered once.
TEST_F(GatheredCovarianceTest, FromLandmarkToLandmarkAndBack) {
  for (const int landmark : {0, 1, 1, 0}) expect_product(rows_of_landmark(landmark));
  expect_product(clone_rows());
  expect_product(rows_of_landmark(1));
}

TEST_F(GatheredCovarianceTest, RowsOfDifferentColumns) {
  std::array<LinearRow, 6> rows;
  const auto landmark = rows_of_landmark(1);
  const auto clone = clone_rows();
  std::copy(landmark.begin(), landmark.end(), rows.begin());
  std::copy(clone.begin(), clone.begin() + 3, rows.begin() + 3);
  expect_product(rows);
}

// Pose, velocity, three clones, calibration: they are multiplied one by one.
TEST_F(GatheredCovarianceTest, RowsOfMoreColumnsThanAreGathered) {
  RowBatch batch(10);
  fill(random_, layout_, covariance_.size(), {3}, &batch);
  std::array<LinearRow, 6> rows;
  const auto landmark = landmark_rows();
  std::copy(landmark.begin(), landmark.end(), rows.begin());
  std::copy(batch.rows().begin(), batch.rows().end(), rows.begin() + 3);
  expect_product(rows);
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
