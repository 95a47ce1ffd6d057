// SPDX-License-Identifier: BSD-3-Clause
// Geometry of the simulated radar: signs, frames, lever arm, folding, view, cells, ghosts.
#include "rio/sim/radar.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "sim/radar_cases.hpp"

namespace rio::sim {
namespace {

Room one_reflector(const Vector3d& position_W) {
  Room room{.low_W = {-20, -20, -20}, .high_W = {20, 20, 20}, .reflectors = {}};
  room.reflectors.push_back({.position_W = position_W, .rcs_dbsm = 0.0, .ghost_rank = 1.0});
  return room;
}

TEST(Radar, ApproachIsNegativeAndRecedingPositive) {
  Trajectory::Point body;
  for (const double speed : {1.0, -0.5}) {
    RadarSimulator radar(forward_looking(noise_free()), one_reflector({5.0, 0.0, 0.0}), 1);
    body.nav.v_WB = {speed, 0.7, 0.0};
    const LabeledScan result = radar.scan(body);
    ASSERT_EQ(result.scan.detections.size(), 1U);
    EXPECT_NEAR(result.scan.detections[0].range_rate, -speed, 1e-12);
    EXPECT_TRUE(result.scan.detections[0].point_S.isApprox(Vector3d(5.0, 0.0, 0.0), 1e-12));
    EXPECT_EQ(result.labels[0].cause, Cause::kStatic);
    EXPECT_EQ(result.labels[0].reflector, 0);
  }
}

TEST(Radar, TurningAboutTheBodyMovesTheRadarOnItsLever) {
  RadarModel model = forward_looking(noise_free());
  model.T_BS.translation = {0.0, 0.5, 0.0};
  RadarSimulator radar(model, one_reflector({5.0, 0.5, 0.0}), 1);
  Trajectory::Point body;
  body.gyro_B = {0.0, 0.0, 1.0};  // the radar, at +y, moves towards -x: away
  const LabeledScan result = radar.scan(body);
  ASSERT_EQ(result.scan.detections.size(), 1U);
  EXPECT_NEAR(result.scan.detections[0].range_rate, 0.5, 1e-12);
}

TEST(Radar, RangeRateIsTheDerivativeOfTheRangeInFlight) {
  RadarModel model = noise_free();
  model.T_BS.translation = {0.3, -0.2, 0.1};
  const Trajectory trajectory = random_flight(6, {.length = 60.0});
  RadarSimulator radar(model, make_room(6), 6);
  constexpr double kStep = 1e-4;
  int checked = 0;
  for (double t = 6.0; t < 40.0; t += 0.0667) {
    const Trajectory::Point body = trajectory.at(t);
    const NavState before = trajectory.at(t - kStep).nav;
    const NavState after = trajectory.at(t + kStep).nav;
    const LabeledScan result = radar.scan(body);
    for (std::size_t i = 0; i < result.labels.size(); ++i) {
      const Vector3d q = position(radar.room(), result.labels[i]);
      const double rate =
          ((q - radar_position(after, model)).norm() - (q - radar_position(before, model)).norm()) /
          (2.0 * kStep);
      const RadarDetection& detection = result.scan.detections[i];
      // truncation: kStep^2/6 times a third derivative below 1000
      ASSERT_NEAR(detection.range_rate, rate, 1e-5);
      ASSERT_LT((detection.point_S - in_radar_frame(q, body.nav, model)).norm(), 1e-12);
      ++checked;
    }
  }
  EXPECT_GT(checked, 5000);
}

TEST(Radar, DefaultMountLooksDown) {
  const Vector3d boresight_B = RadarModel().T_BS.rotation * Vector3d::UnitX();
  EXPECT_TRUE(boresight_B.isApprox(Vector3d(std::sqrt(0.5), 0.0, -std::sqrt(0.5)), 1e-12));
}

TEST(Radar, FoldsIntoTheUnambiguousInterval) {
  EXPECT_DOUBLE_EQ(fold(1.0, 1.5), 1.0);
  EXPECT_DOUBLE_EQ(fold(1.5, 1.5), -1.5);
  EXPECT_DOUBLE_EQ(fold(-1.5, 1.5), -1.5);
  EXPECT_DOUBLE_EQ(fold(2.0, 1.5), -1.0);
  EXPECT_DOUBLE_EQ(fold(-7.0, 1.5), -1.0);

  RadarModel model = forward_looking(noise_free());
  model.ambiguous = true;
  RadarSimulator radar(model, one_reflector({5.0, 0.0, 0.0}), 1);
  Trajectory::Point body;
  body.nav.v_WB = {2.0, 0.0, 0.0};
  EXPECT_NEAR(radar.scan(body).scan.detections.at(0).range_rate, -2.0 + 2.0 * 1.51, 1e-12);
}

TEST(Radar, SeesItsFieldOfViewOnly) {
  const RadarModel model = forward_looking(noise_free());
  const auto sees = [&](const Vector3d& direction) {
    RadarSimulator radar(model, one_reflector(direction), 1);
    return radar.scan(Trajectory::Point{}).scan.detections.size() == 1;
  };
  const auto at = [](double azimuth, double elevation, double range) {
    return Polar{range, azimuth * kDegree, elevation * kDegree}.point();
  };
  EXPECT_TRUE(sees(at(59.0, 0.0, 2.0)));
  EXPECT_FALSE(sees(at(61.0, 0.0, 2.0)));
  EXPECT_FALSE(sees(at(-61.0, 0.0, 2.0)));
  EXPECT_TRUE(sees(at(0.0, -14.0, 2.0)));
  EXPECT_FALSE(sees(at(0.0, 16.0, 2.0)));
  EXPECT_FALSE(sees(at(180.0, 0.0, 2.0)));
  EXPECT_FALSE(sees(at(0.0, 0.0, 0.14)));
  EXPECT_FALSE(sees(at(0.0, 0.0, 17.0)));
}

TEST(Radar, SnrFollowsTheFourthPowerOfTheRange) {
  const auto snr = [](const Vector3d& at) {
    RadarSimulator radar(forward_looking(noise_free()), one_reflector(at), 1);
    return radar.scan(Trajectory::Point{}).scan.detections.at(0).snr_db;
  };
  const double near = snr({2.0, 0.0, 0.0});
  EXPECT_NEAR(near - snr({4.0, 0.0, 0.0}), 40.0 * std::log10(2.0), 1e-9);
  EXPECT_NEAR(near - snr(Polar{2.0, 60.0 * kDegree * 0.999, 0.0}.point()), 6.0, 0.02);
}

TEST(Radar, OnePeakACellAndEverythingOnTheGrid) {
  // a radar that misjudges its Doppler misjudges its grid and its limit alike
  for (const double scale : {0.0, 0.03}) {
    RadarModel model;
    model.doppler_scale = scale;
    EXPECT_DOUBLE_EQ(model.reported_max_doppler(), (1.0 + scale) * model.max_doppler);
    double fastest = 0.0;
    for (const auto& [t, body, result] : flown_scans(model, 9)) {
      std::set<std::pair<long, long>> cells;
      for (const RadarDetection& detection : result.scan.detections) {
        const double range = detection.point_S.norm() / model.range_resolution;
        const double doppler = detection.range_rate / model.reported_doppler_resolution();
        EXPECT_NEAR(range, std::round(range), 1e-9);
        EXPECT_NEAR(doppler, std::round(doppler), 1e-9);
        EXPECT_GE(detection.range_rate, -model.reported_max_doppler());
        EXPECT_LT(detection.range_rate, model.reported_max_doppler());
        EXPECT_TRUE(cells.insert({std::lround(range), std::lround(doppler)}).second);
        fastest = std::max(fastest, std::abs(detection.range_rate));
      }
    }
    EXPECT_EQ(fastest > model.max_doppler, scale > 0.0);
  }
}

TEST(Radar, OutlierShareIsWhatWasAskedFor) {
  for (const double share : {0.0, 0.15, 0.35}) {
    RadarModel model;
    model.outlier_share = share;
    std::array<int, 6> count{};
    for (const auto& [t, body, result] : flown_scans(model, 10)) {
      for (const Label& label : result.labels) {
        ++count[static_cast<std::size_t>(label.cause)];
        EXPECT_EQ(label.reflector < 0, label.cause == Cause::kFalseAlarm);
      }
    }
    const auto of = [&](Cause cause) { return count[static_cast<std::size_t>(cause)]; };
    const int outliers = of(Cause::kMirror) + of(Cause::kDoubleBounce) + of(Cause::kFalseAlarm);
    const int all = outliers + of(Cause::kStatic) + of(Cause::kSpecular);
    // outliers in a taken cell are hidden, which costs a few per cent of them
    EXPECT_NEAR(static_cast<double>(outliers) / all, share, 0.1 * share);
    EXPECT_EQ(of(Cause::kPerson), 0);
    if (share > 0.0) {
      for (const Cause kind : {Cause::kMirror, Cause::kDoubleBounce, Cause::kFalseAlarm}) {
        EXPECT_GT(of(kind), 300) << to_string(kind);
      }
    }
  }
}

TEST(Radar, GhostsObeyTheirGeometry) {
  RadarModel model = noise_free();
  model.outlier_share = 0.4;
  model.false_alarm_share = 0.0;
  const Room room = make_room(11);
  int mirrors = 0;
  int bounces = 0;
  for (const auto& [t, body, result] : flown_scans(model, 11)) {
    const Vector3d v_S = radar_velocity_S(body, model);
    for (std::size_t i = 0; i < result.labels.size(); ++i) {
      const Label& label = result.labels[i];
      const RadarDetection& detection = result.scan.detections[i];
      if (label.cause == Cause::kStatic || label.cause == Cause::kFalseAlarm) continue;
      const Vector3d q_W = position(room, label);
      const double along = -detection.point_S.normalized().dot(v_S);
      if (label.cause == Cause::kDoubleBounce) {
        const Vector3d q_S = in_radar_frame(q_W, body.nav, model);
        EXPECT_LT((detection.point_S - 2.0 * q_S).norm(), 1e-9);
        EXPECT_NEAR(detection.range_rate, 2.0 * along, 1e-9);
        ++bounces;
        continue;
      }
      EXPECT_NEAR(detection.range_rate, along, 1e-9);  // an image stands still, too
      const Vector3d ghost_W = in_world(detection.point_S, body.nav, model);
      const double outside =
          std::max((ghost_W - room.high_W).maxCoeff(), (room.low_W - ghost_W).maxCoeff());
      EXPECT_GT(outside, 0.09);  // beyond a surface by as much as the reflector is before it
      EXPECT_EQ(((ghost_W - q_W).array().abs() > 1e-9).count(), 1);
      ++mirrors;
    }
  }
  EXPECT_GT(mirrors, 300);
  EXPECT_GT(bounces, 300);
}

}  // namespace
}  // namespace rio::sim
