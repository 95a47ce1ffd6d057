// SPDX-License-Identifier: BSD-3-Clause
// How to simulate a measurement of each model: random true states, and sensors from sim/.
#pragma once

#include <optional>

#include "rio/core/so3.hpp"
#include "rio/models/doppler.hpp"
#include "rio/models/landmark_distance.hpp"
#include "rio/models/landmark_point.hpp"
#include "rio/models/landmark_position.hpp"
#include "rio/models/rest.hpp"
#include "rio/models/trail_distance.hpp"
#include "rio/sim/radar.hpp"
#include "rio/testing/model_suite.hpp"

namespace rio::test {

/// Small angle noise: what a model drops is of second order in it.
inline sim::RadarModel test_radar(const Pose& T_BS, bool noise) {
  sim::RadarModel m = sim::RadarModel::ideal();
  m.T_BS = T_BS;
  m.fov_azimuth = m.fov_elevation = std::numbers::pi;
  m.min_range = 0.01;
  m.threshold_db = -1000.0;
  m.sigma_azimuth = 0.01;
  m.sigma_elevation = 0.02;
  if (!noise) m.sigma_range = m.sigma_azimuth = m.sigma_elevation = m.sigma_doppler = 0.0;
  return m;
}

/// The filter's idea of test_radar.
inline RadarOptions test_radar_options() {
  const sim::RadarModel m = test_radar(Pose{}, true);
  RadarOptions o;
  o.sigma_range = m.sigma_range;
  o.sigma_azimuth = m.sigma_azimuth;
  o.sigma_elevation = m.sigma_elevation;
  o.sigma_doppler = m.sigma_doppler;
  o.weak_snr_db = -200.0;  // all echoes are alike
  return o;
}

/// The range rates of the simulated radar have the right scale.
inline constexpr double kNoScaleError = 0.0;

/// The elevations of the simulated radar have no common error.
inline constexpr double kNoElevationError = 0.0;

/// Each component from -1 to 1.
inline Vector3d in_cube(sim::Random& random) {
  return random.in_box(-Vector3d::Ones(), Vector3d::Ones());
}

/// A body in motion with a radar on it.
struct RandomBody {
  explicit RandomBody(sim::Random& random)
      : T_BS{quaternion_exp(2.0 * in_cube(random)), 0.3 * in_cube(random)},
        gyro_bias(0.05 * in_cube(random)) {
    point.nav.q_WB = quaternion_exp(2.0 * in_cube(random));
    point.nav.p_WB = 5.0 * in_cube(random);
    point.nav.v_WB = 3.0 * in_cube(random);
    point.gyro_B = 2.0 * in_cube(random);
  }

  RigidPose pose() const { return {point.nav.q_WB.toRotationMatrix(), point.nav.p_WB}; }
  RigidPose mount() const { return RigidPose(T_BS); }

  /// The world position of a place in front of the radar.
  Vector3d place(sim::Random& random) const {
    const sim::Polar polar{random.uniform(1.5, 8.0), random.uniform(-0.8, 0.8),
                           random.uniform(-0.4, 0.4)};
    const Vector3d point_B = T_BS.rotation * polar.point() + T_BS.translation;
    return point.nav.q_WB * point_B + point.nav.p_WB;
  }
  /// The detection the simulated radar makes of that place.
  Detection detect(const Vector3d& place_W, sim::Random& random, bool noise) const {
    const sim::Room room{Vector3d::Zero(), Vector3d::Zero(), {{place_W, 0.0, 1.0}}};
    const std::uint64_t seed = random.next();
    sim::RadarSimulator radar(test_radar(T_BS, noise), room, seed);
    const sim::LabeledScan scan = radar.scan(point);
    return make_detection(scan.scan.detections.at(0), test_radar_options());
  }

  sim::Trajectory::Point point;
  Pose T_BS;
  Vector3d gyro_bias;
};

/// A model without options that is defined everywhere; a case of another one replaces the function.
template <class M>
struct CaseOf {
  using Model = M;
  static Model model() { return {}; }
  static std::optional<Sample<Model>> outside(sim::Random&) { return std::nullopt; }
};

struct DopplerCase : CaseOf<DopplerModel> {
  static Model model() { return Model(DopplerDirections::kNoisy); }
  static Sample<Model> simulate(sim::Random& random, bool noise) {
    const RandomBody body(random);
    const Detection d = body.detect(body.place(random), random, noise);
    return {DopplerModel::measurement(d, body.point.gyro_B + body.gyro_bias),
            {body.pose(), body.point.nav.v_WB, body.gyro_bias, body.mount(), kNoScaleError}};
  }
};

struct TrailDistanceCase : CaseOf<TrailDistanceModel> {
  static constexpr double kSigma = 0.05;
  static Model model() { return Model(kSigma); }
  static Sample<Model> simulate(sim::Random& random, bool noise) {
    RandomBody now(random);
    RandomBody then(random);
    then.T_BS = now.T_BS;
    // a later pose near the earlier one, as between scans, so that both see the place
    then.point.nav.q_WB = now.point.nav.q_WB * quaternion_exp(0.1 * in_cube(random));
    then.point.nav.p_WB = now.point.nav.p_WB + 0.2 * in_cube(random);
    const Vector3d place = now.place(random);
    Detection current = now.detect(place, random, false);
    if (noise) current.range += kSigma * random.normal();
    const Detection past = then.detect(place, random, false);
    return {TrailDistanceModel::measurement(current, past), {now.pose(), then.pose(), now.mount()}};
  }
  static std::optional<Sample<Model>> outside(sim::Random& random) {
    Sample<Model> sample = simulate(random, false);
    // the past detection lies where the radar is now
    RigidPose& then = std::get<1>(sample.x);
    const RigidPose& now = std::get<0>(sample.x);
    const RigidPose& mount = std::get<2>(sample.x);
    then.p = now.R * mount.p + now.p - then.R * (mount.R * sample.z.past_S + mount.p);
    return sample;
  }
};

struct LandmarkDistanceCase : CaseOf<LandmarkDistanceModel> {
  static constexpr double kSigma = 0.05;
  static Model model() { return Model(kSigma); }
  static Sample<Model> simulate(sim::Random& random, bool noise) {
    const RandomBody body(random);
    const Vector3d place = body.place(random);
    Detection d = body.detect(place, random, false);
    if (noise) d.range += kSigma * random.normal();
    return {Model::measurement(d), {body.pose(), body.mount(), place}};
  }
  static std::optional<Sample<Model>> outside(sim::Random& random) {
    const RandomBody body(random);
    const Vector3d radar = body.pose().R * body.mount().p + body.pose().p;
    return Sample<Model>{{0.0}, {body.pose(), body.mount(), radar}};
  }
};

struct LandmarkPositionCase : CaseOf<LandmarkPositionModel> {
  static Sample<Model> simulate(sim::Random& random, bool noise) {
    const RandomBody body(random);
    const Vector3d place = body.place(random);
    const Detection d = body.detect(place, random, noise);
    return {Model::measurement(d), {body.pose(), body.mount(), place}};
  }
};

struct LandmarkPointCase : CaseOf<LandmarkPointModel> {
  static Sample<Model> simulate(sim::Random& random, bool noise) {
    const RandomBody body(random);
    const Vector3d place = body.place(random);
    const Detection d = body.detect(place, random, noise);
    return {Model::measurement(d), {body.pose(), body.mount(), place, kNoElevationError}};
  }
  static std::optional<Sample<Model>> outside(sim::Random& random) {
    Sample<Model> sample = simulate(random, false);
    const RigidPose& body = std::get<0>(sample.x);
    std::get<2>(sample.x) = body.R * std::get<1>(sample.x).p + body.p;  // where the radar is
    return sample;
  }
};

struct LandmarkDopplerCase : CaseOf<LandmarkDopplerModel> {
  static Sample<Model> simulate(sim::Random& random, bool noise) {
    const RandomBody body(random);
    const Vector3d place = body.place(random);
    const Detection d = body.detect(place, random, noise);
    return {Model::measurement(d, body.point.gyro_B + body.gyro_bias),
            {body.pose(), body.point.nav.v_WB, body.gyro_bias, body.mount(), kNoScaleError, place}};
  }
  static std::optional<Sample<Model>> outside(sim::Random& random) {
    Sample<Model> sample = simulate(random, false);
    const RigidPose& body = std::get<0>(sample.x);
    std::get<5>(sample.x) = body.R * std::get<3>(sample.x).p + body.p;  // where the radar is
    return sample;
  }
};

/// A body that stands: what it still moves, and what the mean of the gyroscope is off by, is noise.
struct RestCase : CaseOf<RestModel> {
  static constexpr double kSigmaVelocity = 0.01;
  static constexpr double kSigmaRate = 1e-3;
  static Sample<Model> simulate(sim::Random& random, bool noise) {
    const RandomBody body(random);
    Model::Measurement z{body.gyro_bias, kSigmaVelocity, kSigmaRate};
    Vector3d v_WB = Vector3d::Zero();
    if (noise) {
      z.gyro_B += kSigmaRate * random.normal3();
      v_WB = kSigmaVelocity * random.normal3();
    }
    return {z, {body.pose(), v_WB, body.gyro_bias}};
  }
};

}  // namespace rio::test
