// SPDX-License-Identifier: BSD-3-Clause
#include "rio/bag/dataset_presets.hpp"

#include <stdexcept>
#include <vector>

#include "io/yaml.hpp"

namespace rio::bag {

namespace {

/// "a|b": the first that is there; "a|": or the only one of its type.
constexpr DatasetPreset kDatasets[] = {
    {.name = "icins-2021",
     .meaning = "Doer and Trommer: IWR6843AOP, ADIS16448, barometer",
     .imu = "/sensor_platform/imu",
     .radar = "/sensor_platform/radar/scan",
     .pressure = "/sensor_platform/baro|",
     .truth = "/ground_truth/pose|",
     .points = "rio",
     .doubt = "the mounting is in its calib.yaml; whether scans are stamped by their trigger"},
    {.name = "jgn-2022",
     .meaning = "Doer and Trommer: three IWR6843AOP, ADIS16448, barometer",
     .imu = "/sensor_platform/imu",
     .radar = "/sensor_platform/radar_left/scan,/sensor_platform/radar_right/scan,"
              "/sensor_platform/radar_center/scan",
     .pressure = "/sensor_platform/baro|",
     .truth = "/ground_truth/pose|",
     .points = "rio",
     .doubt = "the mountings are in its calib_*.yaml; whether scans are stamped by their trigger"},
    {.name = "irs-rtvi",
     .meaning = "Doer and Trommer: TI radar, IMU, visual and thermal camera",
     .imu = "/sensor_platform/imu",
     .radar = "/sensor_platform/radar/scan",
     .points = "rio",
     .doubt = "the fields are taken to be those of icins-2021; the mounting is in its "
              "radar_calib.yaml"},
    {.name = "brio",
     .meaning = "ethz-asl/rio: AWR1843AOP, BMI088, BMP390",
     .imu = "/imu/data_raw",
     .radar = "/radar/cfar_detections",
     .pressure = "/baro/pressure|",
     .points = "mav",
     .mounting = {0.122, 0.0, -0.025, 0.0, 0.956305, 0.0, -0.292372}},
    {.name = "aau",
     .meaning = "aau-cns, awr_6 and awr_7: AWR1843BOOST, IMU of a PX4, motion capture",
     .imu = "/mavros/imu/data_raw",
     .radar = "/ti_mmwave/radar_scan_pcl",
     .truth = "/twins_cns4/vrpn_client/raw_pose|",
     .points = "pointxyzi",
     .axes = "flu",
     .doubt = "the axes of the points: forward, left, up follows from the published mounting"},
    {.name = "ekf-rio-tc",
     .meaning = "Kim et al., sequences 1 to 7: AWR1843BOOST, MTi-670, motion capture",
     .imu = "/imu/data",
     .radar = "/ti_mmwave/radar_scan_pcl_0",
     .mounting = {0.09, -0.01, -0.10, 0.92388, 0.0, 0.382683, 0.0},
     .doubt = "the topic of the motion capture"},
    {.name = "coloradar",
     .meaning = "ColoRadar, single chip, bag or folder: AWR1843BOOST, 3DM-GX5-25, lidar truth",
     .imu = "/gx5/imu/data",
     .radar = "/mmWaveDataHdl/RScan",
     .truth = "/lidar_ground_truth|",
     .points = "coloradar",
     .doubt = "the mounting is in its calib/transforms"},
    {.name = "hkust",
     .meaning = "HKUST-Aerial-Robotics/RIO, sequences 1 to 3: ARS548, BMI088, motion capture",
     .imu = "/mavros/imu/data",
     .radar = "/radar_raw_message",
     .truth = "/pos_vel_mocap/odom_TA|",
     .points = "ars548",
     .doubt = "unit (rad) and axes of the angles; the mounting"},
    {.name = "ntu4dradlm",
     .meaning = "NTU4DRadLM: Oculii Eagle, VN-100",
     .imu = "/vectornav/imu",
     .radar = "/radar_enhanced_pcl",
     .points = "eagle",
     .imu_axes = Axes::kFrd,
     .doubt = "the axes of IMU and points are those of their users; the mounting: its calibration "
              "files contradict the paper"},
    {.name = "msc-rad4r",
     .meaning = "MSC-RAD4R: Oculii Eagle, MTi-630",
     .imu = "/imu/data",
     .radar = "/oculii_radar/point_cloud",
     .points = "msc",
     .doubt = "the axes of the points: its page says those of the lidar (--axes flu), two users "
              "right, down, forward; whether power and doppler are exchanged; the mounting"},
    {.name = "snail",
     .meaning = "SNAIL: ARS548 (or --radar /radar_enhanced_pcl2, the Eagle), MTi-3DK",
     .imu = "/mti3dk/imu",
     .radar = "/ars548|/radar_enhanced_pcl2|/radar_pcl2",
     .axes = "flu",
     .doubt = "the mounting depends on the day: tf_static.launch of the sequence"},
    {.name = "mine-and-forest",
     .meaning = "Mine and Forest (Orebro): Sensrad Hugin, MTi-30 turned by 90 deg",
     .imu = "/imu/data",
     .radar = "/hugin_raf_1/radar_data",
     .axes = "flu",
     .imu_axes = Axes::kTi,
     .doubt = "the axes of the points; the lever arm"},
    {.name = "orebro",
     .meaning = "Orebro challenge: three Sensrad Hugin, MTi-30",
     .imu = "/imu/data|",
     .radar = "/hugin_1/radar_data,/hugin_2/radar_data,/hugin_3/radar_data",
     .truth = "/icp_odom|",
     .axes = "flu",
     .doubt = "the topic and the axes of the IMU; the axes of the points; the mountings"},
    {.name = "ntnu",
     .meaning = "NTNU unified autonomy stack: IWR6843, VN-100",
     .imu = "/vectornav_driver_node/imu/data|",
     .radar = "/radar/cloud|",
     .points = "mimosa",
     .doubt = "the topics differ by vehicle; two sources for the mounting differ by some degrees"},
    {.name = "hercules",
     .meaning = "HeRCULES, a folder: ARS548, MTi-300",
     .imu = "/imu/data_raw|",
     .doubt = "the axes of the points (taken as forward, left, up) and the sign of their Doppler; "
              "the mounting is in its calibration files"},
};

}  // namespace

Pose DatasetPreset::T_BS() const {
  Pose pose;
  pose.translation = {mounting[0], mounting[1], mounting[2]};
  pose.rotation = Quaternion(mounting[3], mounting[4], mounting[5], mounting[6]).normalized();
  return pose;
}

std::span<const DatasetPreset> dataset_presets() {
  return kDatasets;
}

const DatasetPreset& dataset_preset(const std::string& name) {
  std::vector<std::string> names;
  std::string list;
  for (const DatasetPreset& preset : kDatasets) {
    if (name == preset.name) return preset;
    names.emplace_back(preset.name);
    list += std::string("\n  ") + preset.name + ": " + preset.meaning;
  }
  throw std::runtime_error("no such data set: \"" + name + "\"" + io::did_you_mean(name, names) +
                           "; there are" + list);
}

bool take_mounting(const DatasetPreset& preset, io::RadarInfo* radar) {
  if (!preset.is_mounted() || radar->T_BS) return false;
  radar->T_BS = preset.T_BS();
  return true;
}

RecordingRequest request_of(const DatasetPreset& preset) {
  RecordingRequest request;
  request.imu_topic = preset.imu;
  request.imu_axes = preset.imu_axes;
  request.radar_topic = preset.radar;
  request.pressure_topic = preset.pressure;
  request.truth_topic = preset.truth;
  request.points.preset = preset.points;
  request.points.axes = preset.axes;
  request.mounting_is_known = preset.is_mounted();
  return request;
}

}  // namespace rio::bag
