// SPDX-License-Identifier: BSD-3-Clause
// sensor.yaml of IMU and radars: its keys, and its reader.
#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <stdexcept>

#include "dataset_layout.hpp"
#include "decimal.hpp"
#include "yaml.hpp"

namespace rio::io {

namespace fs = std::filesystem;

namespace {

/// Reads a 4x4 homogeneous matrix in EuRoC's {cols, rows, data}, or {translation, quaternion_wxyz}
/// as in option files.
Pose read_pose(const YamlFile& file, const YAML::Node& node) {
  if (node.IsMap() && node["quaternion_wxyz"].IsDefined()) {
    const std::vector<double> q =
        yaml_numbers(file, node["quaternion_wxyz"], "T_BS: quaternion_wxyz", "", 4);
    const auto rotation = unit_quaternion(q[0], q[1], q[2], q[3]);
    if (!rotation) fail_at(file, node["quaternion_wxyz"], "T_BS: not a unit quaternion");
    if (!node["translation"].IsDefined()) fail_at(file, node, "T_BS: no translation");
    return {*rotation, yaml_vector(file, node["translation"], "T_BS: translation", "m")};
  }
  const YAML::Node data = node.IsMap() ? node["data"] : node;
  const std::vector<double> m = yaml_numbers(file, data.IsDefined() ? data : node, "T_BS", "", 16);
  const Eigen::Matrix4d T =
      Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(m.data());
  const Matrix3d R = T.topLeftCorner<3, 3>();
  const double error = (R.transpose() * R - Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(error < 1e-3) || R.determinant() < 0.0) {
    fail_at(file, node, "T_BS: the rotation is not orthonormal");
  }
  if (!T.allFinite() || T.row(3) != Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0)) {
    fail_at(file, node, "T_BS: not a homogeneous matrix");
  }
  const Eigen::JacobiSVD<Matrix3d> svd(R, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Matrix3d nearest = svd.matrixU() * svd.matrixV().transpose();
  return {Quaternion(nearest).normalized(), T.topRightCorner<3, 1>()};
}

/// Notes a key that is not read, such as a misspelt one.
void note_unknown(const YamlFile& file, const YAML::Node& key, const std::vector<SensorKey>& keys,
                  std::vector<std::string>* notes) {
  // read elsewhere, or descriptive as in EuRoC
  constexpr const char* kOther[] = {"T_BS", "mounting", "sensor_type", "comment"};
  const std::string& name = key.Scalar();
  if (std::find(std::begin(kOther), std::end(kOther), name) != std::end(kOther)) return;
  std::vector<std::string> names{"T_BS", "mounting"};
  for (const SensorKey& known : keys) names.emplace_back(known.key);
  notes->push_back(fmt::format("{}:{}: unknown key \"{}\" is not used{}", file.name,
                               key.Mark().line + 1, name, did_you_mean(name, names)));
}

/// Reads the known keys; most values must not be negative.
void read_sensor_keys(const YamlFile& file, const std::vector<SensorKey>& keys,
                      std::vector<std::string>* notes) {
  for (const auto& entry : file.root) {
    const std::string& name = entry.first.Scalar();
    const auto known =
        std::find_if(keys.begin(), keys.end(), [&](const SensorKey& k) { return name == k.key; });
    if (known == keys.end()) {
      note_unknown(file, entry.first, keys, notes);
      continue;
    }
    if (known->target->has_value()) fail_at(file, entry.first, name + ": given twice");
    const double value = yaml_number(file, entry.second, name, known->unit) * known->factor;
    if (!std::isfinite(value) || (value < 0.0 && !known->is_signed)) {
      fail_at(file, entry.second,
              name + ": must be a finite number" + (known->is_signed ? "" : " not below zero"));
    }
    *known->target = value;
  }
}

}  // namespace

std::vector<SensorKey> imu_keys(ImuInfo* info) {
  return {{"rate_hz", "Hz", 1.0, &info->rate_hz},
          {"gyroscope_noise_density", "rad/s/sqrt(Hz)", 1.0, &info->gyro_noise_density},
          {"gyroscope_random_walk", "rad/s^2/sqrt(Hz)", 1.0, &info->gyro_random_walk},
          {"accelerometer_noise_density", "m/s^2/sqrt(Hz)", 1.0, &info->accel_noise_density},
          {"accelerometer_random_walk", "m/s^3/sqrt(Hz)", 1.0, &info->accel_random_walk}};
}

std::vector<SensorKey> radar_keys(RadarInfo* info) {
  return {{"rate_hz", "Hz", 1.0, &info->rate_hz},
          {"max_range_m", "m", 1.0, &info->max_range},
          {"max_doppler_mps", "m/s", 1.0, &info->max_doppler},
          {"range_resolution_m", "m", 1.0, &info->range_resolution},
          {"doppler_resolution_mps", "m/s", 1.0, &info->doppler_resolution},
          {"fov_azimuth_deg", "", kDegree, &info->fov_azimuth},
          {"azimuth_fov_deg", "", kDegree, &info->fov_azimuth},
          {"fov_azimuth_rad", "rad", 1.0, &info->fov_azimuth},
          {"azimuth_fov_rad", "rad", 1.0, &info->fov_azimuth},
          {"fov_elevation_deg", "", kDegree, &info->fov_elevation},
          {"elevation_fov_deg", "", kDegree, &info->fov_elevation},
          {"fov_elevation_rad", "rad", 1.0, &info->fov_elevation},
          {"elevation_fov_rad", "rad", 1.0, &info->fov_elevation},
          {"sigma_range_m", "m", 1.0, &info->sigma_range},
          {"sigma_azimuth_deg", "", kDegree, &info->sigma_azimuth},
          {"sigma_azimuth_rad", "rad", 1.0, &info->sigma_azimuth},
          {"sigma_elevation_deg", "", kDegree, &info->sigma_elevation},
          {"sigma_elevation_rad", "rad", 1.0, &info->sigma_elevation},
          {"sigma_doppler_mps", "m/s", 1.0, &info->sigma_doppler},
          {"weak_snr_db", "dB", 1.0, &info->weak_snr_db, true},
          {"time_offset_s", "s", 1.0, &info->time_offset, true},
          {"doppler_scale", "", 1.0, &info->doppler_scale, true},
          {"prior_rotation_deg", "", kDegree, &info->prior_rotation},
          {"prior_rotation_rad", "rad", 1.0, &info->prior_rotation},
          {"prior_position_m", "m", 1.0, &info->prior_position},
          {"prior_time_offset_s", "s", 1.0, &info->prior_time_offset},
          {"prior_doppler_scale", "", 1.0, &info->prior_doppler_scale}};
}

fs::path dataset_root(const fs::path& path) {
  if (!fs::exists(path)) throw std::runtime_error(path.string() + ": no such folder");
  if (!fs::is_directory(path)) throw std::runtime_error(path.string() + ": is not a folder");
  if (!fs::exists(path / kImu) && fs::is_directory(path / "mav0")) return path / "mav0";
  return path;
}

void read_imu_info(const fs::path& path, Dataset* dataset) {
  if (!fs::exists(path)) {
    dataset->notes.push_back(path.string() + " missing: IMU noise from the options");
    return;
  }
  const YamlFile file = load_yaml(path);
  read_sensor_keys(file, imu_keys(&dataset->imu_info), &dataset->notes);
  for (const auto& entry : file.root) {
    if (entry.first.Scalar() != "T_BS") continue;
    const Pose T_BS = read_pose(file, entry.second);
    if (T_BS.translation.norm() > 1e-6 || T_BS.rotation.vec().norm() > 1e-6) {
      fail_at(file, entry.first, "T_BS: must be the identity, the body frame is the IMU frame");
    }
  }
}

void read_radar_info(const fs::path& path, RadarInfo* info, std::vector<std::string>* notes) {
  const char* const consequence = ": radar pose from the options, by default at the body origin";
  if (!fs::exists(path)) {
    notes->push_back(path.string() + " missing" + consequence);
    return;
  }
  const YamlFile file = load_yaml(path);
  read_sensor_keys(file, radar_keys(info), notes);
  if (const YAML::Node pose = file.root["T_BS"]) info->T_BS = read_pose(file, pose);
  if (const YAML::Node mounting = file.root["mounting"]) {
    if (mounting.Scalar() != "unknown") {
      fail_at(file, mounting, "mounting: is \"unknown\" or left out");
    }
    constexpr double kAnywhere = 1.0;  // on a small vehicle [m]
    info->prior_rotation = info->prior_rotation.value_or(std::numbers::pi);
    info->prior_position = info->prior_position.value_or(kAnywhere);
  } else if (!info->T_BS) {
    notes->push_back(path.string() + " has no T_BS" + consequence);
  }
}

Dataset read_sensor_info(const fs::path& path) {
  const fs::path root = dataset_root(path);
  Dataset dataset;
  read_imu_info(root / kImu / kSensor, &dataset);
  read_radar_info(root / kRadar / kSensor, &dataset.radar_info, &dataset.notes);
  for (std::size_t r = 1; r <= Options::kMaxOtherRadars; ++r) {
    if (!fs::exists(root / radar_folder(r))) break;
    dataset.other_radars.emplace_back();
    read_radar_info(root / radar_folder(r) / kSensor, &dataset.other_radars.back().info,
                    &dataset.notes);
  }
  return dataset;
}

}  // namespace rio::io
