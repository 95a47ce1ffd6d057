// SPDX-License-Identifier: BSD-3-Clause
#include "check/check.hpp"

#include <algorithm>
#include <utility>

#include "check/imu_check.hpp"
#include "check/motion.hpp"
#include "check/motion_check.hpp"
#include "check/radar_check.hpp"

namespace rio::check {

Findings check_recording(const io::Dataset& dataset, const Options& options, Source source,
                         const std::filesystem::path& imu_csv) {
  const std::vector<ImuSample> samples = usable(dataset.imu);
  ImuCheck imu = check_imu(dataset.imu, samples, dataset.imu_info, source, imu_csv);
  Findings out = std::move(imu.findings);
  const auto append = [&out](const Findings& more) {
    out.insert(out.end(), more.begin(), more.end());
  };
  if (dataset.imu.empty() || dataset.scans.empty()) return out;
  append({check_clocks(dataset, source)});
  Options read = options;
  double& limit = read.radar.max_doppler;
  if (limit > 0.0) limit = std::max(limit, fastest(dataset.scans));
  const std::vector<RadarSpeed> speeds = radar_speeds(dataset.scans, read);
  append(check_radar(dataset, speeds, options, source));
  append(check_motion(samples, speeds, imu.gyro_unit, imu.accel_unit, options, source));
  return out;
}

}  // namespace rio::check
