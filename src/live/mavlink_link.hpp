// SPDX-License-Identifier: BSD-3-Clause
// The link to an autopilot: ODOMETRY and HEARTBEAT to it, its clock and its IMU back.
//
// All messages are stamped in the clock of this machine (CLOCK_MONOTONIC), and the autopilot's
// TIMESYNC requests are answered with the same clock, so that it can convert the stamps to its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <string>

#include "live/session.hpp"
#include "rio/mavlink/imu.hpp"
#include "rio/mavlink/odometry.hpp"
#include "rio/mavlink/parser.hpp"
#include "rio/mavlink/timesync.hpp"

namespace rio::live {

class MavlinkLink : public Listener {
 public:
  struct Settings {
    double rate = 30.0;  ///< of ODOMETRY [Hz]; 0: neither ODOMETRY nor HEARTBEAT is sent
    mavlink::Content content = mavlink::Content::kAll;
    std::uint8_t system = 1;   ///< that of the vehicle
    bool raw_imu = false;      ///< RAW_IMU instead of HIGHRES_IMU
    bool asks_clock = false;   ///< sends TIMESYNC requests, to use the IMU
    double gyro_sigma = 0.01;  ///< noise of a sample [rad/s]
  };
  /// Sends a complete frame, or drops it and returns false.
  using Send = std::function<bool(const std::uint8_t* bytes, std::size_t count)>;
  using OnImu = std::function<void(const ImuSample& sample)>;

  MavlinkLink(const Settings& settings, Send send);

  /// Bytes of the autopilot. Requests are answered at once.
  /// @param on_imu called for each sample of its first IMU, in its clock; not for those of other
  /// vehicles on the line
  void receive(const std::uint8_t* bytes, std::size_t count, Time arrival, const OnImu& on_imu);
  /// To be called about ten times a second: HEARTBEAT, requests.
  void tick(const Session& session, Time now);

  /// ODOMETRY at the configured rate, if the health allows it.
  void on_imu(const Session& session, const ImuSample& sample) override;

  /// This machine's clock minus the autopilot's, once known from its answers.
  std::optional<Time> host_offset() const;
  std::uint64_t sent() const { return sent_; }
  /// Of the messages received, of those that the parser knows: "HEARTBEAT, RAW_IMU".
  std::string received() const;
  const mavlink::ParserCounters& counters() const { return parser_.counters(); }

 private:
  template <class Message>
  bool send(const Message& message);
  std::optional<ImuSample> sample_of(const mavlink::Packet& packet) const;
  bool is_of_vehicle(const mavlink::Address& from);

  Settings settings_;
  Send send_;
  mavlink::Writer writer_;
  mavlink::Parser parser_;
  std::set<std::uint32_t> received_;        ///< messages
  std::optional<mavlink::Address> imu_of_;  ///< sender of the samples, whose clock is asked
  mavlink::TimesyncClient timesync_;
  mavlink::RateLimiter odometry_due_;
  mavlink::RateLimiter second_{1.0};
  std::uint64_t imu_samples_ = 0;  ///< a second ago
  std::uint64_t sent_ = 0;         ///< ODOMETRY
};

}  // namespace rio::live
