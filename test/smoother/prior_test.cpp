// SPDX-License-Identifier: BSD-3-Clause
// The prior of the sliding window: its derivatives against differences of its own cost, the
// elimination of landmarks and what walks against dense matrices. prior_in_flight_test.cpp: that it
// never learns what cannot be observed.
#include "rio/smoother/prior.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <numeric>
#include <vector>

#include "rio/sim/random.hpp"
#include "rio/update/look_correlation.hpp"
#include "support/dense_rows.hpp"
#include "support/random_state.hpp"

namespace rio::test {
namespace {

constexpr int kStates = 3;  // of the window; the prior knows the first two
constexpr int kLeading = 2;
constexpr int kLandmarks = 4;  // of the window; the prior knows the first three
constexpr int kKnown = 3;

constexpr int kCalibration = 9;

CalibrationOptions calibration() {
  return {0.05, 0.03, 0.02, 0.02, 0.03, 0.04};
}

/// Unknowns, order [states | calibration | landmarks].
struct Point {
  Layout layout{calibration(), 0, kLandmarks};
  Window window{kStates, Options{}};
  Estimate x;

  int landmarks() const { return static_cast<int>(x.landmarks.size()); }
  int border() const { return kCalibration + 3 * landmarks(); }
  int unknowns() const { return body::kSize * kStates + border(); }

  Point moved(const VectorXd& e) const {
    Point out = *this;
    for (int s = 0; s < kStates; ++s) {
      NavState& nav = out.window[static_cast<std::size_t>(s)].nav;
      nav = perturbed(nav, e.segment<15>(body::kSize * s));
    }
    int at = body::kSize * kStates;
    out.x.T_BS.rotation = x.T_BS.rotation * rotation_of(e.segment<3>(at));
    out.x.T_BS.translation += e.segment<3>(at + 3);
    out.x.doppler_scale += e[at + 6];
    out.x.time_offset += e[at + 7];
    out.x.elevation_error += e[at + 8];
    at += kCalibration;
    for (LandmarkState& l : out.x.landmarks) {
      l.p_W += e.segment<3>(at);
      at += 3;
    }
    return out;
  }
  /// Of the prior alone; its system if wanted.
  double cost(Prior* prior, NormalEquations* system) const {
    system->clear(kStates, border());
    return prior->add_to(system, window, x);
  }
  NormalEquations system() const { return {kStates, border()}; }
  /// Central differences: error h^2 of the third derivative and 1e-16 / h of the cost.
  VectorXd slope(Prior* prior) const {
    constexpr double h = 1e-5;
    NormalEquations unused = system();
    VectorXd out(unknowns());
    for (int i = 0; i < unknowns(); ++i) {
      const VectorXd e = h * VectorXd::Unit(unknowns(), i);
      out[i] = (moved(e).cost(prior, &unused) - moved(-e).cost(prior, &unused)) / (2.0 * h);
    }
    return out;
  }
};

class PriorTest : public testing::Test {
 protected:
  PriorTest() {
    for (int s = 0; s < kStates; ++s) made_.window.push().nav = random_.state();
    made_.x.T_BS = {random_.rotation(), random_.normal_vector()};
    made_.x.doppler_scale = 0.01;
    made_.x.time_offset = 0.01;
    made_.x.elevation_error = 0.02;
    for (int i = 0; i < kKnown; ++i) made_.x.landmarks.push_back({random_.normal_vector(5.0)});
  }

  /// Of the prior, and the column of landmark i in it.
  static constexpr int kSize = body::kSize * kLeading + kCalibration + 3 * kKnown;
  static int landmark(int i) { return kSize - 3 * (kKnown - i); }

  Prior made_of(const MatrixXd& A, const VectorXd& g) const {
    Prior prior(made_.layout, kStates);
    prior.assign(A, g, made_.window, 0, kLeading, made_.x);
    return prior;
  }
  MatrixXd random_information(int n = kSize) {
    const MatrixXd L = random_matrix(numbers_, n, n);
    return L * L.transpose() + MatrixXd::Identity(n, n);
  }
  VectorXd random_vector(int n) { return random_matrix(numbers_, n, 1); }
  /// The states have moved far, and a landmark has come.
  Point later() {
    Point out = made_.moved(0.3 * random_vector(made_.unknowns()));
    out.x.landmarks.push_back({random_.normal_vector(5.0)});
    return out;
  }

  sim::Random numbers_{41};
  Random random_{41};
  Point made_;  ///< where the prior is made
};

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

/// Information and vector of the prior.
struct Dense {
  explicit Dense(const Prior& prior) : A(prior.A()), g(prior.g()) {}

  /// Three unknowns from `at` on are eliminated; their rows and columns stay, zero.
  Dense without(int at) const {
    const MatrixXd A_E = A.middleCols(at, 3);
    const MatrixXd own = A.block(at, at, 3, 3);
    const MatrixXd K = A_E * own.inverse();
    Dense out = *this;
    out.A -= K * A_E.transpose();
    out.g -= K * VectorXd(g.segment(at, 3));
    out.A.middleRows(at, 3).setZero();
    out.A.middleCols(at, 3).setZero();
    out.g.segment(at, 3).setZero();
    return out;
  }
  /// The variances of the unknowns from `at` on have grown, the mean has not moved.
  Dense grown(Eigen::Index at, const VectorXd& variances) const {
    MatrixXd P = A.inverse();
    const VectorXd mean = P * g;
    P.diagonal().segment(at, variances.size()) += variances;
    Dense out = *this;
    out.A = P.inverse();
    out.g = out.A * mean;
    return out;
  }

  MatrixXd A;
  VectorXd g;
};
void expect_prior(const Prior& prior, const Dense& expected, double relative) {
  expect_close(prior.A(), expected.A, relative);
  expect_close(prior.g(), expected.g, relative);
}

TEST_F(PriorTest, RemovingALandmarkIsTheSchurComplement) {
  for (int i = 0; i < kKnown; ++i) {
    Prior prior = made_of(random_information(), random_vector(kSize));
    Dense expected = Dense(prior).without(landmark(i));
    prior.remove_landmark(static_cast<std::size_t>(i), kKnown - 1);
    std::vector<Eigen::Index> order(kSize - 3);  // the last one has moved to i
    std::iota(order.begin(), order.end(), 0);
    for (int c = 0; c < 3 && i < kKnown - 1; ++c) {
      order[static_cast<std::size_t>(landmark(i)) + static_cast<std::size_t>(c)] =
          landmark(kKnown - 1) + c;
    }
    expected.A = expected.A(order, order).eval();
    expected.g = expected.g(order).eval();
    expect_prior(prior, expected, 1e-10);
  }
}

TEST_F(PriorTest, ALandmarkUnknownToThePriorMayTakeThePlaceOfAKnownOne) {
  Prior prior = made_of(random_information(), random_vector(kSize));
  const Dense before(prior);
  prior.remove_landmark(kKnown, kKnown);  // none of its business
  EXPECT_EQ(MatrixXd(prior.A()), before.A);
  prior.remove_landmark(1, kKnown);
  expect_prior(prior, before.without(landmark(1)), 1e-10);
}

TEST_F(PriorTest, LandmarkNoiseAddsToTheCovariance) {
  const Vector3d p_WB(1.0, 2.0, 3.0);
  made_.x.landmarks[1].looks.elevation_walk = 0.1;
  Prior prior = made_of(random_information(), random_vector(kSize));
  const Dense before(prior);
  VectorXd variances(3 * kKnown);
  for (int i = 0; i < kKnown; ++i) {
    const LandmarkState& seen = made_.x.landmarks[static_cast<std::size_t>(i)];
    variances.segment<3>(3 * i) = landmark_walk(seen, p_WB, 0.5, 1.2);
  }
  EXPECT_GT(variances[5], 2.0 * variances[4]);
  prior.add_landmark_noise(made_.x, p_WB, 0.5, 1.2);
  expect_prior(prior, before.grown(landmark(0), variances), 1e-9);
}

// Two of them are constant.
TEST_F(PriorTest, ParametersThatWalkLoseInformation) {
  VectorXd walk = VectorXd::LinSpaced(kCalibration, 0.1, 0.9);
  walk[3] = walk[7] = 0.0;
  Prior prior = made_of(random_information(), random_vector(kSize));
  const Dense before(prior);
  prior.add_parameter_noise(walk, 0.5);
  expect_prior(prior, before.grown(body::kSize * kLeading, 0.5 * walk), 1e-9);
}

// As a Kalman filter would: the mean and the covariance of all else remain.
TEST_F(PriorTest, WhatIsConsideredHasItsPriorAgain) {
  const int at = body::kSize * kLeading + kCalibration - 1;
  const VectorXd variances = VectorXd::Constant(kCalibration, 0.5);
  for (const double scale : {1e3, 0.1}) {  // it is known better than its prior, and worse
    Prior prior = made_of(scale * random_information(), random_vector(kSize));
    const Dense before(prior);
    MatrixXd P = before.A.inverse();
    VectorXd mean = P * before.g;
    EXPECT_EQ(P(at, at) < 0.5, scale > 1.0);
    P(at, at) = std::max(P(at, at), 0.5);
    mean[at] = -made_.x.elevation_error;  // from where the prior was made
    prior.consider(variances);
    Dense expected = before;
    expected.A = P.inverse();
    expected.g = expected.A * mean;
    // the information that stands for unknown landmarks is 1e-8 of the least here
    expect_prior(prior, expected, 1e-7);
  }
}

// Landmarks that the prior does not know are no obstacle, and the radars have each their own.
TEST_F(PriorTest, ConsidersTheErrorOfEachRadarBesideUnknownLandmarks) {
  constexpr int n = body::kSize * kLeading + 2 * kCalibration + 3 * kKnown;
  Prior prior(Layout(calibration(), 0, kLandmarks, 0, 2), kStates);
  MatrixXd A = 1e3 * random_information(n);
  A.bottomRows(3).setZero();
  A.rightCols(3).setZero();
  VectorXd g = random_vector(n);
  g.tail(3).setZero();
  prior.assign(A, g, made_.window, 0, kLeading, made_.x);
  prior.consider(VectorXd::Constant(2 * kCalibration, 0.5));
  const MatrixXd P = MatrixXd(prior.A()).topLeftCorner(n - 3, n - 3).inverse();
  const VectorXd mean = P * VectorXd(prior.g()).head(n - 3);
  for (int r = 0; r < 2; ++r) {
    const int at = body::kSize * kLeading + (r + 1) * kCalibration - 1;
    EXPECT_NEAR(P(at, at), 0.5, 1e-6) << r;
    EXPECT_NEAR(mean[at], r == 0 ? -made_.x.elevation_error : 0.0, 1e-6) << r;
  }
}

// Four radars have more parameters than one product may be deep.
TEST_F(PriorTest, AnyNumberOfParametersWalks) {
  constexpr int kRadars = 4;
  constexpr int n = body::kSize * kLeading + kRadars * kCalibration;
  Prior prior(Layout(calibration(), 0, 0, 0, kRadars), kStates);
  prior.assign(random_information(n), random_vector(n), made_.window, 0, kLeading, Estimate{});
  const Dense before(prior);
  const VectorXd walk = VectorXd::Constant(kRadars * kCalibration, 0.3);
  prior.add_parameter_noise(walk, 1.0);
  expect_prior(prior, before.grown(body::kSize * kLeading, walk), 1e-8);
}

// Ten at a call: each has walked as far as all the others when its turn comes, wherever it stands.
TEST_F(PriorTest, ManyLandmarksWalkInTurn) {
  constexpr int kMany = 25;
  constexpr double kVariance = 0.3;
  constexpr int n = kSize + 3 * (kMany - kKnown);
  for (int i = kKnown; i < kMany; ++i) made_.x.landmarks.push_back({random_.normal_vector(5.0)});
  Prior prior(Layout(calibration(), 0, kMany), kStates);
  prior.assign(random_information(n), random_vector(n), made_.window, 0, kLeading, made_.x);
  const auto expect_walk = [&](const std::vector<double>& walked) {
    const Dense before(prior);
    VectorXd variances(3 * walked.size());
    for (int i = 0; i < variances.size(); ++i) {
      variances[i] = kVariance * walked[static_cast<std::size_t>(i / 3)];
    }
    for (int call = 0; call < 3; ++call) {
      prior.add_landmark_noise(made_.x, Vector3d::Zero(), 1.0, kVariance);
    }
    expect_prior(prior, before.grown(landmark(0), variances), 1e-8);
  };
  std::vector<double> walked(kMany, 1.0);
  std::fill(walked.begin() + 10, walked.end(), 2.0);
  std::fill(walked.begin() + 20, walked.end(), 3.0);
  expect_walk(walked);
  // the last one, whose walk is done, takes the place of one that two steps are owed
  prior.remove_landmark(0, kMany - 1);
  walked.assign(kMany - 1, 3.0);
  walked[0] = 1.0;
  expect_walk(walked);
}

}  // namespace
}  // namespace rio::test
