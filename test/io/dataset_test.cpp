// SPDX-License-Identifier: BSD-3-Clause
#include "rio/io/dataset.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "support/temp_dir.hpp"

namespace rio::io {
namespace {

using test::TempDir;

constexpr const char* kImuRows = "#t,w,w,w,a,a,a\n100,1,2,3,4,5,6\n200,1,2,3,4,5,6\n";
constexpr const char* kRadarRows = "#t,x,y,z,d,snr,noise\n150,1,2,3,-0.5,10,1\n";
constexpr const char* kRadarSensor =
    "T_BS:\n  cols: 4\n  rows: 4\n"
    "  data: [0, -1, 0, 0.1, 1, 0, 0, 0.2, 0, 0, 1, 0.3, 0, 0, 0, 1]\n";

/// A folder with the smallest complete dataset.
void write_minimal(const TempDir& dir, const std::string& prefix = "") {
  dir.write(prefix + "imu0/data.csv", kImuRows);
  dir.write(prefix + "radar0/data.csv", kRadarRows);
  dir.write(prefix + "radar0/sensor.yaml", kRadarSensor);
}

Dataset sample_dataset() {
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
      {Time(1403636579758555397), {{Vector3d(third, 2, 3), -0.7, 12.5, 1.0 + third}, {}}});
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
  return d;
}

TEST(Dataset, RoundTripIsExact) {
  const TempDir dir;
  const Dataset a = sample_dataset();
  write_dataset(dir.path() / "new", a);
  const Dataset b = read_dataset(dir.path() / "new");
  ASSERT_EQ(b.imu.size(), a.imu.size());
  for (std::size_t i = 0; i < a.imu.size(); ++i) {
    EXPECT_EQ(b.imu[i].time, a.imu[i].time);
    EXPECT_EQ(b.imu[i].gyro_B, a.imu[i].gyro_B);
    EXPECT_EQ(b.imu[i].accel_B, a.imu[i].accel_B);
  }
  ASSERT_EQ(b.scans.size(), a.scans.size());
  for (std::size_t i = 0; i < a.scans.size(); ++i) {
    EXPECT_EQ(b.scans[i].time, a.scans[i].time);
    ASSERT_EQ(b.scans[i].detections.size(), a.scans[i].detections.size());
    for (std::size_t k = 0; k < a.scans[i].detections.size(); ++k) {
      const RadarDetection& p = a.scans[i].detections[k];
      const RadarDetection& q = b.scans[i].detections[k];
      EXPECT_EQ(q.point_S, p.point_S);
      EXPECT_EQ(q.range_rate, p.range_rate);
      EXPECT_EQ(q.snr_db, p.snr_db);
      EXPECT_EQ(q.noise_db, p.noise_db);
    }
  }
  ASSERT_EQ(b.baro.size(), a.baro.size());
  EXPECT_EQ(b.baro[2].time, a.baro[2].time);
  EXPECT_EQ(b.baro[2].pressure, a.baro[2].pressure);
  ASSERT_EQ(b.ground_truth.size(), a.ground_truth.size());
  for (std::size_t i = 0; i < a.ground_truth.size(); ++i) {
    EXPECT_EQ(b.ground_truth[i].time, a.ground_truth[i].time);
    EXPECT_EQ(b.ground_truth[i].q_WB.coeffs(), a.ground_truth[i].q_WB.coeffs());
    EXPECT_EQ(b.ground_truth[i].p_WB, a.ground_truth[i].p_WB);
    EXPECT_EQ(b.ground_truth[i].v_WB, a.ground_truth[i].v_WB);
    EXPECT_EQ(b.ground_truth[i].gyro_bias, a.ground_truth[i].gyro_bias);
    EXPECT_EQ(b.ground_truth[i].accel_bias, a.ground_truth[i].accel_bias);
  }
  EXPECT_TRUE(b.notes.empty());
}

TEST(Dataset, SensorInfoRoundTrip) {
  const TempDir dir;
  const Dataset a = sample_dataset();
  write_dataset(dir.path(), a);
  const Dataset b = read_dataset(dir.path());
  EXPECT_EQ(b.imu_info.rate_hz, a.imu_info.rate_hz);
  EXPECT_EQ(b.imu_info.gyro_noise_density, a.imu_info.gyro_noise_density);
  EXPECT_EQ(b.imu_info.gyro_random_walk, a.imu_info.gyro_random_walk);
  EXPECT_EQ(b.imu_info.accel_noise_density, a.imu_info.accel_noise_density);
  EXPECT_EQ(b.imu_info.accel_random_walk, a.imu_info.accel_random_walk);
  const RadarInfo& p = a.radar_info;
  const RadarInfo& q = b.radar_info;
  EXPECT_EQ(q.rate_hz, p.rate_hz);
  EXPECT_EQ(q.max_range, p.max_range);
  EXPECT_EQ(q.max_doppler, p.max_doppler);
  EXPECT_EQ(q.range_resolution, p.range_resolution);
  EXPECT_EQ(q.doppler_resolution, p.doppler_resolution);
  EXPECT_EQ(q.fov_azimuth, p.fov_azimuth);
  EXPECT_EQ(q.fov_elevation, p.fov_elevation);
  EXPECT_EQ(q.sigma_range, p.sigma_range);
  EXPECT_EQ(q.sigma_azimuth, p.sigma_azimuth);
  EXPECT_EQ(q.sigma_elevation, p.sigma_elevation);
  EXPECT_EQ(q.sigma_doppler, p.sigma_doppler);
  EXPECT_EQ(q.T_BS->translation, p.T_BS->translation);
  // the file holds the matrix: quaternion to matrix and back costs some roundings
  EXPECT_LT((q.T_BS->rotation.coeffs() - p.T_BS->rotation.coeffs()).norm(), 1e-15);
}

TEST(Dataset, FindsMav0) {
  const TempDir dir;
  write_minimal(dir, "mav0/");
  EXPECT_EQ(read_dataset(dir.path()).imu.size(), 2U);
  EXPECT_EQ(read_dataset(dir.path() / "mav0").imu.size(), 2U);
}

TEST(Dataset, ScansAreRunsOfOneStamp) {
  const TempDir dir;
  write_minimal(dir);
  dir.write("radar0/data.csv",
            "#t\r\n10,1,2,3,0.1,,,junk\r\n10,1,2,3,0.2,5,6,\r\n20,,,,,,,\r\n15,1,1,1,0.3,7,8,9\r\n"
            "10,1,1,1,nan,7,8,9");
  const Dataset d = read_dataset(dir.path());
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

TEST(Dataset, SignalToNoiseMayBeMissing) {
  const TempDir dir;
  write_minimal(dir);
  dir.write("radar0/data.csv", "10,1,2,3,0.1\n");
  const Dataset d = read_dataset(dir.path());
  EXPECT_EQ(d.scans.at(0).detections.at(0).snr_db, 0.0);
  EXPECT_EQ(d.scans[0].detections[0].range_rate, 0.1);
}

TEST(Dataset, SigmasOfADetectionRoundTrip) {
  const TempDir dir;
  Dataset a = sample_dataset();
  RadarDetection& d = a.scans[0].detections[0];
  d.sigma_range = 0.1;
  d.sigma_azimuth = 1.0 / 3.0;
  d.sigma_doppler = 0.02;
  write_dataset(dir.path() / "new", a);
  const Dataset b = read_dataset(dir.path() / "new");
  const RadarDetection& e = b.scans.at(0).detections.at(0);
  EXPECT_EQ(e.sigma_range, 0.1);
  EXPECT_EQ(e.sigma_azimuth, 1.0 / 3.0);
  EXPECT_EQ(e.sigma_elevation, 0.0);
  EXPECT_EQ(e.sigma_doppler, 0.02);
  EXPECT_EQ(b.scans[0].detections.at(1).sigma_range, 0.0);
  EXPECT_EQ(b.scans.at(1).detections.size(), 0U);
}

TEST(Dataset, KeepsTheOrderAndOddValuesOfTheFile) {
  const TempDir dir;
  write_minimal(dir);
  dir.write("imu0/data.csv", "300,1,2,3,4,5,6\n100,nan,2,3,4,5,inf\n100,1,2,3,4,5,6\n");
  const Dataset d = read_dataset(dir.path());
  ASSERT_EQ(d.imu.size(), 3U);
  EXPECT_EQ(d.imu[0].time, Time(300));
  EXPECT_EQ(d.imu[1].time, Time(100));
  EXPECT_TRUE(std::isnan(d.imu[1].gyro_B.x()));
  EXPECT_TRUE(std::isinf(d.imu[1].accel_B.z()));
}

TEST(Dataset, DamageIsAnErrorWithFileAndLine) {
  const TempDir dir;
  const auto read_with = [&dir](const char* file, const char* text) {
    write_minimal(dir);
    dir.write(file, text);
    read_dataset(dir.path());
  };
  const char* imu = "imu0/data.csv";
  EXPECT_ERROR(read_with(imu, "1,1,2,3,4,5,6\n2,1,2,3,4,5\n"), "imu0/data.csv:2: has 6 columns");
  EXPECT_ERROR(read_with(imu, "1,1,2,3,4,5,x6\n"), "imu0/data.csv:1: column 7: not a number");
  EXPECT_ERROR(read_with(imu, "1,1,2,3,4,5\n"), "imu0/data.csv:1: has 6 columns, column 7");
  EXPECT_ERROR(read_with(imu, "1.5,1,2,3,4,5,6\n"), "imu0/data.csv:1: column 1: not an integer");
  EXPECT_ERROR(read_with(imu, "#only a header\n"), "imu0/data.csv: holds no samples");
  EXPECT_ERROR(read_with(imu, ""), "imu0/data.csv: is empty");
  const char* radar = "radar0/data.csv";
  EXPECT_ERROR(read_with(radar, "1,1,2,3,4,5,6\n1,1,2,3,4\n"), "radar0/data.csv:2: has 5 columns");
  EXPECT_ERROR(read_with(radar, "1,1,2,3,,,\n"), "radar0/data.csv:1: column 5: not a number");
  EXPECT_ERROR(read_with(radar, "1,1,2,3,4,5dB,6\n"), "radar0/data.csv:1: column 6");
  EXPECT_ERROR(read_with(radar, "1,1,2,3,4\n1,,,,\n"), "radar0/data.csv:2: an empty scan has");
  EXPECT_ERROR(read_with(radar, "1,,,,\n1,1,2,3,4\n"), "radar0/data.csv:2: a detection has");
  EXPECT_ERROR(read_with(radar, "1,1,2,3,4,5,6,0.1,,-1,0\n"), "radar0/data.csv:1: a sigma is");
  EXPECT_ERROR(read_with(radar, "1,1,2,3,4,5,6,0.1,,nan,0\n"), "radar0/data.csv:1: a sigma is");
  EXPECT_ERROR(read_with(radar, "1\n"), "radar0/data.csv:1: has 1 columns");
  EXPECT_ERROR(read_with(radar, "# nothing\n"), "radar0/data.csv: holds no scans");
}

TEST(Dataset, MissingPartsAreErrors) {
  const TempDir dir;
  EXPECT_ERROR(read_dataset(dir.path() / "none"), "none: no such folder");
  EXPECT_ERROR(read_dataset(dir.write("file", "x")), "file: is not a folder");
  EXPECT_ERROR(read_dataset(dir.path()), "imu0/data.csv: no such file");
  dir.write("imu0/data.csv", kImuRows);
  EXPECT_ERROR(read_dataset(dir.path()), "radar0/data.csv: no such file");
  write_minimal(dir);
  std::filesystem::create_directory(dir.path() / "baro0");
  EXPECT_ERROR(read_dataset(dir.path()), "baro0/data.csv: no such file");
}

TEST(Dataset, GroundTruthMustBeSound) {
  const TempDir dir;
  write_minimal(dir);
  const auto read_with = [&dir](const char* text) {
    dir.write("state_groundtruth_estimate0/data.csv", text);
    read_dataset(dir.path());
  };
  EXPECT_ERROR(read_with("1,0,0,0,1,0,0,0\n"), "data.csv:1: has 8 columns, 17 are needed");
  EXPECT_ERROR(read_with("1,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0\n"), "not a unit quaternion");
  EXPECT_ERROR(read_with("1,0,0,0,1,0,0,0,nan,0,0,0,0,0,0,0,0\n"), "a value is not finite");
  EXPECT_ERROR(read_with("2,0,0,0,1,0,0,0,0,0,0,0,0,0,0,0,0\n1,0,0,0,1,0,0,0,0,0,0,0,0,0,0,0,0\n"),
               "data.csv:2: time does not increase");
}

TEST(Dataset, MissingRadarPoseIsNoted) {
  const TempDir dir;
  write_minimal(dir);
  dir.write("imu0/sensor.yaml", "rate_hz: 200\n");
  std::filesystem::remove(dir.path() / "radar0/sensor.yaml");
  Dataset d = read_dataset(dir.path());
  ASSERT_EQ(d.notes.size(), 1U);
  EXPECT_TRUE(test::contains(d.notes[0], "radar0/sensor.yaml missing")) << d.notes[0];
  dir.write("radar0/sensor.yaml", "rate_hz: 10\nsigma_dopler_mps: 0.1\n");
  d = read_dataset(dir.path());
  ASSERT_EQ(d.notes.size(), 2U);
  EXPECT_TRUE(test::contains(d.notes[0], "\"sigma_dopler_mps\" is not used")) << d.notes[0];
  EXPECT_TRUE(test::contains(d.notes[1], "has no T_BS")) << d.notes[1];
  EXPECT_EQ(d.radar_info.rate_hz, 10.0);
}

TEST(Dataset, SensorFilesAreChecked) {
  const TempDir dir;
  const auto read_with = [&dir](const char* file, const std::string& text) {
    write_minimal(dir);
    dir.write(file, text);
    read_dataset(dir.path());
  };
  const char* radar = "radar0/sensor.yaml";
  EXPECT_ERROR(read_with(radar, "rate_hz: 1\nT_BS: {data: [1, 2]}\n"),
               "sensor.yaml:2: T_BS: a list");
  EXPECT_ERROR(read_with(radar, "T_BS: {data: [1,0,0,0, 0,1.1,0,0, 0,0,1,0, 0,0,0,1]}\n"),
               "sensor.yaml:1: T_BS: the rotation is not orthonormal");
  EXPECT_ERROR(read_with(radar, "T_BS: {data: [1,0,0,0, 0,1,0,0, 0,0,-1,0, 0,0,0,1]}\n"),
               "not orthonormal");
  EXPECT_ERROR(read_with(radar, "T_BS: {data: [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,1,1]}\n"),
               "not a homogeneous matrix");
  EXPECT_ERROR(read_with(radar, "sigma_range_m: -1\n"), "sensor.yaml:1: sigma_range_m: must be");
  EXPECT_ERROR(read_with(radar, "sigma_range_m: two\n"), "sigma_range_m: not a number");
  EXPECT_ERROR(read_with(radar, "sigma_range_m: 2 deg\n"), "does not fit the unit [m]");
  EXPECT_ERROR(read_with(radar, "fov_azimuth_deg: 120\nazimuth_fov_rad: 2\n"),
               "sensor.yaml:2: azimuth_fov_rad: given twice");
  EXPECT_ERROR(read_with(radar, "rate_hz: 1\nrate_hz: 2\n"), "sensor.yaml:2: duplicate key");
  EXPECT_ERROR(read_with(radar, "rate_hz: [1\n"), "radar0/sensor.yaml:");
  std::filesystem::remove(dir.path() / radar);
  EXPECT_ERROR(
      read_with("imu0/sensor.yaml", "T_BS: {data: [1,0,0,0.01, 0,1,0,0, 0,0,1,0, 0,0,0,1]}\n"),
      "imu0/sensor.yaml:1: T_BS: must be the identity");
}

TEST(Dataset, AnglesAreReadInAllSpellings) {
  const TempDir dir;
  for (const char* keys : {"fov_azimuth_deg: 120\nfov_elevation_deg: 30\nsigma_azimuth_deg: 2\n",
                           "azimuth_fov_deg: 120\nelevation_fov_deg: 30\nsigma_azimuth_deg: 2\n",
                           "azimuth_fov_rad: 120 deg\nelevation_fov_rad: 30 deg\n"
                           "sigma_azimuth_rad: 2 deg\n"}) {
    write_minimal(dir);
    dir.write("radar0/sensor.yaml", std::string(kRadarSensor) + keys);
    const RadarInfo info = read_dataset(dir.path()).radar_info;
    EXPECT_NEAR(info.fov_azimuth.value(), 2.0943951023931953, 1e-15) << keys;
    EXPECT_NEAR(info.fov_elevation.value(), 0.52359877559829887, 1e-15) << keys;
    EXPECT_NEAR(info.sigma_azimuth.value(), 0.034906585039886591, 1e-16) << keys;
  }
}

TEST(Dataset, AlmostOrthonormalPoseIsNormalised) {
  const TempDir dir;
  write_minimal(dir);
  dir.write("radar0/sensor.yaml",
            "T_BS: {data: [1,0.0002,0,0.1, 0,1.0001,0,0.2, 0,0,1,0.3, 0,0,0,1]}\n");
  const Pose T_BS = read_dataset(dir.path()).radar_info.T_BS.value();
  EXPECT_NEAR(T_BS.rotation.norm(), 1.0, 1e-15);
  EXPECT_LT(T_BS.rotation.vec().norm(), 1e-4);  // the shear halves into a rotation of 1e-4 rad
  EXPECT_EQ(T_BS.translation, Vector3d(0.1, 0.2, 0.3));
}

TEST(Dataset, SensorInfoBecomesOptions) {
  const Dataset d = sample_dataset();
  Options o;
  apply_sensor_info(d, &o);
  EXPECT_EQ(o.imu.gyro_noise_density, 1.0 / 3.0);
  EXPECT_EQ(o.imu.gyro_random_walk, 2e-5);
  EXPECT_EQ(o.imu.accel_noise_density, 0.1);
  EXPECT_EQ(o.imu.accel_random_walk, 1e-4);
  EXPECT_EQ(o.radar.T_BS.translation, d.radar_info.T_BS->translation);
  EXPECT_EQ(o.radar.T_BS.rotation.coeffs(), d.radar_info.T_BS->rotation.coeffs());
  EXPECT_EQ(o.radar.sigma_range, 0.03);
  EXPECT_EQ(o.radar.sigma_azimuth, 1.0 / 30.0);
  EXPECT_EQ(o.radar.sigma_elevation, 0.07);
  EXPECT_EQ(o.radar.sigma_doppler, 0.04);
  EXPECT_EQ(o.radar.range_resolution, 0.039);
  EXPECT_EQ(o.radar.doppler_resolution, 1.0 / 3.0);
  EXPECT_NEAR(o.radar.max_range, 16.28 + 0.09, 1e-12);
  // 120 deg wide, sigma at the edge 1/cos(60 deg) = 2 times that at boresight
  EXPECT_NEAR(o.radar.fov_azimuth, 2.0943951023931953 + 6.0 * 2.0 / 30.0, 1e-12);
  EXPECT_NEAR(o.radar.fov_elevation, 0.5 + 6.0 * 0.07 / std::cos(0.25), 1e-12);
  EXPECT_TRUE(o.validate());
}

TEST(Dataset, UnknownSensorInfoLeavesTheOptions) {
  Options o;
  o.radar.max_range = 12.0;
  o.radar.T_BS.translation.x() = 1.0;
  Dataset d;
  d.radar_info.sigma_doppler = 0.0;
  apply_sensor_info(d, &o);
  EXPECT_EQ(o.radar.max_range, 12.0);
  EXPECT_EQ(o.radar.T_BS.translation.x(), 1.0);
  EXPECT_EQ(o.radar.sigma_doppler, Options{}.radar.sigma_doppler);
  d.radar_info.fov_azimuth = 3.1;
  apply_sensor_info(d, &o);
  EXPECT_EQ(o.radar.fov_azimuth, 3.14159265358979323846);  // capped
  EXPECT_TRUE(o.validate());
}

TEST(Dataset, WriterRefusesWhatItCouldNotReadBack) {
  const TempDir dir;
  Dataset d = sample_dataset();
  write_dataset(dir.path(), d);
  d.baro.clear();
  EXPECT_ERROR(write_dataset(dir.path(), d), "baro0: is left from another recording");
  d = sample_dataset();
  d.scans[1].time = d.scans[0].time;
  EXPECT_ERROR(write_dataset(dir.path() / "x", d), "scans 0 and 1 have the same stamp");
}

TEST(Dataset, RealRecording) {
  const char* folder = std::getenv("RIO_TEST_DATA");
  if (folder == nullptr || !std::filesystem::exists(std::filesystem::path(folder) / "ti_demo")) {
    GTEST_SKIP() << "set RIO_TEST_DATA to a folder that holds ti_demo";
  }
  const Dataset d = read_dataset(std::filesystem::path(folder) / "ti_demo");
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

/// A radar file with Doppler values on a grid, or off it by a random part of a step.
void write_doppler(const TempDir& dir, double step, double jitter) {
  std::string rows = "#t,x,y,z,d,snr,noise\n";
  for (int i = 0; i < 400; ++i) {
    const double doppler = step * (i % 21 - 10) + jitter * std::sin(1.7 * i);
    rows += std::to_string(1000 + i) + ",1,2,3," + std::to_string(doppler) + ",10,1\n";
  }
  dir.write("radar0/data.csv", rows);
}

TEST(Dataset, NotesASensorThatEndsLongBeforeTheOther) {
  const TempDir dir;
  write_minimal(dir);
  EXPECT_EQ(read_dataset(dir.path()).notes.size(), 1U);  // no imu0/sensor.yaml
  dir.write("imu0/data.csv", std::string(kImuRows) + "5000000000,1,2,3,4,5,6\n");
  EXPECT_NE(read_dataset(dir.path()).notes.back().find("radar0 ends 5.0 s before imu0"),
            std::string::npos);
}

TEST(Dataset, ReadsTheDopplerGridOffTheData) {
  const TempDir dir;
  write_minimal(dir);
  write_doppler(dir, 0.1249, 0.0);
  const Dataset gridded = read_dataset(dir.path());
  ASSERT_TRUE(gridded.radar_info.doppler_resolution.has_value());
  EXPECT_NEAR(*gridded.radar_info.doppler_resolution, 0.1249, 1e-6);
  EXPECT_TRUE(test::contains(gridded.notes.back(), "no doppler_resolution_mps"));
  write_doppler(dir, 0.1249, 0.05);
  EXPECT_FALSE(read_dataset(dir.path()).radar_info.doppler_resolution.has_value());
}

}  // namespace
}  // namespace rio::io
