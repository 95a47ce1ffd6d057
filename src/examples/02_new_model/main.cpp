// SPDX-License-Identifier: BSD-3-Clause
// Example 2: a measurement model of your own, from outside of the library. It flies a simulated
// flight with a barometer that reads 30 Pa too much (2.5 m), with either back-end, and checks the
// bias it finds and the normalised innovations.
#include <cmath>
#include <cstdio>

#include <rio/aiding.hpp>
#include <rio/sim/flight.hpp>
#include <rio/sim/random.hpp>

#include "barometer.hpp"

namespace {

constexpr double kBias = 30.0;  // [Pa]

/// What the sensor reads at a true height: a millibar is 8.43 m at sea level.
double reading(double height) {
  return 101325.0 * std::exp(5.25588 * std::log1p(-0.0065 / 288.15 * height)) + kBias;
}

bool fly(const rio::sim::Flight& flight, rio::BackEnd backend, const char* name) {
  rio::Options options;
  options.backend = backend;
  options.radar.T_BS = flight.configured_T_BS;
  options.auxiliary.declare<PressureBias>();
  std::string why;
  auto odometry = rio::Odometry::create(options, &why);
  if (!odometry) return std::printf("%s\n", why.c_str()), false;
  rio::sim::Random random(2);
  double nis = 0.0;
  double rows = 0.0;
  std::size_t scan = 0;
  for (std::size_t i = 0; i < flight.imu.size(); ++i) {
    const rio::Time now = flight.imu[i].time;
    (void)odometry->add_imu(flight.imu[i]);
    if (i % 10 == 0) {  // 20 Hz
      const double pressure = reading(flight.truth_at(now).p_WB.z()) + 2.0 * random.normal();
      (void)odometry->add_measurement({now, Barometer{}, {pressure, 2.0}});
    }
    for (; scan < flight.scans.size() && flight.scans[scan].time <= now; ++scan) {
      (void)odometry->add_scan(flight.scans[scan]);
      for (const rio::InnovationRecord& record : odometry->report().records) {
        if (record.name != Barometer::kName) continue;
        nis += record.nis;
        rows += record.dof;
      }
    }
  }
  const auto bias = rio::auxiliary<PressureBias>(*odometry);
  const double sigma = std::sqrt(bias->covariance(0, 0));
  std::printf("%s: bias %.1f +- %.1f Pa (true %.1f), NIS %.2f over %.0f rows\n", name,
              bias->value[0], sigma, kBias, nis / rows, rows);
  return std::abs(bias->value[0] - kBias) < 3.0 * sigma && sigma < 10.0 && rows > 300.0 &&
         std::abs(nis / rows - 1.0) < 0.3;
}

}  // namespace

int main() {
  rio::sim::Scenario scenario;
  scenario.path.length = 30.0;
  const rio::sim::Flight flight = rio::sim::simulate_flight(scenario);
  const bool filter = fly(flight, rio::BackEnd::kEkf, "filter");
  const bool window = fly(flight, rio::BackEnd::kSmoother, "window");
  return filter && window ? 0 : 1;
}
