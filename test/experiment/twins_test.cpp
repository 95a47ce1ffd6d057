// SPDX-License-Identifier: BSD-3-Clause
// What a recording tells of itself, on one whose scenario is known, and its twin, which must agree.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"
#include "experiment/signature.hpp"
#include "experiment/twin.hpp"
#include "experiment/witness.hpp"
#include "rio/sim/flight.hpp"
#include "support/measured.hpp"
#include "support/temp_dir.hpp"

namespace rio::experiment {
namespace {

/// A drive of the scenario rough-ground with what its files would say.
Recording drive() {
  sim::Scenario scenario = scenario_of("rough-ground");
  scenario.seed = 5;
  scenario.path.length = 15.0;
  const sim::Flight flight = sim::simulate_flight(scenario);
  Recording r{"drive", "", {}, {}};
  r.data.imu = flight.imu;
  r.data.scans = flight.scans;
  r.data.imu_info.rate_hz = scenario.imu.rate_hz;
  r.data.radar_info.T_BS = flight.configured_T_BS;
  r.data.radar_info.max_range = scenario.radar.max_range;
  r.data.radar_info.max_doppler = scenario.radar.max_doppler;
  r.data.radar_info.doppler_resolution = scenario.radar.doppler_resolution;
  r.data.radar_info.range_resolution = scenario.radar.range_resolution;
  r.data.radar_info.fov_azimuth = scenario.radar.fov_azimuth;
  r.data.radar_info.fov_elevation = scenario.radar.fov_elevation;
  for (const NavState& nav : flight.truth) r.reference.push_back({nav.time, nav.p_WB, nav.q_WB});
  return r;
}

TEST(Spectrum, PutsASinusoidIntoItsBand) {
  std::vector<Vector3d> samples;
  for (int i = 0; i < 640; ++i) {
    const double t = 0.01 * i;
    const double low = std::sin(2.0 * std::numbers::pi * 7.8125 * t);
    const double high = std::sin(2.0 * std::numbers::pi * 25.0 * t);
    samples.push_back(Vector3d::Constant(3.0 * low + 1.0 * high) + Vector3d(9.81, 0.1 * t, 0.0));
  }
  const Bands bands = spectrum(samples, 100.0);
  test::measured("rms of 3 sin at 7.8 Hz, in 5 to 10 Hz", bands[1], "2.12 within 0.05");
  EXPECT_NEAR(bands[1], 3.0 / std::sqrt(2.0), 0.05);
  EXPECT_NEAR(bands[3], 1.0 / std::sqrt(2.0), 0.02);
  EXPECT_LT(bands[0], 0.1 * bands[1]);  // the trend that is taken off leaks
  EXPECT_LT(bands[4], 0.05);
  EXPECT_TRUE(std::isnan(spectrum({}, 100.0)[0]));
}

TEST(Signature, TellsWhatTheScenarioSays) {
  const sim::Scenario scenario = scenario_of("rough-ground");
  const Recording r = drive();
  const Motion motion = motion_of(r.data);
  const ImuSignature imu = imu_signature(r.data, motion);
  EXPECT_NEAR(imu.rate_hz, 100.0, 0.1);
  test::measured("samples interpolated, share", imu.interpolated, "0.31 within 0.03");
  EXPECT_NEAR(imu.interpolated, scenario.imu.lost_share, 0.03);
  EXPECT_EQ(imu.missing, 0.0);
  EXPECT_NEAR(imu.run, 1.0, 0.02);
  const double moving = rms_from(imu.accel_moving, 0);
  const double most = std::hypot(scenario.imu.low.accel_moving, scenario.imu.high.accel_moving);
  test::measured("accelerometer in motion over that at full speed", moving / most, "0.5 to 1");
  EXPECT_GT(moving, 0.5 * most);  // slower than full speed, and smoothed by the interpolation
  EXPECT_LT(moving, most);
  const RadarSignature radar = radar_signature(r.data, motion);
  EXPECT_NEAR(radar.rate_hz, scenario.radar.rate_hz, 0.1);
  EXPECT_NEAR(radar.late, scenario.radar.lost_share, 0.015);
  EXPECT_GT(radar.still_at_rest, 0.9);
  EXPECT_GT(radar.snr_db.low, scenario.radar.threshold_db - 0.5);
  // 3 places in 20 % of the scans, of about 6 points; found again after half a second in as many
  EXPECT_GT(radar.rides_along, 0.002);
  EXPECT_LT(radar.rides_along, 0.06);
}

TEST(Twin, IsLikeTheDriveItIsMadeFrom) {
  const Recording r = drive();
  const Motion motion = motion_of(r.data);
  sim::Scenario scenario = scenario_of("rough-ground");
  scenario.imu.lost_share = 0.0;  // what it has to find in the recording
  scenario.imu.low.accel_moving = 0.1;
  scenario.radar.snr_1m_db += 6.0;
  scenario.radar.rate_hz = 10.0;
  const Twin twin = twin_of(r, scenario);
  const ImuSignature a = imu_signature(r.data, motion);
  const ImuSignature b = imu_signature(twin.data, twin.motion);
  const RadarSignature c = radar_signature(r.data, motion);
  const RadarSignature d = radar_signature(twin.data, twin.motion);
  EXPECT_NEAR(b.interpolated, a.interpolated, 0.03);
  const double vibration = rms_from(b.accel_moving, 0) / rms_from(a.accel_moving, 0);
  test::measured("vibration, twin over drive", vibration, "1 within 0.15");
  EXPECT_NEAR(vibration, 1.0, 0.15);
  EXPECT_NEAR(d.rate_hz, c.rate_hz, 0.1);
  const double points = d.mean_points / c.mean_points;
  test::measured("points a scan, twin over drive", points, "1 within 0.25");
  EXPECT_NEAR(points, 1.0, 0.25);
  const Testimony e = testimony(r.data, motion);
  const Testimony f = testimony(twin.data, twin.motion);
  ASSERT_GT(e.scans, 100);
  ASSERT_GT(f.scans, 100);
  EXPECT_NEAR(f.inlier_share, e.inlier_share, 0.1);
  EXPECT_NEAR(f.doppler_rms / e.doppler_rms, 1.0, 0.25);
}

TEST(Twins, PrintsATableOfRecordingsAndTwins) {
  const test::TempDir dir;
  Recording r = drive();
  io::write_dataset(dir.path() / "drive", r.data);
  Settings settings;
  EXPECT_THROW(twins(settings), std::runtime_error);
  settings.seeds = settings.threads = 1;
  settings.recordings = {(dir.path() / "drive").string()};
  settings.scenario = "nonsense";
  EXPECT_THROW(twins(settings), std::runtime_error);
  settings.scenario.clear();
  const std::string text = twins(settings).markdown;
  for (const char* row : {"IMU rate [Hz] | 100.0 / 100.0", "Doppler grid [m/s] | 0.491 / 0.491",
                          "points a scan", "inliers", "... NIS of these", "rough-ground"}) {
    EXPECT_NE(text.find(row), std::string::npos) << row;
  }
}

}  // namespace
}  // namespace rio::experiment
