// SPDX-License-Identifier: BSD-3-Clause
// The panel-wise update against the batch update in Joseph form.
#include "rio/ekf/panel_update.hpp"

#include <gtest/gtest.h>

#include "rio/core/symmetric.hpp"
#include "support/covariance_case.hpp"
#include "support/symmetric.hpp"

namespace rio::test {
namespace {

using PanelUpdateTest = CovarianceCase;

TEST_F(PanelUpdateTest, PanelUpdateEqualsTheBatchJosephUpdate) {
  RowBatch batch(100);
  // blocks of several sizes over three panels, one of which does not fill its panel
  const DenseRows d =
      fill(random_, layout_, covariance_.size(), {1, 7, 1, 3, 20, 6, 1, 1, 18, 9, 2}, &batch);
  const MatrixXd P = dense();
  const MatrixXd S = d.H * P * d.H.transpose() + d.R;
  const MatrixXd K = solve(S, d.H * P).transpose();
  const MatrixXd A = MatrixXd::Identity(P.rows(), P.rows()) - K * d.H;
  VectorXd dx(layout_.capacity());
  PanelUpdate update(layout_.capacity());
  ASSERT_TRUE(update.apply(batch, &covariance_, &dx));
  mirror_lower(covariance_.matrix());
  EXPECT_LT((dx.head(P.rows()) - K * d.r).cwiseAbs().maxCoeff(), 1e-9);
  expect_equal(A * P * A.transpose() + K * d.R * K.transpose(), 1e-9);
}

TEST_F(PanelUpdateTest, FailedUpdateChangesNothing) {
  const MatrixXd before = dense();
  VectorXd dx(layout_.capacity());
  PanelUpdate update(layout_.capacity());
  for (const double bad_variance : {-1e3, std::nan("")}) {
    RowBatch batch(80);
    fill(random_, layout_, covariance_.size(), {20, 20}, &batch);  // the first panel succeeds
    auto bad = linear_rows<1>(Eigen::Matrix<double, 1, 6>::Ones(), BlockList<BodyPose>{}, {0},
                              Eigen::Matrix<double, 1, 1>::Zero(), -1);
    bad[0].residual = 1.0;
    bad[0].variance = bad_variance;
    batch.begin_block();
    batch.push(bad[0]);
    EXPECT_FALSE(update.apply(batch, &covariance_, &dx));
    EXPECT_EQ(dense(), before);
  }
}

TEST_F(PanelUpdateTest, EmptyUpdateIsNoUpdate) {
  const MatrixXd before = dense();
  VectorXd dx = VectorXd::Ones(layout_.capacity());
  PanelUpdate update(layout_.capacity());
  EXPECT_TRUE(update.apply(RowBatch(1), &covariance_, &dx));
  EXPECT_EQ(dense(), before);
  EXPECT_EQ(dx.head(covariance_.size()).norm(), 0.0);
}

}  // namespace
}  // namespace rio::test
