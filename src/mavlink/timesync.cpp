// SPDX-License-Identifier: BSD-3-Clause
#include "rio/mavlink/timesync.hpp"

#include <algorithm>

namespace rio::mavlink {
namespace {

constexpr Time kLongestTrip = std::chrono::seconds(1);
constexpr std::int64_t kMostNanoseconds = std::int64_t{1} << 62;  // 146 years
constexpr int kMany = 3;  // consecutive contradictions that are not accidental

bool is_sane(std::int64_t nanoseconds) {
  return nanoseconds > -kMostNanoseconds && nanoseconds < kMostNanoseconds;
}

Time length(Time t) {
  return t < Time{0} ? -t : t;
}

}  // namespace

std::optional<Timesync> timesync_answer(const Timesync& question, const Address& asked_by,
                                        Time now) {
  if (question.tc1 != 0) return std::nullopt;
  Timesync answer;
  answer.tc1 = now.count();
  answer.ts1 = question.ts1;
  answer.target_system = asked_by.system;
  answer.target_component = asked_by.component;
  return answer;
}

Timesync TimesyncClient::ask(Time now) {
  asked_[next_asked_] = now;
  next_asked_ = (next_asked_ + 1) % asked_.size();
  Timesync question;
  question.ts1 = now.count();
  return question;
}

bool TimesyncClient::take(const Timesync& answer, Time now) {
  const Time asked(answer.ts1);
  if (answer.tc1 == 0 || !is_sane(answer.tc1) || !is_sane(answer.ts1)) return false;
  const Time trip = now - asked;
  if (trip < Time{0} || trip > kLongestTrip || !was_asked(asked)) return false;
  const Exchange exchange{now, Time(answer.tc1) - asked - trip / 2, trip / 2};
  contradictions_ = contradicts(exchange) ? contradictions_ + 1 : 0;
  if (contradictions_ >= kMany) {
    ++restarts_;
    contradictions_ = 0;
    count_ = 0;
  } else if (contradictions_ > 0) {
    return false;
  }
  exchanges_[count_++ % exchanges_.size()] = exchange;
  best_ = exchange;
  for (std::size_t i = 0; i < std::min(count_, exchanges_.size()); ++i) {
    if (bound(exchanges_[i], now) < bound(best_, now)) best_ = exchanges_[i];
  }
  return true;
}

Time TimesyncClient::bound(Time now) const {
  return bound(best_, now);
}

Time TimesyncClient::bound(const Exchange& exchange, Time now) const {
  return exchange.half_trip + from_seconds(max_drift_ * to_seconds(length(now - exchange.at)));
}

/// A request is answered once.
bool TimesyncClient::was_asked(Time when) {
  for (std::optional<Time>& asked : asked_) {
    if (asked != when) continue;
    asked.reset();
    return true;
  }
  return false;
}

/// Whether the bounds of this exchange and of the best one are disjoint.
bool TimesyncClient::contradicts(const Exchange& exchange) const {
  if (count_ == 0) return false;
  return length(exchange.offset - best_.offset) >
         exchange.half_trip + bound(best_, exchange.at) + std::chrono::microseconds(1);
}

}  // namespace rio::mavlink
