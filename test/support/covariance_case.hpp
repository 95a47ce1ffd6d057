// SPDX-License-Identifier: BSD-3-Clause
// A covariance with clones, landmarks, calibration and dense cross-covariances everywhere, and
// dense matrices to compare with.
#pragma once

#include <gtest/gtest.h>

#include "rio/state/calibration.hpp"
#include "rio/update/covariance.hpp"
#include "support/dense_rows.hpp"

namespace rio::test {

class CovarianceCase : public testing::Test {
 protected:
  CovarianceCase() : layout_(calibration(), 3, 4), covariance_(layout_) {
    const MatrixXd A = 0.1 * random_matrix(random_, 15, 15);
    covariance_.reset(BodyCovariance(A * A.transpose()),
                      parameter_noise(layout_, calibration()).prior);
    for (int scan = 0; scan < 5; ++scan) {  // more scans than clones
      covariance_.propagate(random_transition(), noise());
      covariance_.assign_clone(scan % 3, clone_rows());
      if (scan >= 3) {
        covariance_.add_landmark(scan - 3, landmark_rows(), 0.01 * Matrix3d::Identity());
      }
    }
    covariance_.propagate(random_transition(), noise());
  }

  static CalibrationOptions calibration() { return {0.05, 0.03, 0.02, 0.02, 0.03}; }
  /// Of all but the biases, which stay what they are.
  Matrix15d random_transition() {
    Matrix15d phi = Matrix15d::Identity();
    phi.topRows<body::kGyroBias>() += 0.1 * random_matrix(random_, body::kGyroBias, 15);
    return phi;
  }
  static Matrix15d noise() { return 1e-3 * Matrix15d::Identity(); }
  /// The body's pose, early by the time offset.
  std::array<LinearRow, 6> clone_rows() {
    return linear_rows<6>(Eigen::Matrix<double, 6, 6>::Identity(), BlockList<BodyPose>{},
                          {body::kAttitude}, random_matrix(random_, 6, 1), layout_.time_offset());
  }
  std::array<LinearRow, 3> landmark_rows() {
    return linear_rows<3>(random_matrix(random_, 3, 13),
                          BlockList<BodyPose, Extrinsics, DopplerScale>{},
                          {body::kAttitude, layout_.extrinsics(), layout_.doppler_scale()},
                          random_matrix(random_, 3, 1), layout_.time_offset());
  }
  MatrixXd dense() const { return covariance_.matrix(); }
  void expect_equal(const MatrixXd& expected, double tolerance) const {
    ASSERT_EQ(expected.rows(), covariance_.size());
    EXPECT_LE((covariance_.matrix() - expected).cwiseAbs().maxCoeff(),
              tolerance * std::max(1.0, expected.cwiseAbs().maxCoeff()));
    EXPECT_EQ(dense(), dense().transpose());
  }

  sim::Random random_{31};
  Layout layout_;
  Covariance covariance_;
};

/// Rows as a model with a body, a clone and a velocity block would produce.
inline DenseRows fill(sim::Random& random, const Layout& layout, int n,
                      const std::vector<int>& block_sizes, RowBatch* batch) {
  const std::size_t first = batch->rows().size();
  for (const int size : block_sizes) {
    batch->begin_block();
    for (int i = 0; i < size; ++i) {
      LinearRow row = linear_rows<1>(random_matrix(random, 1, 15),
                                     BlockList<BodyPose, ClonePose, BodyVelocity>{},
                                     {0, layout.clone(i % layout.max_clones()), body::kVelocity},
                                     random_matrix(random, 1, 1), layout.time_offset())[0];
      row.residual = random.normal();
      row.variance = 0.5 + random.uniform();
      batch->push(row);
    }
  }
  return dense_rows(std::span(batch->rows()).subspan(first), n);
}

}  // namespace rio::test
