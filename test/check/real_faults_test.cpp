// SPDX-License-Identifier: BSD-3-Clause
// The faults of check/faults.hpp in real recordings: ti_demo, carried by hand, and a go-kart with
// six points a scan. Skipped without RIO_TEST_DATA, a folder with them.
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "check/check_it.hpp"
#include "support/measured.hpp"
#include "support/real_data.hpp"

namespace rio::test {
namespace {

/// Faults that are named although the radar is poor: told by units, columns, clocks and by how its
/// points move from scan to scan.
const std::set<std::string> kToldWithoutMotion = {"DopplerSign",
                                                  "GyroInDegrees",
                                                  "AccelerometerInG",
                                                  "AccelerometerInMilliG",
                                                  "PointsInMillimetres",
                                                  "PointsInCentimetres",
                                                  "DopplerInKilometresPerHour",
                                                  "AccelerometerFirst",
                                                  "DopplerAndSnrSwapped",
                                                  "NoOverlap"};

/// @return faults named
int expect_named(const std::string& name, const std::set<std::string>* expected_names) {
  const io::Dataset healthy = io::read_dataset(real_data(name));
  SCOPED_TRACE(name);
  expect_ok(healthy);
  int named = 0;
  for (const Fault& fault : faults()) {
    const Findings findings = check_it_with(fault, healthy);
    const bool is_named = check::naming(findings, fault) != nullptr;
    const bool expected = expected_names == nullptr || expected_names->count(fault.name) > 0;
    EXPECT_EQ(is_named, expected) << fault.name << "\n" << text_of(findings);
    EXPECT_TRUE(expected || worst(findings) == Verdict::kOk) << fault.name << "\n"
                                                             << text_of(findings);
    named += is_named ? 1 : 0;
  }
  return named;
}

/// Of these faults, whatever is said of others.
void expect_told(const io::Dataset& healthy, const std::set<std::string>& names) {
  for (const Fault& fault : faults()) {
    if (names.count(fault.name) == 0) continue;
    const Findings findings = check_it_with(fault, healthy);
    EXPECT_NE(check::naming(findings, fault), nullptr) << fault.name << "\n" << text_of(findings);
  }
}

TEST(CheckOfARealRecording, NamesTheFaultsItsMotionTells) {
  if (real_data("ti_demo").empty()) GTEST_SKIP() << kNoRealData;
  measured("ti_demo: faults named", expect_named("ti_demo", nullptr),
           std::to_string(faults().size()));
}

TEST(CheckOfARealRecording, AStepOfAClockIsFound) {
  if (real_data("ti_demo").empty()) GTEST_SKIP() << kNoRealData;
  const io::Dataset healthy = io::read_dataset(real_data("ti_demo"));
  for (const double step : {0.2, 0.3}) {
    for (const double part : {0.5, 0.7}) {
      const auto make_step = [&](auto* items) {
        step_stamps(items, 1 + static_cast<std::size_t>(part * static_cast<double>(items->size())),
                    step);
      };
      io::Dataset radar = healthy;
      make_step(&radar.scans);
      io::Dataset imu = healthy;
      make_step(&imu.imu);
      SCOPED_TRACE(testing::Message() << step << " s after " << part);
      expect(said(radar, "delay of the radar"), Verdict::kWrong, "a clock steps", "split");
      expect(said(imu, "delay of the radar"), Verdict::kWrong, "a clock steps", "split");
    }
  }
}

TEST(CheckOfARealRecording, APoorRadarTellsUnitsAndTheSignOfItsDoppler) {
  if (real_data("kart/driveAround1_A").empty()) GTEST_SKIP() << kNoRealData;
  for (const char* name : {"kart/driveAround1_A", "kart/outside4_B"}) {
    measured(std::string(name) + ": faults named", expect_named(name, &kToldWithoutMotion),
             std::to_string(kToldWithoutMotion.size()));
  }
}

TEST(CheckOfARealRecording, GravityTellsAnImuInFrdFromARadarTurnedAlike) {
  for (const char* name : {"kart/labDriveAround3_A", "kart2/jun26_DriveArroundFast"}) {
    if (real_data(name).empty()) GTEST_SKIP() << kNoRealData;
    SCOPED_TRACE(name);
    expect_told(io::read_dataset(real_data(name)), {"ImuInForwardRightDown"});
  }
}

TEST(CheckOfARealRecording, AGyroInDegreesDoesNotRest) {
  for (const char* name : {"kart/driveAround1_B", "kart2/sep_labHallway_L"}) {
    if (real_data(name).empty()) GTEST_SKIP() << kNoRealData;
    io::Dataset dataset = io::read_dataset(real_data(name));
    for (ImuSample& s : dataset.imu) s.gyro_B *= 180.0 / kHalfTurn;
    expect(said(dataset, "gyro unit"), Verdict::kWrong, "in deg/s", "--gyro-unit deg/s");
  }
}

TEST(CheckOfARealRecording, WindowsOfSecondsTellTheMountingWithSixPointsAScan) {
  if (real_data("kart/labDriveAround1_A").empty()) GTEST_SKIP() << kNoRealData;
  for (const char* name : {"kart/labDriveAround1_A", "kart/labDriveAround3_B"}) {
    const io::Dataset healthy = io::read_dataset(real_data(name));
    SCOPED_TRACE(name);
    expect_ok(healthy);
    expect_told(healthy, {"MountingTurned90AboutTheBody", "MountingTurned180AboutTheBody",
                          "MountingUpsideDown", "AxesOfTheChip", "ImuInForwardRightDown"});
  }
}

}  // namespace
}  // namespace rio::test
