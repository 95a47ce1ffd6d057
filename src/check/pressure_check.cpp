// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "check/imu_check.hpp"
#include "check/numbers.hpp"
#include "rio/io/barometer.hpp"

namespace rio::check {

std::optional<Finding> check_pressures(const std::vector<io::BaroSample>& baro) {
  constexpr double kLeast = 2e4;  // 12 km above the sea [Pa]
  constexpr double kMost = 1.2e5;
  std::vector<double> values;
  for (const io::BaroSample& sample : baro) {
    if (std::isfinite(sample.pressure)) values.push_back(sample.pressure);
  }
  const double usual = median(values);
  if (values.empty() || (usual > kLeast && usual < kMost)) return std::nullopt;
  std::string change = fmt::format("heights in m are to be written as 101325 exp(-h / {:.0f}) Pa",
                                   io::kPressureScale);
  for (const auto& [unit, factor] : {std::pair("hPa", 100.0), std::pair("kPa", 1000.0)}) {
    if (factor * usual < kLeast || factor * usual > kMost) continue;
    change =
        fmt::format("multiply the pressures by {:.0f} if they are in {}; {}", factor, unit, change);
  }
  return Finding{
      Verdict::kWrong, "barometer",
      fmt::format("the median of the pressures is {:.4g}: that is no air pressure in Pa, "
                  "of which there are 101325 at the level of the sea",
                  usual),
      change};
}

}  // namespace rio::check
