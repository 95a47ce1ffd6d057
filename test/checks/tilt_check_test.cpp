// SPDX-License-Identifier: BSD-3-Clause
#include "rio/checks/tilt_check.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "rio/core/so3.hpp"
#include "support/constants.hpp"
#include "support/measured.hpp"
#include "support/seen_vehicle.hpp"

namespace rio {
namespace {

/// A drive of `scans` scans of `points`; the estimate is the truth, changed by `wrong`.
struct Drive {
  int points = 20;
  int scans = 100;
  double sigma_tilt = 0.002;       ///< claimed [rad]
  double sigma_accel_bias = 0.02;  ///< same [m/s^2]
  bool tied = false;               ///< the bias has the error that makes up for that of the tilt
  double sigma_mounting = 0.0;     ///< same [rad]
  double turn_mounting = 0.0;      ///< of the radar, about the body's z axis [rad]
  double sigma_elevation = RadarOptions{}.sigma_elevation;  ///< told; the points have none [rad]
  double accel_noise = ImuOptions{}.accel_noise_density;    ///< told [m/s^2/sqrt(Hz)]
  std::function<void(Estimate&)> wrong = [](Estimate&) {};
  std::function<bool(int)> silent = [](int) { return false; };  ///< no scan: dead reckoning

  struct Verdict {
    double seconds = -1.0;  ///< until gravity was contradicted; negative: it never was
    double error = 0.0;     ///< of the other gravity [m/s^2]
    double sigma = 0.0;     ///< what is said of that [m/s^2]
  };
  Verdict run(test::Random* random) const {
    Options options;
    options.imu.accel_noise_density = accel_noise;
    options.radar.sigma_elevation = sigma_elevation;
    options.radar.T_BS.translation = Vector3d(0.1, 0.05, -0.1);
    test::SeenVehicle vehicle(options, Vector3d(0.4, -0.3, 0.1), random);
    vehicle.mounting = Quaternion(Eigen::AngleAxisd(turn_mounting, Vector3d::UnitZ()));
    TiltCheck check(options);
    check.reset(vehicle.truth.time);
    BodyCovariance P = BodyCovariance::Zero();
    P.diagonal().segment<3>(body::kAttitude).setConstant(sigma_tilt * sigma_tilt);
    P.diagonal().segment<3>(body::kAccelBias).setConstant(sigma_accel_bias * sigma_accel_bias);
    Eigen::Matrix4d P_radar = Eigen::Matrix4d::Zero();
    P_radar.diagonal().head<3>().setConstant(sigma_mounting * sigma_mounting);
    for (int i = 0; i < scans; ++i) {
      if (i % 15 == 0) {  // back and forth
        vehicle.acceleration = random->normal_vector(0.6) - 0.7 * vehicle.truth.v_WB;
        vehicle.rate = random->normal_vector(0.3);
      }
      const Time last = vehicle.truth.time;
      vehicle.advance();
      Estimate x = vehicle.estimate();
      wrong(x);
      if (tied) tie_bias_to_tilt(x, &P);
      const DetectionList scan = vehicle.scan(points);
      Observations seen;
      seen.scan = &scan;
      for (int k = 0; k < points; ++k) seen.ego_velocity.inlier[static_cast<std::size_t>(k)] = true;
      check.carry(x, last, vehicle.imu(), false);
      if (silent(i)) continue;
      const auto down = check.observe(seen, x, P, P_radar);
      if (!down) continue;
      const Vector3d g_B = vehicle.truth.q_WB.conjugate() * Vector3d(0.0, 0.0, -9.81);
      return {to_seconds(vehicle.truth.time), (down->g_B - g_B).norm(), down->sigma};
    }
    return {};
  }
  /// The specific force of rest is known although neither tilt nor bias is: b = g_B x theta.
  static void tie_bias_to_tilt(const Estimate& x, BodyCovariance* P) {
    const Matrix3d J = skew(x.nav.q_WB.conjugate() * Vector3d(0.0, 0.0, -9.81));
    const Matrix3d tilt = P->block<3, 3>(body::kAttitude, body::kAttitude);
    P->block<3, 3>(body::kAttitude, body::kAccelBias) = tilt * J.transpose();
    P->block<3, 3>(body::kAccelBias, body::kAttitude) = J * tilt;
    P->block<3, 3>(body::kAccelBias, body::kAccelBias) = J * tilt * J.transpose();
  }
};

std::function<void(Estimate&)> tilted(const Vector3d& theta) {
  return [theta](Estimate& x) { x.nav.q_WB = x.nav.q_WB * test::rotation_of(theta); };
}
/// Horizontal in the body's axes of the moment: about an axis of W.
std::function<void(Estimate&)> tilted_in_world(double angle) {
  return [angle](Estimate& x) {
    x.nav.q_WB = test::rotation_of(Vector3d(angle, 0.0, 0.0)) * x.nav.q_WB;
  };
}

TEST(TiltCheck, FindsAWrongTiltInTwoSeconds) {
  double slowest = 0.0;
  for (const int points : {4, 8, 20}) {
    for (const double degrees : {3.0, 10.0, 30.0}) {
      test::Random random(3);
      Drive drive;
      drive.points = points;
      drive.wrong = tilted_in_world(degrees * kDegree);
      const Drive::Verdict verdict = drive.run(&random);
      EXPECT_GT(verdict.seconds, 0.0) << points << " points, " << degrees << " deg";
      EXPECT_LT(verdict.seconds, 2.5) << points << " points, " << degrees << " deg";
      EXPECT_LT(verdict.error, 0.3) << points << " points, " << degrees << " deg";
      EXPECT_LT(verdict.error, 3.0 * verdict.sigma) << points << " points, " << degrees << " deg";
      slowest = std::max(slowest, verdict.seconds);
    }
  }
  test::measured("wrong tilt of 3 to 30 deg, 4 to 20 points a scan: found after at most [s]",
                 slowest, "below 2.5");
}

TEST(TiltCheck, FindsAWrongAccelerometerBias) {
  test::Random random(4);
  Drive drive;
  drive.wrong = [](Estimate& x) { x.nav.accel_bias += Vector3d(0.3, -0.4, 0.0); };
  const Drive::Verdict verdict = drive.run(&random);
  EXPECT_GT(verdict.seconds, 0.0);
  EXPECT_NEAR(verdict.error, 0.5, 0.1);
  EXPECT_GT(verdict.sigma, 0.4);
}

TEST(TiltCheck, WhatTheCovarianceAdmitsIsNoContradiction) {
  test::Random random(5);
  for (const int points : {3, 6, 20}) {
    for (int run = 0; run < 20; ++run) {
      Drive drive;
      drive.points = points;
      drive.sigma_tilt = 0.05;
      drive.sigma_accel_bias = 0.1;
      const Vector3d bias = random.normal_vector(0.1);
      const auto tilt = tilted(random.normal_vector(0.05));
      drive.wrong = [&](Estimate& x) {
        tilt(x);
        x.nav.accel_bias += bias;
      };
      EXPECT_LT(drive.run(&random).seconds, 0.0) << points << " " << run;
    }
  }
}

TEST(TiltCheck, OnlyAWrongTiltIsContradicted) {
  constexpr double kTurn = 20.0 * kDegree;
  constexpr int kLong = 2000;  // scans
  const auto by_3_degrees = tilted_in_world(3.0 * kDegree);
  const auto half_silent = [](int i) { return i % 30 < 15; };  // one second of every two
  const struct {
    const char* name;
    Drive drive;
    bool contradicted;
  } rows[] = {
      {"right, 3 points", {.points = 3, .scans = kLong}, false},
      {"right, 6 points", {.points = 6, .scans = kLong}, false},
      {"right, 20 points", {.points = 20, .scans = kLong}, false},
      {"right, elevations told too noisy", {.scans = kLong, .sigma_elevation = 0.18}, false},
      {"right, the velocity changes in silence", {.scans = kLong, .silent = half_silent}, false},
      {"wrong",
       {.scans = kLong, .wrong = tilted_in_world(5.0 * kDegree), .silent = half_silent},
       true},
      {"a turned radar sees turned changes", {.scans = kLong, .turn_mounting = kTurn}, true},
      {"that sigma is known",
       {.scans = kLong, .sigma_mounting = kTurn, .turn_mounting = kTurn},
       false},
      {"either sigma admits 3 degrees",
       {.sigma_tilt = 0.05, .sigma_accel_bias = 0.5, .wrong = by_3_degrees},
       false},
      {"their correlation does not",
       {.sigma_tilt = 0.05, .sigma_accel_bias = 0.5, .tied = true, .wrong = by_3_degrees},
       true},
      // Of a noise of 0.2 m/s^2/sqrt(Hz) a line over two seconds of velocity is off by 0.155 m/s^2
      // (E4); with movers and the covariance four sigmas are 0.66 m/s^2, of a tilt of 3.9 deg.
      {"noisy: admits 3.4 degrees",
       {.accel_noise = 0.2, .wrong = tilted_in_world(3.4 * kDegree)},
       false},
      {"noisy: does not admit 4.4 degrees",
       {.accel_noise = 0.2, .wrong = tilted_in_world(4.4 * kDegree)},
       true},
  };
  for (const auto& row : rows) {
    test::Random random(3);
    EXPECT_EQ(row.drive.run(&random).seconds > 0.0, row.contradicted) << row.name;
  }
}

}  // namespace
}  // namespace rio
