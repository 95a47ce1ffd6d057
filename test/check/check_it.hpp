// SPDX-License-Identifier: BSD-3-Clause
// Simulated flights as recordings, and what `rio check` says of recordings, for tests.
#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "check/check.hpp"
#include "check/faults.hpp"
#include "rio/io/dataset.hpp"
#include "support/short_flight.hpp"
#include "support/temp_dir.hpp"

namespace rio::test {

using check::delay_scans;
using check::each_detection;
using check::each_sample;
using check::Fault;
using check::faults;
using check::Finding;
using check::Findings;
using check::in_axes;
using check::kHalfTurn;
using check::MakeFault;
using check::of_detections;
using check::of_samples;
using check::Source;
using check::turn_mounting;
using check::Verdict;

inline io::Dataset flown(const sim::Scenario& scenario, const sim::Flight& flight) {
  io::Dataset out;
  out.imu = flight.imu;
  out.scans = flight.scans;
  out.radar_info.T_BS = flight.configured_T_BS;
  if (scenario.radar.ambiguous) out.radar_info.max_doppler = scenario.radar.reported_max_doppler();
  out.radar_info.doppler_resolution = scenario.radar.reported_doppler_resolution();
  out.radar_info.rate_hz = scenario.radar.rate_hz;
  return out;
}
inline io::Dataset flown(const sim::Scenario& scenario) {
  return flown(scenario, sim::simulate_flight(scenario));
}
/// Each is flown once for all tests.
inline const io::Dataset& flown(const std::string& name, double length) {
  static std::map<std::pair<std::string, double>, io::Dataset> flights;
  const auto [at, is_new] = flights.try_emplace({name, length});
  if (is_new) {
    sim::Scenario scenario = scenario_named(name);
    scenario.path.length = length;
    at->second = flown(scenario);
  }
  return at->second;
}

/// One with which nothing is wrong.
inline const io::Dataset& flight() {
  return flown("indoor-1", 50.0);
}

/// The stamps of the items from `first` on are off by a step [s].
template <class Items>
void step_stamps(Items* items, std::size_t first, double seconds) {
  for (std::size_t i = first; i < items->size(); ++i) (*items)[i].time += from_seconds(seconds);
}

/// @param folder of the recording, for lines of its files
inline Findings check_it(const io::Dataset& dataset, Source source = Source::kBag,
                         const std::filesystem::path& folder = {}) {
  Options options;
  io::apply_sensor_info(dataset, &options);
  return check::check_recording(dataset, options, source, folder);
}
/// Of the recording with a fault.
inline Findings check_it_with(const Fault& fault, io::Dataset dataset) {
  fault.make(&dataset);
  return check_it(dataset);
}

inline std::string text_of(const Findings& findings) {
  std::string text;
  for (const Finding& f : findings) {
    text += std::string(to_string(f.verdict)) + " " + f.subject + ": " + f.text + " -> " +
            f.change + "\n";
  }
  return text;
}

inline void expect_ok(const Findings& findings) {
  EXPECT_EQ(worst(findings), Verdict::kOk) << text_of(findings);
}
inline void expect_ok(const io::Dataset& dataset) {
  expect_ok(check_it(dataset));
}

inline const Finding* find(const Findings& findings, const std::string& subject) {
  for (const Finding& f : findings) {
    if (f.subject == subject) return &f;
  }
  return nullptr;
}

/// The finding with this subject; an empty one, and a failure, if there is none.
inline Finding said(const Findings& findings, const std::string& subject) {
  const Finding* found = find(findings, subject);
  EXPECT_NE(found, nullptr) << subject << "\n" << text_of(findings);
  return found == nullptr ? Finding{} : *found;
}
inline Finding said(const io::Dataset& dataset, const std::string& subject,
                    Source source = Source::kBag) {
  return said(check_it(dataset, source), subject);
}

/// The change said to a recording of `subject` holds this.
inline void expect_change(const io::Dataset& dataset, const std::string& subject,
                          const std::string& change, Source source = Source::kBag) {
  EXPECT_PRED2(contains, said(dataset, subject, source).change, change);
}

/// This verdict, with these parts of the sentence and of the proposed change.
inline void expect(const Finding& finding, Verdict verdict, const std::string& text,
                   const std::string& change = "") {
  EXPECT_EQ(finding.verdict, verdict) << finding.text;
  EXPECT_PRED2(contains, finding.text, text);
  EXPECT_PRED2(contains, finding.change, change);
}

/// The rotation in a line to paste.
inline Quaternion mounting_in(const std::string& line) {
  const std::string key = "quaternion_wxyz: [";
  const std::size_t at = line.find(key);
  Quaternion q = Quaternion::Identity();
  EXPECT_NE(at, std::string::npos) << line;
  if (at == std::string::npos) return q;
  const int read = std::sscanf(line.c_str() + at + key.size(), "%lf, %lf, %lf, %lf", &q.w(), &q.x(),
                               &q.y(), &q.z());
  EXPECT_EQ(read, 4) << line;
  return q;
}

/// What is said of the flight with a fault.
struct Cause {
  MakeFault make;
  const char* subject;
  Verdict verdict;
  std::string text;         ///< part of the sentence
  std::string change = "";  ///< part of the proposed change
};
inline void expect_said(const std::vector<Cause>& causes) {
  for (const Cause& cause : causes) {
    SCOPED_TRACE(cause.subject + (": " + cause.text) + " -> " + cause.change);
    io::Dataset dataset = flight();
    cause.make(&dataset);
    expect(said(dataset, cause.subject), cause.verdict, cause.text, cause.change);
  }
}

}  // namespace rio::test
