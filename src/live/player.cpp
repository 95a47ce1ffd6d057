// SPDX-License-Identifier: BSD-3-Clause
#include "live/player.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>
#include <utility>

#include "live/imu_stream.hpp"
#include "live/port.hpp"

namespace rio::live {
namespace {

constexpr double kDelay = 0.02;    // [s]
constexpr std::size_t kRun = 64;   // [bytes]
constexpr std::size_t kParts = 5;  // at most
constexpr Time kApart = std::chrono::milliseconds(1);
constexpr Time kImuDelay = std::chrono::microseconds(500);

}  // namespace

bool Cable::happens(double share) {
  return std::bernoulli_distribution(share)(random_);
}

std::size_t Cable::draw(std::size_t least, std::size_t most) {
  return std::uniform_int_distribution<std::size_t>(least, most)(random_);
}

void Cable::send(Bytes packet, Time due) {
  ++counters_.packets;
  if (happens(noise_.dropped)) {
    ++counters_.dropped;
    return;
  }
  if (happens(noise_.damaged)) {
    ++counters_.damaged;
    const std::size_t length = draw(1, std::min(kRun, packet.size()));
    const auto begin =
        packet.begin() + static_cast<std::ptrdiff_t>(draw(0, packet.size() - length));
    packet.erase(begin, begin + static_cast<std::ptrdiff_t>(length));
  }
  if (happens(noise_.delayed)) {
    ++counters_.delayed;
    due += from_seconds(std::exponential_distribution<double>(1.0 / kDelay)(random_));
  }
  if (!pieces_.empty()) due = std::max(due, pieces_.back().due);
  if (packet.size() > kParts && happens(noise_.split)) {
    ++counters_.split;
    cut(packet, due);
  } else {
    pieces_.push_back({due, std::move(packet)});
  }
}

void Cable::cut(const Bytes& packet, Time due) {
  const std::size_t parts = draw(2, kParts);
  std::vector<std::size_t> ends{packet.size()};
  for (std::size_t i = 1; i < parts; ++i) ends.push_back(draw(1, packet.size() - 1));
  std::sort(ends.begin(), ends.end());
  std::size_t begin = 0;
  for (const std::size_t end : ends) {
    const auto at = packet.begin();
    pieces_.push_back({due, Bytes(at + static_cast<std::ptrdiff_t>(begin),
                                  at + static_cast<std::ptrdiff_t>(end))});
    begin = end;
    due += kApart;
  }
}

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
