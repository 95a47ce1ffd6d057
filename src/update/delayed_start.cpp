// SPDX-License-Identifier: BSD-3-Clause
#include "rio/update/delayed_start.hpp"

#include <algorithm>

namespace rio {

namespace {

constexpr Time kTryEvery = std::chrono::seconds(1);
constexpr std::size_t kLeast = 20;  // measurements: with fewer a wrong place can explain an outlier

}  // namespace

DelayedStarts::DelayedStarts(const Options& options)
    : states_(options.auxiliary), gravity_(options.imu.gravity) {
  int first = 0;
  for (const AuxiliaryState& state : states_) {
    if (state.delayed) {
      delayed_.push_back({});
      delayed_.back().declared = state;
      delayed_.back().first = first;
    }
    first += state.size;
  }
  for (DelayedState& state : delayed_) state.held.reserve(DelayedState::kMostHeld);
}

void DelayedStarts::reset() {
  for (DelayedState& state : delayed_) {
    state.waits = true;
    state.interval = Time{0};
    state.held.clear();
  }
}

bool DelayedStarts::any() const {
  return std::any_of(delayed_.begin(), delayed_.end(),
                     [](const DelayedState& w) { return w.waits; });
}

bool DelayedStarts::waits(int first) const {
  return std::any_of(delayed_.begin(), delayed_.end(),
                     [first](const DelayedState& w) { return w.waits && w.first == first; });
}

bool DelayedStarts::hold(const AidingObservation& seen, const StateEstimate& x) {
  const AidingMeasurement& z = seen.measurement;
  DelayedState* one = nullptr;
  for (DelayedState& state : delayed_) {
    if (!state.waits || !z.depends_on(states_, state.first)) continue;
    if (one != nullptr) return true;  // of two unknown states: it determines neither
    one = &state;
  }
  if (one == nullptr) return false;
  std::vector<HeldMeasurement>& held = one->held;
  if (!held.empty() && z.time() < held.back().z.time() + one->interval) return true;
  if (held.empty()) one->next_try = z.time() + kTryEvery;
  if (held.size() == DelayedState::kMostHeld) {  // keeps every second one
    for (std::size_t i = 0; i < held.size() / 2; ++i) held[i] = held[2 * i];
    held.erase(held.begin() + static_cast<std::ptrdiff_t>(held.size() / 2), held.end());
    one->interval = (held.back().z.time() - held.front().z.time()) / (held.size() - 1);
  }
  held.push_back({z, aided_state(z, seen.to_now, x.estimate().nav, x.estimate(), gravity_),
                  x.covariance().matrix().block<3, 3>(body::kPosition, body::kPosition)});
  return true;
}

const DelayedStart* DelayedStarts::determine(const StateEstimate& x) {
  for (DelayedState& state : delayed_) {
    if (!state.waits || state.held.empty()) continue;
    const Time newest = state.held.back().z.time();
    if (newest < state.next_try || state.held.size() < kLeast) continue;
    state.next_try = newest + kTryEvery;
    if (!fit(state, x)) continue;
    state.waits = false;
    state.held.clear();
    return &start_;
  }
  return nullptr;
}

}  // namespace rio
