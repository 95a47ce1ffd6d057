// SPDX-License-Identifier: BSD-3-Clause
#include "experiment/fault.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>

namespace rio::experiment {

namespace {

constexpr std::uint64_t kStreamOfFaults = 30;  // of random numbers

Stream events_of(const sim::Flight& flight) {
  Stream all;
  all.reserve(flight.imu.size() + flight.scans.size());
  for (const ImuSample& s : flight.imu) {
    all.push_back({.arrival = s.time, .measured = s.time, .sample = s});
  }
  for (std::size_t i = 0; i < flight.scans.size(); ++i) {
    all.push_back({.arrival = flight.arrivals[i],
                   .measured = flight.scans[i].time,
                   .kind = Event::Kind::kScan,
                   .scan = flight.scans[i]});
  }
  return all;
}

void sort_by_arrival(Stream& all) {
  std::stable_sort(all.begin(), all.end(),
                   [](const Event& a, const Event& b) { return a.arrival < b.arrival; });
}

}  // namespace

std::string promise_text(const Fault& fault) {
  constexpr std::array kTexts = {"ignored", "bridged", "honest", "recovered", "reported"};
  const auto& [promise, within] = fault.promised;
  const std::string text = kTexts[static_cast<std::size_t>(promise)];
  return promise == Promise::kRecovered ? fmt::format("{} in {} s", text, within) : text;
}

Fault together(const Fault& a, const Fault& b, Promised promised) {
  const auto change = [a, b](Event& e, Moment& m) {
    a.apply(e, m);
    b.apply(e, m);
  };
  return {a.name + ", and " + b.name, Of::kBoth, std::max(a.duration, b.duration), promised,
          change};
}

Stream disturbed(const sim::Flight& flight, const Fault& fault, Time begin) {
  Stream all = events_of(flight);
  sort_by_arrival(all);
  if (!fault.change) return all;
  const Time first = flight.imu.front().time + begin;
  std::array<Event, 2> before;  // by kind
  std::array<int, 2> count{};
  sim::Random random(flight.scenario.seed, kStreamOfFaults);
  Stream more;
  for (Event& e : all) {
    const std::size_t kind = e.is_imu() ? 0 : 1;
    if (e.arrival < first) {
      before[kind] = e;
      continue;
    }
    const double t = to_seconds(e.arrival - first);
    if (t >= fault.duration) break;
    Moment moment{t, count[kind]++, first, before[kind], flight, random, more};
    fault.apply(e, moment);
  }
  all.insert(all.end(), more.begin(), more.end());
  std::erase_if(all, [](const Event& e) { return e.lost; });
  sort_by_arrival(all);
  return all;
}

}  // namespace rio::experiment
