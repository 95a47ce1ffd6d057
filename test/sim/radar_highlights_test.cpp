// SPDX-License-Identifier: BSD-3-Clause
// Mirror images and highlights of walls and edges, from their geometry.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <vector>

#include "sim/radar_cases.hpp"
#include "support/statistics.hpp"

namespace rio::sim {
namespace {

/// Sees nothing else, and all that are in view.
RadarModel every_highlight() {
  RadarModel model = noise_free();
  model.specular = true;
  model.threshold_db = -100.0;
  model.fov_azimuth = model.fov_elevation = 170.0 * kDegree;
  return model;
}

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
  EXPECT_LT(test::mean_of(planes), mirror_dbsm - 10.0);
  EXPECT_LT(test::mean_of(edges), mirror_dbsm - 10.0);
  EXPECT_GT(test::sigma_of(planes), 3.0);  // differ from face to face and from room to room
}

TEST(RadarHighlights, RangeRateIsTheDerivativeOfTheRangeAndThePlaceRidesAlong) {
  const RadarModel model = with_lever(every_highlight());
  const auto foot_W = [](const Label& label, double, const Vector3d& p_W) {
    return perpendicular_foot(empty_room(), label.reflector, p_W).value();
  };
  const auto detections = with_true_range_rates(model, empty_room(), foot_W);
  std::map<int, Vector3d> last;
  double moved = 0.0;
  for (const FlownDetection& d : detections) {
    ASSERT_EQ(d.cause, Cause::kSpecular);
    const Vector3d place_W = in_world(d.point_S, d.body.nav, model);
    if (last.count(d.reflector) > 0) moved += (place_W - last[d.reflector]).norm();
    last[d.reflector] = place_W;
  }
  EXPECT_GT(detections.size(), 1500U);
  EXPECT_GT(last.size(), 12U);
  // a scan: the flight makes 0.06 m, some of it along u
  EXPECT_GT(moved / static_cast<double>(detections.size()), 0.02);
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
  EXPECT_GT(test::mean_of(per_scan), 0.1);
  EXPECT_LT(test::mean_of(per_scan), 1.5);
  EXPECT_LE(test::array_of(per_scan).maxCoeff(), 6.0);
  EXPECT_GT(appearances, 40.0);
}

TEST(RadarHighlights, CountAmongTheStaticEchoes) {
  RadarModel model = every_highlight();
  model.max_static = 2;
  RadarSimulator radar(model, empty_room(), 3);
  EXPECT_EQ(radar.scan(Trajectory::Point{}).labels.size(), 2U);
}

}  // namespace
}  // namespace rio::sim
