// SPDX-License-Identifier: BSD-3-Clause
// Every fault put into a simulated flight is named, with what to change; flights without one have
// nothing wrong.
#include "check/check.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <string>

#include "check/check_it.hpp"
#include "check/imu_check.hpp"
#include "rio/core/so3.hpp"
#include "rio/sim/catalogue.hpp"
#include "support/measured.hpp"
#include "support/temp_dir.hpp"

namespace rio::test {
namespace {

struct FaultyFlight {
  const char* name;
  double length;  ///< [m]; the delay of a frame needs a minute of changing speed
};

class NamesTheFault : public testing::TestWithParam<FaultyFlight> {};

TEST_P(NamesTheFault, AndNothingIsWrongWithoutIt) {
  const io::Dataset healthy = flown(GetParam().name, GetParam().length);
  expect_ok(healthy);
  int named = 0;
  for (const Fault& fault : faults()) {
    SCOPED_TRACE(fault.name);
    const Finding finding = said(check_it_with(fault, healthy), fault.subject);
    expect(finding, Verdict::kWrong, fault.text, fault.change);
    named += finding.verdict == Verdict::kWrong ? 1 : 0;
  }
  measured(std::string(GetParam().name) + ": faults named", named, std::to_string(faults().size()));
}

INSTANTIATE_TEST_SUITE_P(Flights, NamesTheFault,
                         testing::Values(FaultyFlight{"indoor-1", 50.0},
                                         FaultyFlight{"aggressive", 120.0}),
                         [](const auto& p) { return p.index == 0 ? "Indoor" : "Aggressive"; });

TEST(Check, EveryFlightOfTheCatalogueIsOkUnlessTheRadarIsSilentForLong) {
  for (const sim::CatalogueEntry& entry : sim::catalogue()) {
    const Findings findings = check_it(flown(entry.name, 40.0));
    for (const Finding& f : findings) {
      const bool silent = std::string(entry.name) == "dropout" && f.subject == "radar stamps";
      EXPECT_EQ(f.verdict, silent ? Verdict::kDoubtful : Verdict::kOk) << entry.name << "\n"
                                                                       << text_of(findings);
    }
    if (std::string(entry.name) == "hover") {
      EXPECT_PRED2(contains, said(findings, "axes and Doppler sign").text,
                   "the motion does not tell");
    }
  }
}

/// The one that is not ok.
Finding only_fault(const Findings& findings) {
  Findings bad = findings;
  std::erase_if(bad, [](const Finding& f) { return f.verdict == Verdict::kOk; });
  EXPECT_EQ(bad.size(), 1U) << text_of(findings);
  return bad.empty() ? Finding{} : bad.front();
}

TEST(Check, AStampFarInTheFutureCostsItsOwnRow) {
  const io::Dataset healthy = flown("indoor-1", 40.0);
  const std::size_t n = healthy.imu.size();
  for (const std::size_t row : {std::size_t{0}, n / 2, n - 1}) {
    io::Dataset dataset = healthy;
    dataset.imu[row].time += from_seconds(1e9);
    EXPECT_EQ(check::Usable(dataset.imu).good().size(), n - 1);
    const TempDir dir;
    io::write_dataset(dir.path(), dataset);
    const std::string csv = (dir.path() / "imu0/data.csv").string();
    const Finding finding = only_fault(check_it(dataset, Source::kFolder, dir.path()));
    EXPECT_EQ(finding.subject, "imu stamps");
    expect(finding, Verdict::kDoubtful, ", 1 out of order");
    EXPECT_EQ(finding.change, "remove the line " + csv + ":" + std::to_string(row + 2));
  }
}

TEST(Check, ACorruptStampOfTheRadarIsNamedWithItsLine) {
  io::Dataset dataset = flown("indoor-1", 40.0);
  const std::size_t scan = dataset.scans.size() / 2;
  std::size_t line = 2;  // below the heading
  for (std::size_t i = 0; i < scan; ++i) {
    line += std::max<std::size_t>(1, dataset.scans[i].detections.size());
  }
  for (const double jump : {1e9, -20.0}) {
    const TempDir dir;
    io::write_dataset(dir.path(), dataset);
    std::ifstream in(dir.path() / "radar0/data.csv");
    std::string text;
    std::size_t number = 1;
    for (std::string row; std::getline(in, row); ++number) {
      const std::size_t comma = row.find(',');
      if (number == line) {
        const Time stamp = dataset.scans[scan].time + from_seconds(jump);
        row = std::to_string(stamp.count()) + row.substr(comma);
      }
      text += row + "\n";
    }
    const auto csv = dir.write("radar0/data.csv", text);
    const io::Dataset corrupt = io::read_dataset(dir.path());
    const Finding finding = only_fault(check_it(corrupt, Source::kFolder, dir.path()));
    EXPECT_EQ(finding.subject, "radar stamps");
    EXPECT_PRED2(contains, finding.change, "; see " + csv.string() + ":" + std::to_string(line));
  }
}

TEST(Check, EveryRadarIsNamed) {
  io::Dataset dataset = flown("indoor-1", 60.0);
  const io::Dataset healthy = dataset;
  for (int r = 1; r <= 2; ++r) dataset.other_radars.push_back({healthy.scans, healthy.radar_info});
  const Findings fine = check_it(dataset, Source::kFolder);
  EXPECT_NE(worst(fine), Verdict::kWrong) << text_of(fine);
  EXPECT_NE(find(fine, "radar1: axes and Doppler sign"), nullptr) << text_of(fine);
  for (RadarScan& scan : dataset.other_radars[0].scans) {
    for (RadarDetection& d : scan.detections) d.range_rate = -d.range_rate;
  }
  Quaternion& turned = dataset.other_radars[1].info.T_BS->rotation;
  turned = quaternion_exp(Vector3d(0.0, 0.0, 0.5 * kHalfTurn)) * turned;
  const Findings findings = check_it(dataset, Source::kFolder);
  const auto is_wrong = [](const Finding& f) { return f.verdict == Verdict::kWrong; };
  EXPECT_EQ(std::count_if(findings.begin(), findings.end(), is_wrong), 3) << text_of(findings);
  expect(said(findings, "radar1: Doppler by the ranges"), Verdict::kWrong, "");
  EXPECT_EQ(said(findings, "radar1: axes and Doppler sign").change,
            "negate the column doppler of radar1/data.csv");
  const std::string line = said(findings, "radar2: axes and Doppler sign").change;
  EXPECT_TRUE(line.starts_with("radar2/sensor.yaml: T_BS: {translation: [")) << line;
  EXPECT_LT(mounting_in(line).angularDistance(healthy.radar_info.T_BS->rotation), 0.02);
  // an option of a bag is for all radars
  dataset.other_radars.pop_back();
  const char* const subject = "radar1: axes and Doppler sign";
  EXPECT_TRUE(said(dataset, subject).change.starts_with("if it is radar1 alone: `rio convert`"));
  dataset.scans = dataset.other_radars[0].scans;
  EXPECT_TRUE(said(dataset, subject).change.starts_with("--approaching"));
}

TEST(Check, MuchMotionThatNoMountingExplainsIsDoubtful) {
  const Quaternion turn = quaternion_exp(Vector3d(0.8, -0.4, 0.3));
  expect_said({{of_samples([=](ImuSample& s) { s.gyro_B = turn * s.gyro_B; }),
                "axes and Doppler sign", Verdict::kDoubtful, "no mounting explains it"}});
}

/// The verdicts that points over time have given, by their subjects.
std::string said_by_points(const Findings& findings) {
  std::string text;
  for (const char* subject : {"Doppler by the ranges", "gyro unit by the points"}) {
    const Finding* said = find(findings, subject);
    if (said != nullptr && said->verdict != Verdict::kOk) text += said->change + ";";
  }
  return text;
}

TEST(Check, AFewNoisyPointsTellTheSignOfTheDopplerAndTheUnits) {
  const io::Dataset healthy =
      flown("rough-ground", 40.0);  // five points, motion that does not tell
  expect_ok(healthy);
  int named = 0;
  for (const Fault& fault : faults()) {
    const Findings findings = check_it_with(fault, healthy);
    const bool expected = *fault.also != '\0';  // the gyro's unit the IMU may tell by itself
    EXPECT_TRUE(!expected || check::naming(findings, fault) != nullptr) << text_of(findings);
    EXPECT_TRUE(expected || said_by_points(findings).empty()) << text_of(findings);
    named += expected ? 1 : 0;
  }
  measured("rough-ground: faults told by points over time", named, "3");
}

TEST(Check, SignAndUnitOfTheDopplerTogether) {
  io::Dataset dataset = flown("rough-ground", 40.0);
  each_detection(&dataset, [](RadarDetection& d) { d.range_rate *= -3.6; });
  expect(said(dataset, "Doppler by the ranges"), Verdict::kWrong,
         "the Doppler has the wrong sign and the Doppler is in km/h",
         "--approaching (without it, if it is given), and --field");
}

TEST(Check, GapsAreJudgedByWhatTheyCost) {
  const io::Dataset healthy = flown("indoor-1", 40.0);
  const auto with_gap = [&healthy](auto io::Dataset::*items, double length, const char* subject) {
    io::Dataset dataset = healthy;
    const Time begin = (dataset.*items).front().time + from_seconds(20.0);
    const Time end = begin + from_seconds(length);
    std::erase_if(dataset.*items,
                  [&](const auto& item) { return item.time > begin && item.time < end; });
    return said(dataset, subject);
  };
  expect(with_gap(&io::Dataset::imu, 0.2, "imu stamps"), Verdict::kOk, "bridged at 0.0");
  expect(with_gap(&io::Dataset::imu, 3.0, "imu stamps"), Verdict::kDoubtful, "");
  expect(with_gap(&io::Dataset::scans, 2.0, "radar stamps"), Verdict::kOk, "");
  expect(with_gap(&io::Dataset::scans, 5.0, "radar stamps"), Verdict::kDoubtful,
         "the IMU alone may run away by 0.9 m/s");
}

TEST(Check, AVelocityNowAndThenIsEnoughOneInTwoSecondsIsNot) {
  const io::Dataset healthy = flown("indoor-1", 40.0);
  const auto points = [&healthy](std::size_t of, std::size_t with) {
    io::Dataset dataset = healthy;
    for (std::size_t i = 0; i < dataset.scans.size(); ++i) {
      std::vector<RadarDetection>& detections = dataset.scans[i].detections;
      if (i % of >= with) detections.resize(std::min<std::size_t>(1, detections.size()));
    }
    return said(dataset, "points");
  };
  expect(points(15, 5), Verdict::kOk, "");
  expect(points(90, 5), Verdict::kDoubtful, "");
}

/// Every twentieth.
template <class Item>
void thin_out(std::vector<Item>* items) {
  for (std::size_t i = 0; 20 * i < items->size(); ++i) (*items)[i] = (*items)[20 * i];
  items->resize((items->size() + 19) / 20);
}

// An IMU at 10 Hz is slow, a radar at 1 Hz, too; the units are as before.
TEST(Check, ALowRateIsNoWrongUnit) {
  const io::Dataset healthy = flown("indoor-1", 60.0);
  io::Dataset slow = healthy;
  thin_out(&slow.imu);
  expect(said(slow, "accelerometer unit"), Verdict::kOk, "");
  expect(said(slow, "gyro unit"), Verdict::kOk, "");
  slow = healthy;
  thin_out(&slow.scans);
  expect_change(slow, "points", "scans a second");
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
