// SPDX-License-Identifier: BSD-3-Clause
#include "rio/io/start.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/temp_dir.hpp"

namespace rio::io {
namespace {

using test::TempDir;

TEST(Start, CovarianceOfYawFollowsTheAttitude) {
  StartOptions start;
  start.sigma_yaw = 0.3;
  start.sigma_tilt = 0.1;
  start.sigma_position = 2.0;
  start.sigma_velocity = 0.5;
  // nose down by 90 deg: heading is rotation about the body -x axis
  const Quaternion q(Eigen::AngleAxisd(std::acos(0.0), Vector3d::UnitY()));
  const BodyCovariance P = start_covariance(q, start);
  const double tolerance = 1e-15;  // a rotation by 90 deg is exact to rounding
  EXPECT_NEAR(P(body::kAttitude, body::kAttitude), 0.09, tolerance);
  EXPECT_NEAR(P(body::kAttitude + 1, body::kAttitude + 1), 0.01, tolerance);
  EXPECT_NEAR(P(body::kAttitude + 2, body::kAttitude + 2), 0.01, tolerance);
  EXPECT_EQ(P(body::kPosition, body::kPosition), 4.0);
  EXPECT_EQ(P(body::kVelocity + 2, body::kVelocity + 2), 0.25);
  EXPECT_EQ(P(body::kGyroBias, body::kGyroBias), start.sigma_gyro_bias * start.sigma_gyro_bias);
  EXPECT_EQ(P(body::kAccelBias, body::kAccelBias), start.sigma_accel_bias * start.sigma_accel_bias);
}

TEST(Start, ReadsEveryKey) {
  const TempDir dir;
  const StartFile file = load_start(dir.write("s.yaml",
                                              "time_ns: 1403636579758555392\n"
                                              "position: [1, 2 cm, 3]\n"
                                              "quaternion_wxyz: [0, 0.6, 0, 0.8]\n"
                                              "velocity: [4, 5, 6]\n"
                                              "gyro_bias: [0.1, 0.2, 0.3]\n"
                                              "accel_bias: [0.4, 0.5, 0.6]\n"
                                              "sigma:\n"
                                              "  position: 2\n"
                                              "  orientation: [1 deg, 2 deg, 3 deg]\n"
                                              "  velocity: 0\n"
                                              "  gyro_bias: 0.5\n"
                                              "  accel_bias: [1, 2, 4]\n"),
                                    StartOptions{}, Time(5));
  EXPECT_EQ(file.state.time, Time(1403636579758555392));
  EXPECT_EQ(file.state.p_WB, Vector3d(1.0, 0.02, 3.0));
  EXPECT_EQ(file.state.q_WB.coeffs(), Quaternion(0.0, 0.6, 0.0, 0.8).coeffs());
  EXPECT_EQ(file.state.v_WB, Vector3d(4, 5, 6));
  EXPECT_EQ(file.state.gyro_bias, Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(file.state.accel_bias, Vector3d(0.4, 0.5, 0.6));
  const BodyCovariance& P = file.covariance;
  const double degree = 3.14159265358979323846 / 180.0;
  EXPECT_NEAR(P(body::kAttitude + 2, body::kAttitude + 2), 9.0 * degree * degree, 1e-16);
  EXPECT_EQ(P(body::kPosition, body::kPosition), 4.0);
  EXPECT_EQ(P(body::kVelocity, body::kVelocity), 0.0);
  EXPECT_EQ(P(body::kGyroBias + 1, body::kGyroBias + 1), 0.25);
  EXPECT_EQ(P(body::kAccelBias + 2, body::kAccelBias + 2), 16.0);
  EXPECT_EQ(BodyCovariance(P.transpose()), P);
}

TEST(Start, MissingKeysHaveDefaults) {
  const TempDir dir;
  StartOptions start;
  start.sigma_tilt = 0.2;
  const StartFile file = load_start(
      dir.write("s.yaml", "quaternion_wxyz: [1, 0, 0, 0]\nvelocity: [1, 0, 0]\n"), start, Time(5));
  EXPECT_EQ(file.state.time, Time(5));
  EXPECT_EQ(file.state.p_WB, Vector3d(0, 0, 0));
  EXPECT_EQ(file.covariance, start_covariance(Quaternion::Identity(), start));
}

TEST(Start, RejectsDamage) {
  const TempDir dir;
  const auto load = [&dir](const std::string& text) {
    load_start(dir.write("s.yaml", "quaternion_wxyz: [1, 0, 0, 0]\nvelocity: [1, 0, 0]\n" + text),
               StartOptions{}, Time(0));
  };
  EXPECT_ERROR(load("positon: [1, 2, 3]\n"),
               "s.yaml:3: unknown key \"positon\", did you mean \"position\"?");
  EXPECT_ERROR(load("sigma: {orientaton: 1}\n"), "did you mean \"orientation\"?");
  EXPECT_ERROR(load("position: [1, 2]\n"), "s.yaml:3: position: a list of 3 numbers");
  EXPECT_ERROR(load("position: [1, 2, nan]\n"), "position: not finite");
  EXPECT_ERROR(load("sigma: {velocity: -1}\n"), "sigma.velocity: below zero");
  EXPECT_ERROR(load("sigma: 3\n"), "sigma: a map is expected");
  EXPECT_ERROR(load("time_ns: 1.5\n"), "time_ns: not an integer");
  const auto load_only = [&dir](const std::string& text) {
    load_start(dir.write("s.yaml", text), StartOptions{}, Time(0));
  };
  EXPECT_ERROR(load_only("velocity: [1, 0, 0]\n"), "quaternion_wxyz missing");
  EXPECT_ERROR(load_only("quaternion_wxyz: [1, 0, 0, 0]\n"), "velocity missing");
  EXPECT_ERROR(load_only("quaternion_wxyz: [2, 0, 0, 0]\n"), "not a unit quaternion");
}

}  // namespace
}  // namespace rio::io
