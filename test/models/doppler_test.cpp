// SPDX-License-Identifier: BSD-3-Clause
// The errors-in-variables correction of the Doppler model.
#include "rio/models/doppler.hpp"

#include <gtest/gtest.h>

#include "rio/models/landmark_point.hpp"
#include "support/model_cases.hpp"
#include "support/random_state.hpp"

namespace rio::test {
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(ModelSuite);  // instantiated in model_suite_test.cpp
namespace {

/// (E2), with the tangents at u itself.
double variance(const DopplerModel::Measurement& z, const DopplerModel::Blocks::Values& x) {
  Evaluation<DopplerModel> at;
  EXPECT_TRUE(evaluate(DopplerModel(DopplerDirections::kNoisy), z, x, &at));
  return at.R(0, 0);
}

/// r^2 / (2 R): what the corrected Jacobian is the gradient of when P_h = 0.
double cost(const DopplerModel::Measurement& z, const DopplerModel::Blocks::Values& x) {
  Evaluation<DopplerModel> at;
  EXPECT_TRUE(evaluate(DopplerModel(DopplerDirections::kCorrected), z, x, &at));
  return 0.5 * at.r[0] * at.r[0] / variance(z, x);
}

TEST(DopplerModel, CorrectedJacobianIsTheGradientOfTheWeightedSquare) {
  sim::Random random(21);
  for (int i = 0; i < 200; ++i) {
    const Sample<DopplerModel> sample = DopplerCase::simulate(random, true);
    Evaluation<DopplerModel> at;
    ASSERT_TRUE(evaluate(DopplerModel(DopplerDirections::kCorrected), sample.z, sample.x, &at));
    const double R = variance(sample.z, sample.x);
    if (at.r[0] * at.r[0] > 8.0 * R) continue;  // near the outlier bound
    const Eigen::RowVectorXd analytic = -at.r[0] / R * at.J;
    for (int k = 0; k < DopplerModel::Blocks::kDof; ++k) {
      const Eigen::VectorXd e = Eigen::VectorXd::Unit(DopplerModel::Blocks::kDof, k) * 1e-5;
      const double plus = cost(sample.z, retract(DopplerModel::Blocks{}, sample.x, e));
      const double minus = cost(sample.z, retract(DopplerModel::Blocks{}, sample.x, -e));
      // curvature terms: (1e-5)^2 times third derivatives of up to 1e4
      EXPECT_NEAR(analytic[k], (plus - minus) / 2e-5, 1e-5 * std::max(1.0, std::abs(analytic[k])));
    }
  }
}

/// Least-squares speed along a badly measured angle from many points, iterated to convergence.
Vector3d solve_velocity(bool correction, double sigma_elevation) {
  sim::Random random(22);
  const Vector3d v_true(0.4, 0.2, 0.9);
  const RadarOptions options{.sigma_azimuth = 0.02,
                             .sigma_elevation = sigma_elevation,
                             .weak_snr_db = -200.0};  // all echoes are alike
  const DopplerModel model(correction ? DopplerDirections::kCorrected : DopplerDirections::kNoisy);
  std::vector<DopplerModel::Measurement> all;
  for (int i = 0; i < 200'000; ++i) {
    const sim::Polar polar{3.0, random.uniform(-0.9, 0.9), random.uniform(-0.26, 0.26)};
    RadarDetection d;
    d.range_rate = -polar.point().normalized().dot(v_true) + 0.03 * random.normal();
    sim::Polar noisy = polar;
    noisy.azimuth += 0.02 / std::cos(polar.azimuth) * random.normal();
    noisy.elevation += sigma_elevation / std::cos(polar.elevation) * random.normal();
    d.point_S = noisy.point();
    all.push_back(DopplerModel::measurement(make_detection(d, options), Vector3d::Zero()));
  }
  Vector3d v = Vector3d::Zero();
  for (int pass = 0; pass < 30; ++pass) {
    Matrix3d A = Matrix3d::Zero();
    Vector3d b = Vector3d::Zero();
    for (auto& z : all) {
      z.variance_factor =
          correction ? DopplerModel::expected_direction(z, z.direction_S, v).variance_factor : 1.0;
      Evaluation<DopplerModel> at;
      EXPECT_TRUE(
          evaluate(model, z, {RigidPose(), v, Vector3d::Zero(), RigidPose(), kNoScaleError}, &at));
      const Vector3d J = at.J.segment<3>(DopplerModel::Blocks::column<BodyVelocity>());
      A += J * J.transpose() / at.R(0, 0);
      b += J * at.r[0] / at.R(0, 0);
    }
    v += A.ldlt().solve(b);
  }
  return v - v_true;
}

TEST(DopplerModel, DirectionErrorShrinksTheVelocityUnlessCorrected) {
  // elevation spans a standard deviation of 0.15 rad: 4 deg of noise shrink the vertical speed by
  // 0.07^2 / (0.07^2 + 0.15^2) = 18 %
  EXPECT_NEAR(solve_velocity(false, 0.07).z(), -0.18 * 0.9, 0.04);
  // 200,000 points: standard deviation 1 mm/s. Without (E5) 4 mm/s, without (E6) 7
  EXPECT_LT(solve_velocity(true, 0.07).norm(), 0.002);
}

TEST(DopplerModel, PredictedVarianceTempersTheCorrection) {
  // with a vague state the innovation says nothing about the direction
  DopplerModel::Measurement z;
  z.range_rate = 0.2;
  z.sigma_doppler = 0.03;
  z.direction_cov = Matrix3d(Vector3d(0.0, 0.01, 0.01).asDiagonal());
  const DopplerModel::Blocks::Values x{RigidPose(), Vector3d(0.0, 0.0, 1.0), Vector3d::Zero(),
                                       RigidPose(), kNoScaleError};
  const auto tilt = [&](double predicted_var) {
    z.predicted_var = predicted_var;
    Evaluation<DopplerModel> at;
    EXPECT_TRUE(evaluate(DopplerModel(DopplerDirections::kCorrected), z, x, &at));
    return std::abs(at.J(0, DopplerModel::Blocks::column<BodyVelocity>() + 2));
  };
  EXPECT_GT(tilt(0.0), 0.1);
  EXPECT_NEAR(tilt(100.0), 0.0, 1e-4);
}

// (E7): calibration as at the other motion, all else as predicted; of a landmark by the same
// change.
TEST(DopplerModel, CalibrationIsLinearisedAtTheSteadyMotion) {
  Random random(5);
  const SteadyOffset offset{random.normal_vector(0.5), random.normal_vector(0.3)};
  const RigidPose T_WB(random.rotation().toRotationMatrix(), random.normal_vector());
  const RigidPose T_BS(random.rotation().toRotationMatrix(), random.normal_vector(0.2));
  const Vector3d v = random.normal_vector(2.0);
  const Vector3d w = random.normal_vector(0.5);
  const Vector3d steady_v = v + T_WB.R * (T_BS.R * offset.velocity_S - offset.rate_B.cross(T_BS.p));
  const Vector3d direction_S(0.8, 0.48, -0.36);
  constexpr double kScaleError = 0.01;
  const auto at_motion = [&](const Vector3d& v_WB, const Vector3d& rate_B, SteadyOffset steady) {
    DopplerModel::Measurement z;
    z.sigma_doppler = 0.03;
    z.direction_S = direction_S;
    z.gyro_B = rate_B;
    z.steady = steady;
    Evaluation<DopplerModel> at;
    EXPECT_TRUE(evaluate(DopplerModel(DopplerDirections::kNoisy), z,
                         {T_WB, v_WB, Vector3d::Zero(), T_BS, kScaleError}, &at));
    return at;
  };
  const auto of_landmark = [&](SteadyOffset steady) {
    LandmarkDopplerModel::Measurement z;
    z.sigma_doppler = 0.03;
    z.gyro_B = w;
    z.steady = steady;
    Evaluation<LandmarkDopplerModel> at;
    EXPECT_TRUE(evaluate(
        LandmarkDopplerModel(), z,
        {T_WB, v, Vector3d::Zero(), T_BS, kScaleError, to_world(T_WB, T_BS, 4.0 * direction_S)},
        &at));
    return at;
  };
  const auto predicted = at_motion(v, w, {});
  const auto steady = at_motion(steady_v, w + offset.rate_B, {});
  auto both = at_motion(v, w, offset);
  EXPECT_EQ(both.r, predicted.r);
  EXPECT_EQ(both.R, predicted.R);
  constexpr int kFirst = DopplerModel::Blocks::column<Extrinsics>();
  constexpr int kCount = Extrinsics::kDof + DopplerScale::kDof;
  const auto calibration = [](auto& at) { return at.J.template middleCols<kCount>(kFirst); };
  EXPECT_LT((calibration(both) - calibration(steady)).norm(), 1e-12);
  const Eigen::RowVectorXd change = calibration(both) - calibration(predicted);
  EXPECT_GT(change.norm(), 0.1);
  calibration(both) = calibration(predicted);
  EXPECT_EQ(both.J, predicted.J);
  Eigen::RowVectorXd of_landmark_change = of_landmark(offset).J - of_landmark({}).J;
  of_landmark_change.segment(kFirst, kCount) -= change;
  EXPECT_LT(of_landmark_change.norm(), 1e-12);
}

}  // namespace
}  // namespace rio::test
