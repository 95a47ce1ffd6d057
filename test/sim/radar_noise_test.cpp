// SPDX-License-Identifier: BSD-3-Clause
// Noise and grids of the simulated radar, recovered from its own output.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "sim/radar_cases.hpp"
#include "support/measured.hpp"
#include "support/statistics.hpp"

namespace rio::sim {
namespace {

using test::mean_of;
using test::sigma_of;

/// Errors of one static detection against its label.
struct Error : FlownDetection {
  Polar truth;
  double range;
  double azimuth;
  double elevation;
  double doppler;
  Vector3d cosines;  ///< of the direction
};

/// Those of a flight of 60 m.
std::vector<Error> errors_of(const RadarModel& model) {
  const Room room = make_room(8);
  std::vector<Error> errors;
  for (const FlownDetection& d : detections_of(flown_scans(model, 8))) {
    if (d.cause != Cause::kStatic) continue;
    const Vector3d q_S = in_radar_frame(position(room, d), d.body.nav, model);
    const Vector3d u_S = q_S.normalized();
    const Polar polar = Polar::of(d.point_S);
    const Polar truth = Polar::of(q_S);
    const double doppler = d.range_rate + u_S.dot(radar_velocity_S(d.body, model));
    errors.push_back({d, truth, polar.range - truth.range, polar.azimuth - truth.azimuth,
                      polar.elevation - truth.elevation,
                      model.ambiguous ? fold(doppler, model.max_doppler) : doppler,
                      d.point_S.normalized() - u_S});
  }
  return errors;
}

constexpr auto kEvery = [](const Error&) { return true; };
template <typename Value, typename Keep = decltype(kEvery)>
std::vector<double> select(const std::vector<Error>& errors, Value value, Keep keep = kEvery) {
  std::vector<double> values;
  for (const Error& e : errors) {
    if (keep(e)) values.push_back(std::invoke(value, e));
  }
  return values;
}

/// How the range errors of the reflectors correlate from scan to scan, and the mean of
/// what `expected` says for the way of the radar [m] between the two, weighted alike.
template <typename Expected>
std::pair<double, double> correlation(const RadarModel& model, const Expected& expected) {
  std::map<int, Error> last;
  double product = 0.0;
  double square = 0.0;
  double weighted = 0.0;
  for (const Error& e : errors_of(model)) {
    const auto before = last.find(e.reflector);
    if (before != last.end() && e.seconds - before->second.seconds < 1.5 * kScanPeriod) {
      const Vector3d way =
          radar_position(e.body.nav, model) - radar_position(before->second.body.nav, model);
      product += e.range * before->second.range;
      square += e.range * e.range;
      weighted += e.range * e.range * expected(way.norm());
    }
    last.insert_or_assign(e.reflector, e);
  }
  return {product / square, weighted / square};
}

/// Their standard deviation is `sigma` within a share of it, and so is their mean zero.
void expect_sigma(const std::vector<double>& values, double sigma, double share,
                  double share_of_mean = 1e9) {
  EXPECT_NEAR(sigma_of(values), sigma, share * sigma);
  EXPECT_NEAR(mean_of(values), 0.0, share_of_mean * sigma);
}

double boresight_azimuth(const Error& e) {
  return e.azimuth * std::cos(e.truth.azimuth);
}
double boresight_elevation(const Error& e) {
  return e.elevation * std::cos(e.truth.elevation);
}

TEST(RadarNoise, IdealIsUnbiasedAndHasItsSigmas) {
  const std::vector<Error> errors = errors_of(RadarModel::ideal());
  ASSERT_GT(errors.size(), 20000U);  // a sigma is then known to 0.5 %
  // five standard errors
  expect_sigma(select(errors, &Error::range), 0.03, 0.025, 0.035);
  expect_sigma(select(errors, boresight_azimuth), 2.0 * kDegree, 0.025, 0.035);
  expect_sigma(select(errors, boresight_elevation), 4.0 * kDegree, 0.025, 0.035);
  expect_sigma(select(errors, &Error::doppler), 0.02, 0.025, 0.035);
}

TEST(RadarNoise, ASceneTurnsAllDirectionsAndChangesWithTheWay) {
  RadarModel model = noise_free();
  model.scene_angle = 2.0 * kDegree;
  model.scene_distance = 0.3;
  std::vector<Error> scans;  // the first error of each
  double product = 0.0;
  double expected = 0.0;
  for (const Error& e : errors_of(model)) {
    if (!scans.empty() && e.seconds == scans.back().seconds) {
      EXPECT_NEAR(e.azimuth, scans.back().azimuth, 1e-9);
      EXPECT_NEAR(e.elevation, scans.back().elevation, 1e-9);
      continue;
    }
    if (!scans.empty()) {
      const Error& last = scans.back();
      const Vector3d way = radar_position(e.body.nav, model) - radar_position(last.body.nav, model);
      product += e.azimuth * last.azimuth + e.elevation * last.elevation;
      expected += std::exp(-way.norm() / model.scene_distance) *
                  (last.azimuth * last.azimuth + last.elevation * last.elevation);
    }
    scans.push_back(e);
  }
  // 200 e-folding distances, two angles: three standard errors
  expect_sigma(select(scans, &Error::azimuth), model.scene_angle, 0.15);
  expect_sigma(select(scans, &Error::elevation), model.scene_angle, 0.15);
  EXPECT_NEAR(product / expected, 1.0, 0.05);
}

TEST(RadarNoise, IdealIsWhiteAndOtherDecaysWithTheWayFlown) {
  const auto white = [](double) { return 0.0; };
  // some 10^4 pairs: five standard errors
  EXPECT_NEAR(correlation(RadarModel::ideal(), white).first, 0.0, 0.04);
  RadarModel model = RadarModel::ideal();
  model.fresh_noise = 0.0;
  model.noise_distance = 0.05;
  // 0.5 to 1 m/s at 15 Hz in flight, and all of it at rest
  const auto [seen, expected] =
      correlation(model, [](double way) { return std::exp(-way / 0.05); });
  EXPECT_GT(expected, 0.2);
  EXPECT_NEAR(seen, expected, 0.05);
}

TEST(RadarNoise, AzimuthGrowsOffBoresight) {
  const std::vector<Error> errors = errors_of(RadarModel::ideal());
  for (const double centre : {0.0, 25.0, 50.0}) {
    SCOPED_TRACE(centre);
    const auto values = select(errors, &Error::azimuth, [&](const Error& e) {
      return std::abs(std::abs(e.truth.azimuth) - centre * kDegree) < 5.0 * kDegree;
    });
    ASSERT_GT(values.size(), 1500U);
    expect_sigma(values, 2.0 * kDegree / std::cos(centre * kDegree), 0.07);  // four standard errors
  }
}

TEST(RadarNoise, AnglesOfWeakEchoesAreWorse) {
  RadarModel model = RadarModel::ideal();
  model.weak_angle_growth = 3.0;
  const std::vector<Error> errors = errors_of(model);
  for (const double excess_db : {0.25, 3.0, 6.0, 15.0}) {
    SCOPED_TRACE(excess_db);
    const auto near = [&](const Error& e) {
      return std::abs(e.snr_db - model.threshold_db - excess_db) < 0.25;
    };
    const auto count = static_cast<double>(select(errors, &Error::range, near).size());
    ASSERT_GT(count, 200.0);
    const double share = 4.0 / std::sqrt(2.0 * count);  // four standard errors
    const double growth = std::sqrt(1.0 + 3.0 * std::pow(10.0, -excess_db / 10.0));
    expect_sigma(select(errors, boresight_azimuth, near), 2.0 * kDegree * growth, share);
    expect_sigma(select(errors, boresight_elevation, near), 4.0 * kDegree * growth, share);
    expect_sigma(select(errors, &Error::range, near), 0.03, share);
    expect_sigma(select(errors, &Error::doppler, near), 0.02, share);
  }
}

TEST(RadarNoise, GridsAddTheirUniformError) {
  RadarModel model;
  model.wander_sigma = model.weak_angle_growth = model.angle_grid = 0.0;
  const std::vector<Error> errors = errors_of(model);
  // 5 %: the errors of a reflector last for 0.15 m, which leaves some 1500 independent values
  expect_sigma(select(errors, &Error::range), std::hypot(0.03, 0.0394 / std::sqrt(12.0)), 0.05);
  expect_sigma(select(errors, boresight_azimuth), 2.0 * kDegree, 0.05);
  expect_sigma(select(errors, boresight_elevation), 4.0 * kDegree, 0.05);
  // a tenth of the flight stands, where the Doppler sits on a grid point
  const double step = 1.51 / 16.0;
  expect_sigma(select(errors, &Error::doppler), std::hypot(0.02, step / std::sqrt(12.0)), 0.07);
}

TEST(RadarNoise, AngleGridAddsItsUniformError) {
  RadarModel model = noise_free();
  model.angle_grid = 1.0 / 32.0;
  const std::vector<Error> errors = errors_of(model);
  for (const int axis : {1, 2}) {
    const auto values = select(errors, [&](const Error& e) { return e.cosines[axis]; });
    expect_sigma(values, model.angle_grid / std::sqrt(12.0), 0.03, 0.03);
    EXPECT_LE(test::array_of(values).abs().maxCoeff(), 0.5 * model.angle_grid + 1e-12);
  }
  EXPECT_LT(test::array_of(select(errors, &Error::range)).abs().maxCoeff(), 1e-12);
}

TEST(RadarNoise, SlipsIntoTheNeighbouringDopplerCell) {
  RadarModel model = RadarModel::ideal();
  model.quantize = true;
  model.sigma_doppler = 1e-3;
  model.doppler_resolution = 0.1;
  const auto resting = [](const Error& e) { return e.seconds < kTakeOff; };
  const auto errors_if = [&](const auto& keep) {
    const std::vector<double> values = select(errors_of(model), &Error::doppler, keep);
    return Eigen::ArrayXd(test::array_of(values).abs());
  };
  EXPECT_LT(errors_if(kEvery).maxCoeff(), 0.055);
  model.doppler_slip_share = 0.4;
  // half of it for range rates spread evenly over a cell; none at rest
  EXPECT_LT(errors_if(resting).maxCoeff(), 0.055);
  const Eigen::ArrayXd moving = errors_if(std::not_fn(resting));
  EXPECT_LT(moving.maxCoeff(), 0.105);  // one cell, beside the border it was near
  const double slipped = (moving > 0.055).cast<double>().mean();
  test::expect_between("share of slips of 0.4 on the border", slipped, 0.15, 0.22);
}

TEST(RadarNoise, WanderMovesTheScatteringCentre) {
  RadarModel model = noise_free();
  model.wander_sigma = 0.05;
  const auto range = select(errors_of(model), &Error::range);
  EXPECT_NEAR(sigma_of(range), 0.05, 0.005);  // correlated in time: few independent values
}

TEST(RadarNoise, RepeatsAtRestAndChangesInFlight) {
  RadarModel model = RadarModel::ideal();
  model.fresh_noise = 0.2;
  std::map<int, std::vector<double>> resting;
  std::vector<double> flying;
  std::vector<double> fresh;
  for (const Error& e : errors_of(model)) {
    (e.seconds < kTakeOff ? resting[e.reflector] : flying).push_back(e.range);
  }
  for (const auto& [reflector, values] : resting) {
    for (const double v : values) fresh.push_back(v - mean_of(values));
  }
  // the mean over at most 60 scans takes a few per cent of the fresh part away
  EXPECT_NEAR(sigma_of(fresh), 0.2 * 0.03, 0.06 * 0.2 * 0.03);
  EXPECT_NEAR(sigma_of(flying), 0.03, 0.05 * 0.03);
}

TEST(RadarAngles, DirectionsOutsideOfTheUnitCircleStepInwards) {
  constexpr double kGrid = 0.25;
  // rounds to (1, 0.25): outside
  const Vector3d snapped = snap_direction(2.0 * Vector3d(0.1, 0.97, 0.22).normalized(), kGrid);
  EXPECT_NEAR(snapped.norm(), 2.0, 1e-12);
  EXPECT_NEAR(snapped.y() / 2.0, 0.75, 1e-12);
  EXPECT_NEAR(snapped.z() / 2.0, 0.25, 1e-12);
  // rounds to (-0.75, -0.75)
  const Vector3d corner = snap_direction(Vector3d(0.1, -0.7, -0.701).normalized(), kGrid);
  EXPECT_NEAR(corner.norm(), 1.0, 1e-12);
  EXPECT_GT(corner.x(), 0.0);
  // a single cosine of one stays
  EXPECT_TRUE(snap_direction({0.05, 1.0, 0.0}, kGrid).isApprox(Vector3d::UnitY() * 1.00125, 1e-5));
  EXPECT_EQ(snap_direction({3.0, 1.0, 0.5}, 0.0), Vector3d(3.0, 1.0, 0.5));
}

}  // namespace
}  // namespace rio::sim
