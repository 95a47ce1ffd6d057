// SPDX-License-Identifier: BSD-3-Clause
// The messages of a run for viewers that connect while it goes on: a server of the Foxglove
// WebSocket protocol (subprotocol foxglove.websocket.v1), in a thread of its own.
//
// The run never waits for a viewer: it puts a message into a queue of bounded size and goes on.
// A viewer that reads too slowly loses messages, oldest first; they are counted.
// Built with libwebsockets only (RIO_HAS_LIBWEBSOCKETS).
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "view/messages.hpp"

namespace rio::view {

class LiveServer : public MessageTarget {
 public:
  /// Listens. Throws std::runtime_error if it cannot.
  /// @param address of this machine on which it listens; 127.0.0.1: this machine only
  /// @param port 0: any that is free
  LiveServer(const std::string& address, int port);
  ~LiveServer() override;

  int port() const;
  std::uint16_t add_channel(const std::string& topic, const std::string& type,
                            const std::string& definition, bool latest_stays) override;
  void add(std::uint16_t channel, Time time, std::string_view message) override;
  void flush(Time time) override;
  /// Waits for viewers to read on, a second at most; then disconnects them.
  void close() override;

  /// Messages that viewers have lost.
  std::uint64_t dropped() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rio::view
