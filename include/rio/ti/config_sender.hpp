// SPDX-License-Identifier: BSD-3-Clause
// Sends a configuration to the radar over its CLI port (115200 baud, 8N1), line by line: each line
// after the answer to the one before. C++17. Allocates; for use before a flight.
//
//   rio::ti::ConfigSender sender(rio::ti::parse_config(text));
//   while (!sender.over()) {
//     write(port, sender.to_send(now));                        // may be empty
//     sender.receive(bytes, read(port, bytes), now);
//   }
//   if (!sender.done()) ... sender.error()
//
// The demos of SDK 3.x answer with an echo of the line, optional text, `Done` or `Error <n>`, and
// the prompt, such as `mmwDemo:/>`. Comments, which they answer with `Skipped`, are not sent. The
// first line after power-on may arrive garbled, so an empty line is sent first. An error of
// `sensorStop` on a stopped radar is ignored.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "rio/ti/config.hpp"

namespace rio::ti {

class ConfigSender {
 public:
  /// Longest line of the demos [bytes].
  static constexpr std::size_t kMaxLine = 255;

  /// @param timeout per line; the calibration in sensorStart takes some tenths of a second
  explicit ConfigSender(Config config, Time timeout = std::chrono::seconds(3));

  /// The bytes to write to the port now; empty while an answer is awaited. Call it after every
  /// receive(), and periodically without one: it also detects the timeout of an answer.
  std::string to_send(Time now);

  /// Bytes read from the port.
  void receive(const std::uint8_t* bytes, std::size_t count);

  /// All lines were accepted, or one was refused.
  bool over() const { return done() || !error_.empty(); }
  bool done() const { return next_ > config_.commands.size() && error_.empty(); }
  /// Why it ended early, with the line and the answer of the radar; else empty.
  const std::string& error() const { return error_; }
  /// Lines accepted so far.
  std::size_t accepted() const { return accepted_; }

 private:
  const ConfigCommand* current() const;
  bool give_up_waiting(Time now);
  void judge(const std::string& answer);
  void fail(const std::string& why);

  Config config_;
  Time timeout_;
  std::size_t next_ = 0;  ///< 0 the empty line, then the commands from 1
  std::size_t accepted_ = 0;
  bool waiting_ = false;
  Time sent_{0};
  std::string answer_;  ///< since the last line
  std::string error_;
};

}  // namespace rio::ti
