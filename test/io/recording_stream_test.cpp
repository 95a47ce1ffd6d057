// SPDX-License-Identifier: BSD-3-Clause
// Recordings sample by sample: what read_dataset() gives, and its errors.
#include "rio/io/recording_stream.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "io/sample_dataset.hpp"

namespace rio::io {
namespace {

using test::TempDir;

/// The same error from both readers; empty where there is none.
std::string error_of_both(const std::filesystem::path& path) {
  std::string error = test::error_of([&] { (void)open_dataset(path); });
  EXPECT_EQ(error, test::error_of([&] { (void)read_dataset(path, Truth::kStart); }));
  return error;
}

/// Stamps out of order, twice the same, not finite, no detection; two radars.
Dataset irregular_dataset() {
  Dataset d = sample_dataset();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  d.imu.push_back({d.imu[0].time - Time(5), Vector3d(nan, 1, 2), Vector3d(1, 2, 3)});
  d.imu.push_back({d.imu[0].time - Time(5), Vector3d(1e9, -1e-9, 2), Vector3d(1, nan, 3)});
  d.imu.push_back({d.imu[0].time + Time(5'000'000'000), Vector3d(3, 1, 2), Vector3d(1, 2, 3)});
  d.scans.push_back({d.scans[0].time - Time(1'000'000'000), {{Vector3d(1, nan, 3), nan, 1, 0}}});
  d.scans.push_back({d.scans[0].time, {}});
  d.scans.push_back({d.scans[0].time + Time(1), {{Vector3d(1, 2, 3), 1, 1, 0, 0.1, 0, 0, 0.2}}});
  d.other_radars.resize(2);
  d.other_radars[0].info.T_BS = Pose{};
  d.other_radars[0].scans = {d.scans[1], d.scans[0]};
  d.other_radars[1].scans = {d.scans[0], d.scans[3], d.scans[1]};
  return d;
}

TEST(RecordingStream, GivesWhatTheDatasetHas) {
  const TempDir dir;
  for (const Dataset& d : {sample_dataset(), irregular_dataset()}) {
    const auto path = dir.path() / std::to_string(d.imu.size());
    write_dataset(path, d);
    const Dataset all = read_dataset(path, Truth::kStart);
    expect_same(all.imu, d.imu);
    expect_same(all.scans, d.scans);
    const auto stream = open_dataset(path);
    expect_same(collect(stream.get()), all);
    expect_same(collect(stream.get()), all);  // again from the beginning

    const RecordingOutline& outline = stream->outline();
    EXPECT_EQ(outline.imu_samples, all.imu.size());
    EXPECT_EQ(outline.imu_begin, all.imu.front().time);
    EXPECT_EQ(outline.imu_end, all.imu.back().time);
    EXPECT_EQ(outline.baro_samples, all.baro.size());
    ASSERT_EQ(outline.scan_times.size(), 1 + all.other_radars.size());
    for (std::size_t i = 0; i < all.scans.size(); ++i) {
      EXPECT_EQ(outline.scan_times[0][i], all.scans[i].time);
    }
    ASSERT_EQ(outline.sensors.ground_truth.size(), 1U);
    EXPECT_EQ(outline.sensors.ground_truth[0].time, all.ground_truth[0].time);
    EXPECT_TRUE(outline.sensors.imu.empty());
    EXPECT_TRUE(outline.sensors.scans.empty());
    EXPECT_EQ(outline.sensors.damage, "");
  }
}

TEST(RecordingStream, SensorsDoNotWaitForEachOther) {
  const TempDir dir;
  const Dataset d = irregular_dataset();
  write_dataset(dir.path() / "d", d);
  const auto stream = open_dataset(dir.path() / "d");
  RadarScan scan;
  ImuSample sample;
  BaroSample pressure;
  ASSERT_TRUE(stream->next(&scan, 2));
  EXPECT_EQ(text_of(scan), text_of(d.other_radars[1].scans[0]));
  for (std::size_t i = 0; i < d.imu.size(); ++i) {
    ASSERT_TRUE(stream->next(&sample));
    EXPECT_EQ(sample.time, d.imu[i].time);
  }
  EXPECT_FALSE(stream->next(&sample));
  ASSERT_TRUE(stream->next(&scan));
  EXPECT_EQ(text_of(scan), text_of(d.scans[0]));
  ASSERT_TRUE(stream->next(&scan, 2));
  EXPECT_EQ(text_of(scan), text_of(d.other_radars[1].scans[1]));
  ASSERT_TRUE(stream->next(&scan));
  EXPECT_TRUE(scan.detections.empty());
  ASSERT_TRUE(stream->next(&pressure));
  EXPECT_EQ(text_of(pressure), text_of(d.baro[0]));
  ASSERT_TRUE(stream->next(&scan, 1));
  EXPECT_EQ(text_of(scan), text_of(d.other_radars[0].scans[0]));
  EXPECT_FALSE(stream->next(&sample));
}

/// What is wrong is thrown before the first sample, with the place.
TEST(RecordingStream, ErrorsNameFileAndLine) {
  const struct {
    const char* sensor;
    const char* rows;
    const char* error;
  } kCases[] = {
      {"imu0", "#t\n100,1,2,3,4,5,6\n200,1,2,3,4,5\n300,1,2,3,4,5,6\n", ":3: has 6 columns"},
      {"imu0", "1,1,2,3,4,5\n", ":1: has 6 columns, column 7"},
      {"imu0", "100,1,2,x,4,5,6\n", ":1: column 4: not a number: \"x\""},
      {"imu0", "100,1,2,-,4,5,6\n", ":1: column 4: not a number: \"-\""},
      {"imu0", "100,1,2,3.5e,4,5,6\n", ":1: column 4: not a number: \"3.5e\""},
      {"imu0", "100,1,2,1e999,4,5,6\n", ":1: column 4: not a number"},
      {"imu0", "1,1,2,3,4,5,x6\n", ":1: column 7: not a number"},
      {"imu0", "1.5,1,2,3,4,5,6\n", ":1: column 1: not an integer"},
      {"imu0", "#only a header\n", ": holds no samples"},
      {"imu0", "", ": is empty"},
      {"radar0", "9,1,2,3,4\n10,1,2,3,1.2.3\n", ":2: column 5: not a number"},
      {"radar0", "9,1,2,3,4\n10,1,0x2,3,4\n", ":2: column 3: not a number"},
      {"radar0", "1,1,2,3,,,\n", ":1: column 5: not a number"},
      {"radar0", "1,1,2,3,4,5dB,6\n", ":1: column 6"},
      {"radar0", "1,1,2,3,4,5,6\n1,1,2,3,4\n2,1,2,3,4,5,6\n", ":2: has 5 columns"},
      {"radar0", "9,1,2,3,4\n9,,,,\n", ":2: an empty scan has the stamp"},
      {"radar0", "9,,,,\n9,1,2,3,4\n", ":2: a detection has the stamp"},
      {"radar0", "9,1,2,3,4,5,6,0.1,0.1,-1,0\n", ":1: a sigma is negative"},
      {"radar0", "1,1,2,3,4,5,6,0.1,,nan,0\n", ":1: a sigma is"},
      {"radar0", "1\n", ":1: has 1 columns"},
      {"radar0", "#t\n", ": holds no scans"},
      {"radar1", "9,1,2,3,4\n10,1,2\n11,1,2,3,4\n", ":2: has 3 columns"},
      {"baro0", "9,1\n10,\n11,1\n", ":2: column 2: not a number"},
  };
  for (const auto& [sensor, rows, error] : kCases) {
    const TempDir dir;
    write_minimal(dir);
    EXPECT_EQ(error_of_both(dir.path()), "");
    const std::string file = std::string(sensor) + "/data.csv";
    dir.write(file, rows);
    EXPECT_PRED2(test::contains, error_of_both(dir.path()), file + error);
  }
}

/// The first pass does not turn them into numbers.
TEST(RecordingStream, NumbersMayBeWrittenInAnyWay) {
  const TempDir dir;
  write_minimal(dir);
  dir.write("imu0/data.csv",
            "100, +1,2.,.5,-0,1e5,1E5\r\n200,1e-300,2,3,1.7e308,5,123456789012345678901234567890\n"
            "300,inf,2,3,-inf,5,6\n350,,2,3,4,5,\n400,nan,2,3,4,5,6");
  dir.write("radar0/data.csv", "150,1,2,3,-0.5\n150,1e-3,+2,3,.5\n160,,,,\n170,nan,2,3,-inf\n");
  const auto stream = open_dataset(dir.path());
  const Dataset all = read_dataset(dir.path());
  expect_same(collect(stream.get()), all);
  ASSERT_EQ(all.imu.size(), 5U);
  EXPECT_EQ(all.imu[0].gyro_B, Vector3d(1, 2, 0.5));
  EXPECT_EQ(all.imu[2].gyro_B.x(), INFINITY);
  EXPECT_EQ(all.imu[2].accel_B.x(), -INFINITY);
  EXPECT_TRUE(std::isnan(all.imu[3].gyro_B.x()) && std::isnan(all.imu[3].accel_B.z()));  // empty
  EXPECT_TRUE(std::isnan(all.imu[4].gyro_B.x()));
  EXPECT_EQ(all.scans[0].detections[0].snr_db, 0.0);  // may be missing
  ASSERT_FALSE(all.notes.empty());
  EXPECT_PRED2(test::contains, all.notes[0], "data.csv:3: not finite, the first of 3");
}

/// Of the long one there are more values than are kept: it is read off the file again.
TEST(RecordingStream, FindsTheDopplerGridOfAShortAndOfALongRecording) {
  for (const int scans : {20, 4000}) {
    for (const double jitter : {0.0, 0.1}) {
      const TempDir dir;
      write_minimal(dir);
      std::string rows;
      for (int i = 0; i < scans; ++i) {
        for (int k = -10; k <= 10; ++k) {
          const double speed = 0.25 * k + jitter * std::sin(1.7 * (21 * i + k));
          rows += std::to_string(1000 + i) + ",1,2,3," + std::to_string(speed) + "\n";
        }
      }
      dir.write("radar0/data.csv", rows);
      const Dataset sensors = open_dataset(dir.path())->outline().sensors;
      const std::optional<double> step = sensors.radar_info.doppler_resolution;
      EXPECT_EQ(step.has_value(), jitter == 0.0) << scans;
      if (step) {
        EXPECT_DOUBLE_EQ(*step, 0.25);
        EXPECT_PRED2(test::contains, sensors.notes.back(), "no doppler_resolution_mps");
      }
      EXPECT_EQ(read_dataset(dir.path()).radar_info.doppler_resolution, step);
    }
  }
}

TEST(RecordingStream, AFileThatGrowsGivesWhatWasLookedAt) {
  const TempDir dir;
  write_minimal(dir);
  const auto stream = open_dataset(dir.path());
  dir.write("imu0/data.csv", std::string(kImuRows) + "300,1,2,3,4,5,6\n400,broken");
  ImuSample sample;
  EXPECT_TRUE(stream->next(&sample));
  EXPECT_TRUE(stream->next(&sample));
  EXPECT_FALSE(stream->next(&sample));
}

}  // namespace
}  // namespace rio::io
