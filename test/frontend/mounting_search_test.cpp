// SPDX-License-Identifier: BSD-3-Clause
// The mounting from scans of the simulator and its true motion, with errors of an IMU added.
#include "rio/frontend/mounting_search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "rio/core/so3.hpp"
#include "support/measured.hpp"
#include "support/short_flight.hpp"

namespace rio::test {
namespace {

/// The error of an integrated IMU, (E2) of the header, and what is claimed of it.
struct Drift {
  double sigma_position = 0.01;  // [m]
  double sigma_velocity = 0.05;  // [m/s]
  double sigma_accel = 0.05;     // [m/s^2]
  Vector3d velocity = Vector3d::Zero();
  Vector3d accel = Vector3d::Zero();

  BodyCovariance covariance() const {
    BodyCovariance P = BodyCovariance::Identity() * 1e-12;
    P.diagonal().segment<3>(body::kPosition).setConstant(sigma_position * sigma_position);
    P.diagonal().segment<3>(body::kVelocity).setConstant(sigma_velocity * sigma_velocity);
    P.diagonal().segment<3>(body::kAccelBias).setConstant(sigma_accel * sigma_accel);
    return P;
  }
};

/// True minus found, and what is claimed of it: rotation and translation of the mounting, position
/// and velocity of the body at the scan that completed the evidence.
struct Found {
  Pose T_BS;
  Eigen::Matrix<double, 12, 1> error;
  Eigen::Matrix<double, 12, 12> covariance;

  double rotation() const { return error.head<3>().norm(); }
  double sigma(int i) const { return std::sqrt(covariance(i, i)); }
  void expect_within_three_sigma(int begin, int end) const {
    for (int i = begin; i < end; ++i) EXPECT_LT(std::abs(error[i]), 3.0 * sigma(i)) << i;
  }
};

/// The first 25 s of a scenario; each is flown once for all tests.
const sim::Flight& first_seconds(const std::string& name, std::uint64_t seed) {
  static std::map<std::pair<std::string, std::uint64_t>, sim::Flight> flights;
  const auto [at, is_new] = flights.try_emplace({name, seed});
  if (is_new) at->second = short_flight(name, 25.0, seed);
  return at->second;
}

Options options_of(const sim::Flight& flight, const Pose& configured) {
  const sim::RadarModel& radar = flight.scenario.radar;
  Options options;
  options.radar.T_BS = configured;
  options.radar.sigma_azimuth = radar.sigma_azimuth;
  options.radar.sigma_elevation = radar.sigma_elevation;
  options.radar.sigma_doppler = radar.sigma_doppler;
  options.radar.doppler_resolution = radar.doppler_resolution;
  options.radar.max_doppler = radar.max_doppler;
  options.calibration.rotation_sigma = std::numbers::pi;
  options.calibration.translation_sigma = 0.5;
  return options;
}

using Each = std::function<void(MountingSearch*, Estimate*, double t)>;
using Claim = std::function<void(BodyCovariance*)>;

/// Every scan from the first motion on, `each` before it; `claim` changes the covariance.
std::optional<Found> search(const sim::Flight& flight, const Pose& configured,
                            const Drift& drift = {}, const Each& each = {},
                            const Claim& claim = {}) {
  const Options options = options_of(flight, configured);
  MountingSearch search(options);
  DetectionList list(options.frontend.max_detections);
  BodyCovariance P = drift.covariance();
  if (claim) claim(&P);
  std::optional<Time> begin;
  for (const RadarScan& scan : flight.scans) {
    Estimate x;
    x.nav = flight.truth_at(scan.time);
    if (!begin && x.nav.v_WB.norm() < 0.05) continue;
    if (!begin) begin = scan.time;
    const double t = to_seconds(scan.time - *begin);
    x.nav.v_WB -= drift.velocity + t * drift.accel;
    x.nav.p_WB -= t * drift.velocity + 0.5 * t * t * drift.accel;
    x.gyro_B = flight.trajectory.at(scan.time).gyro_B + x.nav.gyro_bias;
    x.accel_density = 1e-6;
    if (each) each(&search, &x, t);
    filter_detections(scan, options.radar, options.frontend.max_detections, list);
    const auto found = search.add(list, x, P);
    if (!found) continue;
    const Pose& truth = flight.scenario.radar.T_BS;
    const NavState nav = flight.truth_at(scan.time);
    Found out{found->T_BS, {}, found->covariance};
    out.error << quaternion_log(found->T_BS.rotation.conjugate() * truth.rotation),
        truth.translation - found->T_BS.translation,
        nav.p_WB - x.nav.p_WB - found->position_error_W,
        nav.v_WB - x.nav.v_WB - found->velocity_error_W;
    return out;
  }
  return std::nullopt;
}

Pose turned(const Pose& mounting, double angle, const Vector3d& axis) {
  return {
      (mounting.rotation * Quaternion(Eigen::AngleAxisd(angle, axis.normalized()))).normalized(),
      mounting.translation};
}

TEST(MountingSearch, FindsAMountingTurnedByAnyAngle) {
  const sim::Flight& flight = first_seconds("indoor-1", 3);
  const Pose truth = flight.scenario.radar.T_BS;
  for (const double angle : {0.0, 30.0, 90.0, 150.0, 180.0}) {
    for (const Vector3d& axis : {Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(1, -2, 3)}) {
      const auto found = search(flight, turned(truth, angle * kDegree, axis));
      SCOPED_TRACE(testing::Message() << angle << " deg about " << axis.transpose());
      ASSERT_TRUE(found);
      found->expect_within_three_sigma(0, 12);
      EXPECT_LT(found->rotation(), 0.3);
    }
  }
}

TEST(MountingSearch, FindsALongLeverArm) {
  sim::Scenario scenario;
  scenario.max_duration = 25.0;
  scenario.radar.T_BS.translation = {1.0, 0.4, -0.3};
  const sim::Flight flight = sim::simulate_flight(scenario);
  const auto found = search(flight, Pose{});
  ASSERT_TRUE(found);
  found->expect_within_three_sigma(3, 6);
  EXPECT_LT(std::abs(found->error[3]), 0.5);
}

TEST(MountingSearch, ErrorsOfAnImuAreWithinTheCovariance) {
  double rotation = 0.0;
  double motion = 0.0;
  constexpr int kFlights = 12;
  for (std::uint64_t seed = 1; seed <= kFlights; ++seed) {
    const sim::Flight& flight = first_seconds("indoor-1", seed);
    sim::Random random(seed);
    Drift drift;
    for (int i = 0; i < 3; ++i) {
      drift.velocity[i] = drift.sigma_velocity * random.normal();
      drift.accel[i] = drift.sigma_accel * random.normal();
    }
    const auto found = search(flight, turned(flight.scenario.radar.T_BS, 2.0, {1, 2, 3}), drift);
    ASSERT_TRUE(found) << seed;
    const auto nees = [&](int at, int size) {
      const Eigen::VectorXd part = found->error.segment(at, size);
      return part.dot(found->covariance.block(at, at, size, size).ldlt().solve(part)) / size;
    };
    rotation += nees(0, 3) / kFlights;
    motion += nees(6, 6) / kFlights;
  }
  // the simulator has no error of the directions that lasts: the claim (E4) is wider than needed
  expect_between("NEES of the rotation", rotation, 0.02, 1.5);
  expect_below("NEES of position and velocity", motion, 1.5);
}

// A climb, with the elevations too noisy for the vertical velocity of a scan: the errors of short
// velocities must not be preferred.
TEST(MountingSearch, NoisyVelocitiesDoNotTurnIt) {
  double pitch = 0.0;
  constexpr int kFlights = 12;
  for (std::uint64_t seed = 1; seed <= kFlights; ++seed) {
    const sim::Flight& flight = first_seconds("outdoor", seed);
    const auto found = search(flight, Pose{});
    ASSERT_TRUE(found) << seed;
    pitch += found->error[1] / found->sigma(1) / kFlights;
  }
  const double three_sigma = 3.0 / std::sqrt(kFlights);
  expect_near("pitch over its sigma, mean of 12 flights", pitch, 0.0, three_sigma);
}

TEST(MountingSearch, WhatTheImuKnowsBestStaysSo) {
  const sim::Flight& flight = first_seconds("outdoor", 1);
  Drift drift;
  drift.sigma_velocity = 0.2;
  constexpr double kVertical = 1e-3;
  const auto found =
      search(flight, Pose{}, drift, {}, [](BodyCovariance* P) {  // as after a start on level ground
        (*P)(body::kVelocity + 2, body::kVelocity + 2) = kVertical * kVertical;
        (*P)(body::kAccelBias + 2, body::kAccelBias + 2) = 1e-8;
        (*P)(body::kAttitude, body::kAttitude) = 1e-4;
      });
  ASSERT_TRUE(found);
  EXPECT_LT(found->sigma(11), 0.02);
  EXPECT_GT(std::min(found->sigma(9), found->sigma(10)), 0.05);
}

// Flights that begin with a climb of five seconds, which does not show the heading of the radar.
TEST(MountingSearch, WhatAClimbDoesNotShowIsAwaited) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const sim::Flight& flight = first_seconds("outdoor", seed);
    const Pose truth = flight.scenario.radar.T_BS;
    const auto found = search(flight, turned(truth, 90.0 * kDegree, {1, -2, 3}));
    ASSERT_TRUE(found) << seed;
    EXPECT_LT(found->rotation(), 0.6) << seed;
  }
}

TEST(MountingSearch, WhatAStraightDriveDoesNotShowIsAsConfigured) {
  const sim::Flight flight = sim::simulate_flight({.path = {.ground = true,
                                                            .length = 30.0,
                                                            .low = {-2.0, -0.2, 0.3},
                                                            .high = {40.0, 0.2, 0.3},
                                                            .reach = {30.0, 0.1, 0.1},
                                                            .max_yaw = 0.02}});
  const Pose truth = flight.scenario.radar.T_BS;
  // ahead in radar axes: the direction that the drive shows
  const Vector3d ahead_S = truth.rotation.conjugate() * Vector3d::UnitX();
  const Pose rolled = turned(truth, 40.0 * kDegree, ahead_S);
  const auto found = search(flight, rolled);
  ASSERT_TRUE(found);
  const Vector3d off = quaternion_log(truth.rotation.conjugate() * found->T_BS.rotation);
  EXPECT_NEAR(off.dot(ahead_S), 40.0 * kDegree, 5.0 * kDegree);
  const Matrix3d P = found->covariance.topLeftCorner<3, 3>();
  const double along = ahead_S.dot(P * ahead_S);
  EXPECT_NEAR(std::sqrt(along), 0.25, 0.05);
  EXPECT_LT((off - off.dot(ahead_S) * ahead_S).norm(), 3.0 * std::sqrt(P.trace() - along));
  EXPECT_LT(std::sqrt(P.trace() - along), 0.3);
}

// With a lever arm that is unknown, too, a turn on level ground looks the same upside down.
TEST(MountingSearch, ADriveOnLevelGroundIsNotUpsideDown) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const sim::Flight flight = short_flight("rough-ground", 40.0, seed);
    const auto found = search(flight, Pose{});
    ASSERT_TRUE(found) << seed;
    EXPECT_LT(found->rotation(), 1.0) << seed;
  }
}

TEST(MountingSearch, ACorrectedVelocityNeedsARestart) {
  const sim::Flight& flight = first_seconds("indoor-1", 3);
  const Pose configured = turned(flight.scenario.radar.T_BS, 2.0, {1, 2, 3});
  Drift drift;
  drift.sigma_velocity = 1.0;
  const auto rotation_error = [&](bool restart) {
    bool corrected = false;
    const auto found =
        search(flight, configured, drift, [&](MountingSearch* search, Estimate* x, double t) {
          if (t < 1.5) {
            x->nav.v_WB += Vector3d(1.0, -1.0, 0.5);
          } else if (restart && !corrected) {
            search->restart_drift();
            corrected = true;
          }
        });
    return found ? found->rotation() : 10.0;
  };
  EXPECT_LT(rotation_error(true), 0.4);
  EXPECT_GT(rotation_error(false), 0.6);
}

TEST(MountingSearch, IsOnlyForAPriorThatIsNoCalibration) {
  CalibrationOptions calibration;
  EXPECT_FALSE(MountingSearch::is_unknown(calibration));
  calibration.rotation_sigma = 1.0;
  EXPECT_FALSE(MountingSearch::is_unknown(calibration));
  calibration.rotation_sigma = std::numbers::pi;
  EXPECT_TRUE(MountingSearch::is_unknown(calibration));
}

}  // namespace
}  // namespace rio::test
