// SPDX-License-Identifier: BSD-3-Clause
#include "rio/io/scan_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "decimal.hpp"
#include "doppler_grid.hpp"
#include "rio/io/csv.hpp"

namespace rio::io {

namespace fs = std::filesystem;

namespace {

static_assert(std::endian::native == std::endian::little, "as the files");

constexpr const char* kColoImu = "imu/imu_data.txt";
constexpr const char* kColoScans = "single_chip/pointclouds";
constexpr const char* kHerculesImu = "sensor_data/xsens_imu.csv";
constexpr const char* kHerculesScans = "Radar/Continental";

double float_at(const char* bytes) {
  float value = 0.0F;
  std::memcpy(&value, bytes, sizeof(value));
  return static_cast<double>(value);
}

RadarDetection coloradar_point(const char* p) {
  RadarDetection d;
  d.point_S = {float_at(p + 4), -float_at(p), float_at(p + 8)};
  d.snr_db = float_at(p + 12);
  d.range_rate = float_at(p + 16);
  return d;
}

RadarDetection hercules_point(const char* p) {
  RadarDetection d;
  d.point_S = {float_at(p), float_at(p + 4), float_at(p + 8)};
  d.range_rate = float_at(p + 12);
  return d;
}

/// Points of a file.
struct Layout {
  std::size_t bytes;
  RadarDetection (*point)(const char*);
};
constexpr Layout kColoradar = {20, coloradar_point};
constexpr Layout kHercules = {29, hercules_point};

class ScanFolder final : public RecordingStream {
 public:
  explicit ScanFolder(const fs::path& root)
      : layout_(fs::exists(root / kColoImu) ? kColoradar : kHercules) {
    outline_.scan_times.emplace_back();
    if (fs::exists(root / kColoImu)) {
      find_coloradar(root);
    } else {
      find_hercules(root);
    }
    if (imu_.empty()) throw std::runtime_error(root.string() + ": no samples of the IMU");
    if (files_.empty()) throw std::runtime_error(root.string() + ": no scans");
    survey();
  }

 private:
  void find_coloradar(const fs::path& root) {
    CsvReader times(root / "imu/timestamps.txt", ' ');
    for (CsvReader rows(root / kColoImu, ' '); rows.next();) {
      if (!times.next()) rows.fail("has no stamp in imu/timestamps.txt");
      imu_.push_back({Time(times.seconds_to_ns(0)),
                      {rows.number(3), rows.number(4), rows.number(5)},
                      {rows.number(0), rows.number(1), rows.number(2)}});
    }
    for (CsvReader rows(root / kColoScans / "timestamps.txt", ' '); rows.next();) {
      outline_.scan_times[0].emplace_back(rows.seconds_to_ns(0));
      files_.push_back(root / kColoScans / "data" /
                       fmt::format("radar_pointcloud_{}.bin", files_.size()));
    }
    outline_.sensors.radar_info.axes = "ti";
  }

  void find_hercules(const fs::path& root) {
    for (CsvReader rows(root / kHerculesImu); rows.next();) {
      imu_.push_back({Time(rows.integer(0)),
                      {rows.number(8), rows.number(9), rows.number(10)},
                      {rows.number(11), rows.number(12), rows.number(13)}});
    }
    for (const fs::directory_entry& entry : fs::directory_iterator(root / kHerculesScans)) {
      if (entry.path().extension() == ".bin") files_.push_back(entry.path());
    }
    std::sort(files_.begin(), files_.end());  // names of 19 digits
    for (const fs::path& file : files_) {
      const std::string name = file.stem().string();
      const auto stamp = plain_number_of<std::int64_t>(name);
      if (name.size() != 19 || !stamp || *stamp < 0) {
        throw std::runtime_error(file.string() + ": its name is no stamp in nanoseconds");
      }
      outline_.scan_times[0].emplace_back(*stamp);
    }
    outline_.sensors.radar_info.axes = "flu";
  }

  /// Reads all scans once.
  void survey() {
    DopplerGrid grid;
    const auto each_scan = [this](const auto& use) {
      RadarScan scan;
      for (const fs::path& file : files_) {
        read_points(file, &scan);
        if (!use(scan)) break;
      }
    };
    each_scan([&grid](const RadarScan& scan) {
      grid.add(scan);
      return true;
    });
    Dataset& sensors = outline_.sensors;
    if (2 * cut_ > files_.size()) throw std::runtime_error(sensors.damage);  // another format
    if (left_out_ > 0) {
      sensors.notes.push_back(fmt::format("{} points are not finite and are left out", left_out_));
    }
    const std::vector<Time>& times = outline_.scan_times[0];
    outline_.imu_samples = imu_.size();
    outline_.imu_begin = imu_.front().time;
    outline_.imu_end = imu_.back().time;
    const auto rate = [](Time span, std::size_t count) {
      return span > Time(0) ? std::optional(static_cast<double>(count - 1) / to_seconds(span))
                            : std::nullopt;
    };
    sensors.imu_info.rate_hz = rate(outline_.imu_end - outline_.imu_begin, imu_.size());
    sensors.radar_info.rate_hz = rate(times.back() - times.front(), times.size());
    sensors.radar_info.doppler_resolution = grid.step(each_scan);
  }

  void read_points(const fs::path& file, RadarScan* scan) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw std::runtime_error(file.string() + ": cannot be opened");
    const std::string bytes((std::istreambuf_iterator<char>(stream)), {});
    if (bytes.size() % layout_.bytes != 0 && cut_++ == 0) {
      outline_.sensors.damage = fmt::format("{}: {} bytes are no points of {} bytes", file.string(),
                                            bytes.size(), layout_.bytes);
    }
    scan->detections.clear();
    for (std::size_t at = 0; at + layout_.bytes <= bytes.size(); at += layout_.bytes) {
      RadarDetection d = layout_.point(bytes.data() + at);
      if (!std::isfinite(d.snr_db)) d.snr_db = 0.0;  // as if not given
      if (d.point_S.allFinite() && std::isfinite(d.range_rate)) {
        scan->detections.push_back(d);
      } else {
        ++left_out_;
      }
    }
  }

  bool read(ImuSample* sample) override {
    *sample = imu_[next_imu_++];
    return true;
  }
  bool read(RadarScan* scan, std::size_t /*radar*/) override {
    read_points(files_[next_scan_], scan);
    scan->time = outline_.scan_times[0][next_scan_++];
    return true;
  }
  bool read(BaroSample* /*sample*/) override { return false; }
  void start_over() override { next_imu_ = next_scan_ = 0; }

  Layout layout_;
  std::vector<ImuSample> imu_;
  std::vector<fs::path> files_;
  std::size_t next_imu_ = 0;
  std::size_t next_scan_ = 0;
  std::size_t left_out_ = 0;  ///< points
  std::size_t cut_ = 0;       ///< files
};

}  // namespace

bool is_scan_folder(const fs::path& path) {
  return (fs::exists(path / kColoImu) && fs::exists(path / kColoScans)) ||
         (fs::exists(path / kHerculesImu) && fs::exists(path / kHerculesScans));
}

std::unique_ptr<RecordingStream> open_scan_folder(const fs::path& path) {
  return std::make_unique<ScanFolder>(path);
}

}  // namespace rio::io
