// SPDX-License-Identifier: BSD-3-Clause
// Noise and grids of the simulated radar, recovered from its own output.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <set>
#include <vector>

#include "sim/radar_cases.hpp"
#include "support/measured.hpp"

namespace rio::sim {
namespace {

double largest(const std::vector<double>& values) {
  double most = 0.0;
  for (const double v : values) most = std::max(most, std::abs(v));
  return most;
}

/// Errors of one static detection against its label.
struct Error {
  Polar truth;
  double range;
  double azimuth;
  double elevation;
  double doppler;
  double y_over_r;
  double z_over_r;
  double snr_db;
  int reflector;
  double seconds;
};

/// Those of a flight of 60 m.
std::vector<Error> errors_of(const RadarModel& model) {
  const Room room = make_room(8);
  std::vector<Error> errors;
  for (const auto& [t, body, result] : flown_scans(model, 8)) {
    const Vector3d v_S = radar_velocity_S(body, model);
    for (std::size_t i = 0; i < result.labels.size(); ++i) {
      if (result.labels[i].cause != Cause::kStatic) continue;
      const Vector3d q_S = in_radar_frame(position(room, result.labels[i]), body.nav, model);
      const RadarDetection& detection = result.scan.detections[i];
      const Polar polar = Polar::of(detection.point_S);
      const Polar truth = Polar::of(q_S);
      const Vector3d cosines = detection.point_S.normalized() - q_S.normalized();
      const double doppler = detection.range_rate + q_S.normalized().dot(v_S);
      errors.push_back({truth, polar.range - truth.range, polar.azimuth - truth.azimuth,
                        polar.elevation - truth.elevation,
                        model.ambiguous ? fold(doppler, model.max_doppler) : doppler, cosines.y(),
                        cosines.z(), detection.snr_db, result.labels[i].reflector, t});
    }
  }
  return errors;
}

template <typename Value, typename Keep>
std::vector<double> select(const std::vector<Error>& errors, Value value, Keep keep) {
  std::vector<double> values;
  for (const Error& e : errors) {
    if (keep(e)) values.push_back(std::invoke(value, e));
  }
  return values;
}
template <typename Value>
std::vector<double> select(const std::vector<Error>& errors, Value value) {
  return select(errors, value, [](const Error&) { return true; });
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

TEST(RadarNoise, IdealIsWhite) {
  std::map<int, const Error*> last;
  double product = 0.0;
  double square = 0.0;
  const std::vector<Error> errors = errors_of(RadarModel::ideal());
  for (const Error& e : errors) {
    const Error*& before = last[e.reflector];
    if (before != nullptr && e.seconds - before->seconds < 1.5 * kScanPeriod) {
      product += e.range * before->range;
      square += e.range * e.range;
    }
    before = &e;
  }
  EXPECT_NEAR(product / square, 0.0, 0.04);  // about 15000 pairs: five standard errors
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
  for (const auto cosine : {&Error::y_over_r, &Error::z_over_r}) {
    const std::vector<double> values = select(errors, cosine);
    expect_sigma(values, model.angle_grid / std::sqrt(12.0), 0.03, 0.03);
    EXPECT_LE(largest(values), 0.5 * model.angle_grid + 1e-12);
  }
  EXPECT_LT(largest(select(errors, &Error::range)), 1e-12);
}

TEST(RadarNoise, SlipsIntoTheNeighbouringDopplerCell) {
  RadarModel model = RadarModel::ideal();
  model.quantize = true;
  model.sigma_doppler = 1e-3;
  model.doppler_resolution = 0.1;
  const auto slipped = [](const std::vector<Error>& errors) {
    double count = 0.0;
    for (const Error& e : errors) count += std::abs(e.doppler) > 0.055 ? 1.0 : 0.0;
    return count / static_cast<double>(errors.size());
  };
  EXPECT_EQ(slipped(errors_of(model)), 0.0);
  model.doppler_slip_share = 0.4;
  // half of it for range rates spread evenly over a cell; none at rest
  const std::vector<Error> errors = errors_of(model);
  double moving = 0.0;
  double off = 0.0;
  for (const Error& e : errors) {
    if (e.seconds < kTakeOff) {
      EXPECT_LT(std::abs(e.doppler), 0.055);
      continue;
    }
    moving += 1.0;
    off += std::abs(e.doppler) > 0.055 ? 1.0 : 0.0;
    EXPECT_LT(std::abs(e.doppler), 0.105);  // one cell, beside the border it was near
  }
  test::measured("share of slips of 0.4 on the border", off / moving, "0.15 to 0.22");
  EXPECT_GT(off / moving, 0.15);
  EXPECT_LT(off / moving, 0.22);
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

TEST(RadarNoise, DecaysWithTheWayFlown) {
  RadarModel model = RadarModel::ideal();
  model.fresh_noise = 0.0;
  model.noise_distance = 0.05;
  // pairs of neighbouring scans by the way between them: 0.5 to 1 m/s at 15 Hz
  const Trajectory trajectory = random_flight(13, {.length = 60.0});
  RadarSimulator radar(model, make_room(13), 13);
  std::map<int, std::pair<double, int>> last;  // error of a reflector and its scan
  Vector3d last_p = Vector3d::Zero();
  double product = 0.0;
  double square = 0.0;
  double expected = 0.0;
  for (int scan = 0; scan * kScanPeriod < trajectory.duration(); ++scan) {
    const Trajectory::Point body = trajectory.at(scan * kScanPeriod);
    const Vector3d p = body.nav.p_WB + body.nav.q_WB * model.T_BS.translation;
    const double keep = std::exp(-(p - last_p).norm() / model.noise_distance);
    last_p = p;
    const LabeledScan result = radar.scan(body);
    for (std::size_t i = 0; i < result.labels.size(); ++i) {
      const int id = result.labels[i].reflector;
      const Vector3d& q = radar.room().reflectors[static_cast<std::size_t>(id)].position_W;
      const double error = result.scan.detections[i].point_S.norm() - (q - p).norm();
      const auto before = last.find(id);
      if (body.flying && before != last.end() && before->second.second == scan - 1) {
        product += error * before->second.first;
        square += error * error;
        expected += error * error * keep;
      }
      last[id] = {error, scan};
    }
  }
  EXPECT_GT(expected / square, 0.2);
  EXPECT_NEAR(product / square, expected / square, 0.05);  // some 10^4 pairs
}

TEST(RadarAngles, EveryDetectionLiesOnTheGrid) {
  RadarModel model;
  model.people = 4;
  std::set<Cause> causes;
  for (const auto& [t, body, result] : flown_scans(model, 9)) {
    for (std::size_t i = 0; i < result.labels.size(); ++i) {
      const Vector3d u = result.scan.detections[i].point_S.normalized() / model.angle_grid;
      ASSERT_NEAR(u.y(), std::round(u.y()), 1e-9);
      ASSERT_NEAR(u.z(), std::round(u.z()), 1e-9);
      ASSERT_GE(u.x(), 0.0);
      causes.insert(result.labels[i].cause);
    }
  }
  EXPECT_EQ(causes.size(), 6U);
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
