// SPDX-License-Identifier: BSD-3-Clause
#include "check/advice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace rio::check {

namespace {

/// From axes of this name to forward, left, up.
Matrix3d to_flu(const std::string& name) {
  Matrix3d M = Matrix3d::Identity();
  if (name == "ti") M << 0, 1, 0, -1, 0, 0, 0, 0, 1;
  if (name == "rdf") M << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  if (name == "frd") M << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  return M;
}

}  // namespace

std::string Advice::csv() const {
  return fmt::format("radar{}/data.csv", radar);
}

std::string Advice::scale(const std::string& quantity, double factor,
                          const std::string& from) const {
  if (!bag()) return fmt::format("multiply the column {} of {} by {:.4g}", quantity, csv(), factor);
  std::string name = "NAME";
  for (const auto& [known, field] : info != nullptr ? info->fields : io::RadarInfo().fields) {
    if (known != (from.empty() ? quantity : from)) continue;
    const std::size_t star = field.rfind('*');
    name = field.substr(0, star);
    if (star != std::string::npos) factor *= std::atof(field.c_str() + star + 1);
  }
  return fmt::format("--field {}={}*{:.4g}", quantity, name, factor);
}

std::string Advice::negate_doppler() const {
  return bag() ? "--approaching (without it, if it is given)"
               : "negate the column doppler of " + csv();
}

std::string Advice::gyro_in(const std::string& unit, double factor) const {
  if (!bag()) {
    return fmt::format(
        "multiply the first three columns after the stamp of imu0/data.csv by {:.6g}", factor);
  }
  const bool no_option = unit.find(' ') != std::string::npos;
  return no_option ? fmt::format("multiply the rates by {:.6g} in the driver of the IMU", factor)
                   : "--gyro-unit " + unit;
}

std::string Advice::sensor_line(const std::string& line) const {
  return fmt::format("radar{}/sensor.yaml{}: {}", radar, bag() ? " of --sensors" : "", line);
}

std::string Advice::option(const std::string& of_first, const std::string& of_others) const {
  return radar == 0 ? "radar: {" + of_first + "}" : sensor_line(of_others);
}

std::optional<std::string> Advice::axes(const Matrix3d& turn) const {
  if (info == nullptr || (bag() && info->axes.empty())) return std::nullopt;
  if (several && (!bag() || info->is_from_tree)) return std::nullopt;
  for (const char* name : {"flu", "ti", "rdf", "frd"}) {
    const bool fits = (turn * to_flu(info->axes) - to_flu(name)).norm() < 1e-6;
    if (fits) return std::string("--axes ") + name;
  }
  return std::nullopt;
}

bool Advice::has(const std::string& quantity) const {
  const auto is_it = [&](const auto& field) { return field.first == quantity; };
  return info != nullptr && std::ranges::any_of(info->fields, is_it);
}

std::optional<std::string> Advice::mirror(const Matrix3d& M) const {
  constexpr const char* kPoints[] = {"x", "y", "z"};
  constexpr const char* kAngles[] = {"", "azimuth", "elevation"};
  if (M.determinant() > 0.0 || info == nullptr || info->axes.empty()) return std::nullopt;
  const Matrix3d of_fields = to_flu(info->axes).transpose() * M * to_flu(info->axes);
  std::string change;
  for (int i = 0; i < 3; ++i) {
    int from = 0;
    (void)of_fields.row(i).cwiseAbs().maxCoeff(&from);
    const double sign = std::round(of_fields(i, from));
    if (i == from && sign > 0.0) continue;
    const auto& names = has("x") ? kPoints : kAngles;
    if (!has(names[i]) || !has(names[from]) || (i != from && !has("x"))) return std::nullopt;
    change += (change.empty() ? "" : " ") + scale(names[i], sign, names[from]);
  }
  return change;
}

std::optional<std::string> Advice::imu_axes(const Matrix3d& turn, const Vector3d& up) const {
  constexpr double kUpright = 0.7;  // cosine
  if (info != nullptr && info->is_from_tree) return std::nullopt;
  for (const char* name : {"rdf", "frd"}) {
    const Matrix3d M = to_flu(name);
    const bool upright = (M * up).z() > kUpright * up.norm();
    if (upright && (turn * M).isIdentity(1e-6)) return name;
  }
  return std::nullopt;
}

}  // namespace rio::check
