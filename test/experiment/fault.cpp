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

const Fault& named(const std::vector<Fault>& all, std::string_view name) {
  const auto found =
      std::find_if(all.begin(), all.end(), [name](const Fault& f) { return f.name == name; });
  if (found == all.end()) throw std::runtime_error(fmt::format("no such fault: \"{}\"", name));
  return *found;
}

std::vector<Fault> make_catalogue() {
  std::vector<Fault> all = {{.name = "none", .promised = Promise::kIgnored}};
  for (const auto& group : {time_faults, imu_faults, radar_faults, configuration_faults}) {
    for (Fault& fault : group()) all.push_back(std::move(fault));
  }
  const auto pair = [&all](std::string_view a, std::string_view b, Promised promised) {
    all.push_back(together(named(all, a), named(all, b), promised));
  };
  pair("radar silent for 5 s", "IMU silent for 0.3 s", recovered(5.0));
  pair("radar silent for 10 s", "all clocks start again at 0", Promise::kHonest);
  pair("radar silent for 10 s", "gyro bias x +0.01 rad/s", recovered(15.0));
  pair("empty scans for 5 s", "IMU frozen for 0.5 s", recovered(5.0));
  pair("empty scans for 5 s", "accel bias x +0.5 m/s^2", recovered(15.0));
  pair("80 % random outliers for 3 s", "gyro bias y +0.01 rad/s", recovered(15.0));
  pair("80 % random outliers for 3 s", "one sample of 100 m/s^2", recovered(5.0));
  pair("60 % coherent outliers for 3 s", "IMU silent for 0.3 s", recovered(5.0));
  pair("70 % movers for 10 s", "IMU samples swapped for 10 s", Promise::kBridged);
  pair("70 % movers for 10 s", "gyro bias z +0.01 rad/s", Promise::kHonest);
  return all;
}

}  // namespace

std::string promise_text(const Fault& fault) {
  constexpr std::array kTexts = {"ignored", "bridged", "honest", "recovered", "reported"};
  const auto& [promise, within] = fault.promised;
  const std::string text = kTexts[static_cast<std::size_t>(promise)];
  return promise == Promise::kRecovered ? fmt::format("{} in {} s", text, within) : text;
}

const std::vector<Fault>& faults() {
  static const std::vector<Fault> all = make_catalogue();
  return all;
}

const Fault& fault_named(std::string_view name) {
  return named(faults(), name);
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
