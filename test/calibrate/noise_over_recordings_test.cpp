// SPDX-License-Identifier: BSD-3-Clause
// The noise of simulated sensors over two flights.
#include "calibrate/noise_over_recordings.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "experiment/trial.hpp"
#include "support/measured.hpp"
#include "support/short_flight.hpp"

namespace rio::calibrate {
namespace {

TEST(NoiseOverRecordings, IsThatOfTheSimulatedSensors) {
  sim::Scenario scenario = test::scenario_named("monte-carlo");
  std::vector<Recording> recordings;
  std::vector<RecordingCalibration> runs;
  Options options;
  for (const std::uint64_t seed : {11U, 13U}) {  // that of 12 does not settle in six runs
    scenario.seed = seed;
    const sim::Flight flight = sim::simulate_flight(scenario);
    options = experiment::options_for(flight, "default");
    recordings.push_back({flight.imu, flight.scans, std::nullopt, {}});
    const CalibrationRun run = run_calibration(recordings.back(), options, std::nullopt);
    RecordingCalibration r;
    r.begin = run.states.front();
    r.middle = half_way(run.states);
    runs.push_back(r);
  }
  const SensorNoise found = noise_over_recordings(recordings, runs, options);
  const auto expect = [](const char* what, const NoiseEstimate& n, double truth, double allowed) {
    test::expect_near(std::string(what) + ", found over true", n.value / truth, 1.0, allowed);
    EXPECT_EQ(n.verdict, Determination::kDetermined) << what;
  };
  // 15 % as in noise_calibration_test.cpp
  expect("range", found.radar[0], scenario.radar.sigma_range, 0.15);
  expect("azimuth", found.radar[1], scenario.radar.sigma_azimuth, 0.15);
  expect("elevation", found.radar[2], scenario.radar.sigma_elevation, 0.15);
  expect("Doppler", found.radar[3], scenario.radar.sigma_doppler, 0.15);
  // 1.5 s of rest each
  expect("gyro density", found.gyro, scenario.imu.gyro_noise_density,
         3.0 * found.gyro.relative_error);
  expect("accelerometer density", found.accel, scenario.imu.accel_noise_density,
         3.0 * found.accel.relative_error);
  EXPECT_LT(found.gyro.relative_error, 0.25);
  EXPECT_TRUE(found.notes.empty()) << (found.notes.empty() ? "" : found.notes.front());
}

// The vibration of a flight is not the noise of the IMU at rest.
TEST(NoiseOverRecordings, ARecordingThatBeginsInMotionTellsNothingOfTheImu) {
  const sim::Flight flight = sim::simulate_flight(test::scenario_named("monte-carlo", 11));
  Options options = experiment::options_for(flight, "default");
  options.start.max_wait = 3.0;
  Recording recording{flight.imu, flight.scans, std::nullopt, {}};
  const Time begin = flight.imu.front().time + std::chrono::seconds(10);
  std::erase_if(recording.imu, [begin](const ImuSample& s) { return s.time < begin; });
  const CalibrationRun run = run_calibration(recording, options, std::nullopt);
  EXPECT_TRUE(run.began_in_motion);
  RecordingCalibration r;
  r.begin = run.states.front();
  r.began_in_motion = run.began_in_motion;
  r.middle = half_way(run.states);
  const SensorNoise found = noise_over_recordings({recording}, {r}, options);
  EXPECT_EQ(found.gyro.verdict, Determination::kNotDetermined);
  EXPECT_EQ(found.accel.verdict, Determination::kNotDetermined);
  EXPECT_EQ(found.radar[3].verdict, Determination::kDetermined);
  EXPECT_TRUE(found.notes.empty()) << (found.notes.empty() ? "" : found.notes.front());
}

TEST(NoiseOverRecordings, SaysWhichRecordingTellsNothing) {
  const sim::Flight flight = sim::simulate_flight(test::scenario_named("monte-carlo", 12));
  const Options options = experiment::options_for(flight, "default");
  Recording recording{flight.imu, flight.scans, std::nullopt, {}};
  recording.scans.resize(25);  // hardly off the ground
  RecordingCalibration run;
  run.begin.state.time = flight.scans[2].time;
  run.middle.state.time = flight.scans[12].time;
  const SensorNoise found = noise_over_recordings({recording}, {run}, options);
  for (const NoiseEstimate& n : found.radar) {
    EXPECT_EQ(n.verdict, Determination::kNotDetermined);
    EXPECT_EQ(n.value, 0.0);
  }
  ASSERT_EQ(found.notes.size(), 1U);
  EXPECT_NE(found.notes[0].find("recording 1"), std::string::npos) << found.notes[0];
  EXPECT_NE(found.notes[0].find("fly longer"), std::string::npos) << found.notes[0];
}

}  // namespace
}  // namespace rio::calibrate
