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
#include <string>

namespace rio::live {

class Port {
 public:
  enum class State {
    kOpen,
    kVanished,  ///< not present (any more); may come back
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
  void lose(State state);

  std::string name_;
  std::string path_;
  int baud_;
  bool is_udp_ = false;
  bool listens_ = false;  ///< UDP without a given peer
  sockaddr_in peer_{};
  int fd_ = -1;
  bool is_line_ = false;  ///< a terminal: may come back
  State state_ = State::kVanished;
};

}  // namespace rio::live
