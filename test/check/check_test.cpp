// SPDX-License-Identifier: BSD-3-Clause
// Every fault put into a simulated flight is named, with what to change; flights without one have
// nothing wrong.
#include "check/check.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "rio/core/so3.hpp"
#include "rio/sim/catalogue.hpp"
#include "rio/sim/flight.hpp"
#include "support/measured.hpp"

namespace rio::test {
namespace {

using check::Finding;
using check::Findings;
using check::Source;
using check::Verdict;

constexpr double kHalfTurn = 3.14159265358979323846;

io::Dataset flown(const sim::Scenario& scenario) {
  const sim::Flight flight = sim::simulate_flight(scenario);
  io::Dataset out;
  out.imu = flight.imu;
  out.scans = flight.scans;
  out.radar_info.T_BS = flight.told_T_BS;
  if (scenario.radar.ambiguous) out.radar_info.max_doppler = scenario.radar.reported_max_doppler();
  out.radar_info.doppler_resolution = scenario.radar.reported_doppler_resolution();
  out.radar_info.rate_hz = scenario.radar.rate_hz;
  return out;
}

io::Dataset flown(const std::string& name, double length) {
  sim::Scenario scenario;
  EXPECT_TRUE(sim::scenario(name, &scenario)) << name;
  scenario.path.length = length;
  return flown(scenario);
}

Findings check_it(const io::Dataset& dataset, Source source = Source::kBag) {
  Options options;
  io::apply_sensor_info(dataset, &options);
  return check::check_recording(dataset, options, source);
}

std::string text_of(const Findings& findings) {
  std::string text;
  for (const Finding& f : findings) {
    text += std::string(to_string(f.verdict)) + " " + f.subject + ": " + f.text + " -> " +
            f.change + "\n";
  }
  return text;
}

const Finding* find(const Findings& findings, const std::string& subject) {
  for (const Finding& f : findings) {
    if (f.subject == subject) return &f;
  }
  return nullptr;
}

void each_detection(io::Dataset* d, const std::function<void(RadarDetection*)>& change) {
  for (RadarScan& scan : d->scans) {
    for (RadarDetection& detection : scan.detections) change(&detection);
  }
}

void turn_mounting(io::Dataset* d, const Vector3d& phi, bool in_body) {
  Quaternion& q = d->radar_info.T_BS->rotation;
  q = in_body ? quaternion_exp(phi) * q : q * quaternion_exp(phi);
}

/// The rotation in a line to paste.
Quaternion mounting_in(const std::string& line) {
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

/// A fault, and what is said of it.
struct Fault {
  const char* name;
  std::function<void(io::Dataset*)> make;
  const char* subject;
  const char* text;    ///< in the sentence
  const char* change;  ///< in what is to be changed
};

std::vector<Fault> faults() {
  const double quarter = 0.5 * kHalfTurn;
  return {
      {"DopplerSign",
       [](io::Dataset* d) {
         each_detection(d, [](RadarDetection* r) { r->range_rate = -r->range_rate; });
       },
       "axes and Doppler sign", "the Doppler has the wrong sign", "--approaching"},
      {"MountingTurned90AboutTheBody",
       [=](io::Dataset* d) {
         turn_mounting(d, {0.0, 0.0, quarter}, true);
       },
       "axes and Doppler sign", "turned by 90 deg about the -z axis of the body", "quaternion"},
      {"MountingTurned180AboutTheBody",
       [](io::Dataset* d) {
         turn_mounting(d, {0.0, 0.0, kHalfTurn}, true);
       },
       "axes and Doppler sign", "turned by 180 deg about the z axis of the body", "quaternion"},
      {"MountingUpsideDown",
       [](io::Dataset* d) {
         turn_mounting(d, {kHalfTurn, 0.0, 0.0}, false);
       },
       "axes and Doppler sign", "turned by 180 deg about the x axis of the radar", "quaternion"},
      {"AxesOfTheChip",  // right, forward, up for forward, left, up
       [](io::Dataset* d) {
         each_detection(d, [](RadarDetection* r) {
           const Vector3d p = r->point_S;
           r->point_S = {-p.y(), p.x(), p.z()};
         });
       },
       "axes and Doppler sign", "turned by 90 deg about the -z axis of the radar", "quaternion"},
      {"AxesSwapped",
       [](io::Dataset* d) {
         each_detection(d, [](RadarDetection* r) { std::swap(r->point_S.x(), r->point_S.y()); });
       },
       "axes and Doppler sign", "x and y of the points are swapped", "--axes"},
      {"AxisMirrored",
       [](io::Dataset* d) {
         each_detection(d, [](RadarDetection* r) { r->point_S.y() = -r->point_S.y(); });
       },
       "axes and Doppler sign", "y of the points has the wrong sign", "--axes"},
      {"GyroInDegrees",
       [](io::Dataset* d) {
         for (ImuSample& s : d->imu) s.gyro_B *= 180.0 / kHalfTurn;
       },
       "gyro unit", "deg/s", "--gyro-unit deg/s"},
      {"AccelerometerInG",
       [](io::Dataset* d) {
         for (ImuSample& s : d->imu) s.accel_B /= 9.80665;
       },
       "accelerometer unit", "it is in g", "--accel-unit g"},
      {"AccelerometerInMilliG",
       [](io::Dataset* d) {
         for (ImuSample& s : d->imu) s.accel_B *= 1e3 / 9.80665;
       },
       "accelerometer unit", "it is in mg", "--accel-unit mg"},
      {"DopplerInKilometresPerHour",
       [](io::Dataset* d) { each_detection(d, [](RadarDetection* r) { r->range_rate *= 3.6; }); },
       "Doppler scale", "km/h", "*0.27"},
      {"NoOverlap",
       [](io::Dataset* d) {
         for (RadarScan& scan : d->scans) scan.time += from_seconds(4000.0);
       },
       "clocks", "both for 0.0 s", "--radar-offset"},
      {"RadarAFrameLate",
       [](io::Dataset* d) {
         for (RadarScan& scan : d->scans) scan.time += from_seconds(1.0 / 15.0);
       },
       "delay of the radar", "moved by -", "time_offset: 0.0"},
  };
}

struct FaultyFlight {
  const char* name;
  double length;  ///< [m]; the delay of a frame needs a minute of changing speed
};

class NamesTheFault : public testing::TestWithParam<FaultyFlight> {};

TEST_P(NamesTheFault, AndNothingIsWrongWithoutIt) {
  const io::Dataset healthy = flown(GetParam().name, GetParam().length);
  const Findings fine = check_it(healthy);
  EXPECT_EQ(worst(fine), Verdict::kOk) << text_of(fine);
  int named = 0;
  for (const Fault& fault : faults()) {
    io::Dataset damaged = healthy;
    fault.make(&damaged);
    const Findings findings = check_it(damaged);
    const Finding* said = find(findings, fault.subject);
    ASSERT_NE(said, nullptr) << fault.name << "\n" << text_of(findings);
    EXPECT_EQ(said->verdict, Verdict::kWrong) << fault.name << "\n" << text_of(findings);
    EXPECT_NE(said->text.find(fault.text), std::string::npos) << fault.name << "\n" << said->text;
    EXPECT_NE(said->change.find(fault.change), std::string::npos) << fault.name << "\n"
                                                                  << said->change;
    named += said->verdict == Verdict::kWrong ? 1 : 0;
  }
  measured(std::string(GetParam().name) + ": faults named", named, std::to_string(faults().size()));
}

INSTANTIATE_TEST_SUITE_P(Flights, NamesTheFault,
                         testing::Values(FaultyFlight{"indoor-1", 50.0},
                                         FaultyFlight{"aggressive", 120.0}),
                         [](const auto& p) { return p.index == 0 ? "Indoor" : "Aggressive"; });

TEST(Check, NothingIsWrongInAnyFlightOfTheCatalogue) {
  for (const sim::CatalogueEntry& entry : sim::catalogue()) {
    const Findings findings = check_it(flown(entry.name, 40.0));
    EXPECT_NE(worst(findings), Verdict::kWrong) << entry.name << "\n" << text_of(findings);
  }
}

TEST(Check, SaysThatHoverDoesNotTell) {
  const Findings findings = check_it(flown("hover", 40.0));
  const Finding* axes = find(findings, "axes and Doppler sign");
  ASSERT_NE(axes, nullptr) << text_of(findings);
  EXPECT_EQ(axes->verdict, Verdict::kOk);
  EXPECT_NE(axes->text.find("the motion does not tell"), std::string::npos) << axes->text;
}

TEST(Check, WhatItSaysToChangePutsTheMountingRight) {
  io::Dataset dataset = flown("indoor-1", 60.0);
  const Quaternion truth = dataset.radar_info.T_BS->rotation;
  turn_mounting(&dataset, {0.0, 0.0, kHalfTurn}, true);
  const Findings findings = check_it(dataset);
  const std::string& line = find(findings, "axes and Doppler sign")->change;
  const Quaternion q = mounting_in(line);
  EXPECT_LT(quaternion_log(truth.conjugate() * q).norm(), 1e-3) << line;
}

TEST(Check, FindsAMountingThatNobodyTold) {
  io::Dataset dataset = flown("indoor-1", 50.0);
  Quaternion& told = dataset.radar_info.T_BS->rotation;  // 45 deg down
  const Quaternion truth = told;
  told = quaternion_exp(Vector3d(0.6, -0.9, 0.4)) * truth;
  const Findings findings = check_it(dataset);
  const Finding* said = find(findings, "axes and Doppler sign");
  ASSERT_NE(said, nullptr) << text_of(findings);
  EXPECT_EQ(said->verdict, Verdict::kWrong) << said->text;
  const double off = quaternion_log(truth.conjugate() * mounting_in(said->change)).norm();
  measured("mounting found at any angle, off by [deg]", off * 180.0 / kHalfTurn, "below 10");
  EXPECT_LT(off, 10.0 * kHalfTurn / 180.0) << said->change;
}

TEST(Check, FindsTheAxesOfALateRadar) {
  io::Dataset dataset = flown("indoor-1", 50.0);
  turn_mounting(&dataset, {0.0, 0.0, kHalfTurn}, true);
  for (RadarScan& scan : dataset.scans) scan.time += from_seconds(0.12);
  const Findings findings = check_it(dataset);
  for (const char* subject : {"axes and Doppler sign", "delay of the radar"}) {
    const Finding* said = find(findings, subject);
    ASSERT_NE(said, nullptr) << text_of(findings);
    EXPECT_EQ(said->verdict, Verdict::kWrong) << text_of(findings);
  }
}

TEST(Check, AFewSamplesAreNoRecording) {
  io::Dataset dataset = flown("indoor-1", 40.0);
  dataset.imu.resize(50);
  EXPECT_EQ(worst(check_it(dataset)), Verdict::kWrong);
  dataset = flown("indoor-1", 40.0);
  dataset.scans.resize(3);
  EXPECT_EQ(find(check_it(dataset), "radar stamps")->verdict, Verdict::kWrong);
}

}  // namespace
}  // namespace rio::test
