// SPDX-License-Identifier: BSD-3-Clause
#include "rio/frontend/direction_noise.hpp"

#include <gtest/gtest.h>

#include "support/random_state.hpp"

namespace rio {
namespace {

/// A radar that looks down ahead, and what is true of it; configured are the defaults.
struct Radar {
  const char* name;
  double azimuth = RadarOptions{}.sigma_azimuth;      ///< true sigmas [rad]
  double elevation = RadarOptions{}.sigma_elevation;  ///< same
  double doppler = RadarOptions{}.sigma_doppler;      ///< same [m/s]
  int points = 12;
  double speed = 1.5;   ///< [m/s]
  double movers = 0.0;  ///< share of points that move by 0.1 m/s
};

/// Sigmas that are used after some scans, over the configured ones: azimuth, elevation.
Eigen::Vector2d factor_after(int scans, const Radar& radar, unsigned seed) {
  test::Random random(seed);
  RadarOptions told;
  told.doppler_resolution = 0.1;
  DirectionNoise noise(told);
  DetectionList scan;
  for (int k = 0; k < scans; ++k) {
    const Vector3d v_S = radar.speed * random.uniform(0.5, 1.5) *
                         Vector3d(1.0, 0.5 * random.normal(), 1.0).normalized();
    scan.items.clear();
    Observations seen;
    for (int i = 0; i < radar.points; ++i) {
      const double az = random.uniform(-1.05, 1.05);
      const double el = random.uniform(-0.52, 0.52);
      // the array measures direction cosines
      const double az_seen = az + radar.azimuth / std::cos(az) * random.normal();
      const double el_seen = el + radar.elevation / std::cos(el) * random.normal();
      const auto direction = [](double a, double e) {
        return Vector3d(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
      };
      const bool moves = random.uniform(0.0, 1.0) < radar.movers;
      const double rate =
          -direction(az, el).dot(v_S) + radar.doppler * random.normal() + (moves ? 0.1 : 0.0);
      const double grid = told.doppler_resolution;
      scan.items.push_back(make_detection(
          {5.0 * direction(az_seen, el_seen), grid * std::round(rate / grid), 40.0}, told));
      seen.ego_velocity.inlier[static_cast<std::size_t>(i)] = true;
    }
    noise.apply(&scan);
    seen.scan = &scan;
    seen.ego_velocity.v_S = v_S + random.normal_vector(0.02);
    noise.observe(seen, k + 1.0);
  }
  const Detection before = make_detection({Vector3d(5.0, 0.0, 0.0), 0.0, 40.0}, told);
  DetectionList next;
  next.items = {before};
  noise.apply(&next);
  return {next.items[0].sigma_azimuth_S.norm() / before.sigma_azimuth_S.norm(),
          next.items[0].sigma_elevation_S.norm() / before.sigma_elevation_S.norm()};
}

TEST(DirectionNoise, FindsAnElevationToldTwiceTooNoisy) {
  const Radar finer{.name = "finer", .elevation = 0.5 * RadarOptions{}.sigma_elevation};
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (unsigned seed = 1; seed <= 10; ++seed) mean += 0.1 * factor_after(4000, finer, seed);
  EXPECT_GT(mean.y(), 0.5);  // three sigmas remain
  EXPECT_LT(mean.y(), 0.565);
  EXPECT_GT(mean.x(), 0.95);
}

TEST(DirectionNoise, KeepsWhatIsRightOrToldTooSmall) {
  const RadarOptions told;
  const Radar kinds[] = {
      {.name = "right"},
      {.name = "few points", .points = 5},
      {.name = "one point", .points = 1},
      {.name = "noisier",
       .azimuth = 2.0 * told.sigma_azimuth,
       .elevation = 2.0 * told.sigma_elevation},
      {.name = "movers", .movers = 0.3},
      {.name = "slow", .elevation = 0.0, .points = 30, .speed = 0.25},
  };
  for (const Radar& radar : kinds) {
    int kept = 0;
    for (unsigned seed = 1; seed <= 40; ++seed) {
      kept += factor_after(300, radar, seed) == Eigen::Vector2d::Ones() ? 1 : 0;
    }
    EXPECT_GE(kept, 39) << radar.name;
  }
}

}  // namespace
}  // namespace rio
