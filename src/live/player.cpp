// SPDX-License-Identifier: BSD-3-Clause
#include "live/player.hpp"

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <thread>
#include <utility>

#include "live/imu_stream.hpp"
#include "live/port.hpp"

namespace rio::live {

namespace fs = std::filesystem;

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
    pieces_.push_back({due, std::move(packet), counters_});
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
    pieces_.push_back(
        {due, Bytes(at + static_cast<std::ptrdiff_t>(begin), at + static_cast<std::ptrdiff_t>(end)),
         counters_});
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

/// The other end is set to raw mode and closed again: from then on poll(2) reports whether it is
/// open.
Pty::Pty(fs::path link) : fd_(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)), link_(std::move(link)) {
  const char* name = nullptr;
  if (fd_ < 0 || grantpt(fd_) != 0 || unlockpt(fd_) != 0 || (name = ptsname(fd_)) == nullptr ||
      fcntl(fd_, F_SETFL, O_NONBLOCK) != 0) {
    throw std::runtime_error(std::string("no pseudo-terminal: ") + std::strerror(errno));
  }
  path_ = name;
  const int other = open(name, O_RDWR | O_NOCTTY | O_CLOEXEC);
  const bool raw = other >= 0 && make_raw(other, 921600);
  close(other);
  if (!raw) throw std::runtime_error(path_ + ": " + std::strerror(errno));
  if (link_.empty()) return;
  if (fs::is_symlink(link_)) fs::remove(link_);
  fs::create_directories(link_.parent_path());
  fs::create_symlink(path_, link_);
}

Pty::Pty(Pty&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)),
      path_(std::move(other.path_)),
      link_(std::exchange(other.link_, {})) {}

Pty::~Pty() {
  if (fd_ >= 0) close(fd_);
  std::error_code ignored;
  if (!link_.empty()) fs::remove(link_, ignored);
}

bool Pty::is_open() const {
  pollfd ask{fd_, 0, 0};
  return poll(&ask, 1, 0) == 0;
}

bool Pty::write(const std::uint8_t* bytes, std::size_t count) {
  constexpr int kPatience = 5000;  // [ms]
  while (count > 0) {
    pollfd ask{fd_, POLLOUT, 0};
    if (poll(&ask, 1, kPatience) != 1 || (ask.revents & POLLHUP) != 0) return false;
    const ssize_t written = ::write(fd_, bytes, count);
    if (written < 0 && errno != EAGAIN && errno != EINTR) return false;
    if (written <= 0) continue;
    bytes += written;
    count -= static_cast<std::size_t>(written);
  }
  return true;
}

std::size_t Pty::read(std::uint8_t* buffer, std::size_t size) {
  const ssize_t count = ::read(fd_, buffer, size);
  return count > 0 ? static_cast<std::size_t>(count) : 0;
}

}  // namespace rio::live
