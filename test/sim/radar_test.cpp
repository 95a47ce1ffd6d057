// SPDX-License-Identifier: BSD-3-Clause
#include "rio/sim/radar.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

namespace rio::sim {
namespace {

RadarModel noise_free() {
  RadarModel model = RadarModel::ideal();
  model.sigma_range = model.sigma_azimuth = model.sigma_elevation = model.sigma_doppler = 0.0;
  model.fading_sigma_db = model.flicker_sigma_db = 0.0;
  return model;
}

/// Radar axes equal body axes, at the body origin.
RadarModel forward_looking(RadarModel model) {
  model.T_BS = Pose{};
  return model;
}

Room one_reflector(const Vector3d& position_W) {
  Room room{.low_W = {-20, -20, -20}, .high_W = {20, 20, 20}, .reflectors = {}};
  room.reflectors.push_back({.position_W = position_W, .rcs_dbsm = 0.0, .ghost_rank = 1.0});
  return room;
}

const Vector3d& position(const RadarSimulator& radar, const Label& label) {
  return radar.room().reflectors[static_cast<std::size_t>(label.reflector)].position_W;
}

/// The radar's own pose, from the body's.
Vector3d radar_position(const NavState& nav, const RadarModel& model) {
  return nav.p_WB + nav.q_WB * model.T_BS.translation;
}
Vector3d in_radar_frame(const Vector3d& point_W, const NavState& nav, const RadarModel& model) {
  return model.T_BS.rotation.conjugate() *
         (nav.q_WB.conjugate() * (point_W - radar_position(nav, model)));
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
  const Trajectory trajectory = indoor_flight(6, 60.0);
  RadarSimulator radar(model, make_room(6), 6);
  constexpr double kStep = 1e-4;
  int checked = 0;
  for (double t = 6.0; t < 40.0; t += 0.0667) {
    const Trajectory::Point body = trajectory.at(t);
    const NavState before = trajectory.at(t - kStep).nav;
    const NavState after = trajectory.at(t + kStep).nav;
    const LabeledScan result = radar.scan(body);
    for (std::size_t i = 0; i < result.labels.size(); ++i) {
      const Vector3d q = position(radar, result.labels[i]);
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

/// Errors of the static detections of one flight against the truth.
struct Spread {
  double mean = 0.0;
  double sigma = 0.0;
};
struct NoiseStudy {
  std::array<std::vector<double>, 4>
      errors;  ///< range, azimuth, elevation, Doppler; angles / sigma

  explicit NoiseStudy(const RadarModel& model) {
    const Trajectory trajectory = indoor_flight(8, 60.0);
    RadarSimulator radar(model, make_room(8), 8);
    for (double t = 0.0; t < trajectory.duration(); t += 1.0 / 15.0) {
      const Trajectory::Point body = trajectory.at(t);
      const LabeledScan result = radar.scan(body);
      const Vector3d v_S =
          model.T_BS.rotation.conjugate() * Vector3d(body.nav.q_WB.conjugate() * body.nav.v_WB +
                                                     body.gyro_B.cross(model.T_BS.translation));
      for (std::size_t i = 0; i < result.labels.size(); ++i) {
        if (result.labels[i].cause != Cause::kStatic) continue;
        const Vector3d q_S = in_radar_frame(position(radar, result.labels[i]), body.nav, model);
        const Polar truth = Polar::of(q_S);
        const RadarDetection& detection = result.scan.detections[i];
        const Polar polar = Polar::of(detection.point_S);
        errors[0].push_back(polar.range - truth.range);
        errors[1].push_back((polar.azimuth - truth.azimuth) * std::cos(truth.azimuth));
        errors[2].push_back((polar.elevation - truth.elevation) * std::cos(truth.elevation));
        const double rate = -q_S.normalized().dot(v_S);
        const double error = detection.range_rate - rate;
        errors[3].push_back(model.ambiguous ? fold(error, model.max_doppler) : error);
      }
    }
  }
  Spread of(std::size_t k) const {
    Spread spread;
    for (const double e : errors[k]) spread.mean += e / static_cast<double>(errors[k].size());
    for (const double e : errors[k]) spread.sigma += (e - spread.mean) * (e - spread.mean);
    spread.sigma = std::sqrt(spread.sigma / static_cast<double>(errors[k].size()));
    return spread;
  }
};

TEST(Radar, IdealNoiseIsUnbiasedAndHasItsSigmas) {
  const NoiseStudy study(RadarModel::ideal());
  ASSERT_GT(study.errors[0].size(), 20000U);  // a sigma is then known to 0.5 %
  const std::array<double, 4> sigmas = {0.03, 2.0 * kDegree, 4.0 * kDegree, 0.02};
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(study.of(k).sigma, sigmas[k], 0.025 * sigmas[k]) << k;  // five standard errors
    EXPECT_NEAR(study.of(k).mean, 0.0, 0.035 * sigmas[k]) << k;
  }
}

TEST(Radar, GridsAddTheirUniformError) {
  RadarModel model;
  model.wander_sigma = 0.0;
  const NoiseStudy study(model);
  const double range = std::sqrt(0.03 * 0.03 + 0.0394 * 0.0394 / 12.0);
  const double step = 1.51 / 16.0;
  EXPECT_NEAR(study.of(0).sigma, range, 0.05 * range);
  EXPECT_NEAR(study.of(1).sigma, 2.0 * kDegree, 0.05 * 2.0 * kDegree);
  EXPECT_NEAR(study.of(2).sigma, 4.0 * kDegree, 0.05 * 4.0 * kDegree);
  // a tenth of the flight stands, where the Doppler sits on a grid point
  const double doppler = std::sqrt(0.02 * 0.02 + step * step / 12.0);
  EXPECT_NEAR(study.of(3).sigma, doppler, 0.07 * doppler);
}

TEST(Radar, WanderMovesTheScatteringCentre) {
  RadarModel model = noise_free();
  model.wander_sigma = 0.05;
  const NoiseStudy study(model);
  EXPECT_NEAR(study.of(0).sigma, 0.05, 0.005);  // correlated in time: few independent values
}

TEST(Radar, OnePeakACellAndEverythingOnTheGrid) {
  const RadarModel model;
  const Trajectory trajectory = indoor_flight(9, 60.0);
  RadarSimulator radar(model, make_room(9), 9);
  for (double t = 0.0; t < trajectory.duration(); t += 1.0 / 15.0) {
    std::set<std::pair<long, long>> cells;
    for (const RadarDetection& detection : radar.scan(trajectory.at(t)).scan.detections) {
      const double range = detection.point_S.norm() / model.range_resolution;
      const double doppler = detection.range_rate / model.doppler_resolution;
      EXPECT_NEAR(range, std::round(range), 1e-9);
      EXPECT_NEAR(doppler, std::round(doppler), 1e-9);
      EXPECT_GE(detection.range_rate, -model.max_doppler);
      EXPECT_LT(detection.range_rate, model.max_doppler);
      EXPECT_TRUE(cells.insert({std::lround(range), std::lround(doppler)}).second);
    }
  }
}

TEST(Radar, OutlierShareIsWhatWasAskedFor) {
  for (const double share : {0.0, 0.15, 0.35}) {
    RadarModel model;
    model.outlier_share = share;
    const Trajectory trajectory = indoor_flight(10, 60.0);
    RadarSimulator radar(model, make_room(10), 10);
    std::array<int, 4> count{};
    for (double t = 0.0; t < trajectory.duration(); t += 1.0 / 15.0) {
      for (const Label& label : radar.scan(trajectory.at(t)).labels) {
        ++count[static_cast<std::size_t>(label.cause)];
        EXPECT_EQ(label.reflector < 0, label.cause == Cause::kFalseAlarm);
      }
    }
    const double outliers = count[1] + count[2] + count[3];
    // outliers in a taken cell are hidden, which costs a few per cent of them
    EXPECT_NEAR(outliers / (count[0] + outliers), share, 0.1 * share);
    if (share > 0.0) {
      EXPECT_GT(*std::min_element(count.begin(), count.end()), 300);  // every kind occurs
    }
  }
}

TEST(Radar, GhostsObeyTheirGeometry) {
  RadarModel model = noise_free();
  model.outlier_share = 0.4;
  model.false_alarm_share = 0.0;
  const Trajectory trajectory = indoor_flight(11, 60.0);
  RadarSimulator radar(model, make_room(11), 11);
  const Room& room = radar.room();
  int mirrors = 0;
  int bounces = 0;
  for (double t = 0.0; t < trajectory.duration(); t += 1.0 / 15.0) {
    const Trajectory::Point body = trajectory.at(t);
    const LabeledScan result = radar.scan(body);
    const Vector3d v_S =
        model.T_BS.rotation.conjugate() * Vector3d(body.nav.q_WB.conjugate() * body.nav.v_WB +
                                                   body.gyro_B.cross(model.T_BS.translation));
    for (std::size_t i = 0; i < result.labels.size(); ++i) {
      const Label& label = result.labels[i];
      const RadarDetection& detection = result.scan.detections[i];
      if (label.cause == Cause::kStatic || label.cause == Cause::kFalseAlarm) continue;
      const Vector3d q_W = position(radar, label);
      const double along = -detection.point_S.normalized().dot(v_S);
      if (label.cause == Cause::kDoubleBounce) {
        const Vector3d q_S = in_radar_frame(q_W, body.nav, model);
        EXPECT_LT((detection.point_S - 2.0 * q_S).norm(), 1e-9);
        EXPECT_NEAR(detection.range_rate, 2.0 * along, 1e-9);
        ++bounces;
        continue;
      }
      EXPECT_NEAR(detection.range_rate, along, 1e-9);  // an image stands still, too
      const Vector3d ghost_W = radar_position(body.nav, model) +
                               body.nav.q_WB * (model.T_BS.rotation * detection.point_S);
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

TEST(Radar, ScansRepeatAtRestMoreThanInFlight) {
  const Trajectory trajectory = indoor_flight(12, 60.0);
  RadarSimulator radar(RadarModel{}, make_room(12), 12);
  const auto persistence = [&](double begin, double end) {
    std::set<int> last;
    double again = 0.0;
    double all = 0.0;
    for (double t = begin; t < end; t += 1.0 / 15.0) {
      std::set<int> now;
      for (const Label& label : radar.scan(trajectory.at(t)).labels) {
        if (label.cause == Cause::kStatic) now.insert(label.reflector);
      }
      for (const int id : last) again += now.count(id) > 0 ? 1.0 : 0.0;
      all += static_cast<double>(last.size());
      last = now;
    }
    return again / all;
  };
  const double rest = persistence(0.0, 4.0);
  const double flight = persistence(8.0, 40.0);
  EXPECT_GT(rest, 0.7);
  EXPECT_GT(flight, 0.5);
  EXPECT_LT(flight, 0.75);
  EXPECT_GT(rest, flight);
}

}  // namespace
}  // namespace rio::sim
