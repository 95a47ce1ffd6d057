// SPDX-License-Identifier: BSD-3-Clause
// The faults of check/faults.hpp in real recordings: ti_demo, carried by hand, and a go-kart with
// six points a scan. Skipped without RIO_TEST_DATA, a folder with them.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>

#include "check/check_it.hpp"
#include "support/measured.hpp"

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

std::filesystem::path recording_at(const std::string& name) {
  const char* data = std::getenv("RIO_TEST_DATA");
  return std::filesystem::path(data != nullptr ? data : "") / name;
}

/// @return faults named
int expect_named(const std::string& name, const std::set<std::string>* expected_names) {
  const io::Dataset healthy = io::read_dataset(recording_at(name));
  const Findings fine = check_it(healthy);
  EXPECT_EQ(worst(fine), Verdict::kOk) << name << "\n" << text_of(fine);
  int named = 0;
  for (const Fault& fault : faults()) {
    io::Dataset damaged = healthy;
    fault.make(&damaged);
    const Findings findings = check_it(damaged);
    const bool is_named = check::naming(findings, fault) != nullptr;
    const bool expected = expected_names == nullptr || expected_names->count(fault.name) > 0;
    EXPECT_EQ(is_named, expected) << name << ", " << fault.name << "\n" << text_of(findings);
    EXPECT_TRUE(expected || worst(findings) == Verdict::kOk) << name << ", " << fault.name << "\n"
                                                             << text_of(findings);
    named += is_named ? 1 : 0;
  }
  return named;
}

TEST(CheckOfARealRecording, NamesTheFaultsItsMotionTells) {
  if (!std::filesystem::exists(recording_at("ti_demo/imu0"))) {
    GTEST_SKIP() << "needs RIO_TEST_DATA, a folder with the recording ti_demo";
  }
  measured("ti_demo: faults named", expect_named("ti_demo", nullptr),
           std::to_string(faults().size()));
}

TEST(CheckOfARealRecording, AStepOfAClockIsFound) {
  if (!std::filesystem::exists(recording_at("ti_demo/imu0"))) {
    GTEST_SKIP() << "needs RIO_TEST_DATA, a folder with the recording ti_demo";
  }
  const io::Dataset healthy = io::read_dataset(recording_at("ti_demo"));
  for (const double step : {0.2, 0.3}) {
    for (const double part : {0.5, 0.7}) {
      io::Dataset radar = healthy;
      for (std::size_t i = 0; i < radar.scans.size(); ++i) {
        const bool after = static_cast<double>(i) > part * static_cast<double>(radar.scans.size());
        if (after) radar.scans[i].time += from_seconds(step);
      }
      io::Dataset imu = healthy;
      for (std::size_t i = 0; i < imu.imu.size(); ++i) {
        const bool after = static_cast<double>(i) > part * static_cast<double>(imu.imu.size());
        if (after) imu.imu[i].time += from_seconds(step);
      }
      SCOPED_TRACE(testing::Message() << step << " s after " << part);
      expect(said(radar, "delay of the radar"), Verdict::kWrong, "a clock steps", "split");
      expect(said(imu, "delay of the radar"), Verdict::kWrong, "a clock steps", "split");
    }
  }
}

TEST(CheckOfARealRecording, APoorRadarTellsUnitsAndTheSignOfItsDoppler) {
  if (!std::filesystem::exists(recording_at("kart/driveAround1_A"))) {
    GTEST_SKIP() << "needs RIO_TEST_DATA, a folder with the recordings of the kart";
  }
  for (const char* name : {"kart/driveAround1_A", "kart/outside4_B"}) {
    measured(std::string(name) + ": faults named", expect_named(name, &kToldWithoutMotion),
             std::to_string(kToldWithoutMotion.size()));
  }
}

TEST(CheckOfARealRecording, WindowsOfSecondsTellTheMountingWithSixPointsAScan) {
  if (!std::filesystem::exists(recording_at("kart/labDriveAround1_A"))) {
    GTEST_SKIP() << "needs RIO_TEST_DATA, a folder with the recordings of the kart";
  }
  const std::set<std::string> told = {"MountingTurned90AboutTheBody",
                                      "MountingTurned180AboutTheBody", "MountingUpsideDown",
                                      "AxesOfTheChip", "ImuInForwardRightDown"};
  for (const char* name : {"kart/labDriveAround1_A", "kart/labDriveAround3_B"}) {
    const io::Dataset healthy = io::read_dataset(recording_at(name));
    EXPECT_EQ(worst(check_it(healthy)), Verdict::kOk) << name << "\n" << text_of(check_it(healthy));
    for (const Fault& fault : faults()) {
      if (told.count(fault.name) == 0) continue;
      io::Dataset damaged = healthy;
      fault.make(&damaged);
      const Findings findings = check_it(damaged);
      EXPECT_NE(check::naming(findings, fault), nullptr) << name << ", " << fault.name << "\n"
                                                         << text_of(findings);
    }
  }
}

}  // namespace
}  // namespace rio::test
