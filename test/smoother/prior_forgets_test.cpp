// SPDX-License-Identifier: BSD-3-Clause
// What the prior of the sliding window forgets: landmarks that are eliminated, what walks and what
// is considered, against dense matrices.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <numeric>
#include <vector>

#include "rio/smoother/prior.hpp"
#include "rio/update/look_correlation.hpp"
#include "smoother/prior_case.hpp"

namespace rio::test {
namespace {

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

// Any number of them, some constant: four radars have more than one product may be deep.
TEST_F(PriorTest, ParametersThatWalkLoseInformation) {
  for (const int radars : {1, 4}) {
    const int n = kSize + (radars - 1) * kCalibration;
    VectorXd walk = VectorXd::LinSpaced(radars * kCalibration, 0.1, 0.9);
    walk[3] = walk[7] = 0.0;
    Prior prior(Layout(calibration(), 0, kLandmarks, 0, static_cast<std::size_t>(radars)), kStates);
    prior.assign(random_information(n), random_vector(n), made_.window, 0, kLeading, made_.x);
    const Dense before(prior);
    prior.add_parameter_noise(walk, 0.5);
    expect_prior(prior, before.grown(body::kSize * kLeading, 0.5 * walk), 1e-9);
  }
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
