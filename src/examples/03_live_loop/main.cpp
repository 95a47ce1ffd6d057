// SPDX-License-Identifier: BSD-3-Clause
// Example 3: driver, odometry and autopilot in one loop. A TI radar on one serial line; an
// autopilot on another, whose IMU is used (HIGHRES_IMU) and which is told the estimate (ODOMETRY).
// Both are simulated, on pseudo-terminals; with hardware only the paths and the clock change.
#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <string>

#include <rio/mavlink/imu.hpp>
#include <rio/mavlink/odometry.hpp>
#include <rio/mavlink/parser.hpp>
#include <rio/rio.hpp>
#include <rio/ti/frame_clock.hpp>
#include <rio/ti/packet_reader.hpp>

#include "hardware.hpp"

namespace {

/// A serial line as a plain wire for bytes.
int open_line(const std::string& path, speed_t baud) {
  const int fd = open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK);
  termios line{};
  tcgetattr(fd, &line);
  cfmakeraw(&line);
  cfsetspeed(&line, baud);
  return tcsetattr(fd, TCSANOW, &line) == 0 ? fd : -1;
}

class Loop {
 public:
  Loop(std::unique_ptr<rio::Odometry> odometry, const rio::ti::FrameTiming& timing, int autopilot)
      : odometry_(std::move(odometry)), clock_(timing), autopilot_(autopilot) {}

  void take_radar(const std::uint8_t* bytes, std::size_t count, rio::Time now) {
    reader_.push(bytes, count, now, [this](rio::ti::Frame& frame) {
      frame.scan.time =
          clock_.stamp(frame) - offset_;  // the middle of the chirps, autopilot's clock
      rio::Status status = odometry_->add_scan(frame.scan);
      if (status == rio::Status::kAhead) std::puts("check the clocks");
    });
  }

  void take_autopilot(const std::uint8_t* bytes, std::size_t count, rio::Time now) {
    parser_.push(bytes, count, now, [&](const rio::mavlink::Packet& packet) {
      rio::mavlink::HighresImu message;
      if (!packet.read(&message)) return;
      const auto sample = rio::mavlink::imu_sample(message);
      if (!sample) return;
      offset_ = std::min(offset_, now - sample->time);  // that of TIMESYNC is better
      rio::Status status = odometry_->add_imu(*sample);
      if (status == rio::Status::kMoving) std::puts("hold still");
      tell(sample->gyro_B);
    });
  }

  const rio::Odometry& odometry() const { return *odometry_; }
  const rio::ti::PacketCounters& packets() const { return reader_.counters(); }

 private:
  /// Nothing while the estimate is lost or has not started.
  void tell(const rio::Vector3d& gyro_B) {
    if (!limiter_.due(odometry_->now().time)) return;
    const auto message = rio::mavlink::odometry_message(
        odometry_->now(), odometry_->covariance_now(), odometry_->health(), gyro_B);
    if (!message) return;
    std::uint8_t frame[rio::mavlink::kMaxFrame];
    const std::size_t size = writer_.write(*message, frame, sizeof frame);
    if (write(autopilot_, frame, size) < 0) std::puts("the line to the autopilot is full");
  }

  std::unique_ptr<rio::Odometry> odometry_;
  rio::ti::FrameClock clock_;
  rio::ti::PacketReader reader_;
  rio::mavlink::Parser parser_;
  rio::mavlink::Writer writer_;
  rio::mavlink::RateLimiter limiter_{30.0};
  rio::Time offset_ = rio::Time::max();  // of this clock to the autopilot's: the least late sample
  int autopilot_;
};

}  // namespace

int main() {
  Hardware hardware;
  rio::Options options;
  options.radar.T_BS = hardware.mounting();
  std::string why;
  auto odometry = rio::Odometry::create(options, &why);
  if (!odometry) return std::printf("%s\n", why.c_str()), 1;
  const int radar = open_line(hardware.radar_port(), B921600);
  const int autopilot = open_line(hardware.autopilot_port(), B921600);
  Loop loop(std::move(odometry), hardware.timing(), autopilot);
  std::uint8_t bytes[4096];
  pollfd lines[] = {{autopilot, POLLIN, 0}, {radar, POLLIN, 0}};
  while (poll(lines, 2, 1000) > 0) {  // a second of silence: the flight is over
    const rio::Time now = hardware.clock();
    ssize_t count = read(autopilot, bytes, sizeof bytes);
    if (count > 0) loop.take_autopilot(bytes, static_cast<std::size_t>(count), now);
    count = read(radar, bytes, sizeof bytes);
    if (count > 0) loop.take_radar(bytes, static_cast<std::size_t>(count), now);
  }
  const rio::NavState& now = loop.odometry().now();
  const rio::NavState truth = hardware.truth_at(now.time);
  const double error = (now.p_WB - truth.p_WB).norm();
  std::printf("%d packets, %d ODOMETRY received; at %.2f %.2f %.2f m, off by %.2f m\n",
              static_cast<int>(loop.packets().frames), hardware.odometry_received(), now.p_WB.x(),
              now.p_WB.y(), now.p_WB.z(), error);
  return loop.odometry().initialized() && hardware.odometry_received() > 300 && error < 0.5 ? 0 : 1;
}
