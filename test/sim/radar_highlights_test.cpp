// SPDX-License-Identifier: BSD-3-Clause
// Mirror images and highlights of walls and edges, from their geometry.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <vector>

#include "sim/radar_cases.hpp"

namespace rio::sim {
namespace {

TEST(RadarHighlights, FeetLieOnTheFaceOrEdge) {
  const Room room = empty_room();
  const Vector3d p_W(1.0, -2.0, 0.5);
  EXPECT_EQ(perpendicular_foot(room, 0, p_W), Vector3d(-4.0, -2.0, 0.5));
  EXPECT_EQ(perpendicular_foot(room, 3, p_W), Vector3d(1.0, 3.5, 0.5));
  EXPECT_EQ(perpendicular_foot(room, 4, p_W), Vector3d(1.0, -2.0, -0.35));
  std::set<std::vector<double>> feet;
  for (int i = 0; i < kHighlights; ++i) {
    const std::optional<Vector3d> foot = perpendicular_foot(room, i, p_W);
    ASSERT_TRUE(foot);
    const auto low = (foot->array() == room.low_W.array()).count();
    const auto high = (foot->array() == room.high_W.array()).count();
    EXPECT_EQ(low + high, i < kPlanes ? 1 : 2);
    feet.insert({foot->x(), foot->y(), foot->z()});
  }
  EXPECT_EQ(feet.size(), static_cast<std::size_t>(kHighlights));
  // beside the room: the floor ends before
  EXPECT_FALSE(perpendicular_foot(room, 4, {5.0, 0.0, 0.5}));
  EXPECT_FALSE(perpendicular_foot(room, 6, {5.0, 0.0, 0.5}));  // edge along x
  EXPECT_TRUE(perpendicular_foot(room, 0, {5.0, 0.0, 0.5}));
}

TEST(RadarHighlights, ImagesLieAsFarBehindAFaceAsThePointBeforeIt) {
  const Room room = empty_room();
  const Vector3d p_W(1.0, -2.0, 0.5);
  const auto images = mirror_images(room, p_W);
  for (int i = 0; i < kPlanes; ++i) {
    const Vector3d middle_W = 0.5 * (images.at(static_cast<std::size_t>(i)) + p_W);
    EXPECT_LT((middle_W - perpendicular_foot(room, i, p_W).value()).norm(), 1e-12) << i;
  }
}

TEST(RadarHighlights, FadeWithTheSecondAndThirdPowerAndReflectLessThanAMirror) {
  // the echo of an image of the radar at 2 r, and of a point reflector at r: pi r^2
  const double mirror_dbsm = 10.0 * std::log10(std::numbers::pi);
  std::vector<double> planes;
  std::vector<double> edges;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Highlights highlights(seed);
    for (int i = 0; i < kHighlights; ++i) {
      (i < kPlanes ? planes : edges).push_back(highlights.rcs_dbsm(i, 1.0));
      const double power = i < kPlanes ? 2.0 : 1.0;
      ASSERT_NEAR(highlights.rcs_dbsm(i, 4.0) - highlights.rcs_dbsm(i, 2.0),
                  power * 10.0 * std::log10(2.0), 1e-9);
    }
  }
  EXPECT_LT(mean_of(planes), mirror_dbsm - 10.0);
  EXPECT_LT(mean_of(edges), mirror_dbsm - 10.0);
  EXPECT_GT(sigma_of(planes), 3.0);  // differ from face to face and from room to room
}

TEST(RadarHighlights, RangeRateIsTheDerivativeOfTheRangeAndThePlaceRidesAlong) {
  RadarModel model = noise_free();
  model.specular = true;
  model.threshold_db = -100.0;  // all that is in view
  model.fov_azimuth = model.fov_elevation = 170.0 * kDegree;
  model.T_BS.translation = {0.3, -0.2, 0.1};
  const Trajectory trajectory = random_flight(6, {.length = 60.0});
  RadarSimulator radar(model, empty_room(), 6);
  constexpr double kStep = 1e-4;
  std::set<int> seen;
  std::map<int, Vector3d> last;
  double moved = 0.0;
  int checked = 0;
  for (double t = 6.0; t < 40.0; t += kScanPeriod) {
    const Trajectory::Point body = trajectory.at(t);
    const auto distance = [&](int index, double at) {
      const Vector3d p_W = radar_position(trajectory.at(at).nav, model);
      return (perpendicular_foot(radar.room(), index, p_W).value() - p_W).norm();
    };
    const LabeledScan result = radar.scan(body);
    for (std::size_t i = 0; i < result.labels.size(); ++i) {
      ASSERT_EQ(result.labels[i].cause, Cause::kSpecular);
      const int index = result.labels[i].reflector;
      const RadarDetection& detection = result.scan.detections[i];
      const double rate = (distance(index, t + kStep) - distance(index, t - kStep)) / (2.0 * kStep);
      // truncation: kStep^2/6 times a third derivative below 1000
      ASSERT_NEAR(detection.range_rate, rate, 1e-5);
      ASSERT_NEAR(detection.point_S.norm(), distance(index, t), 1e-9);
      const Vector3d place_W = in_world(detection.point_S, body.nav, model);
      if (last.count(index) > 0) moved += (place_W - last[index]).norm();
      last[index] = place_W;
      seen.insert(index);
      ++checked;
    }
  }
  EXPECT_GT(checked, 1500);
  EXPECT_GT(seen.size(), 12U);
  EXPECT_GT(moved / checked, 0.02);  // a scan: the flight makes 0.06 m, some of it along u
}

TEST(RadarHighlights, AreFewAndComeAndGo) {
  std::vector<double> per_scan;
  double appearances = 0.0;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    std::set<int> last;
    for (const auto& [t, body, result] : flown_scans(RadarModel{}, seed)) {
      std::set<int> now;
      for (const Label& label : result.labels) {
        if (label.cause == Cause::kSpecular) now.insert(label.reflector);
      }
      for (const int id : now) appearances += last.count(id) > 0 ? 0.0 : 1.0;
      per_scan.push_back(static_cast<double>(now.size()));
      last = now;
    }
  }
  EXPECT_GT(mean_of(per_scan), 0.1);
  EXPECT_LT(mean_of(per_scan), 1.5);
  EXPECT_LE(*std::max_element(per_scan.begin(), per_scan.end()), 6.0);
  EXPECT_GT(appearances, 40.0);
}

TEST(RadarHighlights, CountAmongTheStaticEchoes) {
  RadarModel model = noise_free();
  model.specular = true;
  model.threshold_db = -100.0;
  model.fov_azimuth = model.fov_elevation = 170.0 * kDegree;
  model.max_static = 2;
  RadarSimulator radar(model, empty_room(), 3);
  EXPECT_EQ(radar.scan(Trajectory::Point{}).labels.size(), 2U);
}

}  // namespace
}  // namespace rio::sim
