// SPDX-License-Identifier: BSD-3-Clause
// A simulated flight as bytes, through a session with the arrivals as planned: no clock runs.
#pragma once

#include <map>
#include <vector>

#include "live/imu_stream.hpp"
#include "live/player.hpp"
#include "live/session.hpp"
#include "rio/sim/flight.hpp"
#include "rio/sim/scenario.hpp"

namespace rio::live::test {

inline constexpr Time kHostAhead = std::chrono::hours(7);  // of the IMU's clock

inline sim::Flight short_flight() {
  return sim::simulate_flight({.seed = 9, .path = {.length = 25.0}});
}

inline Options options_of(const sim::Flight& flight) {
  Options options;
  const sim::RadarModel& radar = flight.scenario.radar;
  options.radar.T_BS = flight.configured_T_BS;
  options.radar.max_doppler = radar.ambiguous ? radar.reported_max_doppler() : 0.0;
  options.radar.doppler_resolution = radar.reported_doppler_resolution();
  return options;
}

inline SessionSetup setup_of(const sim::Flight& flight) {
  return {options_of(flight), {simulated_timing(flight.scenario.radar.rate_hz)}};
}

/// The estimates at the scans of a session.
class Estimates : public Listener {
 public:
  std::map<Time, NavState> states;
  std::vector<RadarScan> scans;
  std::vector<ImuSample> imu;

  void on_estimate(const Session& session, Time /*arrival*/) override {
    states[session.odometry().report().time] = session.odometry().at_scan();
  }
  void on_scan(const Session& /*session*/, const RadarScan& scan, std::size_t /*radar*/) override {
    scans.push_back(scan);
  }
  void on_imu(const Session& /*session*/, const ImuSample& sample) override {
    imu.push_back(sample);
  }
};

/// Feeds the bytes of both sensors.
inline void fly(const sim::Flight& flight, const CableNoise& noise, Session* session) {
  const auto timing = simulated_timing(flight.scenario.radar.rate_hz);
  CableNoise imu_noise = noise;
  imu_noise.seed += 1;
  const std::vector<std::vector<Piece>> lines = {
      radar_line(flight.scans, timing, Cable(noise)).pieces(),
      imu_line(flight.imu, Cable(imu_noise)).pieces()};
  ImuFrameReader imu;
  for (const Event& event : in_order(lines)) {
    const Bytes& bytes = event.piece->bytes;
    const Time arrival = event.piece->due + kHostAhead;
    if (event.line == 0) {
      session->radar(0, bytes.data(), bytes.size(), arrival);
    } else {
      imu.push(bytes.data(), bytes.size(),
               [&](const ImuSample& sample) { session->imu(sample, arrival); });
    }
  }
}

}  // namespace rio::live::test
