// SPDX-License-Identifier: BSD-3-Clause
// The writer of recordings.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "dataset_layout.hpp"
#include "dataset_rows.hpp"
#include "rio/io/dataset.hpp"
#include "rio/io/text_file.hpp"

namespace rio::io {

namespace fs = std::filesystem;

namespace {

std::string pose_text(const Pose& pose) {
  const Matrix3d R = pose.rotation.toRotationMatrix();
  std::string text = "T_BS:\n  cols: 4\n  rows: 4\n  data: [";
  for (int i = 0; i < 3; ++i) {
    text +=
        fmt::format("{}, {}, {}, {},\n         ", R(i, 0), R(i, 1), R(i, 2), pose.translation[i]);
  }
  return text + "0, 0, 0, 1]\n";
}

/// The known values, each under its first key in SI units.
std::string keys_text(const std::vector<SensorKey>& keys) {
  std::string text;
  std::set<const std::optional<double>*> written;
  for (const SensorKey& key : keys) {
    if (key.factor != 1.0 || !key.target->has_value()) continue;
    if (!written.insert(key.target).second) continue;
    text += fmt::format("{}: {}\n", key.key, **key.target);
  }
  return text;
}

void write_file(const fs::path& path, const std::string& text) {
  TextFile file(path);
  file.write(text);
  file.close();
}

std::string comment_text(const std::string& line) {
  return line.empty() ? line : "# " + line + "\n";
}

std::string imu_text(const std::vector<ImuSample>& samples) {
  std::string text = kImuHeader;
  for (const ImuSample& sample : samples) append_row(&text, sample);
  return text;
}

bool has_sigmas(const RadarDetection& d) {
  return d.sigma_range + d.sigma_azimuth + d.sigma_elevation + d.sigma_doppler > 0.0;
}

std::string radar_text(const std::vector<RadarScan>& scans) {
  const bool sigmas = std::any_of(scans.begin(), scans.end(), [](const RadarScan& scan) {
    return std::any_of(scan.detections.begin(), scan.detections.end(), has_sigmas);
  });
  std::string text = radar_header(sigmas);
  for (const RadarScan& scan : scans) append_rows(&text, scan, sigmas);
  return text;
}

std::string baro_text(const std::vector<BaroSample>& samples) {
  std::string text = "#timestamp [ns],pressure [Pa]\n";
  for (const BaroSample& sample : samples) {
    text += fmt::format("{},{}\n", sample.time.count(), sample.pressure);
  }
  return text;
}

std::string truth_text(const std::vector<NavState>& states) {
  std::string text =
      "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],"
      "q_RS_z [],v_RS_R_x [m s^-1],v_RS_R_y [m s^-1],v_RS_R_z [m s^-1],b_w_RS_S_x [rad s^-1],"
      "b_w_RS_S_y [rad s^-1],b_w_RS_S_z [rad s^-1],b_a_RS_S_x [m s^-2],b_a_RS_S_y [m s^-2],"
      "b_a_RS_S_z [m s^-2]\n";
  for (const NavState& state : states) {
    text += fmt::format("{}", state.time.count());
    append(&text, state.p_WB);
    text += fmt::format(",{}", state.q_WB.w());
    append(&text, state.q_WB.vec());
    append(&text, state.v_WB);
    append(&text, state.gyro_bias);
    append(&text, state.accel_bias);
    text += '\n';
  }
  return text;
}

std::string radar_info_text(const RadarInfo& info, const std::string& comment) {
  RadarInfo radar = info;
  return comment_text(comment) +
         "sensor_type: radar\ncomment: x forward, y left, z up; doppler = range rate, "
         "positive = receding\n" +
         (radar.T_BS ? pose_text(*radar.T_BS) : "") + keys_text(radar_keys(&radar));
}

/// Two neighbouring scans with one stamp would be read as one.
void check_stamps(const fs::path& folder, const std::vector<RadarScan>& scans) {
  for (std::size_t i = 1; i < scans.size(); ++i) {
    if (scans[i].time != scans[i - 1].time) continue;
    throw std::runtime_error(fmt::format("{}: scans {} and {} have the same stamp {}",
                                         folder.string(), i - 1, i, scans[i].time.count()));
  }
}

}  // namespace

void write_dataset(const fs::path& path, const Dataset& dataset) {
  check_stamps(path / kRadar, dataset.scans);
  for (std::size_t r = 1; r <= Options::kMaxOtherRadars; ++r) {
    const fs::path folder = path / radar_folder(r);
    if (r <= dataset.other_radars.size()) {
      check_stamps(folder, dataset.other_radars[r - 1].scans);
    } else if (fs::exists(folder)) {
      throw std::runtime_error(folder.string() + ": is left from another recording");
    }
  }
  const std::pair<const char*, std::string> optional_files[] = {
      {kBaro, dataset.baro.empty() ? "" : baro_text(dataset.baro)},
      {kTruth, dataset.ground_truth.empty() ? "" : truth_text(dataset.ground_truth)}};
  for (const auto& [folder, text] : optional_files) {
    if (text.empty() && fs::exists(path / folder)) {
      throw std::runtime_error((path / folder).string() + ": is left from another recording");
    }
  }
  fs::create_directories(path / kImu);
  fs::create_directories(path / kRadar);
  write_file(path / kImu / kData, imu_text(dataset.imu));
  write_file(path / kRadar / kData, radar_text(dataset.scans));
  for (const auto& [folder, text] : optional_files) {
    if (text.empty()) continue;
    fs::create_directories(path / folder);
    write_file(path / folder / kData, text);
  }
  for (std::size_t r = 1; r <= dataset.other_radars.size(); ++r) {
    const Dataset::OtherRadar& other = dataset.other_radars[r - 1];
    fs::create_directories(path / radar_folder(r));
    write_file(path / radar_folder(r) / kData, radar_text(other.scans));
    write_radar_info(path, other.info, {}, r);
  }
  write_imu_info(path, dataset.imu_info);
  write_radar_info(path, dataset.radar_info);
}

void write_imu_info(const fs::path& path, const ImuInfo& info, const std::string& comment) {
  fs::create_directories(path / kImu);
  ImuInfo imu = info;
  write_file(path / kImu / kSensor, comment_text(comment) + "sensor_type: imu\n" +
                                        pose_text(Pose{}) + keys_text(imu_keys(&imu)));
}

void write_radar_info(const fs::path& path, const RadarInfo& info, const std::string& comment,
                      std::size_t radar) {
  const fs::path folder = path / radar_folder(radar);
  fs::create_directories(folder);
  write_file(folder / kSensor, radar_info_text(info, comment));
}

}  // namespace rio::io
