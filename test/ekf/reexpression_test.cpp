// SPDX-License-Identifier: BSD-3-Clause
// Re-expression of the covariance after a correction: invariant errors and the null space.
#include "rio/ekf/reexpression.hpp"

#include <gtest/gtest.h>

#include "rio/core/mirror.hpp"
#include "rio/core/so3.hpp"
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

/// The unobservable directions at x: translation along, and rotation about, the world's axes. The
/// rotation about z is the heading.
MatrixXd null_space(const Layout& layout, const Estimate& x) {
  MatrixXd N = MatrixXd::Zero(layout.size(static_cast<int>(x.landmarks.size())), 4);
  const Vector3d z = Vector3d::UnitZ();
  const auto pose = [&](int at, const Matrix3d& R, const Vector3d& p) {
    N.block<3, 1>(at, 3) = R.transpose() * z;
    N.block<3, 1>(at + 3, 3) = z.cross(p);
    N.block<3, 3>(at + 3, 0).setIdentity();
  };
  pose(0, x.nav.q_WB.toRotationMatrix(), x.nav.p_WB);
  N.block<3, 1>(body::kVelocity, 3) = z.cross(x.nav.v_WB);
  for (std::size_t i = 0; i < x.clones.size(); ++i) {
    pose(layout.clone(static_cast<int>(i)), x.clones[i].T_WB.R, x.clones[i].T_WB.p);
  }
  for (std::size_t i = 0; i < x.landmarks.size(); ++i) {
    const int at = layout.landmark(static_cast<int>(i));
    N.block<3, 1>(at, 3) = z.cross(x.landmarks[i].p_W);
    N.block<3, 3>(at, 0).setIdentity();
  }
  return N;
}

TEST_F(ReexpressionTest, ReexpressionMovesTheUnobservableDirectionsAlong) {
  // a P that consists of nothing but the four unobservable directions at the old estimate must
  // consist of those at the new one afterwards: no yaw or position information has come from
  // nowhere
  const CorrectedEstimate x(random_);
  const MatrixXd before = null_space(layout_, x.before);
  const MatrixXd after = null_space(layout_, x.after);
  // bring P to that form: a huge prior along the null space swamps the rest
  Covariance c(layout_);
  BodyCovariance P0 = BodyCovariance::Zero();
  P0 = before.topRows(15) * before.topRows(15).transpose();
  c.reset(P0, parameter_noise(layout_, calibration()).prior);
  // clones and landmarks as exact functions of the body's null direction
  const auto relative = [](const RigidPose& body, const RigidPose& clone) {
    return RigidPose(body.R.transpose() * clone.R, body.R.transpose() * (clone.p - body.p));
  };
  const RigidPose body = x.before.T_WB();
  for (int i = 0; i < 3; ++i) {
    // move the body to the clone's pose (exactly known relative motion), clone, and move back
    const RigidPose rel = relative(body, x.before.clones[static_cast<std::size_t>(i)].T_WB);
    Matrix15d F = Matrix15d::Identity();
    F.block<3, 3>(0, 0) = rel.R.transpose();
    F.block<3, 3>(3, 0) = -body.R * skew(rel.p);
    c.propagate(F, Matrix15d::Zero());
    c.assign_clone(i, linear_rows<6>(Eigen::Matrix<double, 6, 6>::Identity(), BlockList<BodyPose>{},
                                     {body::kAttitude}, Eigen::Matrix<double, 6, 1>::Zero(), -1));
    c.propagate(F.inverse(), Matrix15d::Zero());
  }
  for (int i = 0; i < 2; ++i) {
    const Vector3d l = x.before.landmarks[static_cast<std::size_t>(i)].p_W;
    Eigen::Matrix<double, 3, 6> H;
    H << -body.R * skew(body.R.transpose() * (l - body.p)), Matrix3d::Identity();
    c.add_landmark(
        i,
        linear_rows<3>(H, BlockList<BodyPose>{}, {body::kAttitude}, Vector3d(Vector3d::Zero()), -1),
        Matrix3d::Zero());
  }
  const auto without_calibration = [&](MatrixXd m) {
    const int count = layout_.clone(0) - layout_.extrinsics();
    m.middleRows(layout_.extrinsics(), count).setZero();
    m.middleCols(layout_.extrinsics(), count).setZero();
    return m;
  };
  ASSERT_LT((without_calibration(c.matrix()) - before * before.transpose()).cwiseAbs().maxCoeff(),
            1e-10);
  Reexpression(layout_.capacity()).apply(layout_, x.before, x.after, &c);
  mirror_lower(c.matrix());
  EXPECT_LT((without_calibration(c.matrix()) - after * after.transpose()).cwiseAbs().maxCoeff(),
            1e-10);
}

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
