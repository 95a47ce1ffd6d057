// SPDX-License-Identifier: BSD-3-Clause
// Re-expression of the covariance after a correction keeps the covariance of the invariant error,
// in which the unobservable directions do not depend on the estimate (observability_test.cpp).
#include "rio/ekf/reexpression.hpp"

#include <gtest/gtest.h>

#include "rio/core/so3.hpp"
#include "rio/core/symmetric.hpp"
#include "support/covariance_case.hpp"

namespace rio::test {
namespace {

using ReexpressionTest = CovarianceCase;

/// Estimates before and after some correction, matching CovarianceTest's state.
struct CorrectedEstimate {
  explicit CorrectedEstimate(sim::Random& random) {
    const auto pose = [&] { return RigidPose(gamma(0, random.normal3()), 3.0 * random.normal3()); };
    const auto vary = [&](const RigidPose& x) {
      return RigidPose(x.R * gamma(0, 0.3 * random.normal3()), x.p + random.normal3());
    };
    before.nav.q_WB = quaternion_exp(random.normal3());
    before.nav.p_WB = random.normal3();
    before.nav.v_WB = random.normal3();
    for (std::size_t i = 0; i < 3; ++i) before.clones.push_back({i, pose()});
    for (int i = 0; i < 2; ++i) before.landmarks.push_back(LandmarkState{random.normal3()});
    after = before;
    after.nav.q_WB = before.nav.q_WB * quaternion_exp(0.3 * random.normal3());
    after.nav.p_WB += random.normal3();
    after.nav.v_WB += random.normal3();
    for (Clone& clone : after.clones) clone.T_WB = vary(clone.T_WB);
    for (LandmarkState& landmark : after.landmarks) landmark.p_W += random.normal3();
  }
  Estimate before;
  Estimate after;
};

TEST_F(ReexpressionTest, ReexpressionKeepsTheRightInvariantError) {
  // phi = R theta and eta = dp + [p] phi, written as a dense map of the error, must have one
  // covariance
  const CorrectedEstimate x(random_);
  const auto invariant_map = [&](const Estimate& e) {
    MatrixXd T = MatrixXd::Identity(covariance_.size(), covariance_.size());
    const Matrix3d R = e.nav.q_WB.toRotationMatrix();
    T.block<3, 3>(0, 0) = R;
    T.block<3, 3>(body::kPosition, 0) = skew(e.nav.p_WB) * R;
    T.block<3, 3>(body::kVelocity, 0) = skew(e.nav.v_WB) * R;
    for (std::size_t i = 0; i < e.clones.size(); ++i) {
      const int at = layout_.clone(static_cast<int>(i));
      T.block<3, 3>(at, at) = e.clones[i].T_WB.R;
      T.block<3, 3>(at + 3, at) = skew(e.clones[i].T_WB.p) * e.clones[i].T_WB.R;
    }
    for (std::size_t i = 0; i < e.landmarks.size(); ++i) {
      T.block<3, 3>(layout_.landmark(static_cast<int>(i)), 0) = skew(e.landmarks[i].p_W) * R;
    }
    return T;
  };
  const MatrixXd before = invariant_map(x.before) * dense() * invariant_map(x.before).transpose();
  Reexpression(layout_.capacity()).apply(layout_, x.before, x.after, &covariance_);
  mirror_lower(covariance_.matrix());
  const MatrixXd after = invariant_map(x.after) * dense() * invariant_map(x.after).transpose();
  EXPECT_LT((before - after).cwiseAbs().maxCoeff(), 1e-10 * before.cwiseAbs().maxCoeff());
}

}  // namespace
}  // namespace rio::test
