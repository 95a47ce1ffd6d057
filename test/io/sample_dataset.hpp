// SPDX-License-Identifier: BSD-3-Clause
// Recordings for the tests of reading and writing.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "io/field_values.hpp"
#include "rio/io/dataset.hpp"
#include "support/temp_dir.hpp"

namespace rio::io {

using test::TempDir;

inline constexpr const char* kImuRows = "#t,w,w,w,a,a,a\n100,1,2,3,4,5,6\n200,1,2,3,4,5,6\n";
inline constexpr const char* kRadarRows = "#t,x,y,z,d,snr,noise\n150,1,2,3,-0.5,10,1\n";
inline constexpr const char* kRadarSensor =
    "T_BS:\n  cols: 4\n  rows: 4\n"
    "  data: [0, -1, 0, 0.1, 1, 0, 0, 0.2, 0, 0, 1, 0.3, 0, 0, 0, 1]\n";

/// A folder with the smallest complete dataset.
inline void write_minimal(const test::TempDir& dir, const std::string& prefix = "") {
  dir.write(prefix + "imu0/data.csv", kImuRows);
  dir.write(prefix + "radar0/data.csv", kRadarRows);
  dir.write(prefix + "radar0/sensor.yaml", kRadarSensor);
}

class MinimalDataset : public testing::Test {
 protected:
  MinimalDataset() { write_minimal(dir); }
  Dataset read() const { return read_dataset(dir.path()); }
  /// With another file.
  Dataset read_with(const std::string& file, const std::string& text) const {
    dir.write(file, text);
    return read();
  }

  test::TempDir dir;
};

/// A sample as text, exact to the bit; a NaN is as any other.
template <class... Numbers>
std::string line_of(const Numbers&... numbers) {
  return ((ToText{}(numbers) + " ") + ...);
}
inline std::string text_of(const ImuSample& s) {
  return line_of(s.time.count(), s.gyro_B, s.accel_B);
}
inline std::string text_of(const BaroSample& s) {
  return line_of(s.time.count(), s.pressure);
}
inline std::string text_of(const NavState& s) {
  return line_of(s.time.count(), s.q_WB, s.p_WB, s.v_WB, s.gyro_bias, s.accel_bias);
}
inline std::string text_of(const RadarScan& scan) {
  std::string text = line_of(scan.time.count());
  for (const RadarDetection& d : scan.detections) {
    text += line_of(d.point_S, d.range_rate, d.snr_db, d.noise_db, d.sigma_range, d.sigma_azimuth,
                    d.sigma_elevation, d.sigma_doppler);
  }
  return text;
}

template <class Sample>
void expect_same(const std::vector<Sample>& a, const std::vector<Sample>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(text_of(a[i]), text_of(b[i])) << i;
}
/// All samples, scans, states and notes of both are the same.
inline void expect_same(const Dataset& a, const Dataset& b) {
  expect_same(a.imu, b.imu);
  expect_same(a.scans, b.scans);
  ASSERT_EQ(a.other_radars.size(), b.other_radars.size());
  for (std::size_t r = 0; r < a.other_radars.size(); ++r) {
    expect_same(a.other_radars[r].scans, b.other_radars[r].scans);
  }
  expect_same(a.baro, b.baro);
  expect_same(a.ground_truth, b.ground_truth);
  EXPECT_EQ(a.notes, b.notes);
  EXPECT_EQ(a.radar_info.doppler_resolution, b.radar_info.doppler_resolution);
  EXPECT_EQ(a.imu_info.rate_hz, b.imu_info.rate_hz);
}

/// Something of everything, with values that no short decimal holds.
inline Dataset sample_dataset() {
  Dataset d;
  const double third = 1.0 / 3.0;
  for (int i = 0; i < 3; ++i) {
    d.imu.push_back({Time(1403636579758555392 + i), Vector3d(third * i, -0.1, 1e-17),
                     Vector3d(std::nextafter(9.81, 10.0), 1e300, -third)});
    d.ground_truth.push_back({Time(1403636579758555392 + i),
                              Quaternion(Quaternion(0.1 + i, 0.2, -0.3, third).normalized()),
                              Vector3d(third, 2, 3), Vector3d(0.1, 0.2, 0.3), Vector3d(1, third, 0),
                              Vector3d(0, 0, third)});
    d.baro.push_back({Time(i), 100000.0 + third});
  }
  d.scans.push_back(
      {Time(1403636579758555397),
       {{Vector3d(third, 2, 3), -0.7, 12.5, 1.0 + third, 0.1, third, 0.0, 0.02}, {}}});
  d.scans.push_back({Time(1403636579758555399), {}});
  d.scans.push_back({Time(1403636579758555398), {{Vector3d(1, 2, 3), third, 0.0, 0.0}}});
  d.imu_info = {200.0, third, 2e-5, 0.1, 1e-4};
  RadarInfo& r = d.radar_info;
  r.T_BS =
      Pose{Quaternion(Quaternion(0.9, 0.1, 0.2, -third).normalized()), Vector3d(0.1, third, 3)};
  r.rate_hz = 15.0;
  r.max_range = 16.28;
  r.max_doppler = 1.51;
  r.range_resolution = 0.039;
  r.doppler_resolution = third;
  r.fov_azimuth = 2.0943951023931953;
  r.fov_elevation = 0.5;
  r.sigma_range = 0.03;
  r.sigma_azimuth = third / 10;
  r.sigma_elevation = 0.07;
  r.sigma_doppler = 0.04;
  r.weak_snr_db = -2.5;
  r.time_offset = -third / 100;
  r.doppler_scale = -0.01;
  r.prior_rotation = third / 20;
  r.prior_position = 0.004;
  r.prior_time_offset = 0.002;
  r.prior_doppler_scale = 0.003;
  return d;
}

}  // namespace rio::io
