// SPDX-License-Identifier: BSD-3-Clause
// Geometry of the simulated radar: signs, frames, lever arm, folding, view, cells, ghosts.
#include "rio/sim/radar.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
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

TEST(Radar, RangeRateIsTheDerivativeOfTheRangeInFlight) {
  const Room room = make_room(6);
  const auto reflector_W = [&](const Label& label, double, const Vector3d&) {
    return position(room, label);
  };
  const RadarModel model = with_lever(noise_free());
  const auto detections = with_true_range_rates(model, room, reflector_W);
  EXPECT_GT(detections.size(), 5000U);
  for (const FlownDetection& d : detections) {
    const Vector3d q_S = in_radar_frame(position(room, d), d.body.nav, model);
    ASSERT_LT((d.point_S - q_S).norm(), 1e-12);
  }
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
    model.people = 4;
    model.doppler_scale = scale;
    EXPECT_DOUBLE_EQ(model.reported_max_doppler(), (1.0 + scale) * model.max_doppler);
    double fastest = 0.0;
    std::set<Cause> causes;
    for (const auto& [t, body, result] : flown_scans(model, 9)) {
      for (const Label& label : result.labels) causes.insert(label.cause);
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
        const Vector3d u = detection.point_S.normalized() / model.angle_grid;
        EXPECT_NEAR(u.y(), std::round(u.y()), 1e-9);
        EXPECT_NEAR(u.z(), std::round(u.z()), 1e-9);
        EXPECT_GE(u.x(), 0.0);
      }
    }
    EXPECT_EQ(causes.size(), 6U);
    EXPECT_EQ(fastest > model.max_doppler, scale > 0.0);
  }
}

TEST(Radar, OutlierShareIsWhatWasAskedFor) {
  for (const double share : {0.0, 0.15, 0.35}) {
    RadarModel model;
    model.outlier_share = share;
    std::map<Cause, int> count;
    for (const FlownDetection& d : detections_of(flown_scans(model, 10))) {
      ++count[d.cause];
      EXPECT_EQ(d.reflector < 0, d.cause == Cause::kFalseAlarm);
    }
    int outliers = 0;
    for (const Cause kind : {Cause::kMirror, Cause::kDoubleBounce, Cause::kFalseAlarm}) {
      EXPECT_TRUE(share == 0.0 || count[kind] > 300) << to_string(kind);
      outliers += count[kind];
    }
    const int all = outliers + count[Cause::kStatic] + count[Cause::kSpecular];
    // outliers in a taken cell are hidden, which costs a few per cent of them
    EXPECT_NEAR(static_cast<double>(outliers) / all, share, 0.1 * share);
    EXPECT_EQ(count[Cause::kPerson], 0);
  }
}

TEST(Radar, GhostsObeyTheirGeometry) {
  RadarModel model = noise_free();
  model.outlier_share = 0.4;
  model.false_alarm_share = 0.0;
  const Room room = make_room(11);
  int mirrors = 0;
  int bounces = 0;
  for (const FlownDetection& d : detections_of(flown_scans(model, 11))) {
    if (d.cause == Cause::kStatic) continue;
    const Vector3d& q_W = position(room, d);
    const double along = -d.point_S.normalized().dot(radar_velocity_S(d.body, model));
    if (d.cause == Cause::kDoubleBounce) {
      EXPECT_LT((d.point_S - 2.0 * in_radar_frame(q_W, d.body.nav, model)).norm(), 1e-9);
      EXPECT_NEAR(d.range_rate, 2.0 * along, 1e-9);
      ++bounces;
    } else if (d.cause == Cause::kMirror) {
      EXPECT_NEAR(d.range_rate, along, 1e-9);  // an image stands still, too
      const Vector3d ghost_W = in_world(d.point_S, d.body.nav, model);
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
