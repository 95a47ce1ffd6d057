// SPDX-License-Identifier: BSD-3-Clause
// Rows that are summed up: the information of the batch stays, its length does not.
#include "rio/ekf/row_compression.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/covariance_case.hpp"
#include "support/symmetric.hpp"

namespace rio::test {
namespace {

class RowCompressionTest : public CovarianceCase {
 protected:
  /// Rows that are combinations of `rank` rows over body, velocity and time offset, each a block.
  void push_alike(int count, int rank) {
    const MatrixXd basis = random_matrix(random_, rank, 10);
    for (int i = 0; i < count; ++i) {
      const MatrixXd h = random_matrix(random_, 1, rank) * basis;
      auto row =
          linear_rows<1>(Eigen::Matrix<double, 1, 9>(h.leftCols(9)),
                         BlockList<BodyPose, BodyVelocity>{}, {body::kAttitude, body::kVelocity},
                         Eigen::Matrix<double, 1, 1>(h.rightCols(1)), layout_.time_offset())[0];
      row.residual = random_.normal();
      row.variance = 0.01 + random_.uniform();
      batch_.begin_block();
      batch_.push(row);
    }
  }
  /// H^T R^-1 [H r].
  MatrixXd information(const RowBatch& batch) const {
    const int n = covariance_.size();
    MatrixXd sum = MatrixXd::Zero(n, n + 1);
    for (const RowBlock& block : batch.blocks()) {
      const auto m = static_cast<Eigen::Index>(block.count);
      MatrixXd H(m, n);
      VectorXd r(m);
      MatrixXd R = MatrixXd::Zero(m, m);
      for (Eigen::Index i = 0; i < m; ++i) {
        const LinearRow& row = batch.rows()[block.first + static_cast<std::size_t>(i)];
        H.row(i) = dense_rows(std::array<LinearRow, 1>{row}, n);
        r[i] = row.residual;
        R(i, i) = row.variance;
      }
      const MatrixXd weighted = solve(R, H).transpose();
      sum.leftCols(n) += weighted * H;
      sum.col(n) += weighted * r;
    }
    return sum;
  }
  void expect_same_information(std::size_t rows) {
    RowCompression compression(batch_.capacity());
    const RowBatch& out = compression.compress(batch_);
    EXPECT_EQ(out.rows().size(), rows);
    const MatrixXd expected = information(batch_);
    EXPECT_LE((information(out) - expected).cwiseAbs().maxCoeff(), 1e-12 * expected.norm());
  }

  RowBatch batch_{100};
};

TEST_F(RowCompressionTest, ManyRowsOfThreeDirectionsAreThree) {
  push_alike(18, 3);
  expect_same_information(3);
}

TEST_F(RowCompressionTest, OfFewerDirectionsThereAreFewer) {
  push_alike(9, 1);
  expect_same_information(1);
}

TEST_F(RowCompressionTest, RowsOfManyDirectionsStayAsTheyAre) {
  push_alike(9, 7);
  expect_same_information(9);
}

TEST_F(RowCompressionTest, OtherBlocksStayAndDivideTheRuns) {
  push_alike(8, 3);
  fill(random_, layout_, covariance_.size(), {4, 1, 2}, &batch_);
  push_alike(6, 2);
  expect_same_information(3 + 7 + 2);
}

// The update has to see that a variance is none.
TEST_F(RowCompressionTest, ABadVarianceIsHandedOn) {
  for (const double bad : {-1.0, std::nan("")}) {
    batch_.clear();
    push_alike(8, 3);
    LinearRow row = batch_.rows().back();
    row.variance = bad;
    batch_.begin_block();
    batch_.push(row);
    RowCompression compression(batch_.capacity());
    EXPECT_EQ(compression.compress(batch_).rows().size(), 9U);
  }
}

TEST_F(RowCompressionTest, NothingIsNothing) {
  expect_same_information(0);
}

}  // namespace
}  // namespace rio::test
