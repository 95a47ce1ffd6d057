// SPDX-License-Identifier: BSD-3-Clause
#include "rio/io/dataset_stream.hpp"

#include <stdexcept>
#include <string>

#include "dataset_layout.hpp"
#include "dataset_rows.hpp"

namespace rio::io {

namespace fs = std::filesystem;

namespace {

TextFile begin_file(const fs::path& folder, const std::string& header) {
  const fs::path path = folder / kData;
  if (fs::exists(path)) throw std::runtime_error(path.string() + ": is another recording");
  fs::create_directories(folder);
  TextFile file(path);
  file.write(header);
  return file;
}

}  // namespace

DatasetStream::DatasetStream(const fs::path& path, const Dataset& info)
    : imu_(begin_file(path / kImu, kImuHeader)) {
  write_imu_info(path, info.imu_info);
  for (std::size_t r = 0; r <= info.other_radars.size(); ++r) {
    radars_.push_back({begin_file(path / radar_folder(r), radar_header(false))});
    write_radar_info(path, r == 0 ? info.radar_info : info.other_radars[r - 1].info, {}, r);
  }
}

void DatasetStream::add(const ImuSample& sample) {
  std::string row;
  append_row(&row, sample);
  imu_.write(row);
}

void DatasetStream::add(const RadarScan& scan, std::size_t radar) {
  Radar& to = radars_.at(radar);
  if (to.any && scan.time == to.last) return;
  to.any = true;
  to.last = scan.time;
  std::string rows;
  append_rows(&rows, scan, false);
  to.file.write(rows);
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
