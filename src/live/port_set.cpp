// SPDX-License-Identifier: BSD-3-Clause
#include "live/port_set.hpp"

#include <poll.h>

#include <algorithm>
#include <utility>

namespace rio::live {
namespace {

constexpr int kLongestWait = 50;  // [ms]
constexpr Time kRetry = std::chrono::milliseconds(200);
constexpr double kForEver = 1e9;  // [s]
constexpr std::size_t kBuffer = 65536;

}  // namespace

PortSet::PortSet(const HostClock& clock, double patience, OnMessage on_message)
    : clock_(clock),
      patience_(from_seconds(std::min(patience, kForEver))),
      on_message_(std::move(on_message)),
      buffer_(kBuffer) {}

Port& PortSet::add(Watched watched) {
  entries_.push_back({std::move(watched)});
  entries_.back().since = HostClock::real();
  return entries_.back().watched.port;
}

bool PortSet::wait() {
  std::vector<pollfd> asked;
  for (Entry& entry : entries_) {
    if (!entry.over && entry.watched.port.fd() < 0) reopen(&entry);
    asked.push_back({entry.watched.port.fd(), POLLIN, 0});  // poll ignores negative descriptors
  }
  const int ready = poll(asked.data(), asked.size(), kLongestWait);
  for (std::size_t i = 0; ready > 0 && i < asked.size(); ++i) {
    if (asked[i].revents != 0) read(&entries_[i]);
  }
  return std::any_of(entries_.begin(), entries_.end(),
                     [](const Entry& entry) { return entry.watched.needed && !entry.over; });
}

void PortSet::reopen(Entry* entry) {
  const Time now = HostClock::real();
  if (now < entry->next_try) return;
  entry->next_try = now + kRetry;
  Watched& watched = entry->watched;
  if (watched.port.open()) {
    if (entry->was_open) {
      on_message_(watched.what + ": " + watched.port.name() + " is back");
      watched.on_reopened();
    }
    entry->was_open = true;
  } else if (now - entry->since >= patience_) {
    entry->over = true;
    on_message_(watched.what + ": " + watched.port.name() + " is not there");
  } else if (!entry->was_open && !std::exchange(entry->awaited, true)) {
    on_message_(watched.what + ": " + watched.port.name() + " is not there yet: it is waited for");
  }
}

void PortSet::read(Entry* entry) {
  Watched& watched = entry->watched;
  const std::size_t count = watched.port.read(buffer_.data(), buffer_.size());
  if (count > 0) watched.on_bytes(buffer_.data(), count, clock_.now());
  if (watched.port.state() == Port::State::kOpen) return;
  entry->over = watched.port.state() == Port::State::kEnded;
  entry->since = HostClock::real();
  entry->next_try = entry->since + std::min(kRetry, patience_);
  on_message_(watched.what + ": " + watched.port.name() +
              (entry->over ? " has ended" : " vanished"));
}

}  // namespace rio::live
