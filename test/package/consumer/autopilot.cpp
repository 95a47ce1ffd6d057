// SPDX-License-Identifier: BSD-3-Clause
#include <rio/mavlink/axes.hpp>
#include <rio/mavlink/imu.hpp>
#include <rio/mavlink/odometry.hpp>
#include <rio/mavlink/parser.hpp>
#include <rio/mavlink/timesync.hpp>

int main() {
  rio::Health health;
  health.state = rio::HealthState::kOk;
  const auto message = rio::mavlink::odometry_message({}, rio::BodyCovariance::Identity(), health);
  std::uint8_t buffer[rio::mavlink::kMaxFrame];
  rio::mavlink::Writer writer;
  const std::size_t size = message ? writer.write(*message, buffer, sizeof buffer) : 0;
  rio::mavlink::OdometryMessage received;
  rio::mavlink::Parser parser;
  parser.push(buffer, size, rio::Time{0},
              [&](const rio::mavlink::Packet& packet) { packet.read(&received); });
  return received.velocity_covariance[0] == 1.0F ? 0 : 1;
}
