// SPDX-License-Identifier: BSD-3-Clause
// Files of trajectories and states, and of the state at the start.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "rio/io/csv.hpp"
#include "rio/io/start.hpp"
#include "rio/io/trajectory.hpp"
#include "support/temp_dir.hpp"

namespace rio::io {
namespace {

using test::TempDir;

TEST(Start, CovarianceOfYawFollowsTheAttitude) {
  const StartOptions start{
      .sigma_position = 2.0, .sigma_yaw = 0.3, .sigma_tilt = 0.1, .sigma_velocity = 0.5};
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
  const Alignment file = load_start(dir.write("s.yaml",
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
  const Alignment file = load_start(
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

StampedPose pose_at(std::int64_t ns) {
  return {Time(ns), Vector3d(1.0, -2.5, 0.125), Quaternion(0.5, 0.5, -0.5, 0.5)};
}

TEST(Trajectory, SecondsAreExact) {
  EXPECT_EQ(seconds_text(Time(1403636579758555392)), "1403636579.758555392");
  EXPECT_EQ(seconds_text(Time(5)), "0.000000005");
  EXPECT_EQ(seconds_text(Time(-1500000000)), "-1.500000000");
  EXPECT_EQ(seconds_text(Time::min()), "-9223372036.854775808");
}

TEST(Trajectory, TumLineIsExact) {
  EXPECT_EQ(tum_line(pose_at(1403636579758555392)),
            "1403636579.758555392 1.000000000 -2.500000000 0.125000000 0.500000000 -0.500000000 "
            "0.500000000 0.500000000");
}

TEST(Trajectory, TumRoundTrip) {
  const TempDir dir;
  const std::filesystem::path path = dir.path() / "a.tum";
  write_tum(path, {pose_at(1403636579758555392), pose_at(1403636579758555393)});
  const Trajectory read = read_trajectory(path);
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].time, Time(1403636579758555392));
  EXPECT_EQ(read[1].time, Time(1403636579758555393));
  EXPECT_EQ(read[0].p, pose_at(0).p);
  EXPECT_EQ(read[0].q.coeffs(), pose_at(0).q.coeffs());
}

TEST(Trajectory, ReadsScientificNotationCommentsAndRoundedQuaternions) {
  const TempDir dir;
  const Trajectory read = read_trajectory(
      dir.write("a.txt", "# t x y z qx qy qz qw\n1.5e+00 1e0 2e0 3e0 7.071e-1 0 0e0 0.7071\n"));
  ASSERT_EQ(read.size(), 1U);
  EXPECT_EQ(read[0].time, Time(1500000000));
  EXPECT_EQ(read[0].p, Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(read[0].q.x(), read[0].q.w());
  EXPECT_NEAR(read[0].q.norm(), 1.0, 1e-15);
}

// As of a total station or GNSS, for what needs no attitude.
TEST(Trajectory, PositionsAloneAreReadWhereTheAttitudeIsOptional) {
  const TempDir dir;
  for (const char* text : {"1.5 1 2 3\n2.5 4 5 6\n", "t,x,y,z\n1.5,1,2,3\n2.5,4,5,6\n",
                           "#timestamp [ns],x,y,z\n1403636579758555392,1,2,3\n"
                           "1403636580758555392,4,5,6\n"}) {
    const std::filesystem::path file = dir.write("a.csv", text);
    const Trajectory read = read_trajectory(file, TumOrder::kStrict, Attitude::kOptional);
    ASSERT_EQ(read.size(), 2U) << text;
    EXPECT_EQ(read[1].p, Vector3d(4, 5, 6));
    EXPECT_EQ(read[1].time - read[0].time, Time(1'000'000'000));
    EXPECT_TRUE(read[1].q.coeffs().array().isNaN().all());
    EXPECT_ERROR(read_trajectory(file), "has 4 columns, a TUM file has 8; positions alone");
  }
}

TEST(Trajectory, RejectsDamage) {
  const TempDir dir;
  const auto read = [&dir](const char* text) { read_trajectory(dir.write("a.tum", text)); };
  EXPECT_ERROR(read("1 0 0 0 0 0 0 1 5\n"), "a.tum:1: has 9 columns, a TUM file has 8");
  EXPECT_ERROR(read("1 0 0 0 0 0 0 1\n2 0 0 0 0\n"), "a.tum:2: has 5 columns");
  EXPECT_ERROR(read("#ROSBAG V2.0\n"), "a.tum: a bag of ROS: rio convert makes a folder of it");
  EXPECT_ERROR(read("1;0;0;0;0;0;0;1\n"), "columns are separated by blanks, not by ;");
  EXPECT_ERROR(read("1 0 0 0 0 1 0 0 0 0 1 0\n"), "12 columns, a TUM file has 8; poses of KITTI");
  EXPECT_ERROR(read("t,x,y,z,qw,qx,qy,qz\n1.5,0,0,0,1,0,0,0\n"), "column 5 is \"qw\"");
  EXPECT_ERROR(read("1 0 0 0 0 0 0 0\n"), "a.tum:1: not a unit quaternion");
  EXPECT_ERROR(read("1 0 0 0 nan 0 0 1\n"), "a.tum:1: not a unit quaternion");
  EXPECT_ERROR(read("1 nan 0 0 0 0 0 1\n"), "a.tum:1: position is not finite");
  EXPECT_ERROR(read("2 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n"),
               "a.tum:2: time does not increase: rows to be");
  EXPECT_ERROR(read("# nothing\n"), "a.tum: holds no poses");
  EXPECT_ERROR(read(""), "a.tum: is empty");
  EXPECT_ERROR(read_trajectory(dir.path() / "none.tum"), "none.tum: no such file");
}

TEST(Trajectory, ReadsTheTruthFilesOfPublicDataSets) {
  const TempDir dir;
  const auto check = [](const Trajectory& read) {
    ASSERT_EQ(read.size(), 2U);
    EXPECT_EQ(read[0].time, Time(1403636579758555392));
    EXPECT_EQ(read[0].p, Vector3d(1, 2, 3));
    EXPECT_EQ(read[1].p, Vector3d(4, 5, 6));
    EXPECT_EQ(read[1].q.coeffs(), Quaternion(-0.5, 0.5, 0.5, 0.5).coeffs());
  };
  const std::string poses = " 1 2 3 0 0 0 1\n";
  const std::string others = " 4 5 6 0.5 0.5 0.5 -0.5\n";
  const std::string seconds = "1403636579.758555392" + poses + "1403636580.758555392" + others;
  check(read_trajectory(dir.write("truth.csv", "timestamp tx ty tz qx qy qz qw\n" + seconds)));
  std::string commas = "timestamp,tx,ty,tz,qx,qy,qz,qw\n" + seconds;  // as pandas writes it
  std::replace(commas.begin(), commas.end(), ' ', ',');
  for (const char* name : {"commas.csv", "commas.txt"})
    check(read_trajectory(dir.write(name, commas)));
  check(read_trajectory(
      dir.write("truth.txt", "1403636579758555392" + poses + "1403636580758555392" + others)));
  check(read_trajectory(
      dir.write("mav0/state_groundtruth_estimate0/data.csv",  // of EuRoC
                "#timestamp\n"
                "1403636579758555392,1,2,3,1,0,0,0,4,5,6,.1,.2,.3,.4,.5,.6\n"
                "1403636580758555392,4,5,6,-.5,.5,.5,.5,4,5,6,.1,.2,.3,.4,.5,.6\n")));
  check(read_trajectory(dir.path()));
  dir.write("groundtruth/timestamps.txt", "1403636579.758555392\n1403636580.758555392\n");
  const auto file =
      dir.write("groundtruth/groundtruth_poses.txt", poses.substr(1) + others.substr(1));
  check(read_trajectory(file));
  check(read_trajectory(dir.path()));
  dir.write("groundtruth/timestamps.txt", "1403636579.758555392\n");
  EXPECT_ERROR(read_trajectory(file), "groundtruth_poses.txt:2: has no stamp in ");
}

/// Entry (i, j) is 100 (i + 1) + (j + 1), mirrored: every entry is told apart.
BodyCovariance numbered_covariance() {
  BodyCovariance P;
  for (int i = 0; i < body::kSize; ++i) {
    for (int j = i; j < body::kSize; ++j) P(i, j) = P(j, i) = 100 * (i + 1) + (j + 1);
  }
  return P;
}

TEST(StatesFile, ReordersTheCovariance) {
  const StateCovariance S = state_covariance(numbered_covariance());
  EXPECT_EQ(S(0, 0), 404);  // dp x, dp x
  EXPECT_EQ(S(1, 2), 506);  // dp y, dp z
  EXPECT_EQ(S(0, 3), 104);  // dp x, dtheta x
  EXPECT_EQ(S(2, 4), 206);  // dp z, dtheta y
  EXPECT_EQ(S(3, 5), 103);  // dtheta x, dtheta z
  EXPECT_EQ(S(1, 6), 507);  // dp y, dv x
  EXPECT_EQ(S(5, 7), 308);  // dtheta z, dv y
  EXPECT_EQ(S(8, 8), 909);  // dv z, dv z
  EXPECT_EQ(StateCovariance(S.transpose()), S);
}

TEST(StatesFile, WritesEveryColumnInPlace) {
  const TempDir dir;
  const NavState state{.time = Time(1403636579758555392),
                       .q_WB = Quaternion(0.5, -0.5, 0.5, 0.5),
                       .p_WB = {0.1, 0.2, 0.3},
                       .v_WB = {4, 5, 6},
                       .gyro_bias = {7, 8, 9},
                       .accel_bias = {10, 11, 12}};
  const std::filesystem::path path = dir.path() / "states.csv";
  StatesFile file(path);
  file.add(state, numbered_covariance());
  file.close();

  const std::string text = dir.read("states.csv");
  EXPECT_FALSE(test::contains(text, "P_1_0"));
  EXPECT_TRUE(
      text.starts_with("#t_ns,px_m,py_m,pz_m,qw,qx,qy,qz,vx_mps,vy_mps,vz_mps,P_px_px,P_px_py,"))
      << text;
  EXPECT_TRUE(test::contains(text, ",P_px_vz,P_py_py,"));
  EXPECT_TRUE(
      test::contains(text, ",P_vz_vz,bgx_radps,bgy_radps,bgz_radps,bax_mps2,bay_mps2,baz_mps2\n"));
  CsvReader rows(path);
  ASSERT_TRUE(rows.next());
  ASSERT_EQ(rows.columns(), 62U);
  EXPECT_EQ(rows.integer(0), state.time.count());
  const double head[] = {0.1, 0.2, 0.3, 0.5, -0.5, 0.5, 0.5, 4, 5, 6};
  for (std::size_t i = 0; i < 10; ++i) EXPECT_EQ(rows.number(i + 1), head[i]) << i;
  EXPECT_EQ(rows.number(11), 404);  // P_px_px
  EXPECT_EQ(rows.number(14), 104);  // P_px_thx
  EXPECT_EQ(rows.number(20), 505);  // P_py_py
  EXPECT_EQ(rows.number(55), 909);  // P_vz_vz
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(rows.number(56 + i), 7.0 + double(i)) << i;
  EXPECT_FALSE(rows.next());
  EXPECT_EQ(read_trajectory(path).at(0).q.coeffs(), state.q_WB.coeffs());
}

// Scans of several radars may share an instant: what the last one made of it is the estimate.
TEST(PathFiles, HoldTheLastEstimateOfAnInstant) {
  const TempDir dir;
  PathFiles files(dir.path() / "p.tum", dir.path() / "p.csv");
  for (const auto& [second, x] : {std::pair(1, 1.0), {1, 2.0}, {2, 3.0}, {3, 4.0}, {3, 5.0}}) {
    files.add({.time = std::chrono::seconds(second), .p_WB = {x, 0.0, 0.0}}, numbered_covariance());
  }
  files.close();
  constexpr double kLast[] = {2.0, 3.0, 5.0};
  for (const char* name : {"p.tum", "p.csv"}) {
    const Trajectory path = read_trajectory(dir.path() / name);
    ASSERT_EQ(path.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(path[i].time, std::chrono::seconds(i + 1));
      EXPECT_EQ(path[i].p.x(), kLast[i]);
    }
  }
}

TEST(TextFile, KeepsWhatItHeldUntilTheFirstWrite) {
  const TempDir dir;
  const auto path = dir.path() / "file.txt";
  dir.write("file.txt", "old and longer");
  { const TextFile opened(path); }
  EXPECT_EQ(std::filesystem::file_size(path), 14U);
  TextFile file(path);
  file.write("new");
  file.write("er");
  file.close();
  EXPECT_EQ(std::filesystem::file_size(path), 5U);
  TextFile empty(path);
  empty.close();
  EXPECT_EQ(std::filesystem::file_size(path), 0U);
}

TEST(TextFile, WriteErrorsAreNotMissed) {
  const TempDir dir;
  EXPECT_ERROR(TextFile(dir.path() / "no" / "folder.txt"), "folder.txt: cannot be written");
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "needs /dev/full";
  EXPECT_ERROR(write_tum("/dev/full", {pose_at(1)}), "/dev/full: cannot be written");
}

}  // namespace
}  // namespace rio::io
