// SPDX-License-Identifier: BSD-3-Clause
// Recordings read and written; what they say of their sensors is in sensor_info_test.cpp.
#include "rio/io/dataset.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "io/sample_dataset.hpp"
#include "rio/io/recording_stream.hpp"
#include "support/real_data.hpp"

namespace rio::io {
namespace {

using test::TempDir;
using DatasetTest = MinimalDataset;

TEST_F(DatasetTest, RoundTripIsExact) {
  write_dataset(dir.path() / "new", sample_dataset());
  expect_same(read_dataset(dir.path() / "new"), sample_dataset());
}

TEST_F(DatasetTest, KeepsOfTheTruthWhatAReplayStartsFrom) {
  Dataset d = sample_dataset();
  const auto kept = [&d](const std::vector<Time>& stamps) {
    d.ground_truth.resize(stamps.size());
    for (std::size_t i = 0; i < stamps.size(); ++i) d.ground_truth[i].time = stamps[i];
    const TempDir folder;
    write_dataset(folder.path(), d);
    EXPECT_EQ(read_dataset(folder.path()).ground_truth.size(), stamps.size());
    const std::vector<NavState> start = read_dataset(folder.path(), Truth::kStart).ground_truth;
    EXPECT_EQ(start.size(), 1U);
    return start.front().time;
  };
  const Time first = d.imu.front().time;
  const Time last = d.imu.back().time;
  EXPECT_EQ(kept({first - Time(1), first, last, last + Time(1)}), first);
  EXPECT_EQ(kept({first - Time(1), last + Time(1)}), last + Time(1));
}

TEST_F(DatasetTest, FindsMav0) {
  const TempDir empty;
  write_minimal(empty, "mav0/");
  EXPECT_EQ(read_dataset(empty.path()).imu.size(), 2U);
  EXPECT_EQ(read_dataset(empty.path() / "mav0").imu.size(), 2U);
}

TEST_F(DatasetTest, ScansAreRunsOfOneStamp) {
  const Dataset d = read_with(
      "radar0/data.csv",
      "#t\r\n10,1,2,3,0.1,,,junk\r\n10,1,2,3,0.2,5,6,\r\n20,,,,,,,\r\n15,1,1,1,0.3,7,8,9\r\n"
      "10,1,1,1,nan,7,8,9");
  ASSERT_EQ(d.scans.size(), 4U);
  ASSERT_EQ(d.scans[0].detections.size(), 2U);
  EXPECT_EQ(d.scans[0].detections[0].range_rate, 0.1);
  EXPECT_EQ(d.scans[0].detections[0].snr_db, 0.0);
  EXPECT_EQ(d.scans[0].detections[1].snr_db, 5.0);
  EXPECT_EQ(d.scans[0].detections[1].noise_db, 6.0);
  EXPECT_EQ(d.scans[1].time, Time(20));
  EXPECT_TRUE(d.scans[1].detections.empty());
  EXPECT_EQ(d.scans[2].time, Time(15));  // going back in time is left to the estimator
  EXPECT_EQ(d.scans[3].time, Time(10));
  EXPECT_TRUE(std::isnan(d.scans[3].detections[0].range_rate));
}

TEST_F(DatasetTest, ColumnsWithAHeadingAreSigmasByTheirNames) {
  const auto sigma = [this](const std::string& heading) {
    const std::string row = "\n10,1,2,3,0.1,5,6,0.5,2,3,4\n";
    const Dataset d = read_with("radar0/data.csv", heading + row);
    return d.scans.at(0).detections.at(0).sigma_range;
  };
  const std::string first = "#t,x,y,z,doppler,snr,noise,";
  EXPECT_EQ(sigma(first + "id,track,age,class"), 0.0);
  EXPECT_EQ(sigma(first + "range,azimuth,elevation,rcs"), 0.0);
  EXPECT_EQ(sigma(first + "rangeSTD,azimuthSTD,elevationSTD,dopplerSTD"), 0.5);
  EXPECT_EQ(sigma(first + "sigma range [m],sigma azimuth [rad],sigma elevation,sigma doppler"),
            0.5);
  EXPECT_EQ(sigma("#recorded by hand"), 0.5);
}

TEST_F(DatasetTest, ColumnsOfAnImuAreKnownByTheUsualNames) {
  const auto read = [this](const std::string& heading) {
    read_with("imu0/data.csv", "t," + heading + "\n1,2,3,4,5,6,7\n2,2,3,4,5,6,7\n");
  };
  for (const char* heading :
       {"w_RS_S_x,w_RS_S_y,w_RS_S_z,a_RS_S_x,a_RS_S_y,a_RS_S_z", "gx,gy,gz,ax,ay,az [g]",
        "gyro_x,gyro_y,gyro_z,acc_x,acc_y,acc_z", "1st,2nd,3rd,4th,5th,6th", "p,q,r,ax,ay,az",
        "angular_velocity.x,angular_velocity.y,angular_velocity.z,linear_acceleration.x,"
        "linear_acceleration.y,linear_acceleration.z"}) {
    read(heading);
  }
  for (const char* heading :
       {"ax [m/s^2],ay,az,gx,gy,gz", "accel_x,accel_y,accel_z,gyro_x,gyro_y,gyro_z",
        "orientation.x,orientation.y,orientation.z,orientation.w,wx,wy", "mx,my,mz,gx,gy,gz",
        "roll,pitch,yaw,gx,gy,gz", "a_RS_S_x,a_RS_S_y,a_RS_S_z,w_RS_S_x,w_RS_S_y,w_RS_S_z"}) {
    EXPECT_ERROR(read(heading), "column 2 is");
  }
  EXPECT_ERROR(read("gx,gy,gz,mag_x,mag_y,mag_z"),
               "column 5 is \"mag_x\"; the columns are read as");
}

TEST_F(DatasetTest, RowsInNoOrderOfTimeAreRefused) {
  std::string imu, radar, few;
  for (int i = 0; i < 40; ++i) {
    const std::string stamp = std::to_string(100 + 37 * i % 40);  // falls 36 times
    imu += stamp + ",1,2,3,4,5,6\n";
    radar += stamp + ",1,2,3,-0.5,10,1\n";
    few += std::to_string(100 + (i % 8 == 7 ? i - 2 : i)) + ",1,2,3,4,5,6\n";  // five are late
  }
  EXPECT_ERROR(read_with("imu0/data.csv", imu),
               "data.csv: 36 of 40 stamps are before the one above");
  EXPECT_EQ(read_with("imu0/data.csv", few).imu.size(), 40U);
  EXPECT_ERROR(read_with("radar0/data.csv", radar), "radar0/data.csv: 36 of 40 stamps");
}

TEST_F(DatasetTest, ACutLastLineEndsItsSensorAndIsNamed) {
  dir.write("imu0/data.csv", "100,1,2,3,4,5,6\n200,1,2,3,4,5,6\n300,1,2,3");
  const Dataset d = read_with("radar0/data.csv", "100,1,2,3,4,5,6\n100,2,2,3,4,5,6\n100,3,2,");
  EXPECT_EQ(d.imu.size(), 2U);
  ASSERT_EQ(d.scans.size(), 1U);
  EXPECT_EQ(d.scans[0].detections.size(), 2U);
  EXPECT_PRED2(test::contains, d.damage, "imu0/data.csv:3: the file ends inside of this line\n");
  EXPECT_PRED2(test::contains, d.damage, "radar0/data.csv:3: the file ends inside of this line");
  const auto stream = open_dataset(dir.path());
  EXPECT_EQ(stream->outline().sensors.damage, d.damage);
  EXPECT_EQ(stream->outline().imu_samples, 2U);
}

TEST_F(DatasetTest, MissingPartsAreErrors) {
  const TempDir empty;
  EXPECT_ERROR(read_dataset(empty.path() / "none"), "none: no such folder");
  EXPECT_ERROR(read_dataset(empty.write("file", "x")), "file: is not a folder");
  EXPECT_ERROR(read_dataset(empty.path()), "a folder without a recording: no bag, and no imu0");
  std::filesystem::create_directory(empty.path() / "imu0");
  EXPECT_ERROR(read_dataset(empty.path()), "imu0/data.csv: no such file");
  empty.write("imu0/data.csv", kImuRows);
  EXPECT_ERROR(read_dataset(empty.path()), "radar0/data.csv: no such file");
  write_minimal(empty);
  std::filesystem::create_directory(empty.path() / "baro0");
  EXPECT_ERROR(read_dataset(empty.path()), "baro0/data.csv: no such file");
}

TEST_F(DatasetTest, GroundTruthMustBeSound) {
  const auto read_truth = [this](const char* text) {
    return read_with("state_groundtruth_estimate0/data.csv", text);
  };
  EXPECT_ERROR(read_truth("1,0,0,0,1,0,0,0\n"), "data.csv:1: has 8 columns, 17 are needed");
  EXPECT_ERROR(read_truth("1,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0\n"), "not a unit quaternion");
  EXPECT_ERROR(read_truth("1,0,0,0,1,0,0,0,nan,0,0,0,0,0,0,0,0\n"), "a value is not finite");
  EXPECT_ERROR(read_truth("2,0,0,0,1,0,0,0,0,0,0,0,0,0,0,0,0\n1,0,0,0,1,0,0,0,0,0,0,0,0,0,0,0,0\n"),
               "data.csv:2: time does not increase");
}

TEST_F(DatasetTest, FurtherRadarsHaveFoldersOfTheirOwn) {
  Dataset a = sample_dataset();
  Dataset::OtherRadar other{a.scans, a.radar_info};
  other.scans.pop_back();
  other.info.T_BS->translation = Vector3d(0.5, -0.25, 0.125);
  other.info.time_offset = 0.004;
  a.other_radars = {other, other};
  write_dataset(dir.path(), a);
  const Dataset b = read();
  ASSERT_EQ(b.other_radars.size(), 2U);
  EXPECT_EQ(b.other_radars[1].scans.size(), a.scans.size() - 1);
  Options options;
  apply_sensor_info(b, &options);
  ASSERT_EQ(options.radars(), 3U);
  EXPECT_EQ(options.mount(0).T_BS.translation, a.radar_info.T_BS->translation);
  EXPECT_EQ(options.mount(2).T_BS.translation, other.info.T_BS->translation);
  EXPECT_EQ(options.mount(2).time_offset, 0.004);
  a.other_radars.pop_back();
  EXPECT_ERROR(write_dataset(dir.path(), a), "radar2: is left from another recording");
  std::ofstream(dir.path() / "radar1" / "data.csv") << "#timestamp [ns],x\n1,x\n";
  EXPECT_ERROR(read(), "radar1/data.csv:2");
}

TEST_F(DatasetTest, WriterRefusesWhatItCouldNotReadBack) {
  Dataset d = sample_dataset();
  write_dataset(dir.path(), d);
  d.baro.clear();
  EXPECT_ERROR(write_dataset(dir.path(), d), "baro0: is left from another recording");
  d = sample_dataset();
  d.scans[1].time = d.scans[0].time;
  EXPECT_ERROR(write_dataset(dir.path() / "x", d), "scans 0 and 1 have the same stamp");
}

TEST_F(DatasetTest, RealRecording) {
  const std::filesystem::path folder = test::real_data("ti_demo");
  if (folder.empty()) GTEST_SKIP() << test::kNoRealData;
  const Dataset d = read_dataset(folder);
  EXPECT_EQ(d.imu.size(), 8270U);
  EXPECT_EQ(d.scans.size(), 412U);
  EXPECT_EQ(d.baro.size(), 2057U);
  std::size_t detections = 0;
  for (const RadarScan& scan : d.scans) detections += scan.detections.size();
  EXPECT_EQ(detections, 17872U);
  EXPECT_TRUE(d.ground_truth.empty());
  EXPECT_EQ(d.imu_info.gyro_noise_density, 2.4e-4);
  EXPECT_EQ(d.radar_info.T_BS.value().translation, Vector3d(0.03, 0.03, -0.06));
  EXPECT_NEAR(d.radar_info.doppler_resolution.value(), 0.1249, 1e-4);  // read off the data
  EXPECT_EQ(d.notes.size(), 1U);
}

TEST_F(DatasetTest, NotesASensorThatEndsLongBeforeTheOther) {
  EXPECT_EQ(read().notes.size(), 1U);  // no imu0/sensor.yaml
  dir.write("imu0/data.csv", std::string(kImuRows) + "5000000000,1,2,3,4,5,6\n");
  EXPECT_PRED2(test::contains, read().notes.back(), "radar0 ends 5.0 s before imu0");
  dir.write("imu0/data.csv", "9000000000000000000,1,2,3,4,5,6\n");
  dir.write("radar0/data.csv", "-9000000000000000000,1,2,3,4,5,6\n");
  EXPECT_PRED2(test::contains, read().notes.back(), "radar0 ends 18000000000.0 s before imu0");
}

}  // namespace
}  // namespace rio::io
