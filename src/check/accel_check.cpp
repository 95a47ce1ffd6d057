// SPDX-License-Identifier: BSD-3-Clause
// The unit of the accelerometer, or what else is in its columns.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "check/imu_check.hpp"
#include "check/numbers.hpp"

namespace rio::check {

namespace {

constexpr std::array<Unit, 5> kUnits = {{{"m/s^2", 1.0},
                                         {"g", kStandardGravity},
                                         {"mg", 1e-3 * kStandardGravity},
                                         {"cm/s^2", 1e-2},
                                         {"ft/s^2", 0.3048}}};

/// The unit in which this is gravity, to a share of it; null if there is none.
const Unit* unit_of_gravity(double norm, double share) {
  const auto off = [norm](const Unit& u) {
    return std::abs(norm * u.factor / kStandardGravity - 1.0);
  };
  const auto unit = std::ranges::min_element(kUnits, {}, off);
  return off(*unit) < share ? &*unit : nullptr;
}

std::string accel_in(const Unit& unit, Source source) {
  if (source == Source::kBag) return fmt::format("--accel-unit {}", unit.name);
  return fmt::format("multiply the last three columns of imu0/data.csv by {:.6g}", unit.factor);
}

/// The unit of the accelerometer if its columns are those of the gyro; null if they are not.
const Unit* unit_if_exchanged(const std::vector<ImuSample>& samples, const Rest& rest) {
  if (unit_of_gravity(rest.gyro.norm(), 0.05) == &kUnits[0]) return &kUnits[0];
  // 1 rad/s, as of gravity in g, may also be a turn, but no gyro reads it all the time
  const auto rate = [&samples](double share) {
    return quantile_of(
        samples, [](const ImuSample& s) { return s.gyro_B.norm(); }, share);
  };
  const double usual = rate(0.5);
  const bool constant = rate(0.1) > 0.7 * usual && rate(0.9) < 1.3 * usual;
  return constant ? unit_of_gravity(usual, 0.1) : nullptr;
}

}  // namespace

Finding check_accel(const std::vector<ImuSample>& samples, Source source, ImuCheck* found) {
  const Rest& rest = found->rest;
  const double f = rest.accel.norm();
  const double off = std::abs(f / kStandardGravity - 1.0);
  constexpr double kNothing = 0.5;  // half a g of an IMU in g, little of one in m/s^2
  if (!std::isfinite(rest.spread) && rest.least > kNothing) {
    return {Verdict::kDoubtful, "accelerometer unit", "no second has enough samples to tell",
            "record the IMU at 100 Hz or more"};
  }
  Finding out{Verdict::kOk, "accelerometer unit",
              fmt::format("in the stillest second the specific force is {:.4g} m/s^2 ({:+.3g} "
                          "{:+.3g} {:+.3g}), {:.1f} % off gravity",
                          f, rest.accel.x(), rest.accel.y(), rest.accel.z(), 100.0 * off)};
  if (off < 0.05) return out;
  if (off < 0.2) {
    out.judge(Verdict::kDoubtful, "",
              rest.is_quiet(1.0)
                  ? "calibrate the accelerometer: at rest its scale or bias is off"
                  : "an accelerometer bias this large, or no moment of rest: begin at rest");
    return out;
  }
  out.verdict = Verdict::kWrong;
  if (const Unit* const unit = unit_if_exchanged(samples, rest)) {
    found->exchanged = true;
    found->accel_unit = unit->factor;
    out.text += fmt::format(", but the gyro reads {:.4g}: gyro and accelerometer are exchanged",
                            rest.gyro.norm());
    out.change =
        source == Source::kBag
            ? "exchange angular_velocity and linear_acceleration where they are recorded"
            : "exchange the two groups of three columns of imu0/data.csv: the gyro is first";
    if (unit->factor != 1.0) {
      out.text += fmt::format(", and the accelerometer is in {}", unit->name);
      out.change += ", then " + accel_in(*unit, source);
    }
    return out;
  }
  found->integrable = false;
  if (rest.least < kNothing) {
    out.text += fmt::format(", and once {:.2g}: {}", rest.least,
                            rest.least > 0.0 ? "gravity was removed" : "it is not measured");
    out.change = "record the raw accelerometer: at rest it must read 9.81 m/s^2 upwards";
    return out;
  }
  out.change = "find the unit of the accelerometer; at rest it must read 9.81 m/s^2";
  if (const Unit* const unit = unit_of_gravity(f, 0.1)) {
    found->accel_unit = unit->factor;
    found->integrable = true;
    out.text += fmt::format(": it is in {}", unit->name);
    if (unit->factor < 0.011) out.text += "; mg and cm/s^2 are 2 % apart";
    out.change = accel_in(*unit, source);
  }
  return out;
}

}  // namespace rio::check
