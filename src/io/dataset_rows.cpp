// SPDX-License-Identifier: BSD-3-Clause
#include "dataset_rows.hpp"

#include <fmt/format.h>

#include <iterator>

namespace rio::io {

void append(std::string* row, const Vector3d& v) {
  fmt::format_to(std::back_inserter(*row), ",{},{},{}", v.x(), v.y(), v.z());
}

void append_row(std::string* text, const ImuSample& sample) {
  *text += fmt::format("{}", sample.time.count());
  append(text, sample.gyro_B);
  append(text, sample.accel_B);
  *text += '\n';
}

std::string radar_header(bool sigmas) {
  std::string text = "#timestamp [ns],x [m],y [m],z [m],doppler [m s^-1],snr [dB],noise [dB]";
  if (sigmas) {
    text += ",sigma range [m],sigma azimuth [rad],sigma elevation [rad],sigma doppler [m s^-1]";
  }
  return text + '\n';
}

void append_rows(std::string* text, const RadarScan& scan, bool sigmas) {
  if (scan.detections.empty()) {
    *text += fmt::format("{},,,,,,{}\n", scan.time.count(), sigmas ? ",,,," : "");
  }
  for (const RadarDetection& d : scan.detections) {
    *text += fmt::format("{}", scan.time.count());
    append(text, d.point_S);
    *text += fmt::format(",{},{},{}", d.range_rate, d.snr_db, d.noise_db);
    if (sigmas) {
      *text += fmt::format(",{},{},{},{}", d.sigma_range, d.sigma_azimuth, d.sigma_elevation,
                           d.sigma_doppler);
    }
    *text += '\n';
  }
}

}  // namespace rio::io
