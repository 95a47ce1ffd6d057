// SPDX-License-Identifier: BSD-3-Clause
// A simulated flight as bytes, through a session with the arrivals as planned: no clock runs.
#pragma once

#include <algorithm>
#include <map>
#include <vector>

#include "live/imu_stream.hpp"
#include "live/player.hpp"
#include "live/session.hpp"
#include "rio/io/simulation.hpp"
#include "rio/sim/scenario.hpp"

namespace rio::live::test {

inline constexpr Time kHostAhead = std::chrono::hours(7);  // of the IMU's clock

inline const sim::Flight& flight() {
  static const sim::Flight kFlight = sim::simulate_flight({.seed = 9, .path = {.length = 25.0}});
  return kFlight;
}

inline Options options() {
  Options out;
  io::apply_sensor_info(io::dataset_of(flight()), &out);
  return out;
}

inline SessionSetup setup() {
  return {options(), {simulated_timing(flight().scenario.radar.rate_hz)}};
}

/// What a session has told.
struct Estimates : Listener {
  std::size_t told = 0;             ///< estimates
  std::map<Time, NavState> states;  ///< at the scans
  std::vector<RadarScan> scans;
  std::vector<ImuSample> imu;
  Time worst_lag{0};  ///< from the stamp of a scan to that of the newest sample

  void on_estimate(const Session& session, Time /*arrival*/) override {
    ++told;
    states[session.odometry().report().time] = session.odometry().at_scan();
  }
  void on_scan(const Session& /*session*/, const RadarScan& scan, std::size_t /*radar*/) override {
    scans.push_back(scan);
    worst_lag = std::max(worst_lag, imu.back().time - scan.time);
  }
  void on_imu(const Session& /*session*/, const ImuSample& sample) override {
    imu.push_back(sample);
  }
};

/// Feeds the bytes of the sensors; several radars see the same.
inline void fly(const CableNoise& noise, Session* session,
                const std::vector<RadarScan>& scans = flight().scans) {
  const auto timing = simulated_timing(flight().scenario.radar.rate_hz);
  CableNoise imu_noise = noise;
  imu_noise.seed += 1;
  std::vector<std::vector<Piece>> lines(session->radars(),
                                        radar_line(scans, timing, Cable(noise)).pieces());
  lines.push_back(imu_line(flight().imu, Cable(imu_noise)).pieces());
  ImuFrameReader imu;
  for (const Event& event : in_order(lines)) {
    const Bytes& bytes = event.piece->bytes;
    const Time arrival = event.piece->due + kHostAhead;
    if (event.line < session->radars()) {
      session->radar(event.line, bytes.data(), bytes.size(), arrival);
    } else {
      imu.push(bytes.data(), bytes.size(),
               [&](const ImuSample& sample) { session->imu(sample, arrival); });
    }
  }
}

}  // namespace rio::live::test
