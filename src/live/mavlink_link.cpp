// SPDX-License-Identifier: BSD-3-Clause
#include "live/mavlink_link.hpp"

#include <utility>

namespace rio::live {

using mavlink::Packet;

MavlinkLink::MavlinkLink(const Settings& settings, Send send)
    : settings_(settings),
      send_(std::move(send)),
      writer_({settings.system, mavlink::Address{}.component}),
      odometry_due_(settings.rate) {}

template <class Message>
bool MavlinkLink::send(const Message& message) {
  std::uint8_t frame[mavlink::kMaxFrame];
  return send_(frame, writer_.write(message, frame, sizeof frame));
}

void MavlinkLink::receive(const std::uint8_t* bytes, std::size_t count, Time arrival,
                          const OnImu& on_imu) {
  parser_.push(bytes, count, arrival, [&](const Packet& packet) {
    received_.insert(packet.id);
    mavlink::Timesync timesync;
    if (packet.read(&timesync)) {
      if (imu_of_.value_or(packet.from) == packet.from) (void)timesync_.take(timesync, arrival);
      const auto answer = mavlink::timesync_answer(timesync, packet.from, arrival);
      if (answer) send(*answer);
    }
    const auto sample = sample_of(packet);
    if (sample && is_of_vehicle(packet.from)) on_imu(*sample);
  });
}

/// Of several IMUs on the line that of the vehicle's system, or else the first, is used.
bool MavlinkLink::is_of_vehicle(const mavlink::Address& from) {
  if (!imu_of_ || (from.system == settings_.system && imu_of_->system != from.system)) {
    imu_of_ = from;
    timesync_ = mavlink::TimesyncClient();
  }
  return *imu_of_ == from;
}

std::optional<ImuSample> MavlinkLink::sample_of(const Packet& packet) const {
  mavlink::HighresImu highres;
  mavlink::RawImu raw;
  if (!settings_.raw_imu && packet.read(&highres) && highres.id == 0) return imu_sample(highres);
  if (settings_.raw_imu && packet.read(&raw) && raw.id == 0) return imu_sample(raw);
  return std::nullopt;
}

/// An estimate without further samples is lost, whatever its health was.
void MavlinkLink::tick(const Session& session, Time now) {
  if (!second_.due(now)) return;
  if (settings_.asks_clock) send(timesync_.ask(now));
  if (settings_.rate <= 0.0) return;
  Health health = session.odometry().health();
  if (session.imu_samples() == imu_samples_) {
    health.state = health.velocity = HealthState::kLost;
  }
  imu_samples_ = session.imu_samples();
  send(mavlink::heartbeat(health, settings_.content));
}

void MavlinkLink::on_imu(const Session& session, const ImuSample& sample) {
  const Odometry& odometry = session.odometry();
  if (settings_.rate <= 0.0 || !odometry.initialized()) return;
  if (!odometry_due_.due(odometry.now().time)) return;
  NavState now = odometry.now();
  now.time += session.host_offset();
  const auto message =
      mavlink::odometry_message(now, odometry.covariance_now(), odometry.health(), sample.gyro_B,
                                settings_.gyro_sigma, settings_.content);
  if (message && send(*message)) ++sent_;
}

std::string MavlinkLink::received() const {
  std::string names;
  for (const std::uint32_t id : received_) {
    names += (names.empty() ? "" : ", ") + std::string(mavlink::find_message(id)->name);
  }
  return names;
}

std::optional<Time> MavlinkLink::host_offset() const {
  if (!timesync_.known()) return std::nullopt;
  return -timesync_.offset();
}

}  // namespace rio::live
