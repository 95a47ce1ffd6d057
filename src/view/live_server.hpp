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
  virtual int port() const = 0;
  /// Messages that viewers have lost.
  virtual std::uint64_t dropped() const = 0;
};

/// Listens. Throws std::runtime_error if it cannot. Its close() waits for viewers to read on, a
/// second at most; its end disconnects them.
/// @param address of this machine on which it listens; 127.0.0.1: this machine only
/// @param port 0: any that is free
std::unique_ptr<LiveServer> make_live_server(const std::string& address, int port);

}  // namespace rio::view
