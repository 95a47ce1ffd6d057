// SPDX-License-Identifier: BSD-3-Clause
// The stamps of one topic of a recording: header and receive times, and where the clock of the
// headers jumps.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <utility>
#include <vector>

#include "rio/bag/messages.hpp"
#include "rio/types.hpp"

namespace rio::bag {

/// Added to header stamps from a message of the topic on, so that their clock goes on as the
/// messages were received.
class Shifts {
 public:
  struct Jump {
    std::size_t message = 0;
    Time by{0};     ///< of the header clock
    Time added{0};  ///< to the headers from there on
  };
  void add(const Jump& jump) {
    if (jump.added != last()) jumps_.push_back(jump);
  }
  const std::vector<Jump>& jumps() const { return jumps_; }
  Time last() const { return jumps_.empty() ? Time(0) : jumps_.back().added; }
  Time at(std::size_t message) const {
    Time added{0};
    for (const Jump& jump : jumps_) added = message >= jump.message ? jump.added : added;
    return added;
  }

 private:
  std::vector<Jump> jumps_;
};

/// Filled while the topic is read.
class Stamps {
 public:
  /// @param all keeps one of each for every message
  void add(const Header& head, Time when, bool all);

  std::size_t count = 0;
  std::size_t zeros = 0;  ///< of the headers
  Header first, last;
  Time first_received{0}, last_received{0};
  std::vector<Time> header;
  std::vector<Time> received;
  std::vector<std::uint32_t> sequence;

  /// Median of receive - header, up to the first jump; without zero headers.
  Time delay();
  Shifts shifts();

 private:
  /// Headers of one clock that does not jump.
  struct Piece {
    std::size_t begin = 0;    ///< message
    Time by{0};               ///< the jump before
    std::deque<Time> delays;  ///< receive - header
    Time median();
  };
  std::vector<Piece> pieces_;
  Time stamped_{0};  ///< the last header that is not zero
  Time stamped_received_{0};
};

}  // namespace rio::bag
