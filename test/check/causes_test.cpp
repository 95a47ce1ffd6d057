// SPDX-License-Identifier: BSD-3-Clause
// Faults of recordings with a cause that another one resembles: the right one is named, with what
// to paste.
#include <gtest/gtest.h>

#include <cmath>

#include "check/check_it.hpp"
#include "check/flown.hpp"
#include "check/motion.hpp"
#include "support/temp_dir.hpp"

namespace rio::test {
namespace {

const io::Dataset& flight() {
  static const io::Dataset kFlight = flown("indoor-1", 50.0);
  return kFlight;
}

/// The finding with this subject; one that is empty if there is none.
Finding said(const io::Dataset& dataset, const std::string& subject, Source source = Source::kBag) {
  const Findings findings = check_it(dataset, source);
  const Finding* found = find(findings, subject);
  EXPECT_NE(found, nullptr) << text_of(findings);
  return found == nullptr ? Finding{} : *found;
}

TEST(Causes, AStartThatIsLateOrNeverComesNamesMaxWait) {
  const Finding fine = said(flight(), "start");
  EXPECT_EQ(fine.verdict, Verdict::kOk) << fine.text;
  io::Dataset moving = flight();
  moving.imu.erase(moving.imu.begin(), moving.imu.begin() + 2000);
  const Time begin = moving.imu.front().time;
  std::erase_if(moving.scans, [begin](const RadarScan& s) { return s.time < begin; });
  const Finding late = said(moving, "start");  // at rest in the end
  EXPECT_EQ(late.verdict, Verdict::kDoubtful) << late.text;
  EXPECT_PRED2(contains, late.text, " scans are before it, and dropped");
  EXPECT_EQ(late.change.rfind("start: {max_wait: 3}", 0), 0U) << late.change;
  Options options;
  io::apply_sensor_info(moving, &options);
  options.start.max_wait = 3.0;
  const Findings waited = check::check_recording(moving, options, Source::kBag);
  EXPECT_EQ(find(waited, "start")->verdict, Verdict::kOk);
  moving.imu.resize(moving.imu.size() - 2000);
  const Finding none = said(moving, "start");
  EXPECT_EQ(none.verdict, Verdict::kDoubtful) << none.text;
  EXPECT_PRED2(contains, none.text, "no standstill of 1.5 s");
  EXPECT_EQ(none.change, late.change);
}

TEST(Causes, GravityThatWasRemovedIsNoUnit) {
  io::Dataset dataset = flight();
  const Vector3d at_rest = dataset.imu[100].accel_B;
  for (ImuSample& s : dataset.imu) s.accel_B -= at_rest;
  const Finding finding = said(dataset, "accelerometer unit");
  EXPECT_EQ(finding.verdict, Verdict::kWrong);
  EXPECT_PRED2(contains, finding.text, "gravity was removed");
  EXPECT_PRED2(contains, finding.change, "raw accelerometer");
}

TEST(Causes, ExchangedColumnsAreOneFault) {
  io::Dataset dataset = flight();
  for (ImuSample& s : dataset.imu) std::swap(s.gyro_B, s.accel_B);
  const Findings findings = check_it(dataset);
  for (const Finding& f : findings) {
    EXPECT_EQ(f.verdict, f.subject == "accelerometer unit" ? Verdict::kWrong : Verdict::kOk)
        << text_of(findings);
  }
}

TEST(Causes, StampsInAnotherUnitAreTheOnlyFinding) {
  io::Dataset dataset = flight();
  for (ImuSample& s : dataset.imu) s.time /= 1000;
  for (RadarScan& s : dataset.scans) s.time /= 1000;
  EXPECT_EQ(check_it(dataset).size(), 1U) << text_of(check_it(dataset));
}

TEST(Causes, TheRateOfStampsOnAGridIsThatOfTheRadar) {
  io::Dataset dataset = flight();
  std::size_t lost = 0;
  for (std::size_t i = 0; i < dataset.scans.size(); ++i) {
    if (i % 5 == 0) ++lost;  // lost scans do not count
    const auto tick = static_cast<std::int64_t>(std::floor(static_cast<double>(i + lost) / 0.3));
    dataset.scans[i].time = dataset.imu.front().time + tick * Time(10'000'000);
  }
  dataset.radar_info.rate_hz = 30.0;
  const Finding finding = said(dataset, "radar stamps", Source::kFolder);
  EXPECT_PRED2(contains, finding.text, "(30.0 Hz)");
  EXPECT_EQ(finding.verdict, Verdict::kOk) << finding.text << finding.change;
  dataset.radar_info.rate_hz = 20.0;
  EXPECT_EQ(said(dataset, "radar stamps", Source::kFolder).change,
            "radar0/sensor.yaml: rate_hz: 30.0");
  EXPECT_EQ(said(dataset, "radar stamps").change, "");  // a bag has no such file
}

TEST(Causes, AnSnrThatIsNoDecibelsIsNotAWeakRadar) {
  for (const auto& [scale, factor] : {std::pair(10.0, "0.1"), std::pair(100.0, "0.01")}) {
    io::Dataset dataset = flight();
    for (RadarScan& scan : dataset.scans) {
      for (RadarDetection& d : scan.detections) d.snr_db *= scale;
    }
    EXPECT_EQ(said(dataset, "points").change, std::string("--field snr=NAME*") + factor);
    dataset.radar_info.fields = {{"snr", "power*0.5"}};
    const std::string half = scale == 10.0 ? "0.05" : "0.005";
    EXPECT_EQ(said(dataset, "points").change, "--field snr=power*" + half);
    const Finding finding = said(dataset, "points", Source::kFolder);
    EXPECT_EQ(finding.verdict, Verdict::kWrong);
    EXPECT_EQ(finding.change,
              std::string("multiply the column snr of radar0/data.csv by ") + factor);
  }
}

TEST(Causes, ADopplerWithoutTheMotionOfTheVehicleIsNamed) {
  io::Dataset dataset = flight();
  // by the velocity that most points of the scan agree on
  Options options;
  io::apply_sensor_info(dataset, &options);
  std::size_t k = 0;
  const std::vector<check::RadarSpeed> speeds =
      check::radar_speeds(check::Scans(dataset.scans), options);
  for (RadarScan& scan : dataset.scans) {
    while (k + 1 < speeds.size() && speeds[k].time < scan.time) ++k;
    for (RadarDetection& d : scan.detections) {
      d.range_rate += d.point_S.normalized().dot(speeds[k].v_S);
    }
  }
  const Finding finding = said(dataset, "axes and Doppler sign");
  EXPECT_EQ(finding.verdict, Verdict::kWrong) << finding.text;
  EXPECT_PRED2(contains, finding.text, "the Doppler does not show the motion of the radar");
  EXPECT_PRED2(contains, finding.change, "the driver subtracts the motion of the vehicle");
}

TEST(Causes, MovingTracksAreNoHighThreshold) {
  io::Dataset dataset = flight();
  std::size_t i = 0;
  for (RadarScan& scan : dataset.scans) {
    for (RadarDetection& d : scan.detections) {
      if (++i % 7 != 0) d.range_rate = 1.4 * std::sin(1.7 * static_cast<double>(i));
    }
  }
  const Finding finding = said(dataset, "points");
  EXPECT_EQ(finding.verdict, Verdict::kDoubtful) << finding.text;
  EXPECT_PRED2(contains, finding.change, "most points move");
}

TEST(Causes, AClockThatGoesBackIsNotTwoPublishers) {
  io::Dataset dataset = flight();
  const Time half = dataset.imu[dataset.imu.size() / 2].time;
  for (ImuSample& s : dataset.imu) s.time -= s.time > half ? from_seconds(9.0) : Time(0);
  for (RadarScan& s : dataset.scans) s.time -= s.time > half ? from_seconds(9.0) : Time(0);
  for (const char* subject : {"imu stamps", "radar stamps"}) {
    const Finding finding = said(dataset, subject, Source::kFolder);
    EXPECT_EQ(finding.verdict, Verdict::kDoubtful);
    EXPECT_PRED2(contains, finding.text, "the clock goes back once, first by 9 s");
    EXPECT_PRED2(contains, finding.change, "split the recording there");
  }
}

TEST(Causes, ScansOutOfOrderAreNotRepeated) {
  io::Dataset dataset = flight();
  for (std::size_t i = 10; i + 1 < dataset.scans.size(); i += 10) {
    std::swap(dataset.scans[i], dataset.scans[i + 1]);
  }
  EXPECT_PRED2(contains, said(dataset, "radar stamps").change, "put the scans in the order");
  dataset = flight();
  dataset.scans[20].time = dataset.scans[19].time;
  EXPECT_PRED2(contains, said(dataset, "radar stamps").change, "a stamp of its own");
}

TEST(Causes, ADelayHasOneProposal) {
  io::Dataset dataset = flight();
  for (RadarScan& scan : dataset.scans) scan.time += from_seconds(0.066);
  const Finding finding = said(dataset, "delay of the radar");
  EXPECT_EQ(finding.change.rfind("radar: {time_offset: 0.0", 0), 0U) << finding.change;
  EXPECT_EQ(finding.change.find("--radar-offset"), std::string::npos) << finding.change;
}

TEST(Causes, PointsInOtherKnownAxesNeedNoMounting) {
  io::Dataset dataset = flight();
  for (RadarScan& scan :
       dataset.scans) {  // forward left up, read as if they were those of the chip
    for (RadarDetection& d : scan.detections) {
      d.point_S = Vector3d(d.point_S.y(), -d.point_S.x(), d.point_S.z());
    }
  }
  dataset.radar_info.axes = "ti";
  EXPECT_EQ(said(dataset, "axes and Doppler sign").change, "--axes flu");
  dataset.radar_info.axes = "";
  EXPECT_PRED2(contains, said(dataset, "axes and Doppler sign").change, "T_BS");
}

}  // namespace
}  // namespace rio::test
