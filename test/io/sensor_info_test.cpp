// SPDX-License-Identifier: BSD-3-Clause
// What a recording says of its sensors: sensor.yaml read, written, and made options of.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "io/field_values.hpp"
#include "io/sample_dataset.hpp"
#include "rio/io/options_yaml.hpp"
#include "rio/option_fields.hpp"

namespace rio::io {
namespace {

using SensorInfo = MinimalDataset;

TEST_F(SensorInfo, RoundTrip) {
  const Dataset a = sample_dataset();
  write_dataset(dir.path(), a);
  const Dataset b = read();
  EXPECT_EQ(b.imu_info.rate_hz, a.imu_info.rate_hz);
  EXPECT_EQ(b.radar_info.rate_hz, a.radar_info.rate_hz);
  Options read;
  Options put;
  apply_sensor_info(b, &read);
  apply_sensor_info(a, &put);
  // the file holds the matrix: quaternion to matrix and back costs some roundings
  EXPECT_LT((read.radar.T_BS.rotation.coeffs() - put.radar.T_BS.rotation.coeffs()).norm(), 1e-15);
  read.radar.T_BS.rotation = put.radar.T_BS.rotation;
  EXPECT_EQ(values(read), values(put));
}

TEST_F(SensorInfo, MissingFilesAndKeysOfTheRadarAreNoted) {
  dir.write("imu0/sensor.yaml", "sensor_type: imu\nrate_hz: 200\n");
  std::filesystem::remove(dir.path() / "radar0/sensor.yaml");
  Dataset d = read();
  ASSERT_EQ(d.notes.size(), 1U);
  EXPECT_PRED2(test::contains, d.notes[0], "radar0/sensor.yaml missing");
  dir.write("radar0/sensor.yaml", "comment: x\nrate_hz: 10\nmax_doppler_mp: 2\nlens: 4\n");
  d = read();
  ASSERT_EQ(d.notes.size(), 3U);
  EXPECT_PRED2(test::contains, d.notes[0],
               "radar0/sensor.yaml:3: unknown key \"max_doppler_mp\" is not used, did you mean "
               "\"max_doppler_mps\"?");
  EXPECT_PRED2(test::contains, d.notes[1], "sensor.yaml:4: unknown key \"lens\" is not used");
  EXPECT_PRED2(test::contains, d.notes[2], "has no T_BS");
  EXPECT_EQ(d.radar_info.rate_hz, 10.0);
}

TEST_F(SensorInfo, AnUnknownMountingIsAPriorOfAnyRotation) {
  dir.write("imu0/sensor.yaml", "rate_hz: 200\n");
  const Dataset d = read_with("radar0/sensor.yaml", "rate_hz: 10\nmounting: unknown\n");
  EXPECT_TRUE(d.notes.empty()) << d.notes[0];
  Options options;
  apply_sensor_info(d, &options);
  EXPECT_DOUBLE_EQ(options.calibration.rotation_sigma, std::numbers::pi);
  EXPECT_EQ(options.calibration.translation_sigma, 1.0);
  EXPECT_TRUE(options.validate());
  dir.write("radar0/sensor.yaml", "rate_hz: 10\nmounting: unknown\nprior_position_m: 0.02\n");
  apply_sensor_info(read(), &options);
  EXPECT_EQ(options.calibration.translation_sigma, 0.02);
}

TEST_F(SensorInfo, SensorFilesAreChecked) {
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
  EXPECT_ERROR(read_with(radar, "time_offset_s: nan\n"), "time_offset_s: must be a finite number");
  EXPECT_ERROR(read_with(radar, "prior_position_m: -1\n"), "not below zero");
  EXPECT_ERROR(read_with(radar, "sigma_range_m: 2 deg\n"), "does not fit the unit [m]");
  EXPECT_ERROR(read_with(radar, "fov_azimuth_deg: 120\nazimuth_fov_rad: 2\n"),
               "sensor.yaml:2: azimuth_fov_rad: given twice");
  EXPECT_ERROR(read_with(radar, "rate_hz: [1\n"), "radar0/sensor.yaml:");
  EXPECT_ERROR(read_with(radar, "rate_hz: 1\nmounting: upside down\n"),
               "sensor.yaml:2: mounting: is \"unknown\" or left out");
  std::filesystem::remove(dir.path() / radar);
  EXPECT_ERROR(
      read_with("imu0/sensor.yaml", "T_BS: {data: [1,0,0,0.01, 0,1,0,0, 0,0,1,0, 0,0,0,1]}\n"),
      "imu0/sensor.yaml:1: T_BS: must be the identity");
}

TEST_F(SensorInfo, AnglesAreReadInAllSpellings) {
  for (const char* keys : {"fov_azimuth_deg: 120\nfov_elevation_deg: 30\nsigma_azimuth_deg: 2\n",
                           "azimuth_fov_deg: 120\nelevation_fov_deg: 30\nsigma_azimuth_deg: 2\n",
                           "azimuth_fov_rad: 120 deg\nelevation_fov_rad: 30 deg\n"
                           "sigma_azimuth_rad: 2 deg\n"}) {
    const RadarInfo info =
        read_with("radar0/sensor.yaml", std::string(kRadarSensor) + keys).radar_info;
    EXPECT_NEAR(info.fov_azimuth.value(), 2.0943951023931953, 1e-15) << keys;
    EXPECT_NEAR(info.fov_elevation.value(), 0.52359877559829887, 1e-15) << keys;
    EXPECT_NEAR(info.sigma_azimuth.value(), 0.034906585039886591, 1e-16) << keys;
  }
}

TEST_F(SensorInfo, AlmostOrthonormalPoseIsNormalised) {
  dir.write("radar0/sensor.yaml",
            "T_BS: {data: [1,0.0002,0,0.1, 0,1.0001,0,0.2, 0,0,1,0.3, 0,0,0,1]}\n");
  const Pose T_BS = read().radar_info.T_BS.value();
  EXPECT_NEAR(T_BS.rotation.norm(), 1.0, 1e-15);
  EXPECT_LT(T_BS.rotation.vec().norm(), 1e-4);  // the shear halves into a rotation of 1e-4 rad
  EXPECT_EQ(T_BS.translation, Vector3d(0.1, 0.2, 0.3));
}

TEST_F(SensorInfo, APoseMayBeAQuaternion) {
  const auto read_pose = [this](const std::string& pose) {
    return read_with("radar0/sensor.yaml", "T_BS: " + pose + "\n").radar_info.T_BS.value();
  };
  const Pose T_BS = read_pose("{translation: [10 cm, 0, -0.2], quaternion_wxyz: [0, 0, 0.6, 0.8]}");
  EXPECT_EQ(T_BS.translation, Vector3d(0.1, 0.0, -0.2));
  EXPECT_NEAR(T_BS.rotation.y(), 0.6, 1e-15);
  EXPECT_NEAR(T_BS.rotation.z(), 0.8, 1e-15);
  EXPECT_ERROR(read_pose("{quaternion_wxyz: [1, 0, 0, 0]}"), "sensor.yaml:1: T_BS: no translation");
  EXPECT_ERROR(read_pose("{translation: [0, 0, 0], quaternion_wxyz: [1, 0, 0, 1]}"),
               "sensor.yaml:1: T_BS: not a unit quaternion");
}

TEST_F(SensorInfo, BecomesOptions) {
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
  EXPECT_EQ(o.radar.weak_snr_db, -2.5);
  EXPECT_EQ(o.radar.time_offset, -1.0 / 3.0 / 100.0);
  EXPECT_EQ(o.radar.doppler_scale, -0.01);
  EXPECT_EQ(o.calibration.rotation_sigma, 1.0 / 60.0);
  EXPECT_EQ(o.calibration.translation_sigma, 0.004);
  EXPECT_EQ(o.calibration.time_offset_sigma, 0.002);
  EXPECT_EQ(o.calibration.doppler_scale_sigma, 0.003);
  EXPECT_TRUE(o.validate());
}

/// What the sensors tell changes, and is named; all else stays.
/// @param least number of the changes
/// @return the keys that are named
std::vector<std::string> expect_only_what_is_told(const Dataset& told, Options options,
                                                  std::size_t least) {
  const Options before = options;
  std::vector<std::string> configured;
  apply_sensor_info(told, &options, &configured);
  std::vector<std::string> every;
  visit_fields(options, [&](const FieldInfo& info, const auto&) { every.push_back(info.key); });
  EXPECT_EQ(changed_options(before, options, every), changed_options(before, options, configured));
  EXPECT_GE(changed_options(before, options, configured).size(), least);
  return configured;
}

TEST_F(SensorInfo, ExactlyTheOptionsThatAreToldChange) {
  const std::vector<std::string> every = sensor_option_keys();
  EXPECT_EQ(expect_only_what_is_told(sample_dataset(), {}, 20), every);

  Dataset little;
  little.radar_info.sigma_doppler = 0.0;  // no noise model
  little.radar_info.max_range = 20.0;
  Options own;
  own.radar.sigma_doppler = 0.5;
  own.radar.T_BS.translation.x() = 1.0;
  EXPECT_EQ(expect_only_what_is_told(little, own, 1), std::vector<std::string>{"radar.max_range"});

  // a prior switches no calibration on; what is known of the same is used nonetheless
  Options fixed;
  fixed.calibration = {0.0, 0.0, 0.0, 0.0, 0.0};
  std::vector<std::string> known = every;
  std::erase_if(known, [](const std::string& key) { return key.starts_with("calibration."); });
  EXPECT_EQ(known.size(), every.size() - 4);
  EXPECT_EQ(expect_only_what_is_told(sample_dataset(), fixed, 17), known);
}

TEST_F(SensorInfo, TheFieldOfViewIsAtMostAHalfTurn) {
  Options o;
  Dataset d;
  d.radar_info.fov_azimuth = 3.1;
  apply_sensor_info(d, &o);
  EXPECT_EQ(o.radar.fov_azimuth, std::numbers::pi);
  EXPECT_TRUE(o.validate());
}

TEST_F(SensorInfo, AFurtherRadarIsAsTheFirstButForWhatItsFileSays) {
  Dataset d;
  d.radar_info.T_BS = Pose{Quaternion::Identity(), {0.1, 0.0, 0.0}};
  d.radar_info.sigma_doppler = 0.1;
  d.radar_info.max_doppler = 2.5;
  d.other_radars.resize(2);
  d.other_radars[1].info.T_BS = Pose{Quaternion::Identity(), {-0.1, 0.0, 0.0}};
  d.other_radars[1].info.max_doppler = 8.0;
  d.other_radars[1].info.fov_elevation = 0.5;
  Options o;
  apply_sensor_info(d, &o);
  ASSERT_EQ(o.radars(), 3U);
  EXPECT_EQ(o.radar_of(1).max_doppler, 2.5);
  EXPECT_EQ(o.radar_of(1).T_BS.translation.x(), 0.1);
  EXPECT_EQ(o.radar_of(2).max_doppler, 8.0);
  EXPECT_EQ(o.radar_of(2).sigma_doppler, 0.1);
  EXPECT_EQ(o.radar_of(2).T_BS.translation.x(), -0.1);
  EXPECT_LT(o.radar_of(2).fov_elevation, o.radar_of(0).fov_elevation);

  // an option file speaks of the first, and of the others where theirs are silent
  o.radar.max_doppler = 3.0;
  o.radar.sigma_doppler = 0.2;
  apply_other_radars(d, &o);
  EXPECT_EQ(o.radar_of(1).max_doppler, 3.0);
  EXPECT_EQ(o.radar_of(2).max_doppler, 8.0);
  EXPECT_EQ(o.radar_of(2).sigma_doppler, 0.2);

  std::string why;
  o.other_radars[1].kind->sigma_range = -1.0;
  EXPECT_FALSE(o.validate(&why));
  EXPECT_EQ(why.find("radar 2: radar.sigma_range"), 0U) << why;
}

TEST(OptionsYaml, ASettingHasNoLineAndAWrongPresetTellsAll) {
  Options options;
  EXPECT_ERROR(apply_settings({"radar.colour=1"}, &options),
               "radar.colour=1: unknown key \"radar.colour\"");
  EXPECT_ERROR(apply_settings({"radar.T_BS.translation=0.1,0,0"}, &options),
               "radar.T_BS.translation=0.1,0,0: radar.T_BS.translation: a list of 3 numbers");
  EXPECT_ERROR(
      preset_named("published-ukf"),
      "no such preset: \"published-ukf\"; there are default, published-ekf, published-smoo");
}

}  // namespace
}  // namespace rio::io
