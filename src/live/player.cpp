// SPDX-License-Identifier: BSD-3-Clause
#include "live/player.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "live/imu_stream.hpp"
#include "live/port.hpp"

namespace rio::live {
namespace {

constexpr Time kImuDelay = std::chrono::microseconds(500);

}  // namespace

ti::FrameTiming simulated_timing(double rate_hz) {
  ti::FrameTiming timing;
  timing.period = from_seconds(1.0 / rate_hz);
  return timing;
}

Cable radar_line(const std::vector<RadarScan>& scans, const ti::FrameTiming& timing, Cable cable) {
  std::uint32_t number = 0;
  for (const RadarScan& scan : scans) {
    const double frames = to_seconds(scan.time - scans.front().time) / to_seconds(timing.period);
    number = std::max(number + 1, static_cast<std::uint32_t>(std::lround(frames)) + 1);
    Bytes packet = sim::packet_of_scan(number, scan).bytes();
    const double on_wire = static_cast<double>(packet.size()) * kBitsPerByte / timing.baud;
    const Time due =
        scan.time + timing.chirp_block / 2 + timing.processing_delay + from_seconds(on_wire);
    cable.send(std::move(packet), due);
  }
  return cable;
}

Cable imu_line(const std::vector<ImuSample>& samples, Cable cable) {
  std::uint8_t sequence = 0;
  for (const ImuSample& sample : samples) {
    const auto frame = imu_frame(sample, sequence++);
    cable.send(Bytes(frame.begin(), frame.end()), sample.time + kImuDelay);
  }
  return cable;
}

std::vector<Event> in_order(const std::vector<std::vector<Piece>>& lines) {
  std::vector<Event> events;
  for (std::size_t line = 0; line < lines.size(); ++line) {
    for (const Piece& piece : lines[line]) events.push_back({&piece, line});
  }
  std::stable_sort(events.begin(), events.end(),
                   [](const Event& a, const Event& b) { return a.piece->due < b.piece->due; });
  return events;
}

void play(const std::vector<Event>& events, double speed, const volatile std::sig_atomic_t& stop,
          const std::function<bool(const Event&)>& on_event) {
  const auto begin = std::chrono::steady_clock::now();
  for (const Event& event : events) {
    const double after = to_seconds(event.piece->due - events.front().piece->due) / speed;
    std::this_thread::sleep_until(begin + from_seconds(after));
    if (stop != 0 || !on_event(event)) return;
  }
}

}  // namespace rio::live
