// SPDX-License-Identifier: BSD-3-Clause
// The clock of an autopilot against that of this side, by TIMESYNC. C++17.
//
//   here   --- ts1 ----------- t2 -->        offset = tc1 - (ts1 + t2) / 2, wrong by
//               \             /              half the round trip at most, whatever the ways there
//   there  ------- tc1 -----------> +offset  and back took each
//
// So every exchange bounds the offset from both sides; the one with the tightest bounds, which
// widen with its age by what the clocks may drift, is the best, and exchanges delayed by a busy
// link do no harm. Exchanges whose bounds exclude each other prove that a clock has jumped. Source:
// "Time Synchronization Protocol v2" of the MAVLink guide; clock filter of NTP (RFC 5905, section
// 10).
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "rio/mavlink/frame.hpp"
#include "rio/types.hpp"

namespace rio::mavlink {

/// The answer to a question of the other side (tc1 = 0), to be sent at once: PX4 asks ten times a
/// second, and puts what is stamped by this side onto its clock by the answers.
/// @param asked_by sender of the question
/// @param now      clock of this side, in which the messages are stamped
/// @return nothing if it is no question
std::optional<Timesync> timesync_answer(const Timesync& question, const Address& asked_by,
                                        Time now);

/// Asks for the clock of the other side. No allocation.
class TimesyncClient {
 public:
  /// @param max_drift of the clocks against each other
  explicit TimesyncClient(double max_drift = 1e-4) : max_drift_(max_drift) {}

  /// The question to send now; ten in the first second, then one a second are plenty.
  Timesync ask(Time now);

  /// An answer that arrived at `now`.
  /// @return it was used: it answers one of the last 16 questions, within a second
  bool take(const Timesync& answer, Time now);

  bool known() const { return count_ > 0; }
  /// Clock of the other side minus that of this one, by the best exchange; 0 until known().
  Time offset() const { return best_.offset; }
  /// How wrong it may be: half the round trip, and the drift since then.
  Time bound(Time now) const;
  /// How often a clock has jumped.
  int restarts() const { return restarts_; }

 private:
  struct Exchange {
    Time at{0};
    Time offset{0};
    Time half_trip{0};
  };

  Time bound(const Exchange& exchange, Time now) const;
  bool was_asked(Time when);
  bool contradicts(const Exchange& exchange) const;

  double max_drift_;
  std::array<std::optional<Time>, 16> asked_{};
  std::size_t next_asked_ = 0;
  std::array<Exchange, 32> exchanges_{};  ///< a ring: the newest
  std::size_t count_ = 0;
  Exchange best_;
  int contradictions_ = 0;  ///< in a row
  int restarts_ = 0;
};

}  // namespace rio::mavlink
