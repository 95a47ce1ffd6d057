// SPDX-License-Identifier: BSD-3-Clause
#include "view/report_plots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "view/calibration_names.hpp"

namespace rio::view {

namespace {

/// Three curves with bands of columns NAME.x, NAME.y, NAME.z and sNAME.x...
Plot vector_plot(const std::string& title, const std::string& name) {
  Plot plot{title, "with 3-sigma bands", {}};
  for (const char* axis : kAxes) {
    const std::string column = name + "." + axis;
    plot.curves.push_back({axis, column, "s" + column});
  }
  return plot;
}

std::vector<Plot> state_plots() {
  return {vector_plot("Position [m]", "p"), vector_plot("Velocity [m/s]", "v"),
          Plot{"Attitude [deg]",
               "with 3-sigma bands; yaw unwound",
               {{"roll", "a.roll", "sa.roll"},
                {"pitch", "a.pitch", "sa.pitch"},
                {"yaw", "a.yaw", "sa.yaw"}}},
          vector_plot("Gyro bias [deg/s]", "bg"), vector_plot("Accelerometer bias [m/s²]", "ba")};
}

std::vector<Plot> error_plots() {
  Plot position{"Position error [m]",
                "bands: 3 sigma about zero; 99.7 % of the errors belong inside",
                {{"x", "e.x", "sp.x"}, {"y", "e.y", "sp.y"}, {"z", "e.z", "sp.z"}},
                {0.0}};
  for (Curve& curve : position.curves) curve.about_zero = true;
  Plot attitude{"Attitude error [deg]",
                "band: 3 sigma of the yaw about zero",
                {{"yaw", "e.yaw", "sa.yaw"}, {"tilt", "e.tilt"}},
                {0.0}};
  attitude.curves.front().about_zero = true;
  return {position, attitude};
}

/// A name of the program as the beginning of a title.
std::string title_of(std::string name) {
  name[0] = static_cast<char>(std::toupper(name[0]));
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

std::vector<Plot> model_plots(const std::string& name) {
  const std::string title = title_of(name);
  return {
      {title + ": rows of the update",
       "used, and rejected by the gate",
       {{"used", name + ".used"}, {"gated", name + ".gated"}}},
      {title + ": innovation over its sigma",
       "mean of each scan, band from the smallest to the largest; lines at 3 sigma",
       {{"mean", name + ".mean", "", name + ".low", name + ".high"}},
       {-3.0, 0.0, 3.0}},
      {title + ": NIS a row",
       "of the blocks used; 95 % belong in the band of the chi-squared distribution",
       {{"NIS", name + ".nis"}, {"expected", name + ".one", "", name + ".nlow", name + ".nhigh"}}}};
}

std::vector<Plot> scan_plots() {
  return {{"Points of a scan",
           "received, kept by the filter, static",
           {{"received", "n.received"}, {"kept", "n.kept"}, {"static", "n.static"}}},
          {"Share of static points", "", {{"share", "n.share"}}, {0.5, 1.0}},
          {"Landmarks, matches, past poses",
           "in the state after the update",
           {{"landmarks", "n.landmarks"}, {"matched", "n.matched"}, {"past poses", "n.clones"}},
           {},
           true},
          {"Time of an update [ms]", "", {{"update", "n.ms"}}},
          {"Health: quality [%]",
           "below 50 the estimate is degraded",
           {{"quality", "n.quality"}},
           {50.0},
           true}};
}

/// The parameters of the calibration of one radar, by unit.
std::vector<Plot> calibration_plots(std::size_t radar) {
  std::vector<Plot> plots;
  for (std::size_t i = 0; i < kCalibrationCount; ++i) {
    const CalibrationName& name = kCalibrationNames[i];
    const bool follows = i > 0 && i < 6 && i != 3;  // one plot a vector
    if (!follows) {
      const std::string what = i == 0 ? "radar rotation" : i == 3 ? "radar position" : name.name;
      const std::string title = title_of(fmt::format(
          "{}{} [{}]", radar > 0 ? fmt::format("radar {}: ", radar) : "", what, name.unit));
      plots.push_back(
          {title, "correction of the option's value, with 3-sigma bands", {}, {0.0}, true});
    }
    const std::string column = calibration_name(i, radar);
    plots.back().curves.push_back({i < 6 ? kAxes[i % 3] : "correction", column, "s" + column});
  }
  return plots;
}

}  // namespace

std::vector<Plot> report_plots(std::size_t radars) {
  std::vector<Plot> all;
  const auto append = [&all](const char* group, const std::vector<Plot>& plots) {
    for (const Plot& plot : plots) all.emplace_back(plot).group = group;
  };
  append("Errors against the truth", error_plots());
  append("State", state_plots());
  for (std::size_t i = 0; i < kModelCount; ++i) {
    append("Innovations", model_plots(to_string(static_cast<Model>(i))));
  }
  append("Scans", scan_plots());
  for (std::size_t r = 0; r < radars; ++r) append("Calibration", calibration_plots(r));
  return all;
}

}  // namespace rio::view
