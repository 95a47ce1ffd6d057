// SPDX-License-Identifier: BSD-3-Clause
// The writers of recordings, at once and during the run.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "dataset_layout.hpp"
#include "rio/io/dataset_stream.hpp"

namespace rio::io {

namespace fs = std::filesystem;

namespace {

constexpr const char* kImuHeader =
    "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
    "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n";
constexpr const char* kBaroHeader = "#timestamp [ns],pressure [Pa]\n";
constexpr const char* kTruthHeader =
    "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],"
    "q_RS_z [],v_RS_R_x [m s^-1],v_RS_R_y [m s^-1],v_RS_R_z [m s^-1],b_w_RS_S_x [rad s^-1],"
    "b_w_RS_S_y [rad s^-1],b_w_RS_S_z [rad s^-1],b_a_RS_S_x [m s^-2],b_a_RS_S_y [m s^-2],"
    "b_a_RS_S_z [m s^-2]\n";

/// "x,y,z"; every number exactly.
std::string cells(const Vector3d& v) {
  return fmt::format("{},{},{}", v.x(), v.y(), v.z());
}

std::string row(const ImuSample& s) {
  return fmt::format("{},{},{}\n", s.time.count(), cells(s.gyro_B), cells(s.accel_B));
}
std::string row(const BaroSample& s) {
  return fmt::format("{},{}\n", s.time.count(), s.pressure);
}
std::string row(const NavState& s) {
  return fmt::format("{},{},{},{},{},{},{}\n", s.time.count(), cells(s.p_WB), s.q_WB.w(),
                     cells(s.q_WB.vec()), cells(s.v_WB), cells(s.gyro_bias), cells(s.accel_bias));
}

/// @param sigmas include the columns of the detections' own sigmas
std::string radar_header(bool sigmas) {
  std::string text = "#timestamp [ns],x [m],y [m],z [m],doppler [m s^-1],snr [dB],noise [dB]";
  if (sigmas) {
    text += ",sigma range [m],sigma azimuth [rad],sigma elevation [rad],sigma doppler [m s^-1]";
  }
  return text + '\n';
}

/// A row per detection; one with empty fields for an empty scan.
std::string radar_rows(const RadarScan& scan, bool sigmas) {
  if (scan.detections.empty()) {
    return fmt::format("{},,,,,,{}\n", scan.time.count(), sigmas ? ",,,," : "");
  }
  std::string text;
  for (const RadarDetection& d : scan.detections) {
    text += fmt::format("{},{},{},{},{}", scan.time.count(), cells(d.point_S), d.range_rate,
                        d.snr_db, d.noise_db);
    if (sigmas) {
      text += fmt::format(",{},{},{},{}", d.sigma_range, d.sigma_azimuth, d.sigma_elevation,
                          d.sigma_doppler);
    }
    text += '\n';
  }
  return text;
}

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
  fs::create_directories(path.parent_path());
  TextFile file(path);
  file.write(text);
  file.close();
}

std::string comment_text(const std::string& line) {
  return line.empty() ? line : "# " + line + "\n";
}

/// The data of a sensor.
template <class Sample>
void write_rows(const fs::path& folder, std::string text, const std::vector<Sample>& samples) {
  for (const Sample& sample : samples) text += row(sample);
  write_file(folder / kData, text);
}

void write_scans(const fs::path& folder, const std::vector<RadarScan>& scans) {
  const bool sigmas = has_sigmas(scans);
  std::string text = radar_header(sigmas);
  for (const RadarScan& scan : scans) text += radar_rows(scan, sigmas);
  write_file(folder / kData, text);
}

/// Two neighbouring scans with one stamp would be read as one.
void check_stamps(const fs::path& folder, const std::vector<RadarScan>& scans) {
  for (std::size_t i = 1; i < scans.size(); ++i) {
    if (scans[i].time != scans[i - 1].time) continue;
    throw std::runtime_error(fmt::format("{}: scans {} and {} have the same stamp {}",
                                         folder.string(), i - 1, i, scans[i].time.count()));
  }
}

void refuse_left_over(const fs::path& folder) {
  if (!fs::exists(folder)) return;
  throw std::runtime_error(folder.string() + ": is left from another recording");
}

TextFile begin_file(const fs::path& folder, const std::string& header) {
  const fs::path path = folder / kData;
  if (fs::exists(path)) throw std::runtime_error(path.string() + ": is another recording");
  fs::create_directories(folder);
  TextFile file(path);
  file.write(header);
  return file;
}

}  // namespace

bool has_sigmas(const std::vector<RadarScan>& scans) {
  return std::any_of(scans.begin(), scans.end(), [](const RadarScan& scan) {
    return std::any_of(scan.detections.begin(), scan.detections.end(), [](const auto& d) {
      return d.sigma_range + d.sigma_azimuth + d.sigma_elevation + d.sigma_doppler > 0.0;
    });
  });
}

void write_dataset(const fs::path& path, const Dataset& dataset) {
  const std::size_t others = dataset.other_radars.size();
  check_stamps(path / kRadar, dataset.scans);
  for (std::size_t r = 1; r <= Options::kMaxOtherRadars; ++r) {
    const fs::path folder = path / radar_folder(r);
    if (r <= others) {
      check_stamps(folder, dataset.other_radars[r - 1].scans);
    } else {
      refuse_left_over(folder);
    }
  }
  if (dataset.baro.empty()) refuse_left_over(path / kBaro);
  if (dataset.ground_truth.empty()) refuse_left_over(path / kTruth);
  write_rows(path / kImu, kImuHeader, dataset.imu);
  write_scans(path / kRadar, dataset.scans);
  if (!dataset.baro.empty()) write_rows(path / kBaro, kBaroHeader, dataset.baro);
  if (!dataset.ground_truth.empty()) {
    write_rows(path / kTruth, kTruthHeader, dataset.ground_truth);
  }
  for (std::size_t r = 1; r <= others; ++r) {
    const Dataset::OtherRadar& other = dataset.other_radars[r - 1];
    write_scans(path / radar_folder(r), other.scans);
    write_radar_info(path, other.info, {}, r);
  }
  write_imu_info(path, dataset.imu_info);
  write_radar_info(path, dataset.radar_info);
}

void write_imu_info(const fs::path& path, const ImuInfo& info, const std::string& comment) {
  ImuInfo imu = info;
  write_file(path / kImu / kSensor, comment_text(comment) + "sensor_type: imu\n" +
                                        pose_text(Pose{}) + keys_text(imu_keys(&imu)));
}

void write_radar_info(const fs::path& path, const RadarInfo& info, const std::string& comment,
                      std::size_t radar) {
  RadarInfo copy = info;
  write_file(path / radar_folder(radar) / kSensor,
             comment_text(comment) +
                 "sensor_type: radar\ncomment: x forward, y left, z up; doppler = range rate, "
                 "positive = receding\n" +
                 (copy.T_BS ? pose_text(*copy.T_BS) : "") + keys_text(radar_keys(&copy)));
}

DatasetStream::DatasetStream(const fs::path& path, const Dataset& info)
    : imu_(begin_file(path / kImu, kImuHeader)) {
  write_imu_info(path, info.imu_info);
  for (std::size_t r = 0; r <= info.other_radars.size(); ++r) {
    radars_.push_back({begin_file(path / radar_folder(r), radar_header(false))});
    write_radar_info(path, r == 0 ? info.radar_info : info.other_radars[r - 1].info, {}, r);
  }
}

void DatasetStream::add(const ImuSample& sample) {
  imu_.write(row(sample));
}

void DatasetStream::add(const RadarScan& scan, std::size_t radar) {
  Radar& to = radars_.at(radar);
  if (scan.time == to.last) return;
  to.last = scan.time;
  to.file.write(radar_rows(scan, false));
}

void DatasetStream::flush() {
  imu_.flush();
  for (Radar& radar : radars_) radar.file.flush();
}

void DatasetStream::close() {
  imu_.close();
  for (Radar& radar : radars_) radar.file.close();
}

}  // namespace rio::io
