// SPDX-License-Identifier: BSD-3-Clause
#include "rio/io/recording_stream.hpp"

#include <optional>
#include <utility>

#include "dataset_layout.hpp"
#include "rio/io/scan_folder.hpp"
#include "sensor_rows.hpp"

namespace rio::io {

namespace fs = std::filesystem;

namespace {

/// One file per sensor, opened on demand.
class FolderStream final : public RecordingStream {
 public:
  FolderStream(const fs::path& path, Truth truth) : root_(dataset_root(path)) {
    outline_ = survey(root_, truth);
    radars_.resize(outline_.scan_times.size());
  }

 private:
  bool read(ImuSample* sample) override {
    if (!imu_) imu_.emplace(root_ / kImu / kData);
    return imu_->next(sample);
  }
  bool read(RadarScan* scan, std::size_t radar) override {
    std::optional<RadarRows>& rows = radars_[radar];
    if (!rows) rows.emplace(root_ / radar_folder(radar) / kData);
    return rows->next(scan);
  }
  bool read(BaroSample* sample) override {
    if (!baro_) baro_.emplace(root_ / kBaro / kData);
    return baro_->next(sample);
  }
  void start_over() override {
    imu_.reset();
    for (std::optional<RadarRows>& rows : radars_) rows.reset();
    baro_.reset();
  }

  fs::path root_;
  std::optional<ImuRows> imu_;
  std::vector<std::optional<RadarRows>> radars_;
  std::optional<BaroRows> baro_;
};

}  // namespace

bool RecordingStream::next(ImuSample* sample) {
  if (imu_ == outline_.imu_samples || !read(sample)) return false;
  ++imu_;
  return true;
}

bool RecordingStream::next(RadarScan* scan, std::size_t radar) {
  scans_.resize(outline_.scan_times.size());
  if (scans_[radar] == outline_.scan_times[radar].size() || !read(scan, radar)) return false;
  ++scans_[radar];
  return true;
}

bool RecordingStream::next(BaroSample* sample) {
  if (baro_ == outline_.baro_samples || !read(sample)) return false;
  ++baro_;
  return true;
}

void RecordingStream::rewind() {
  imu_ = 0;
  scans_.clear();
  baro_ = 0;
  start_over();
}

std::unique_ptr<RecordingStream> open_dataset(const fs::path& path, Truth truth) {
  if (is_scan_folder(path)) return open_scan_folder(path);
  return std::make_unique<FolderStream>(path, truth);
}

Dataset collect(RecordingStream* stream) {
  stream->rewind();
  const RecordingOutline& outline = stream->outline();
  Dataset all = outline.sensors;
  all.imu.resize(outline.imu_samples);
  std::size_t count = 0;
  while (count < all.imu.size() && stream->next(&all.imu[count])) ++count;
  all.imu.resize(count);
  for (std::size_t r = 0; r < outline.scan_times.size(); ++r) {
    std::vector<RadarScan>& scans = r == 0 ? all.scans : all.other_radars[r - 1].scans;
    scans.reserve(outline.scan_times[r].size());
    RadarScan scan;
    while (stream->next(&scan, r)) scans.push_back(std::move(scan));
  }
  BaroSample sample;
  while (stream->next(&sample)) all.baro.push_back(sample);
  return all;
}

}  // namespace rio::io
