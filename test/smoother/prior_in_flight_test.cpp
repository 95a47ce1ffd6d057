// SPDX-License-Identifier: BSD-3-Clause
// The prior of the sliding window in flight: it must never learn what cannot be observed, a turn of
// everything about gravity and a translation; and as thousands of states are marginalised into one
// matrix, one after the other, rounding must not add up in it. In the error of prior.hpp the
// unobservable directions do not depend on the state: heading, and all points by the same vector.
// The condition is that of the rest.
// (E1) C = D^-1/2 B^T A B D^-1/2, D the diagonal of B^T A B; B takes all unknowns but heading and
//      position of state 0, which stay where they are, and landmarks of which A knows nothing
#include "rio/smoother/prior.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "support/scanwise_flight.hpp"
#include "support/symmetric.hpp"

namespace rio::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A scan each third of a second, to save time: 3600 of them.
sim::Scenario long_flight() {
  return {.seed = 51, .path = {.length = 0.0, .duration = 1200.0}, .radar = {.rate_hz = 3.0}};
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
  return (x.p_WB - flight.flight().truth_at(x.time).p_WB).norm();
}

/// Beyond this the factorisation loses digits of the solution: 1e-16 times it is some 1e-13.
constexpr double kWellConditioned = 1e3;

TEST(PriorInFlight, ConditionDoesNotGetWorseInTwentyMinutes) {
  SmootherFlight flight(long_flight());
  Options options = flight.options();
  options.update.max_landmarks = 20;  // to save time
  flight.begin(options);
  double first = 0.0;  // worst condition until the fifth minute, the first one left out
  double later = 0.0;
  while (!flight.over()) {
    ASSERT_EQ(flight.step(), Status::kOk);
    if (flight.next() % 60 != 0) continue;
    const MatrixXd A = flight.back_end().prior().A();
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
    // dead reckoning over 900 m, a fifth of the usual scans: 0.2 % of the way
    EXPECT_LT(position_error(flight), 2.0) << "scan " << flight.next();
  }
  EXPECT_LT(later, 3.0 * first);  // which landmarks are in view makes a factor of two
}

/// Translations and the turn about gravity in xi: the same vector at every state.
MatrixXd null_space(const Prior& prior, int calibration) {
  const Eigen::Index n = prior.A().rows();
  MatrixXd N = MatrixXd::Zero(n, 4);
  const int states = body::kSize * prior.leading_states();
  for (int at = 0; at < states; at += body::kSize) {
    N(at + body::kAttitude + 2, 3) = 1.0;
    N.block<3, 3>(at + body::kPosition, 0).setIdentity();
  }
  for (Eigen::Index at = states + calibration; at < n; at += 3) {
    N.block<3, 3>(at, 0).setIdentity();
  }
  return N;
}

TEST(PriorInFlight, NeverLearnsPositionAndHeading) {
  constexpr double kPositionSigma = 10.0;  // all that is ever told of them
  constexpr double kYawSigma = 1.0;
  SmootherFlight flight({.seed = 31, .path = {.length = 110.0}});  // some three minutes
  const Options o = flight.options();
  flight.begin(o);
  BodyCovariance P0 = flight.start_covariance();
  P0.diagonal().segment<3>(body::kPosition).setConstant(kPositionSigma * kPositionSigma);
  // the start is level and at the origin of the errors' axes: yaw is the third angle
  NavState start = flight.flight().truth.front();
  start.p_WB.setZero();
  const Vector3d up = start.q_WB.conjugate() * Vector3d::UnitZ();
  P0.block<3, 3>(0, 0) += kYawSigma * kYawSigma * up * up.transpose();
  flight.pipeline().reset(start, P0);
  const Eigen::Vector4d configured(std::pow(kPositionSigma, -2), std::pow(kPositionSigma, -2),
                                   std::pow(kPositionSigma, -2), std::pow(kYawSigma, -2));
  const int calibration = Layout(o.calibration, 0, 0).size(0) - body::kSize;
  while (!flight.over()) {
    ASSERT_EQ(flight.step(), Status::kOk);
    if (flight.next() % 150 != 0) continue;
    const Prior& prior = flight.back_end().prior();
    const MatrixXd A = prior.A();
    const MatrixXd N = null_space(prior, calibration);
    const Eigen::Vector4d learnt = (N.transpose() * A * N).diagonal();
    // round-off of sums of 1e8 (a position by the IMU over one scan) gives some 2e-7 per scan: in
    // three minutes as much as one fix with a sigma of 45 m, and less than one with 30 m
    for (int i = 0; i < 3; ++i)
      EXPECT_LE(learnt[i], configured[i] + std::pow(30.0, -2)) << flight.next();
    EXPECT_LE(learnt[3], 1.01 * configured[3]) << flight.next();
  }
}

}  // namespace
}  // namespace rio::test
