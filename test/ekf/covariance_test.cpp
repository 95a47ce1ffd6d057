// SPDX-License-Identifier: BSD-3-Clause
// Every operation on P against the same operation written with dense matrices.
#include "rio/ekf/covariance.hpp"

#include <gtest/gtest.h>

#include "rio/sim/random.hpp"

namespace rio::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd random_matrix(sim::Random& random, Eigen::Index rows, Eigen::Index cols) {
  MatrixXd m(rows, cols);
  for (Eigen::Index c = 0; c < cols; ++c) {
    for (Eigen::Index r = 0; r < rows; ++r) m(r, c) = random.normal();
  }
  return m;
}

/// A state with clones, landmarks and extrinsics, and dense cross-covariances everywhere.
class CovarianceTest : public testing::Test {
 protected:
  CovarianceTest() : layout_(options()), covariance_(layout_) {
    const MatrixXd A = 0.1 * random_matrix(random_, 15, 15);
    covariance_.reset(BodyCovariance(A * A.transpose()), options());
    for (int scan = 0; scan < 5; ++scan) {  // more scans than clones
      covariance_.propagate(random_transition(), noise());
      covariance_.clone_body_pose(scan % 3);
      if (scan >= 3) {
        covariance_.add_landmark(scan - 3, random_matrix(random_, 3, 6),
                                 random_matrix(random_, 3, 6), 0.01 * Matrix3d::Identity());
      }
    }
    covariance_.propagate(random_transition(), noise());
  }

  static UpdateOptions options() {
    UpdateOptions o;
    o.max_clones = 3;
    o.max_landmarks = 4;
    return o;
  }
  Matrix15d random_transition() {
    return Matrix15d::Identity() + 0.1 * random_matrix(random_, 15, 15);
  }
  static Matrix15d noise() { return 1e-3 * Matrix15d::Identity(); }
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
  covariance_.reopen_velocity(7.0, 0.2);
  expect_equal(expected, 1e-12);
}

TEST_F(CovarianceTest, CloneIsAnExactCopyOfTheBodyPose) {
  covariance_.clone_body_pose(1);
  const int at = layout_.clone(1);
  EXPECT_EQ(dense().middleRows(at, 6), dense().topRows(6));
  EXPECT_EQ(dense().block(at, at, 6, 6), dense().topLeftCorner(6, 6));
  expect_equal(dense(), 0.0);
}

TEST_F(CovarianceTest, LandmarkEntersWithItsCorrelations) {
  const MatrixXd H_body = random_matrix(random_, 3, 6);
  const MatrixXd H_extrinsics = random_matrix(random_, 3, 6);
  const Matrix3d noise = Vector3d(0.1, 0.2, 0.3).asDiagonal();
  const int n = covariance_.size();
  MatrixXd H = MatrixXd::Zero(n + 3, n);
  H.topRows(n).setIdentity();
  H.block(n, 0, 3, 6) = H_body;
  H.block(n, layout_.extrinsics(), 3, 6) = H_extrinsics;
  MatrixXd expected = H * dense() * H.transpose();
  expected.bottomRightCorner(3, 3) += noise;
  covariance_.add_landmark(2, H_body, H_extrinsics, noise);
  expect_equal(expected, 1e-12);
}

TEST_F(CovarianceTest, LandmarkRelativeToTheRadarEqualsTheDenseProduct) {
  const auto d_body = random_matrix(random_, 3, 6);
  const auto d_extrinsics = random_matrix(random_, 3, 6);
  const auto d_landmark = random_matrix(random_, 3, 3);
  MatrixXd J = MatrixXd::Zero(3, covariance_.size());
  J.middleCols(body::kAttitude, 6) = d_body;
  J.middleCols(layout_.extrinsics(), 6) = d_extrinsics;
  J.middleCols(layout_.landmark(1), 3) = d_landmark;
  const MatrixXd expected = J * dense() * J.transpose();
  const Matrix3d actual = covariance_.landmark_in_radar(1, d_body, d_extrinsics, d_landmark);
  EXPECT_LE((actual - expected).cwiseAbs().maxCoeff(), 1e-12 * expected.norm());
}

TEST_F(CovarianceTest, LandmarkNoiseReachesLandmarksOnly) {
  MatrixXd expected = dense();
  expected.diagonal().tail(6).array() += 0.25;
  covariance_.add_landmark_noise(0.25);
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

/// Rows as a model with a body, a clone and a velocity block would produce.
struct FakeModel {
  static constexpr int kDim = 1;
  using Blocks = BlockList<BodyPose, ClonePose, BodyVelocity>;
};

/// Blocks of rows with their dense equivalent.
struct DenseRows {
  MatrixXd H;
  MatrixXd R;
  VectorXd r;
};

DenseRows fill(sim::Random& random, const Layout& layout, int n,
               const std::vector<int>& block_sizes, RowBatch* batch) {
  int rows = 0;
  for (const int size : block_sizes) rows += size;
  DenseRows d{MatrixXd::Zero(rows, n), MatrixXd::Zero(rows, rows), VectorXd::Zero(rows)};
  int at = 0;
  for (const int size : block_sizes) {
    const double shared = size > 1 ? 0.3 : 0.0;
    batch->begin_block();
    batch->share_variance(shared);
    for (int i = 0; i < size; ++i) {
      const int clone = i % layout.max_clones();
      Evaluation<FakeModel> e;
      e.J = random_matrix(random, 1, FakeModel::Blocks::kDof);
      e.r[0] = random.normal();
      e.R(0, 0) = 0.5 + random.uniform();
      batch->push(e, FakeModel::Blocks{}, {0, layout.clone(clone), body::kVelocity});
      d.H.block(at + i, 0, 1, 6) = e.J.segment<6>(0);
      d.H.block(at + i, layout.clone(clone), 1, 6) = e.J.segment<6>(6);
      d.H.block(at + i, body::kVelocity, 1, 3) = e.J.segment<3>(12);
      d.r[at + i] = e.r[0];
      d.R.block(at, at + i, size, 1).setConstant(shared);
    }
    for (int i = 0; i < size; ++i, ++at) {
      d.R(at, at) = batch->rows()[static_cast<std::size_t>(at)].variance;
    }
  }
  return d;
}

TEST_F(CovarianceTest, PanelUpdateEqualsTheBatchJosephUpdate) {
  RowBatch batch(100);
  // blocks of several sizes over three panels, one of which does not fill its panel
  const DenseRows d =
      fill(random_, layout_, covariance_.size(), {1, 7, 1, 3, 20, 6, 1, 1, 18, 9, 2}, &batch);
  const MatrixXd P = dense();
  const MatrixXd S = d.H * P * d.H.transpose() + d.R;
  const MatrixXd K = S.llt().solve(d.H * P).transpose();
  const MatrixXd A = MatrixXd::Identity(P.rows(), P.rows()) - K * d.H;
  VectorXd dx(layout_.capacity());
  ASSERT_TRUE(covariance_.update(batch, &dx));
  EXPECT_LT((dx.head(P.rows()) - K * d.r).cwiseAbs().maxCoeff(), 1e-9);
  expect_equal(A * P * A.transpose() + K * d.R * K.transpose(), 1e-9);
}

TEST_F(CovarianceTest, InnovationCovarianceOfABlock) {
  RowBatch batch(10);
  const DenseRows d = fill(random_, layout_, covariance_.size(), {5}, &batch);
  Covariance::BlockMatrix S;
  covariance_.innovation_covariance(batch, batch.blocks()[0], &S);
  EXPECT_LT((S - (d.H * dense() * d.H.transpose() + d.R)).cwiseAbs().maxCoeff(), 1e-11);
}

TEST_F(CovarianceTest, FailedUpdateChangesNothing) {
  const MatrixXd before = dense();
  VectorXd dx(layout_.capacity());
  for (const double bad_variance : {-1e3, std::nan("")}) {
    RowBatch batch(80);
    fill(random_, layout_, covariance_.size(), {20, 20}, &batch);  // the first panel succeeds
    Evaluation<FakeModel> e;
    e.J.setOnes();
    e.r[0] = 1.0;
    e.R(0, 0) = bad_variance;
    batch.begin_block();
    batch.push(e, FakeModel::Blocks{}, {0, layout_.clone(0), body::kVelocity});
    EXPECT_FALSE(covariance_.update(batch, &dx));
    EXPECT_EQ(dense(), before);
  }
}

TEST_F(CovarianceTest, EmptyUpdateIsNoUpdate) {
  const MatrixXd before = dense();
  VectorXd dx = VectorXd::Ones(layout_.capacity());
  EXPECT_TRUE(covariance_.update(RowBatch(1), &dx));
  EXPECT_EQ(dense(), before);
  EXPECT_EQ(dx.head(covariance_.size()).norm(), 0.0);
}

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

TEST_F(CovarianceTest, ReexpressionMovesTheUnobservableDirectionsAlong) {
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
  UpdateOptions o = options();
  c.reset(P0, o);
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
    c.clone_body_pose(i);
    c.propagate(F.inverse(), Matrix15d::Zero());
  }
  for (int i = 0; i < 2; ++i) {
    const Vector3d l = x.before.landmarks[static_cast<std::size_t>(i)].p_W;
    Eigen::Matrix<double, 3, 6> H;
    H << -body.R * skew(body.R.transpose() * (l - body.p)), Matrix3d::Identity();
    c.add_landmark(i, H, Eigen::Matrix<double, 3, 6>::Zero(), Matrix3d::Zero());
  }
  const auto without_extrinsics = [&](MatrixXd m) {
    m.middleRows(layout_.extrinsics(), 6).setZero();
    m.middleCols(layout_.extrinsics(), 6).setZero();
    return m;
  };
  ASSERT_LT((without_extrinsics(c.matrix()) - before * before.transpose()).cwiseAbs().maxCoeff(),
            1e-10);
  c.reexpress(x.before, x.after);
  EXPECT_LT((without_extrinsics(c.matrix()) - after * after.transpose()).cwiseAbs().maxCoeff(),
            1e-10);
}

TEST_F(CovarianceTest, ReexpressionKeepsTheRightInvariantError) {
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
  covariance_.reexpress(x.before, x.after);
  const MatrixXd after = invariant_map(x.after) * dense() * invariant_map(x.after).transpose();
  EXPECT_LT((before - after).cwiseAbs().maxCoeff(), 1e-10 * before.cwiseAbs().maxCoeff());
  expect_equal(dense(), 0.0);
}

}  // namespace
}  // namespace rio::test
