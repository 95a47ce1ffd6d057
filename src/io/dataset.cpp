// SPDX-License-Identifier: BSD-3-Clause
#include "rio/io/dataset.hpp"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <stdexcept>

#include "dataset_layout.hpp"
#include "doppler_grid.hpp"
#include "rio/io/csv.hpp"
#include "unit_quaternion.hpp"
#include "yaml.hpp"

namespace rio::io {

namespace fs = std::filesystem;

namespace {

/// The folder that holds the sensor folders.
fs::path dataset_root(const fs::path& path) {
  if (!fs::exists(path)) throw std::runtime_error(path.string() + ": no such folder");
  if (!fs::is_directory(path)) throw std::runtime_error(path.string() + ": is not a folder");
  if (!fs::exists(path / kImu) && fs::is_directory(path / "mav0")) return path / "mav0";
  return path;
}

Vector3d vector_at(const CsvReader& rows, std::size_t i) {
  return {rows.number(i), rows.number(i + 1), rows.number(i + 2)};
}

/// Samples that are not finite are kept, as they were recorded, and the first is noted.
std::vector<ImuSample> read_imu(const fs::path& path, std::vector<std::string>* notes) {
  CsvReader rows(path);
  std::vector<ImuSample> samples;
  int bad = 0;
  std::string first;
  while (rows.next()) {
    samples.push_back({Time(rows.integer(0)), vector_at(rows, 1), vector_at(rows, 4)});
    if ((samples.back().gyro_B + samples.back().accel_B).allFinite()) continue;
    if (++bad == 1) first = rows.place();
  }
  if (samples.empty()) throw std::runtime_error(path.string() + ": holds no samples");
  if (bad > 0) {
    notes->push_back(fmt::format("{}: not finite, the first of {} such samples", first, bad));
  }
  return samples;
}

/// A trailing column that may be missing or empty.
double number_or_zero(const CsvReader& rows, std::size_t i) {
  return i >= rows.columns() || rows.is_empty(i) ? 0.0 : rows.number(i);
}

bool is_empty_scan(const CsvReader& rows) {
  if (rows.columns() < 5) return false;
  for (std::size_t i = 1; i < rows.columns(); ++i) {
    if (!rows.is_empty(i)) return false;
  }
  return true;
}

constexpr std::size_t kRadarColumns = 7;  ///< without the sigmas of each detection

/// Cell i, 0 if it is empty.
double sigma_at(const CsvReader& rows, std::size_t i) {
  const double sigma = number_or_zero(rows, i);
  if (!(std::isfinite(sigma) && sigma >= 0.0)) rows.fail("a sigma is negative or not finite");
  return sigma;
}

RadarDetection detection_at(const CsvReader& rows) {
  RadarDetection d;
  d.point_S = vector_at(rows, 1);
  d.range_rate = rows.number(4);
  d.snr_db = number_or_zero(rows, 5);
  d.noise_db = number_or_zero(rows, 6);
  if (rows.columns() >= kRadarColumns + 4) {
    d.sigma_range = sigma_at(rows, kRadarColumns);
    d.sigma_azimuth = sigma_at(rows, kRadarColumns + 1);
    d.sigma_elevation = sigma_at(rows, kRadarColumns + 2);
    d.sigma_doppler = sigma_at(rows, kRadarColumns + 3);
  }
  return d;
}

std::vector<RadarScan> read_radar(const fs::path& path) {
  CsvReader rows(path);
  std::vector<RadarScan> scans;
  while (rows.next()) {
    const Time time(rows.integer(0));
    const bool same_scan = !scans.empty() && scans.back().time == time;
    if (is_empty_scan(rows)) {
      if (same_scan) rows.fail("an empty scan has the stamp of the row before");
      scans.push_back({time, {}});
      continue;
    }
    if (same_scan && scans.back().detections.empty()) {
      rows.fail("a detection has the stamp of an empty scan");
    }
    if (!same_scan) scans.push_back({time, {}});
    scans.back().detections.push_back(detection_at(rows));
  }
  if (scans.empty()) throw std::runtime_error(path.string() + ": holds no scans");
  return scans;
}

std::vector<BaroSample> read_baro(const fs::path& path) {
  CsvReader rows(path);
  std::vector<BaroSample> samples;
  while (rows.next()) samples.push_back({Time(rows.integer(0)), rows.number(1)});
  return samples;
}

NavState truth_at(const CsvReader& rows) {
  constexpr std::size_t kEurocColumns = 17;
  NavState state;
  state.time = Time(rows.integer(0));
  state.p_WB = vector_at(rows, 1);
  const auto q = unit_quaternion(rows.number(4), rows.number(5), rows.number(6), rows.number(7));
  if (!q) rows.fail("not a unit quaternion");
  state.q_WB = *q;
  if (rows.columns() >= 11) state.v_WB = vector_at(rows, 8);
  if (rows.columns() == kEurocColumns) {  // a states file has its covariance here
    state.gyro_bias = vector_at(rows, 11);
    state.accel_bias = vector_at(rows, 14);
  }
  if (!(state.p_WB + state.v_WB + state.gyro_bias + state.accel_bias).allFinite()) {
    rows.fail("a value is not finite");
  }
  return state;
}

/// Hands over every state.
void read_truth_file(const fs::path& path, std::size_t min_columns,
                     const std::function<void(const NavState&)>& keep) {
  CsvReader rows(path);
  std::optional<Time> last;
  while (rows.next()) {
    if (rows.columns() < min_columns) {
      rows.fail(fmt::format("has {} columns, {} are needed", rows.columns(), min_columns));
    }
    const NavState state = truth_at(rows);
    if (last && state.time <= *last) rows.fail("time does not increase");
    last = state.time;
    keep(state);
  }
  if (!last) throw std::runtime_error(path.string() + ": holds no states");
}

std::vector<NavState> read_truth_file(const fs::path& path, std::size_t min_columns) {
  std::vector<NavState> states;
  read_truth_file(path, min_columns, [&states](const NavState& state) { states.push_back(state); });
  return states;
}

/// The first state within the span of the IMU; the last one if there is none.
NavState read_start_of_truth(const fs::path& path, const std::vector<ImuSample>& imu) {
  std::optional<NavState> start;
  const auto within = [&imu](const NavState& state) {
    return state.time >= imu.front().time && state.time <= imu.back().time;
  };
  read_truth_file(path, 17, [&](const NavState& state) {
    if (!start || !within(*start)) start = state;
  });
  return *start;
}

/// Reads a 4x4 homogeneous matrix in EuRoC's {cols, rows, data}, or {translation, quaternion_wxyz}
/// as in option files.
Pose read_pose(const YamlFile& file, const YAML::Node& node) {
  if (node.IsMap() && node["quaternion_wxyz"].IsDefined()) {
    const std::vector<double> q =
        yaml_numbers(file, node["quaternion_wxyz"], "T_BS: quaternion_wxyz", "", 4);
    const auto rotation = unit_quaternion(q[0], q[1], q[2], q[3]);
    if (!rotation) fail_at(file, node["quaternion_wxyz"], "T_BS: not a unit quaternion");
    if (!node["translation"].IsDefined()) fail_at(file, node, "T_BS: no translation");
    const std::vector<double> p =
        yaml_numbers(file, node["translation"], "T_BS: translation", "m", 3);
    return {*rotation, Vector3d(p[0], p[1], p[2])};
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

/// Of a key that nothing reads, such as a known one with a typing error.
void note_unknown(const YamlFile& file, const YAML::Node& key, const std::vector<SensorKey>& keys,
                  std::vector<std::string>* notes) {
  constexpr const char* kDescriptive[] = {"T_BS", "sensor_type", "comment"};  // as in EuRoC
  const std::string& name = key.Scalar();
  if (std::find(std::begin(kDescriptive), std::end(kDescriptive), name) != std::end(kDescriptive)) {
    return;
  }
  std::vector<std::string> names{"T_BS"};
  for (const SensorKey& known : keys) names.emplace_back(known.key);
  notes->push_back(fmt::format("{}:{}: unknown key \"{}\" is not used{}", file.name,
                               key.Mark().line + 1, name, did_you_mean(name, names)));
}

/// Reads the known keys; most values may not be negative.
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
  for (const auto& entry : file.root) {
    if (entry.first.Scalar() == "T_BS") info->T_BS = read_pose(file, entry.second);
  }
  if (!info->T_BS) {
    notes->push_back(path.string() + " has no T_BS" + consequence);
  }
}

/// A file that was cut between two rows is whole to its reader; the other sensor tells.
void note_if_cut_short(const fs::path& root, Dataset* dataset) {
  // not of the difference, which the integers may not hold
  const double ahead =
      to_seconds(dataset->imu.back().time) - to_seconds(dataset->scans.back().time);
  if (std::abs(ahead) < 1.0) return;
  dataset->notes.push_back(fmt::format("{} ends {:.1f} s before {}",
                                       (root / (ahead > 0.0 ? kRadar : kImu)).string(),
                                       std::abs(ahead), ahead > 0.0 ? kImu : kRadar));
}

}  // namespace

Dataset read_dataset(const fs::path& path, Truth truth) {
  const fs::path root = dataset_root(path);
  Dataset dataset;
  dataset.imu = read_imu(root / kImu / kData, &dataset.notes);
  dataset.scans = read_radar(root / kRadar / kData);
  if (fs::exists(root / kBaro)) dataset.baro = read_baro(root / kBaro / kData);
  if (fs::exists(root / kTruth)) {
    const fs::path file = root / kTruth / kData;
    dataset.ground_truth = truth == Truth::kAll
                               ? read_truth_file(file, 17)
                               : std::vector<NavState>{read_start_of_truth(file, dataset.imu)};
  }
  read_imu_info(root / kImu / kSensor, &dataset);
  read_radar_info(root / kRadar / kSensor, &dataset.radar_info, &dataset.notes);
  for (std::size_t r = 1; r <= Options::kMaxOtherRadars; ++r) {
    const fs::path folder = root / radar_folder(r);
    if (!fs::exists(folder)) break;
    dataset.other_radars.push_back({read_radar(folder / kData), {}});
    read_radar_info(folder / kSensor, &dataset.other_radars.back().info, &dataset.notes);
  }
  note_if_cut_short(root, &dataset);
  std::optional<double>& grid = dataset.radar_info.doppler_resolution;
  if (!grid && (grid = doppler_grid(dataset.scans))) {
    dataset.notes.push_back(
        fmt::format("{}: no doppler_resolution_mps; the data has steps of {:.4f} m/s",
                    (root / kRadar / kSensor).string(), *grid));
  }
  return dataset;
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

std::vector<NavState> read_ground_truth(const fs::path& path) {
  return read_truth_file(fs::is_directory(path) ? dataset_root(path) / kTruth / kData : path, 8);
}

}  // namespace rio::io
