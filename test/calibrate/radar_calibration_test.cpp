// SPDX-License-Identifier: BSD-3-Clause
// Simulated radars told wrongly: what the recordings tell, how honest the sigmas are, and that
// nothing is claimed where the recordings do not tell or contradict themselves.
#include "calibrate/radar_calibration.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "experiment/trial.hpp"
#include "rio/core/so3.hpp"
#include "rio/eval/nees.hpp"
#include "rio/sim/scenario.hpp"
#include "support/constants.hpp"
#include "support/flight_recording.hpp"
#include "support/measured.hpp"

namespace rio::calibrate {
namespace {

/// With every effect of the default room, and told 5 deg, 5 cm, 10 ms and 1 % wrong.
sim::Flight fly_wrong(std::uint64_t seed, double length) {
  return sim::simulate_flight(
      {.seed = seed,
       .path = {.length = length},
       .radar = {.doppler_scale = 0.01, .stamp_offset = 0.01},
       .errors = {.extrinsic_angle = 5.0 * kDegree, .extrinsic_distance = 0.05}});
}

Options configured(const sim::Flight& flight) {
  Options options = experiment::options_for(flight, "default");
  options.radar.T_BS = flight.configured_T_BS;
  return options;
}

/// What the calibration should find, off the configured values.
std::array<double, kCalibrationCount> truth_of(const sim::Flight& flight) {
  const Pose& T = flight.scenario.radar.T_BS;
  const Vector3d turn = quaternion_log(flight.configured_T_BS.rotation.conjugate() * T.rotation);
  const Vector3d shift = T.translation - flight.configured_T_BS.translation;
  return {turn.x(), turn.y(), turn.z(), shift.x(), shift.y(), shift.z(), 0.01, 0.01};
}

TEST(RadarCalibration, FindsWhatWasToldWrongWithHonestSigmas) {
  constexpr int kFlights = 4;
  double mean = 0.0;
  double worst = 0.0;
  for (std::uint64_t seed = 11; seed < 11 + kFlights; ++seed) {
    const sim::Flight flight = fly_wrong(seed, 25.0);
    const RadarCalibration found =
        calibrate_radar({test::recording_of(flight)}, configured(flight));
    const std::array<double, kCalibrationCount> truth = truth_of(flight);
    for (std::size_t i = 0; i < kCalibrationCount; ++i) {
      const ParameterCalibration& p = found.parameters[i];
      const double z = (p.value - truth[i]) / p.sigma;
      EXPECT_LT(std::abs(z), 3.0) << "seed " << seed << " parameter " << i;
      EXPECT_EQ(p.verdict, Determination::kDetermined) << "seed " << seed << " parameter " << i;
      mean += z * z / kFlights;
      worst = std::max(worst, std::abs(z));
    }
    // what is flown with is what was found
    EXPECT_LT(
        quaternion_log(found.radar.T_BS.rotation.conjugate() * flight.scenario.radar.T_BS.rotation)
            .norm(),
        1.0 * kDegree)
        << seed;  // of 5 deg told wrong
    EXPECT_NEAR(found.radar.time_offset, 0.01, 0.003) << seed;
    EXPECT_LT(found.priors.rotation_sigma, 0.5 * CalibrationOptions{}.rotation_sigma) << seed;
    EXPECT_LE(found.priors.doppler_scale_sigma, CalibrationOptions{}.doppler_scale_sigma) << seed;
  }
  constexpr int kParameters = 8;
  const eval::AneesBounds bounds = eval::anees_bounds(kParameters, kFlights, 0.99);
  test::expect_between("chi squared, of 8 degrees of freedom", mean, bounds.lower, bounds.upper);
  test::measured("worst error in sigmas", worst, "below 3");
}

TEST(RadarCalibration, SecondRecordingNarrowsTheSigmas) {
  const sim::Flight a = fly_wrong(1, 25.0);
  sim::Flight b = fly_wrong(2, 25.0);
  // the same vehicle: what was told of a differs from the truth as it does of b
  b.configured_T_BS = a.configured_T_BS;
  const RadarCalibration one = calibrate_radar({test::recording_of(a)}, configured(a));
  const RadarCalibration two =
      calibrate_radar({test::recording_of(a), test::recording_of(b)}, configured(a));
  const std::array<double, kCalibrationCount> truth = truth_of(a);
  for (std::size_t i = 0; i < kCalibrationCount; ++i) {
    EXPECT_LT(two.parameters[i].run_sigma, 0.85 * one.parameters[i].run_sigma) << i;  // 1/sqrt(2)
    EXPECT_LT(std::abs(two.parameters[i].value - truth[i]), 3.0 * two.parameters[i].sigma) << i;
  }
  EXPECT_EQ(two.recordings.size(), 2U);
}

// A radar that is knocked out of place half way: the turn is in neither mounting file.
TEST(RadarCalibration, HalvesThatContradictEachOtherKeepTheConfiguredValues) {
  const sim::Flight flight = fly_wrong(3, 25.0);
  Recording recording = test::recording_of(flight);
  const Quaternion knock = quaternion_exp(Vector3d(0.0, 0.0, 6.0 * kDegree));
  const Time middle = flight.scans[flight.scans.size() / 2].time;
  for (RadarScan& scan : recording.scans) {
    if (scan.time < middle) continue;
    for (RadarDetection& d : scan.detections) d.point_S = knock * d.point_S;
  }
  const RadarCalibration found = calibrate_radar({recording}, configured(flight));
  const ParameterCalibration& yaw = found.of(Calibration::kRotationZ);
  EXPECT_EQ(yaw.verdict, Determination::kContradictory) << yaw.halves_apart;
  EXPECT_GT(yaw.halves_apart, 3.0);
  EXPECT_EQ(found.priors.rotation_sigma, CalibrationOptions{}.rotation_sigma);
  const Vector3d turn =
      quaternion_log(flight.configured_T_BS.rotation.conjugate() * found.radar.T_BS.rotation);
  EXPECT_NEAR(turn.z(), 0.0, 1e-12);
}

TEST(RadarCalibration, StandingStillDeterminesNothing) {
  const sim::Flight rest =
      sim::simulate_flight({.seed = 4, .path = {.stand_before = 10.0}, .max_duration = 8.0});
  const Options options = configured(rest);
  const RadarCalibration found = calibrate_radar({test::recording_of(rest)}, options);
  for (std::size_t i = 0; i < kCalibrationCount; ++i) {
    EXPECT_EQ(found.parameters[i].verdict, Determination::kNotDetermined) << i;
  }
  EXPECT_EQ(found.radar.T_BS.rotation.coeffs(), options.radar.T_BS.rotation.coeffs());
  EXPECT_EQ(found.radar.T_BS.translation, options.radar.T_BS.translation);
  EXPECT_EQ(found.radar.time_offset, 0.0);
  EXPECT_EQ(found.priors.translation_sigma, options.calibration.translation_sigma);
}

// A vehicle on rails whose nose swings by two degrees: what the estimator finds about the line is
// mostly its own error.
TEST(RadarCalibration, AStraightLineDoesNotDetermineTheTurnAboutIt) {
  std::vector<sim::Trajectory::Control> path(5, sim::Trajectory::Control::Zero());
  for (int i = 0; i < 250; ++i) {
    const double step = 0.2 * (1.0 - std::cos(0.126 * i));
    path.emplace_back(path.back() + step * sim::Trajectory::Control::UnitX());
    path.back()[3] = 0.03 * std::sin(0.18 * i);
  }
  path.resize(path.size() + 4, path.back());
  const sim::Trajectory line(path, {.stand_before = 4.0, .stand_after = 2.0, .level = true});
  double worst = 0.0;
  for (const std::uint64_t seed : {2U, 4U}) {
    const sim::Flight flight =
        sim::simulate_flight(line, {.seed = seed, .errors = {.extrinsic_angle = 5.0 * kDegree}});
    Options options = configured(flight);
    options.calibration.rotation_sigma = 10.0 * kDegree;
    const RadarCalibration found = calibrate_radar({test::recording_of(flight)}, options);
    const std::array<double, kCalibrationCount> truth = truth_of(flight);
    for (const Calibration axis : {Calibration::kRotationX, Calibration::kRotationZ}) {
      const ParameterCalibration& p = found.of(axis);  // the line is half way between them
      EXPECT_NE(p.verdict, Determination::kDetermined) << "seed " << seed;
      worst = std::max(worst, std::abs(p.value - truth[static_cast<std::size_t>(axis)]) / p.sigma);
    }
    EXPECT_EQ(found.of(Calibration::kRotationY).verdict, Determination::kDetermined) << seed;
  }
  test::expect_below("turn about the line, worst error in sigmas", worst, 3.0);
}

TEST(RadarCalibration, NeedsARecordingThatStarts) {
  EXPECT_THROW(calibrate_radar({}, Options{}), std::runtime_error);
  const sim::Flight flight = fly_wrong(5, 20.0);
  Recording recording = test::recording_of(flight);
  recording.imu.resize(50);  // a quarter of a second
  EXPECT_THROW(calibrate_radar({recording}, configured(flight)), std::runtime_error);
}

}  // namespace
}  // namespace rio::calibrate
