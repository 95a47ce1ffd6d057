// SPDX-License-Identifier: BSD-3-Clause
// The stamps of one topic of a recording: header and receive times, and where the clock of the
// headers jumps.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "rio/bag/messages.hpp"
#include "rio/types.hpp"

namespace rio::bag {

/// Added to header stamps from a message of the topic on, so that their clock goes on as the
/// messages were received.
struct Shifts {
  struct Jump {
    std::size_t message = 0;
    Time by{0};     ///< of the header clock
    Time added{0};  ///< to the headers from there on
  };
  std::vector<Jump> jumps;

  Time last() const { return jumps.empty() ? Time(0) : jumps.back().added; }
  Time at(std::size_t message) const {
    Time added{0};
    for (const Jump& jump : jumps) added = message >= jump.message ? jump.added : added;
    return added;
  }
};

/// How the messages of a topic are stamped.
struct Stamping {
  bool received = false;  ///< by receive times, else by headers and shifts
  Shifts shifts;
  Time shift{0};  ///< added to all
  Time delay{0};  ///< receive - header, for the header that a driver left zero

  Time stamp(Time header, Time when, std::size_t message) const {
    const bool zero = header == Time(0);  // its receive time is on the clock that goes on already
    const Time measured = zero ? when - delay : header + shifts.at(message);
    return (received ? when : measured) + shift;
  }
};

/// Tells messages that come late, and fill a hole between the headers before, from a clock that is
/// set back, or a second publisher, whose headers fall between those.
class LateMessages {
 public:
  /// @return whether it fills one
  bool add(Time header);
  /// The longest way back of one of them; 0 if most headers that are behind another fill none.
  Time longest() const { return 10 * fill_ > 9 * behind_ ? longest_ : Time(0); }
  std::size_t count() const { return fill_; }

 private:
  std::deque<Time> last_;  ///< headers, in order
  std::size_t behind_ = 0;
  std::size_t fill_ = 0;
  Time longest_{0};
};

/// Filled while the topic is read.
class Stamps {
 public:
  /// Without messages, longer than a driver that stumbles.
  struct Pause {
    Time end{0};  ///< received
    Time length{0};
  };
  /// @param all keeps one of each for every message
  void add(const Header& head, Time when, bool all);

  std::size_t count = 0;
  std::size_t zeros = 0;    ///< of the headers
  std::size_t repeats = 0;  ///< headers that equal the one before, received apart, if each is kept
  std::size_t backs = 0;    ///< headers before the one before, which fill no hole
  LateMessages late;
  Header first, last;
  Time first_received{0}, last_received{0};
  std::vector<Time> header;
  std::vector<Time> received;
  std::vector<std::uint32_t> sequence;

  /// All but one in a hundred, as a driver leaves a few.
  bool has_headers() const { return 100 * zeros <= count; }
  /// Not with those of whole seconds or tenths, nor with one for all messages.
  bool has_times() const { return has_headers() && 5 * repeats <= count; }
  /// Median of receive - header, on the right clock of the headers; without zero headers.
  Time delay();
  /// The smallest one: a topic that arrives later and later had it when it was on time.
  Time least_delay() const;
  /// Whether the headers are on one clock, to a second: the smallest delays agree, or the headers
  /// begin and end together.
  bool is_on_clock_of(const Stamps& other) const;
  /// Whether they were recorded at the same time; else one was added later.
  bool is_recorded_with(const Stamps& other) const {
    return first_received <= other.last_received && other.first_received <= last_received;
  }
  Shifts shifts();
  /// Those of headers and receive times that all of the others have as well.
  std::vector<Pause> common_pauses(const std::vector<const Stamps*>& others) const;

 private:
  /// Headers of one clock that does not jump.
  struct Piece {
    std::size_t begin = 0;    ///< message
    Time by{0};               ///< the jump before
    Time first{0};            ///< header
    Time jitter{0};           ///< up to which the delay is the same as before
    std::deque<Time> delays;  ///< receive - header
    Time median();
    Time least() const;
  };
  /// The piece on the right clock: the first one that agrees with the receive clock, to a second;
  /// the first of all if none does.
  std::size_t anchor() const;
  /// Of the header clock, rather than a message that came late or was stamped twice.
  bool is_step_back(Time step, Time passed) const;
  /// Same, or of a message that came late before some that were lost: shifts() tells them apart.
  bool is_small_step_ahead(Time step, Time passed) const;
  Time interval() const;
  void note_pause(Time step, Time passed, Time when);

  std::vector<Piece> pieces_;
  std::vector<Pause> pauses_;
  Time stamped_{0};  ///< the last header that is not zero
  Time stamped_received_{0};
  Time headers_went_on_{0};  ///< received, after a pause
  Time receiving_went_on_{0};
};

}  // namespace rio::bag
