// SPDX-License-Identifier: BSD-3-Clause
// Fifty Monte Carlo runs with noise that matches the filter's model: is the error as large as the
// covariance says? Prints the table of the README and holds the default preset to its bounds.
#include <cstdio>

#include "rio/eval/nees.hpp"
#include "support/replay.hpp"

namespace rio::test {
namespace {

constexpr int kRuns = 50;

/// NEES of the blocks at one instant, each divided by its dimension.
struct Consistency {
  double position = 0.0;
  double attitude = 0.0;
  double heading = 0.0;
  double velocity = 0.0;

  explicit Consistency(const Step& step) {
    const BodyCovariance& P = step.covariance;
    const auto e = eval::body_error(step.estimate, step.truth);
    const auto block = [&](int at) {
      return eval::nees(e.segment<3>(at).eval(), Matrix3d(P.block<3, 3>(at, at))) / 3.0;
    };
    position = block(body::kPosition);
    attitude = block(body::kAttitude);
    velocity = block(body::kVelocity);
    // heading: the attitude error about the vertical
    const Vector3d up = step.estimate.q_WB.conjugate() * Vector3d::UnitZ();
    const double yaw = up.dot(e.segment<3>(body::kAttitude));
    heading = yaw * yaw / up.dot(P.block<3, 3>(body::kAttitude, body::kAttitude) * up);
  }
  Consistency() = default;

  void add(const Consistency& other) {
    position += other.position / kRuns;
    attitude += other.attitude / kRuns;
    heading += other.heading / kRuns;
    velocity += other.velocity / kRuns;
  }
  void print(const char* preset, const char* when) const {
    std::printf("| %s | %s | %.2f | %.2f | %.2f | %.2f |\n", preset, when, position, attitude,
                heading, velocity);
  }
};

/// Means over the runs of one preset.
struct Campaign {
  Consistency in_flight;  ///< at three quarters of the flight
  Consistency landed;     ///< at the end, after two seconds on the ground
  double doppler_nis = 0.0;
};

Campaign fly(const char* name) {
  Campaign mean;
  for (int i = 0; i < kRuns; ++i) {
    sim::FlightOptions options = sim::FlightOptions::ideal();
    options.seed = 200 + static_cast<std::uint64_t>(i);
    options.length_m = 40.0;
    const sim::Flight flight = sim::simulate_flight(options);
    const auto odometry = Odometry::create(options_for(flight, name));
    double nis = 0.0;
    double rows = 0.0;
    const std::vector<Step> steps = replay(flight, *odometry, [&](const UpdateReport& report) {
      const ModelReport& doppler = report.models[static_cast<std::size_t>(Model::kDoppler)];
      nis += doppler.nis;
      rows += doppler.rows_used;
    });
    mean.in_flight.add(Consistency(steps[3 * steps.size() / 4]));
    mean.landed.add(Consistency(steps.back()));
    mean.doppler_nis += nis / rows / kRuns;
  }
  mean.in_flight.print(name, "in flight");
  mean.landed.print(name, "landed");
  return mean;
}

TEST(Consistency, FiftyMatchedRunsWithBothPresets) {
  const eval::AneesBounds three = eval::anees_bounds(3, kRuns, 0.99);
  const eval::AneesBounds one = eval::anees_bounds(1, kRuns, 0.99);
  std::printf("\n%d runs of 40 m, matched noise: NEES over its dimension\n", kRuns);
  std::printf("(99 %% bounds: %.2f-%.2f for 3 dimensions, %.2f-%.2f for the heading)\n",
              three.lower / 3.0, three.upper / 3.0, one.lower, one.upper);
  std::printf("| preset | when | position | attitude | heading | velocity |\n");
  std::printf("|---|---|---|---|---|---|\n");
  const Campaign standard = fly("default");
  fly("published-ekf");
  // upper bounds: the truth starts at heading and position zero exactly, better than the prior says
  EXPECT_LT(standard.in_flight.position, three.upper / 3.0);
  EXPECT_LT(standard.in_flight.attitude, three.upper / 3.0);
  EXPECT_LT(standard.in_flight.heading, one.upper);
  EXPECT_LT(standard.in_flight.velocity, three.upper / 3.0);
  EXPECT_GT(standard.in_flight.velocity, three.lower / 3.0);
  // mean of a chi-squared variable of one degree cut off at its 99 % quantile
  EXPECT_NEAR(standard.doppler_nis, 0.925, 0.02);
}

}  // namespace
}  // namespace rio::test
