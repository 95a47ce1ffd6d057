// SPDX-License-Identifier: BSD-3-Clause
// Sources and destinations of bytes: a serial line or pseudo-terminal, a file or pipe, standard
// input, UDP. Nothing blocks. Linux.
//
//   /dev/ttyACM1           a serial line at the default baud rate
//   /dev/ttyACM1@3125000   at another
//   flight.bin             any other path: a file, a pipe (mkfifo), a link to one of these
//   -                      standard input
// udp:14551              datagrams to 127.0.0.1:14551; answers go to the last sender
// udp:10.0.0.2:14550     datagrams to and from that address
#pragma once

#include <netinet/in.h>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <vector>

#include "live/host_clock.hpp"

namespace rio::live {

inline constexpr double kBitsPerByte = 10.0;  ///< on the wire, 8N1

/// Makes a terminal a transparent byte channel: raw bytes both ways, 8N1, no flow control, no echo.
/// Pending input is discarded, since its arrival time is unknown. Does nothing if it is not a
/// terminal.
/// @param baud any rate, 1200 to 1e8
/// @return false, with errno set, if the line refuses it or cannot come near the rate
bool make_raw(int fd, int baud);

class Port {
 public:
  enum class State {
    kAbsent,  ///< not present so far
    kOpen,
    kVanished,  ///< not present any more; may come back
    kEnded,     ///< a file or a pipe that has ended
  };

  /// Throws std::runtime_error if the name is invalid.
  Port(const std::string& name, int default_baud);
  ~Port() { close(); }
  Port(Port&& other) noexcept;
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;
  Port& operator=(Port&&) = delete;

  /// Opens the port if it exists. Throws if it exists but cannot be used, for example without
  /// permission.
  /// @return true if it is open
  bool open();
  void close();

  State state() const { return state_; }
  /// For poll(2); -1 unless open.
  int fd() const { return fd_; }
  const std::string& name() const { return name_; }
  /// Without the baud rate.
  const std::string& path() const { return path_; }
  /// Of a serial line.
  int baud() const { return baud_; }

  /// The available bytes, at most `size`; call it when poll(2) reports some. The state may change.
  std::size_t read(std::uint8_t* buffer, std::size_t size);
  /// Writes the bytes if there is space for all of them now.
  /// @return true if they were written
  bool write(const std::uint8_t* bytes, std::size_t count);

 private:
  void open_path();
  void open_udp();

  std::string name_;
  std::string path_;
  int baud_;
  bool is_udp_ = false;
  bool listens_ = false;  ///< UDP without a given peer
  sockaddr_in peer_{};
  int fd_ = -1;
  bool is_line_ = false;  ///< a terminal: may come back
  State state_ = State::kAbsent;
};

/// A port of a set and its handling.
struct Watched {
  Port port;
  std::string what;    ///< for messages, such as "radar 0"
  bool needed = true;  ///< the set is over when all needed ports are
  std::function<void(const std::uint8_t* bytes, std::size_t count, Time arrival)> on_bytes;
  std::function<void()> on_reopened = [] {};
};

/// Several ports in one thread with poll(2): bytes are passed on when they arrive, and a port that
/// vanished is reopened when it is back.
class PortSet {
 public:
  using OnMessage = std::function<void(const std::string& message)>;

  /// @param patience  how long to wait for a missing port [s]
  /// @param on_message called when a port vanishes, comes back, ends
  PortSet(const HostClock& clock, double patience, OnMessage on_message);

  /// Ports are polled in this order. The port keeps its address.
  /// @throws std::runtime_error if there is a port of this name
  Port& add(Watched watched);

  /// Waits for bytes, 50 ms at most, and passes them on.
  /// @return false when all needed ports are over: ended, or vanished for too long
  bool wait();
  void close();

 private:
  struct Entry {
    Watched watched;
    bool was_open = false;
    bool over = false;
    bool awaited = false;  ///< and it was told
    Time since{0};         ///< since when it is missing
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
