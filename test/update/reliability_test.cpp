// SPDX-License-Identifier: BSD-3-Clause
// Least-squares velocity of one scan, many times: its errors against the covariance claimed.
#include "rio/update/reliability.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "rio/models/doppler.hpp"
#include "rio/sim/radar.hpp"
#include "rio/sim/random.hpp"
#include "support/model_cases.hpp"
#include "support/random_state.hpp"

namespace rio::test {
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(ModelSuite);  // instantiated in model_suite_test.cpp
namespace {

constexpr int kPoints = 25;
constexpr double kSigmaDoppler = 0.02;    // [m/s]
constexpr double kSigmaAzimuth = 0.035;   // 2 deg
constexpr double kSigmaElevation = 0.07;  // 4 deg

using Scan = std::vector<DopplerModel::Measurement>;

Scan simulate(sim::Random& random, const Vector3d& v_S) {
  RadarOptions options;
  options.sigma_azimuth = kSigmaAzimuth;
  options.sigma_elevation = kSigmaElevation;
  options.sigma_doppler = kSigmaDoppler;
  options.doppler_resolution = 0.0;
  options.weak_snr_db = -200.0;  // all echoes are alike
  Scan scan;
  for (int i = 0; i < kPoints; ++i) {
    sim::Polar polar{3.0, random.uniform(-1.0, 1.0), random.uniform(-0.26, 0.26)};
    RadarDetection d;
    d.range_rate = -polar.point().normalized().dot(v_S) + kSigmaDoppler * random.normal();
    polar.azimuth += kSigmaAzimuth / std::cos(polar.azimuth) * random.normal();
    polar.elevation += kSigmaElevation / std::cos(polar.elevation) * random.normal();
    d.point_S = polar.point();
    scan.push_back(DopplerModel::measurement(make_detection(d, options), Vector3d::Zero()));
  }
  return scan;
}

struct Solution {
  Vector3d v = Vector3d::Zero();
  Matrix3d information = Matrix3d::Zero();
};

/// Gauss-Newton from the truth on; the reliability is that of the last step.
Solution solve(Scan scan, const Vector3d& v_S, bool reliable) {
  const DopplerModel model(DopplerDirections::kCorrected);
  Solution x;
  x.v = v_S;
  for (int step = 0; step < 8; ++step) {
    Reliability reliability;
    for (const DopplerModel::Measurement& z : scan) reliability.add(z, x.v);
    Vector3d score = Vector3d::Zero();
    x.information.setZero();
    for (DopplerModel::Measurement& z : scan) {
      if (reliable) z.reliability = reliability.matrix();
      Evaluation<DopplerModel> at;
      EXPECT_TRUE(
          evaluate(model, z, {RigidPose(), x.v, Vector3d::Zero(), RigidPose(), kNoErrors}, &at));
      const Vector3d J = at.J.segment<3>(DopplerModel::Blocks::column<BodyVelocity>());
      x.information += J * J.transpose() / at.R(0, 0);
      score += J * at.r[0] / at.R(0, 0);
    }
    x.v += x.information.inverse() * score;
  }
  return x;
}

/// Mean square of the error over its claimed variance, by axis.
Vector3d normalised_errors(bool reliable) {
  constexpr int kScans = 3000;
  const Vector3d v_S(0.8, 0.3, 0.1);
  sim::Random random(23);
  Vector3d sum = Vector3d::Zero();
  for (int i = 0; i < kScans; ++i) {
    const Solution x = solve(simulate(random, v_S), v_S, reliable);
    const Vector3d variance = x.information.inverse().diagonal();
    sum += (x.v - v_S).cwiseAbs2().cwiseQuotient(variance);
  }
  return sum / kScans;
}

TEST(Reliability, InformationOfAScanIsThatOfItsErrors) {
  // 3000 scans: 2.6 % at one sigma; 25 directions tell their own spread within some percent
  const Vector3d with = normalised_errors(true);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(with[i], 1.0, 0.1) << "axis " << i;
  EXPECT_GT(normalised_errors(false).z(), 1.3);
}

TEST(Reliability, IsTheShareOfTheSpreadThatIsNoError) {
  Random random(7);
  for (int run = 0; run < 50; ++run) {
    Reliability reliability;
    Matrix3d S = Matrix3d::Zero();
    Matrix3d C = Matrix3d::Zero();
    for (int i = 0; i < 6; ++i) {
      const Vector3d u = random.direction();
      const Matrix3d root = 0.2 * random.normal_vector() * random.normal_vector().transpose();
      const double variance = random.uniform(0.5, 2.0);
      reliability.add(u, root * root.transpose(), variance);
      S += u * u.transpose() / variance;
      C += root * root.transpose() / variance;
    }
    const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix3d> errors(C, S);
    if (errors.eigenvalues().maxCoeff() > 0.9) continue;  // (E2) as it stands; no bound acts
    const Matrix3d expected = (S - C) * S.inverse();
    EXPECT_LT((reliability.matrix() - expected).cwiseAbs().maxCoeff(), 1e-6) << run;
  }
}

TEST(Reliability, WithoutADirectionErrorAllIsBelieved) {
  Reliability reliability;
  EXPECT_EQ(reliability.matrix(), Matrix3d::Identity());
  for (int i = 0; i < 3; ++i) reliability.add(Vector3d::Unit(i), Matrix3d::Zero(), 1e-3);
  EXPECT_LT((reliability.matrix() - Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Reliability, OfOneDirectionItsOwnErrorTakesNothing) {
  Reliability reliability;
  const Vector3d u = Vector3d(1.0, 2.0, -0.5).normalized();
  reliability.add(u, 0.01 * (Matrix3d::Identity() - u * u.transpose()), 1e-3);
  EXPECT_LT((reliability.matrix() * u - u).norm(), 1e-6);
}

TEST(Reliability, ASpreadThatIsAllErrorTellsNothing) {
  Reliability reliability;
  const Matrix3d errors = Vector3d(0.0, 0.01, 0.04).asDiagonal();
  reliability.add(Vector3d(1.0, 0.0, 0.1), errors, 1e-3);  // 0.2 up and down is one sigma
  reliability.add(Vector3d(1.0, 0.0, -0.1), errors, 1e-3);
  EXPECT_LT(reliability.matrix().row(2).norm(), 1e-6);
  EXPECT_NEAR(reliability.matrix()(0, 0), 1.0, 1e-6);
}

}  // namespace
}  // namespace rio::test
