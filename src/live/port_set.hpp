// SPDX-License-Identifier: BSD-3-Clause
// Several ports in one thread with poll(2): bytes are passed on when they arrive, and a port that
// vanished is reopened when it is back.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <vector>

#include "live/host_clock.hpp"
#include "live/port.hpp"

namespace rio::live {

/// A port and its handling.
struct Watched {
  Port port;
  std::string what;    ///< for messages, such as "radar 0"
  bool needed = true;  ///< the set is over when all needed ports are
  std::function<void(const std::uint8_t* bytes, std::size_t count, Time arrival)> on_bytes;
  std::function<void()> on_reopened = [] {};
};

class PortSet {
 public:
  using OnMessage = std::function<void(const std::string& message)>;

  /// @param patience  how long to wait for a missing port [s]
  /// @param on_message called when a port vanishes, comes back, ends
  PortSet(const HostClock& clock, double patience, OnMessage on_message);

  /// Ports are polled in this order. The port keeps its address.
  Port& add(Watched watched);

  /// Waits for bytes, 50 ms at most, and passes them on.
  /// @return false when all needed ports are over: ended, or vanished for too long
  bool wait();

 private:
  struct Entry {
    Watched watched;
    bool was_open = false;
    bool over = false;
    bool awaited = false;  ///< and it was told
    Time since{0};  ///< since when it is missing
    Time next_try{0};
  };

  void reopen(Entry* entry);
  void read(Entry* entry);

  const HostClock& clock_;
  Time patience_;
  OnMessage on_message_;
  std::deque<Entry> entries_;
  std::vector<std::uint8_t> buffer_;
};

}  // namespace rio::live
