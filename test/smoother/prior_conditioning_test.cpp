// SPDX-License-Identifier: BSD-3-Clause
// The prior of the sliding window over twenty minutes: thousands of states are marginalised into
// one matrix, one after the other, and rounding must not add up in it.
//
// What is unobservable is left out: a turn of everything about gravity and a translation. Their
// information falls as the flight goes on, as it should. In the error of prior.hpp these are
// directions that do not depend on the state: heading, and all points by the same vector.
// (E1) C = D^-1/2 B^T A B D^-1/2, D the diagonal of B^T A B; B takes all unknowns but heading and
//      position of state 0, which stay where they are, and landmarks of which A knows nothing
#include "rio/smoother/prior.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <vector>

#include "support/smoother_flight.hpp"

namespace rio::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A scan each third of a second, to save time: 3600 of them.
sim::Scenario long_flight() {
  sim::Scenario scenario;
  scenario.seed = 51;
  scenario.path.length = 0.0;
  scenario.path.duration = 1200.0;
  scenario.radar.rate_hz = 3.0;
  return scenario;
}

VectorXd eigenvalues(const MatrixXd& A) {
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(A, Eigen::EigenvaluesOnly).eigenvalues();
}

/// (E1)
MatrixXd scaled(const MatrixXd& A) {
  constexpr int kHeading = body::kAttitude + 2;
  std::vector<int> kept;
  for (int i = 0; i < A.rows(); ++i) {
    const bool unobservable = i == kHeading || (i >= body::kPosition && i < body::kPosition + 3);
    if (!unobservable && A(i, i) > 0.0) kept.push_back(i);
  }
  const MatrixXd B = A(kept, kept);
  const VectorXd scale = B.diagonal().cwiseSqrt().cwiseInverse();
  return scale.asDiagonal() * B * scale.asDiagonal();
}

double position_error(const SmootherFlight& flight) {
  const NavState& x = flight.estimate().nav;
  const std::vector<NavState>& truth = flight.flight().truth;
  const auto at = std::lower_bound(truth.begin(), truth.end() - 1, x.time,
                                   [](const NavState& s, Time t) { return s.time < t; });
  return (x.p_WB - at->p_WB).norm();
}

/// Beyond this the factorisation loses digits of the solution: 1e-16 times it is some 1e-13.
constexpr double kWellConditioned = 1e3;

TEST(PriorConditioning, DoesNotGetWorseInTwentyMinutes) {
  SmootherFlight flight(long_flight());
  Options options = flight.options();
  options.update.max_landmarks = 20;  // to save time
  flight.begin(options);
  double first = 0.0;  // worst condition until the fifth minute, the first one left out
  double later = 0.0;
  while (!flight.over()) {
    ASSERT_EQ(flight.step(), Status::kOk);
    if (flight.next() % 60 != 0) continue;
    const MatrixXd A = flight.smoother().prior().A();
    EXPECT_EQ(A, A.transpose());
    const VectorXd all = eigenvalues(A);
    // zero for a landmark of which nothing is known; round-off: 1e-16 of 1e10, an exact calibration
    EXPECT_GE(all[0], -1e-5) << "scan " << flight.next();
    const VectorXd known = eigenvalues(scaled(A));
    ASSERT_GT(known[0], 0.0) << "scan " << flight.next();
    const double condition = known[known.size() - 1] / known[0];
    EXPECT_LT(condition, kWellConditioned);
    double& worst = flight.next() <= 900 ? first : later;
    if (flight.next() > 180) worst = std::max(worst, condition);
    // dead reckoning over 900 m: 0.3 % of the way at this scan rate would be 3 m
    EXPECT_LT(position_error(flight), 2.0) << "scan " << flight.next();
  }
  EXPECT_LT(later, 3.0 * first);  // which landmarks are in view makes a factor of two
}

}  // namespace
}  // namespace rio::test
