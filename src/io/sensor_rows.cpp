// SPDX-License-Identifier: BSD-3-Clause
#include "sensor_rows.hpp"

#include <cmath>
#include <limits>

namespace rio::io {

namespace {

constexpr std::size_t kRadarColumns = 7;  ///< without the sigmas of each detection

/// A trailing column that may be missing or empty.
double number_or_zero(const CsvReader& rows, std::size_t i) {
  return i >= rows.columns() || rows.is_empty(i) ? 0.0 : rows.number(i);
}

/// An empty cell is how spreadsheets and pandas write what is not a number.
double number_or_nan(const CsvReader& rows, std::size_t i) {
  return rows.is_empty(i) ? std::numeric_limits<double>::quiet_NaN() : rows.number(i);
}

bool is_empty_scan(const CsvReader& rows) {
  if (rows.columns() < 5) return false;
  for (std::size_t i = 1; i < rows.columns(); ++i) {
    if (!rows.is_empty(i)) return false;
  }
  return true;
}

/// Cell i, 0 if it is empty.
double sigma_at(const CsvReader& rows, std::size_t i) {
  const double sigma = number_or_zero(rows, i);
  if (!(std::isfinite(sigma) && sigma >= 0.0)) rows.fail("a sigma is negative or not finite");
  return sigma;
}

}  // namespace

Vector3d vector_at(const CsvReader& rows, std::size_t i) {
  return {rows.number(i), rows.number(i + 1), rows.number(i + 2)};
}

bool ImuRows::next(ImuSample* sample) {
  if (!CsvReader::next()) return false;
  sample->time = Time(integer(0));
  for (int k = 0; k < 3; ++k) {
    const auto axis = static_cast<std::size_t>(k);
    sample->gyro_B[k] = number_or_nan(*this, 1 + axis);
    sample->accel_B[k] = number_or_nan(*this, 4 + axis);
  }
  return true;
}

bool RadarRows::has_sigmas() const {
  if (columns() < kRadarColumns + 4) return false;
  const std::string_view name = heading(kRadarColumns);
  const auto is_in = [name](std::string_view part) { return name.find(part) != name.npos; };
  return name.empty() || is_in("sig") || is_in("Sig") || is_in("std") || is_in("STD") ||
         is_in("dev") || is_in("err") || is_in("unc") || is_in("s_");
}

RadarDetection RadarRows::detection() const {
  RadarDetection d;
  d.point_S = vector_at(*this, 1);
  d.range_rate = number(4);
  d.snr_db = number_or_zero(*this, 5);
  d.noise_db = number_or_zero(*this, 6);
  if (has_sigmas()) {
    d.sigma_range = sigma_at(*this, kRadarColumns);
    d.sigma_azimuth = sigma_at(*this, kRadarColumns + 1);
    d.sigma_elevation = sigma_at(*this, kRadarColumns + 2);
    d.sigma_doppler = sigma_at(*this, kRadarColumns + 3);
  }
  return d;
}

bool RadarRows::next(RadarScan* scan) {
  if (!begun_) {
    if (!CsvReader::next()) return false;
    time_ = Time(integer(0));
  }
  begun_ = false;
  scan->time = time_;
  scan->detections.clear();
  const bool empty = is_empty_scan(*this);
  if (!empty) scan->detections.push_back(detection());
  while (CsvReader::next()) {
    time_ = Time(integer(0));
    if (time_ != scan->time) {
      begun_ = true;
      break;
    }
    if (is_empty_scan(*this)) fail("an empty scan has the stamp of the row before");
    if (empty) fail("a detection has the stamp of an empty scan");
    scan->detections.push_back(detection());
  }
  return true;
}

bool BaroRows::next(BaroSample* sample) {
  if (!CsvReader::next()) return false;
  *sample = {Time(integer(0)), number(1)};
  return true;
}

}  // namespace rio::io
