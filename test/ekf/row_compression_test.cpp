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

/// Dopplers that share the noise of a gyro sample.
class SharedRateNoise : public RowCompressionTest {
 protected:
  static constexpr double kRateVariance = 1.0;
  using Blocks = BlockList<BodyPose, BodyVelocity, GyroBias, Extrinsics, DopplerScale>;

  LinearRow row_of(const MatrixXd& h) {
    LinearRow row = linear_rows<1>(Eigen::Matrix<double, 1, Blocks::kDof>(h), Blocks{},
                                   {body::kAttitude, body::kVelocity, body::kGyroBias,
                                    layout_.extrinsics(), layout_.doppler_scale()},
                                   random_matrix(random_, 1, 1), -1)[0];
    row.residual = random_.normal();
    row.variance = 0.01 + random_.uniform();
    return row;
  }
  void push_dopplers(int count, int rank) {
    const MatrixXd basis = random_matrix(random_, rank, Blocks::kDof);
    for (int i = 0; i < count; ++i) {
      batch_.begin_block();
      batch_.push(row_of(random_matrix(random_, 1, rank) * basis));
    }
  }
  void push_landmark() {
    batch_.begin_block();
    for (int i = 0; i < 4; ++i) batch_.push(row_of(random_matrix(random_, 1, Blocks::kDof)));
  }
  /// H^T R^-1 [H r] of blocks of one row with R = diag + s G G^T, of the others with their own.
  /// The same information is the same update.
  MatrixXd expected_information() const {
    const int n = covariance_.size();
    RowBatch others(batch_.capacity());
    std::vector<LinearRow> alone;
    for (const RowBlock& block : batch_.blocks()) {
      if (block.count == 1) {
        alone.push_back(batch_.rows()[block.first]);
        continue;
      }
      others.begin_block();
      for (std::size_t i = 0; i < block.count; ++i) others.push(batch_.rows()[block.first + i]);
    }
    const auto m = static_cast<Eigen::Index>(alone.size());
    MatrixXd H(m, n);
    VectorXd r(m);
    VectorXd variances(m);
    for (Eigen::Index i = 0; i < m; ++i) {
      const LinearRow& row = alone[static_cast<std::size_t>(i)];
      H.row(i) = dense_rows(std::array{row}, n);
      r[i] = row.residual;
      variances[i] = row.variance;
    }
    const MatrixXd G = H.middleCols<3>(body::kGyroBias);
    MatrixXd R = kRateVariance * G * G.transpose();
    R.diagonal() += variances;
    MatrixXd sum = information(others);
    const MatrixXd weighted = solve(R, H).transpose();
    sum.leftCols(n) += weighted * H;
    sum.col(n) += weighted * r;
    return sum;
  }
  /// @return blocks of several rows
  std::vector<LinearRow> expect_shared(std::size_t rows) {
    RowCompression compression(batch_.capacity());
    const RowBatch& out = compression.compress(batch_, kRateVariance);
    EXPECT_EQ(out.rows().size(), rows);
    const MatrixXd expected = expected_information();
    EXPECT_LE((information(out) - expected).cwiseAbs().maxCoeff(), 1e-9 * expected.norm());
    std::vector<LinearRow> others;
    for (const RowBlock& block : out.blocks()) {
      for (std::size_t i = 0; block.count > 1 && i < block.count; ++i) {
        others.push_back(out.rows()[block.first + i]);
      }
    }
    return others;
  }
};

TEST_F(SharedRateNoise, IsThatOfTheDenseCovariance) {
  for (const int rank : {1, 2, 3}) {
    batch_.clear();
    push_dopplers(18, rank);
    (void)expect_shared(static_cast<std::size_t>(rank));
  }
}

TEST_F(SharedRateNoise, OfFewRowsToo) {
  for (const int rows : {1, 2, 3}) {
    batch_.clear();
    push_dopplers(rows, rows);
    (void)expect_shared(static_cast<std::size_t>(rows));
    EXPECT_GT((information(batch_) - expected_information()).norm(),
              0.01 * expected_information().norm());
  }
}

TEST_F(SharedRateNoise, LeavesLandmarksAsTheyAre) {
  for (const int dopplers : {0, 1, 3, 9}) {
    batch_.clear();
    push_landmark();
    push_landmark();
    push_dopplers(dopplers, 3);
    const auto count = static_cast<std::size_t>(std::min(dopplers, 3));
    const std::vector<LinearRow> landmarks = expect_shared(8 + count);
    ASSERT_EQ(landmarks.size(), 8U);
    for (std::size_t i = 0; i < 8; ++i) {
      EXPECT_EQ(landmarks[i].h, batch_.rows()[i].h);
      EXPECT_EQ(landmarks[i].residual, batch_.rows()[i].residual);
      EXPECT_EQ(landmarks[i].variance, batch_.rows()[i].variance);
    }
  }
}

// A distance or another sensor's value does not depend on the rate.
TEST_F(SharedRateNoise, LeavesRowsWithoutARateAsInformativeAsTheyAre) {
  push_alike(3, 3);
  const MatrixXd expected = information(batch_);
  RowCompression compression(batch_.capacity());
  const MatrixXd out = information(compression.compress(batch_, kRateVariance));
  EXPECT_LE((out - expected).cwiseAbs().maxCoeff(), 1e-12 * expected.norm());
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
