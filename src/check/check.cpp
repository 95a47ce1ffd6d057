// SPDX-License-Identifier: BSD-3-Clause
#include "check/check.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "check/imu_check.hpp"
#include "check/motion.hpp"
#include "check/motion_check.hpp"
#include "check/points_check.hpp"
#include "check/radar_check.hpp"
#include "check/units.hpp"

namespace rio::check {

namespace {

/// The IMU data for the other checks.
struct CheckedImu {
  const std::vector<ImuSample>& all;
  const std::vector<ImuSample>& good;  ///< usable()
  ImuCheck check;
};

bool in_metres(const Findings& findings) {
  return std::none_of(findings.begin(), findings.end(), [](const Finding& finding) {
    return finding.subject == "distances" && finding.verdict == Verdict::kWrong;
  });
}

/// A radar; `options` have it as the first one.
Findings check_one_radar(const CheckedImu& imu, const Scans& scans, const io::RadarInfo& info,
                         std::size_t radar, const Options& options, Source source,
                         const std::filesystem::path& folder) {
  const std::string name = "radar" + std::to_string(radar);
  if (scans.empty()) return {};
  Options read = options;
  double& limit = read.radar.max_doppler;
  if (limit > 0.0) limit = std::max(limit, fastest(scans));
  const std::vector<RadarSpeed> speeds = radar_speeds(scans, read);
  Findings out = {check_clocks(imu.all, scans, source)};
  const auto append = [&out](const Findings& more) {
    out.insert(out.end(), more.begin(), more.end());
  };
  const Findings alone =
      check_radar(scans, info, speeds, options, source, folder / name / "data.csv");
  append(alone);
  if (!in_metres(alone)) return out;  // the others would find faults that are none
  const RangeCheck ranges = check_ranges(scans, options, source);
  out.push_back(ranges.finding);
  double gyro_unit = imu.check.gyro_unit;
  if (gyro_unit == 1.0) {
    if (const auto unit = check_rates(imu.good, scans, options, source)) {
      out.push_back(*unit);
      gyro_unit = kDegree;
    }
  }
  append(check_motion({imu.good, speeds, gyro_unit, imu.check.accel_unit, ranges.sign}, options,
                      source, radar));
  return out;
}

/// Prefixes subject and files with the name of the radar.
Finding of_radar(std::size_t radar, Finding finding) {
  const std::string name = "radar" + std::to_string(radar);
  for (std::size_t at = 0; (at = finding.change.find("radar0/", at)) != std::string::npos; ++at) {
    finding.change.replace(at, name.size(), name);
  }
  finding.subject = name + ": " + finding.subject;
  return finding;
}

Findings check_all(const std::vector<ImuSample>& samples, const std::vector<Scans>& radars,
                   const io::Dataset& sensors, const Options& options, Source source,
                   const std::filesystem::path& folder) {
  const std::optional<std::vector<ImuSample>> fewer = usable_if_not_all(samples);
  CheckedImu imu{samples, fewer ? *fewer : samples, {}};
  imu.check = check_imu(samples, imu.good, sensors.imu_info, source, folder / "imu0" / "data.csv");
  Findings out = std::move(imu.check.findings);
  if (samples.empty()) return out;
  const Findings first =
      check_one_radar(imu, radars[0], sensors.radar_info, 0, options, source, folder);
  out.insert(out.end(), first.begin(), first.end());
  for (std::size_t r = 1; r < options.radars() && r < radars.size(); ++r) {
    for (Finding& finding : check_one_radar(imu, radars[r], sensors.other_radars[r - 1].info, r,
                                            options.seen_by(r), source, folder)) {
      out.push_back(of_radar(r, std::move(finding)));
    }
  }
  return out;
}

}  // namespace

Findings check_recording(const io::Dataset& dataset, const Options& options, Source source,
                         const std::filesystem::path& folder) {
  std::vector<Scans> radars;
  radars.emplace_back(dataset.scans);
  for (const io::Dataset::OtherRadar& other : dataset.other_radars) {
    radars.emplace_back(other.scans);
  }
  return check_all(dataset.imu, radars, dataset, options, source, folder);
}

Findings check_recording(const CheckedData& data, const Options& options, Source source,
                         const std::filesystem::path& folder) {
  return check_all(data.imu, data.radars, data.sensors, options, source, folder);
}

}  // namespace rio::check
