// SPDX-License-Identifier: BSD-3-Clause
// Offset between the clock of an autopilot and that of this side, by TIMESYNC. C++17.
//
//   here   --- ts1 ----------- t2 -->        offset = tc1 - (ts1 + t2) / 2, with an error of half
//               \             /              the round trip at most, however the delay is shared
//   there  ------- tc1 -----------> +offset  between the two directions
//
// So every exchange bounds the offset from both sides. The bounds widen with age by the possible
// drift of the clocks; the exchange with the tightest bounds is used, so exchanges delayed by a
// busy link do no harm. Exchanges whose bounds exclude each other prove that a clock has jumped.
// Source: "Time Synchronization Protocol v2" of the MAVLink guide; clock filter of NTP (RFC 5905,
// section 12).
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "rio/mavlink/frame.hpp"
#include "rio/types.hpp"

namespace rio::mavlink {

/// The answer to a request of the other side (tc1 = 0), to be sent at once. PX4 asks ten times a
/// second, and uses the answers to convert the stamps of this side to its clock.
/// @param asked_by sender of the request
/// @param now      clock of this side, in which the messages are stamped
/// @return nothing if it is not a request
std::optional<Timesync> timesync_answer(const Timesync& question, const Address& asked_by,
                                        Time now);

/// Requests the clock of the other side. No allocation.
class TimesyncClient {
 public:
  /// @param max_drift of the clocks relative to each other
  explicit TimesyncClient(double max_drift = 1e-4) : max_drift_(max_drift) {}

  /// The request to send now; ten in the first second, then one a second are sufficient.
  Timesync ask(Time now);

  /// Takes an answer that arrived at `now`.
  /// @return true if it was used: it answers one of the last 16 requests, within a second
  bool take(const Timesync& answer, Time now);

  bool known() const { return count_ > 0; }
  /// Clock of the other side minus that of this one, from the best exchange; 0 until known().
  Time offset() const { return best_.offset; }
  /// Bound of its error: half the round trip, plus the drift since then.
  Time bound(Time now) const;
  /// Number of clock jumps.
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
  std::array<Exchange, 32> exchanges_{};  ///< ring buffer of the newest
  std::size_t count_ = 0;
  Exchange best_;
  int contradictions_ = 0;  ///< in a row
  int restarts_ = 0;
};

}  // namespace rio::mavlink
