// SPDX-License-Identifier: BSD-3-Clause
// Ten simulated indoor flights of 130 to 170 m with realistic noise and 15 % outliers, both
// presets: prints the table of the README and holds the default preset to its bounds.
#include <cstdio>

#include "rio/eval/metrics.hpp"
#include "support/replay.hpp"

namespace rio::test {
namespace {

constexpr int kFlights = 10;

/// Figures of one flight.
struct Accuracy {
  double drift = 0.0;    ///< final drift [% of the path]
  double mae = 0.0;      ///< norm of MAE [m]
  double heading = 0.0;  ///< RMSE of the heading [deg]
  bool finite = true;
};

Accuracy fly(const sim::Flight& flight, const char* name) {
  const auto odometry = Odometry::create(options_for(flight, name));
  const std::vector<Step> steps = replay(flight, *odometry);
  const auto estimate = poses(steps, false);
  const auto truth = poses(steps, true);
  std::vector<eval::PosePair> pairs;
  for (std::size_t i = 0; i < steps.size(); ++i) pairs.push_back({truth[i], estimate[i]});
  Accuracy a{eval::final_drift(pairs), eval::norm_of_mae(pairs), eval::yaw_errors(pairs).rmse};
  a.finite = steps.back().estimate.p_WB.allFinite() && steps.back().covariance.allFinite();
  return a;
}

/// Mean and worst over the flights.
struct Table {
  Accuracy mean;
  Accuracy worst;

  void add(const Accuracy& a) {
    const auto merge = [&](double Accuracy::*field) {
      mean.*field += a.*field / kFlights;
      worst.*field = std::max(worst.*field, a.*field);
    };
    merge(&Accuracy::drift);
    merge(&Accuracy::mae);
    merge(&Accuracy::heading);
  }
  void print(const char* name) const {
    std::printf("| %s | %.3f (%.3f) | %.3f (%.3f) | %.2f (%.2f) |\n", name, mean.drift, worst.drift,
                mean.mae, worst.mae, mean.heading, worst.heading);
  }
};

TEST(Accuracy, TenFlightsWithBothPresets) {
  Table standard;
  Table published;
  for (int i = 0; i < kFlights; ++i) {
    sim::FlightOptions options;
    options.seed = 100 + static_cast<std::uint64_t>(i);
    options.length_m = 130.0 + 40.0 * i / (kFlights - 1);
    const sim::Flight flight = sim::simulate_flight(options);
    const Accuracy a = fly(flight, "default");
    const Accuracy b = fly(flight, "published-ekf");
    EXPECT_TRUE(a.finite);
    EXPECT_TRUE(b.finite);
    standard.add(a);
    published.add(b);
  }
  std::printf("\n%d flights, 130-170 m: mean (worst)\n", kFlights);
  std::printf("| preset | final drift [%%] | norm of MAE [m] | heading RMSE [deg] |\n");
  std::printf("|---|---|---|---|\n");
  standard.print("default");
  published.print("published-ekf");
  EXPECT_LT(standard.mean.drift, 0.5);
  EXPECT_LT(standard.mean.mae, 0.5);
  EXPECT_LE(standard.mean.drift, published.mean.drift);
  EXPECT_LE(standard.mean.mae, published.mean.mae);
  EXPECT_LE(standard.mean.heading, published.mean.heading);
}

}  // namespace
}  // namespace rio::test
