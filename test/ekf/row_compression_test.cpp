// SPDX-License-Identifier: BSD-3-Clause
// Rows that are summed up: the information of the batch stays, its length does not.
#include "rio/ekf/row_compression.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/covariance_case.hpp"

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
    return dense_rows(batch.rows(), covariance_.size()).information();
  }
  void expect_same_information(std::size_t rows) {
    const RowBatch& out = compression_.compress(batch_, 0.0);
    EXPECT_EQ(out.rows().size(), rows);
    const MatrixXd expected = information(batch_);
    EXPECT_LE((information(out) - expected).cwiseAbs().maxCoeff(), 1e-12 * expected.norm());
  }

  RowBatch batch_{100};
  RowCompression compression_{100};
};

struct Alike {
  int rows;
  int directions;
  std::size_t expected;  ///< rows that are left
};

TEST_F(RowCompressionTest, ARunIsAsManyRowsAsItHasFewDirections) {
  for (const Alike& run : {Alike{18, 3, 3}, Alike{9, 1, 1}, Alike{9, 7, 9}, Alike{0, 1, 0}}) {
    SCOPED_TRACE(run.directions);
    batch_.clear();
    push_alike(run.rows, run.directions);
    expect_same_information(run.expected);
  }
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
  /// H^T R^-1 [H r] with R = diag + s G G^T, G of the blocks of one row. The same information is
  /// the same update.
  MatrixXd expected_information() const {
    DenseRows d = dense_rows(batch_.rows(), covariance_.size());
    MatrixXd G = d.H.middleCols<3>(body::kGyroBias);
    for (const RowBlock& block : batch_.blocks()) {
      if (block.count == 1) continue;
      G.middleRows(static_cast<Eigen::Index>(block.first), static_cast<Eigen::Index>(block.count))
          .setZero();
    }
    d.R += kRateVariance * G * G.transpose();
    return d.information();
  }
  const RowBatch& expect_shared(std::size_t rows) {
    const RowBatch& out = compression_.compress(batch_, kRateVariance);
    EXPECT_EQ(out.rows().size(), rows);
    const MatrixXd expected = expected_information();
    EXPECT_LE((information(out) - expected).cwiseAbs().maxCoeff(), 1e-9 * expected.norm());
    return out;
  }
};

TEST_F(SharedRateNoise, IsThatOfTheDenseCovariance) {
  for (const Alike& run : {Alike{18, 1, 1}, Alike{18, 2, 2}, Alike{18, 3, 3}, Alike{1, 1, 1},
                           Alike{2, 2, 2}, Alike{3, 3, 3}}) {
    batch_.clear();
    push_dopplers(run.rows, run.directions);
    expect_shared(run.expected);
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
    const RowBatch& out = expect_shared(8 + static_cast<std::size_t>(std::min(dopplers, 3)));
    std::size_t i = 0;
    for (const RowBlock& block : out.blocks()) {
      for (std::size_t k = 0; block.count > 1 && k < block.count; ++k, ++i) {
        const LinearRow& row = out.rows()[block.first + k];
        EXPECT_EQ(row.h, batch_.rows()[i].h);
        EXPECT_EQ(row.residual, batch_.rows()[i].residual);
        EXPECT_EQ(row.variance, batch_.rows()[i].variance);
      }
    }
    EXPECT_EQ(i, 8U);
  }
}

// A distance or another sensor's value does not depend on the rate.
TEST_F(SharedRateNoise, LeavesRowsWithoutARateAsInformativeAsTheyAre) {
  push_alike(3, 3);
  const MatrixXd expected = information(batch_);
  const MatrixXd out = information(compression_.compress(batch_, kRateVariance));
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
    EXPECT_EQ(compression_.compress(batch_, 0.0).rows().size(), 9U);
  }
}

}  // namespace
}  // namespace rio::test
