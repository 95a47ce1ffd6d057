// SPDX-License-Identifier: BSD-3-Clause
// Example 4: two radars on one body. Each has a mounting of its own and is told apart by its
// number; their scans may come in any order. Flies a simulated flight with the first alone and with
// both.
#include <cstdio>
#include <string>
#include <vector>

#include <rio/rio.hpp>
#include <rio/sim/flight.hpp>

namespace {

using Scans = std::vector<rio::RadarScan>;

/// Position error at the end [m]; negative if it did not fly.
double fly(const rio::sim::Flight& flight, const std::vector<rio::Pose>& mounts,
           const std::vector<Scans>& radars) {
  rio::Options options;
  options.radar.T_BS = mounts[0];
  for (std::size_t r = 1; r < radars.size(); ++r) options.other_radars.push_back({mounts[r]});
  std::string why;
  auto odometry = rio::Odometry::create(options, &why);
  if (!odometry) return std::printf("%s\n", why.c_str()), -1.0;
  std::vector<std::size_t> next(radars.size());
  for (const rio::ImuSample& sample : flight.imu) {
    rio::Status status = odometry->add_imu(sample);
    for (std::size_t r = 0; r < radars.size(); ++r) {
      while (next[r] < radars[r].size() && radars[r][next[r]].time <= sample.time) {
        status = odometry->add_scan(radars[r][next[r]++], r);
      }
    }
    if (status == rio::Status::kUndeclared) return -1.0;
  }
  const rio::NavState& now = odometry->now();
  std::printf(
      "%zu radars: %d scans, off by %.3f m, 1-sigma %.3f m\n", radars.size(),
      static_cast<int>(odometry->counters().scans),
      (now.p_WB - flight.truth_at(now.time).p_WB).norm(),
      odometry->covariance_now().diagonal().segment<3>(rio::body::kPosition).cwiseSqrt().norm());
  return (now.p_WB - flight.truth_at(now.time).p_WB).norm();
}

}  // namespace

int main() {
  rio::sim::Scenario scenario;
  scenario.seed = 5;
  scenario.path.length = 20.0;
  const rio::sim::Flight first = rio::sim::simulate_flight(scenario);
  const std::vector<rio::Pose> mounts = rio::sim::radar_mounts(scenario.radar.T_BS, 2);
  scenario.radar.T_BS = mounts[1];
  const rio::sim::Flight second = rio::sim::simulate_flight(first.trajectory, scenario);
  const double alone = fly(first, mounts, {first.scans});
  const double both = fly(first, mounts, {first.scans, second.scans});
  return alone >= 0.0 && both >= 0.0 && both < 0.5 ? 0 : 1;
}
