// SPDX-License-Identifier: BSD-3-Clause
// The prior of the sliding window: its derivatives against differences of its own cost, and where
// it is looked at from. prior_forgets_test.cpp: what leaves it. prior_in_flight_test.cpp: that it
// never learns what cannot be observed.
#include "rio/smoother/prior.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "smoother/prior_case.hpp"

namespace rio::test {
namespace {

TEST_F(PriorTest, VectorIsTheSlopeOfTheCost) {
  const MatrixXd A = random_information();
  const VectorXd g = random_vector(kSize);
  Prior prior = made_of(A, g);
  const Point now = later();
  NormalEquations system = now.system();
  (void)now.cost(&prior, &system);
  const VectorXd expected = -now.slope(&prior);
  expect_close(system.g(), expected, 1e-7);
}

TEST_F(PriorTest, InformationFollowsTheChangeOfTheError) {
  // with A = 0 and g = e_i the cost is minus an element of xi, in the axes of the point where the
  // prior was made; the slopes of all of them are (E4)
  const MatrixXd A = random_information();
  Prior prior = made_of(A, VectorXd::Zero(kSize));
  std::vector<Prior> elements;
  for (int i = 0; i < kSize; ++i) {
    elements.push_back(made_of(MatrixXd::Zero(kSize, kSize), VectorXd::Unit(kSize, i)));
  }
  const Point now = later();
  MatrixXd M(kSize, now.unknowns());
  for (int i = 0; i < kSize; ++i) {
    M.row(i) = -now.slope(&elements[static_cast<std::size_t>(i)]).transpose();
  }
  NormalEquations system = now.system();
  (void)now.cost(&prior, &system);
  const MatrixXd H = MatrixXd(system.H()).selfadjointView<Eigen::Lower>();
  const MatrixXd expected = M.transpose() * A * M;
  expect_close(H, expected, 1e-7);
}

TEST_F(PriorTest, IsWhatItWasMadeOfWhereItWasMade) {
  const MatrixXd A = random_information();
  const VectorXd g = random_vector(kSize);
  Prior prior = made_of(A, g);
  NormalEquations system = made_.system();
  EXPECT_EQ(made_.cost(&prior, &system), 0.0);
  MatrixXd expected = MatrixXd::Zero(system.size(), system.size());
  const int states = body::kSize * kLeading;
  const int at = body::kSize * kStates;
  expected.topLeftCorner(states, states) = A.topLeftCorner(states, states);
  expected.block(at, 0, made_.border(), states) = A.bottomLeftCorner(made_.border(), states);
  expected.bottomRightCorner(made_.border(), made_.border()) =
      A.bottomRightCorner(made_.border(), made_.border());
  const MatrixXd H = MatrixXd(system.H()).triangularView<Eigen::Lower>();
  const MatrixXd lower = expected.triangularView<Eigen::Lower>();
  expect_close(H, lower, 1e-12);
  expect_close(system.g().head(states), g.head(states), 1e-12);
}

TEST_F(PriorTest, TheErrorsOfTheInvariantAxesAreNotSeenWhereverTheWindowIsMoved) {
  // a prior blind for a translation and a turn about gravity costs the same when the window is
  // translated and turned as a whole: (E1) (E2)
  const MatrixXd A = random_information();
  MatrixXd N = MatrixXd::Zero(kSize, 4);  // in the standard error: as in observability_test.cpp
  const Vector3d z = Vector3d::UnitZ();
  for (int s = 0; s < kLeading; ++s) {
    const NavState& nav = made_.window[static_cast<std::size_t>(s)].nav;
    const int at = body::kSize * s;
    N.block<3, 1>(at + body::kAttitude, 3) = nav.q_WB.conjugate() * z;
    N.block<3, 1>(at + body::kPosition, 3) = z.cross(nav.p_WB);
    N.block<3, 1>(at + body::kVelocity, 3) = z.cross(nav.v_WB);
    N.block<3, 3>(at + body::kPosition, 0).setIdentity();
  }
  for (int i = 0; i < kKnown; ++i) {
    N.block<3, 1>(landmark(i), 3) = z.cross(made_.x.landmarks[static_cast<std::size_t>(i)].p_W);
    N.block<3, 3>(landmark(i), 0).setIdentity();
  }
  const MatrixXd NtN = N.transpose() * N;
  const MatrixXd N_NtN = N * NtN.inverse();
  MatrixXd project = MatrixXd::Identity(kSize, kSize);
  project -= N_NtN * N.transpose();
  const MatrixXd half = project * A;
  Prior prior = made_of(half * project, project * random_vector(kSize));
  Point now = made_.moved(0.3 * random_vector(made_.unknowns()));  // anywhere
  NormalEquations system = now.system();
  const double before = now.cost(&prior, &system);
  const Quaternion turn = rotation_of(Vector3d(0.0, 0.0, 1.3));
  const Vector3d shift(3.0, -2.0, 1.0);
  for (int s = 0; s < kStates; ++s) {
    NavState& nav = now.window[static_cast<std::size_t>(s)].nav;
    nav.q_WB = turn * nav.q_WB;
    nav.p_WB = turn * nav.p_WB + shift;
    nav.v_WB = turn * nav.v_WB;
  }
  for (LandmarkState& l : now.x.landmarks) l.p_W = turn * l.p_W + shift;
  EXPECT_GT(std::abs(before), 1.0);
  EXPECT_NEAR(now.cost(&prior, &system), before, 1e-9 * std::abs(before));
}

}  // namespace
}  // namespace rio::test
