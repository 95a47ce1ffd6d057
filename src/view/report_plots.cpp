// SPDX-License-Identifier: BSD-3-Clause
#include "view/report_plots.hpp"

#include <fmt/format.h>

#include <string>
#include <utility>

#include "view/calibration_names.hpp"

namespace rio::view {

std::vector<Plot> report_plots(std::size_t radars) {
  std::vector<Plot> all;
  const auto add = [&all](const char* group, const std::string& title, const char* note,
                          std::vector<Curve> curves, std::vector<double> lines = {},
                          bool steps = false, std::vector<double> range = {}) {
    all.push_back(
        {group, title, note, std::move(curves), std::move(lines), steps, std::move(range)});
  };
  const auto xyz = [](const std::string& name) {
    return std::vector<Curve>{{"x", name + ".x"}, {"y", name + ".y"}, {"z", name + ".z"}};
  };
  const char* const errors = "Errors against the truth";
  add(errors, "Position error [m]", "bands: 3 sigma about zero; 99.7 % of the errors belong inside",
      xyz("e"), {0.0});
  add(errors, "Attitude error [deg]", "band: 3 sigma of the yaw about zero",
      {{"yaw", "e.yaw"}, {"tilt", "e.tilt"}}, {0.0});
  for (Plot& plot : all) plot.bands_about_zero = true;

  const char* const bands = "bands: 3 sigma, numbers: 1 sigma";
  add("State", "Position [m]", bands, xyz("p"));
  add("State", "Velocity [m/s]", bands, xyz("v"));
  add("State", "Attitude [deg]", "bands: 3 sigma, numbers: 1 sigma; yaw unwound",
      {{"roll", "a.roll"}, {"pitch", "a.pitch"}, {"yaw", "a.yaw"}});
  add("State", "Gyro bias [deg/s]", bands, xyz("bg"));
  add("State", "Accelerometer bias [m/s²]", bands, xyz("ba"));

  for (std::size_t i = 0; i < kModelCount; ++i) {
    const std::string name = to_string(static_cast<Model>(i));
    const std::string title = title_of(name);
    add("Innovations", title + ": measurements of a scan",
        "rows used in the update, and rejected by the gate",
        {{"used", name + ".used"}, {"gated", name + ".gated"}});
    add("Innovations", title + ": innovation over its sigma",
        "mean of each scan, band from the smallest to the largest; dashed: 0 and 3 sigma",
        {{"mean", name + ".mean"}}, {-3.0, 0.0, 3.0});
    add("Innovations", title + ": NIS per row",
        "of what was used; 95 % of the scans belong in the band of the chi-squared distribution",
        {{"NIS", name + ".nis"}, {"expected", name + ".one"}});
  }

  add("Scans", "Points of a scan", "received, kept by the filter, static",
      {{"received", "n.received"}, {"kept", "n.kept"}, {"static", "n.static"}});
  add("Scans", "Share of static points", "of those kept; dashed: a half", {{"share", "n.share"}},
      {0.5}, false, {0.0, 1.05});
  add("Scans", "Landmarks, matches, past poses", "in the state after the update",
      {{"landmarks", "n.landmarks"}, {"matched", "n.matched"}, {"past poses", "n.clones"}}, {},
      true);
  add("Scans", "Time of an update [ms]", "", {{"update", "n.ms"}});
  add("Scans", "Health: quality [%]", "below 50 the estimate is degraded",
      {{"quality", "n.quality"}}, {50.0}, true, {0.0, 105.0});

  for (std::size_t i = 0; i < radars * kCalibrationCount; ++i) {
    const std::size_t k = i % kCalibrationCount;
    const std::string column = calibration_name(k, i / kCalibrationCount);
    if (k == 0 || k == 3 || k >= 6) {  // one plot a vector, without its axis in the title
      const std::string what = title_of(k < 6 ? column.substr(0, column.size() - 2) : column);
      add("Calibration", fmt::format("{} [{}]", what, kCalibrationNames[k].unit),
          "correction of the configured value; bands: 3 sigma, numbers: 1 sigma", {}, {0.0}, true);
    }
    all.back().curves.push_back({k < 6 ? kAxes[k % 3] : "correction", column});
  }
  return all;
}

}  // namespace rio::view
