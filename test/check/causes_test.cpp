// SPDX-License-Identifier: BSD-3-Clause
// Faults of recordings with a cause that another one resembles: the right one is named, with what
// to paste.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "check/check_it.hpp"
#include "check/flown.hpp"
#include "check/motion.hpp"
#include "check/points_check.hpp"
#include "rio/core/so3.hpp"
#include "support/temp_dir.hpp"

namespace rio::test {
namespace {

const io::Dataset& flight() {
  static const io::Dataset kFlight = flown("indoor-1", 50.0);
  return kFlight;
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
  expect(said(dataset, "accelerometer unit"), Verdict::kWrong, "gravity was removed",
         "raw accelerometer");
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
  for (const auto& [divisor, unit] : {std::pair(1000, "us"), std::pair(1000000, "ms")}) {
    io::Dataset dataset = flight();
    for (ImuSample& s : dataset.imu) s.time /= divisor;
    for (RadarScan& s : dataset.scans) s.time /= divisor;
    EXPECT_EQ(check_it(dataset).size(), 1U) << text_of(check_it(dataset));
    expect(said(dataset, "imu stamps"), Verdict::kWrong, std::string("the stamps are in ") + unit,
           "by " + std::to_string(divisor) + ":");
  }
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
    each_detection(&dataset, [k = scale](RadarDetection* d) { d->snr_db *= k; });
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
  expect(said(dataset, "axes and Doppler sign"), Verdict::kWrong,
         "the Doppler does not show the motion of the radar",
         "the driver subtracts the motion of the vehicle");
}

TEST(Causes, MovingTracksAreNoHighThreshold) {
  io::Dataset dataset = flight();
  std::size_t i = 0;
  each_detection(&dataset, [&i](RadarDetection* d) {
    if (++i % 7 != 0) d->range_rate = 1.4 * std::sin(1.7 * static_cast<double>(i));
  });
  expect(said(dataset, "points"), Verdict::kDoubtful, "", "most points move");
}

TEST(Causes, AClockThatGoesBackIsNotTwoPublishers) {
  io::Dataset dataset = flight();
  const Time half = dataset.imu[dataset.imu.size() / 2].time;
  for (ImuSample& s : dataset.imu) s.time -= s.time > half ? from_seconds(9.0) : Time(0);
  for (RadarScan& s : dataset.scans) s.time -= s.time > half ? from_seconds(9.0) : Time(0);
  for (const char* subject : {"imu stamps", "radar stamps"}) {
    expect(said(dataset, subject, Source::kFolder), Verdict::kDoubtful,
           "the clock goes back once, first by 9 s", "split the recording there");
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
  delay_scans(&dataset, 0.066);
  const Finding finding = said(dataset, "delay of the radar");
  EXPECT_EQ(finding.change.rfind("radar: {time_offset: 0.0", 0), 0U) << finding.change;
  EXPECT_EQ(finding.change.find("--radar-offset"), std::string::npos) << finding.change;
}

TEST(Causes, PointsInOtherKnownAxesNeedNoMounting) {
  io::Dataset dataset = flight();
  // forward left up, read as if they were those of the chip
  each_detection(&dataset, [](RadarDetection* d) {
    d->point_S = Vector3d(d->point_S.y(), -d->point_S.x(), d->point_S.z());
  });
  dataset.radar_info.axes = "ti";
  EXPECT_EQ(said(dataset, "axes and Doppler sign").change, "--axes flu");
  dataset.radar_info.axes = "";
  EXPECT_PRED2(contains, said(dataset, "axes and Doppler sign").change, "T_BS");
}

/// A minute at rest with this bias of the gyro about x, in front of walls and a walking person.
io::Dataset standing(double bias) {
  io::Dataset out;
  out.radar_info = flight().radar_info;
  for (int k = 0; k < 12000; ++k) {
    const double wave = 0.02 * std::sin(2.4 * k);
    out.imu.push_back({Time(1'000'000'000LL + 5'000'000LL * k),
                       {bias + 0.01 * wave, 0.01 * wave, 0.01 * wave},
                       {wave, wave, 9.81 + wave}});
  }
  for (int k = 0; k < 900; ++k) {
    RadarScan scan;
    scan.time = Time(1'000'000'000LL + 66'666'667LL * k);
    const double walked = std::sin(0.04 * k);
    for (int i = 0; i < 18; ++i) {
      const bool person = i > 11;
      const double noise = 0.03 * std::sin(7.1 * k * (i + 1));
      RadarDetection d;
      d.point_S = Vector3d(4.0 + noise, 0.5 * i - 3.0, 0.2 * (i % 5) - 0.4);
      if (person) d.point_S = Vector3d(3.0 + 2.0 * walked, 0.5 + noise, noise);
      d.range_rate = person ? 1.2 * std::cos(0.04 * k) + noise : 0.0;
      d.snr_db = 20.0;
      scan.detections.push_back(d);
    }
    out.scans.push_back(scan);
  }
  return out;
}

TEST(Causes, AStandingVehicleHasNoMotionToShow) {
  io::Dataset dataset = standing(0.0175);
  EXPECT_EQ(worst(check_it(dataset)), Verdict::kOk) << text_of(check_it(dataset));
  const auto make_zero = [](RadarDetection* d) { d->range_rate = 0.0; };
  each_detection(&dataset, make_zero);
  EXPECT_EQ(worst(check_it(dataset)), Verdict::kOk) << text_of(check_it(dataset));
  dataset = flight();
  each_detection(&dataset, make_zero);
  EXPECT_PRED2(contains, said(dataset, "Doppler").change, "--field doppler=NAME");
}

TEST(Causes, ADopplerOffByOneBinShowsAtRest) {
  io::Dataset dataset = flight();
  const double bin = *dataset.radar_info.doppler_resolution;
  each_detection(&dataset, [&](RadarDetection* d) { d->range_rate += bin; });
  expect(said(dataset, "Doppler"), Verdict::kWrong, "off by +1.0 steps of its grid");
}

TEST(Causes, AnUnknownMountingIsNotJudged) {
  io::Dataset dataset = flight();
  const Matrix3d quarter = quaternion_exp(Vector3d(0.0, 0.0, -0.5 * kHalfTurn)).toRotationMatrix();
  const Matrix3d turn = quarter * dataset.radar_info.T_BS->rotation.toRotationMatrix();
  each_detection(&dataset, [&](RadarDetection* d) { d->point_S = turn * d->point_S; });
  dataset.radar_info.T_BS.reset();
  EXPECT_EQ(said(dataset, "axes and Doppler sign").verdict, Verdict::kWrong);
  dataset.radar_info.prior_rotation = kHalfTurn;
  const Finding finding = said(dataset, "axes and Doppler sign");
  EXPECT_EQ(finding.verdict, Verdict::kOk) << finding.text;
  EXPECT_PRED2(contains, finding.text, "the mounting is unknown: it is found in flight");
  EXPECT_PRED2(contains, finding.text, "turned by 90 deg about the z axis of the body");
  each_detection(&dataset, [&](RadarDetection* d) { d->range_rate = -d->range_rate; });
  EXPECT_EQ(said(dataset, "axes and Doppler sign").verdict, Verdict::kWrong);
}

TEST(Causes, SignsOfTheGyroAreNoDelay) {
  for (const auto& [signs, text] : {std::pair(Vector3d(-1, -1, -1), "negate all axes of the gyro"),
                                    std::pair(Vector3d(1, 1, -1), "negate z of the gyro"),
                                    std::pair(Vector3d(1, -1, -1), "negate y and z of the gyro")}) {
    io::Dataset dataset = flight();
    for (ImuSample& s : dataset.imu) s.gyro_B = s.gyro_B.cwiseProduct(signs);
    EXPECT_PRED2(contains, said(dataset, "axes of the IMU").change, text);
    EXPECT_EQ(find(check_it(dataset), "delay of the radar"), nullptr);
  }
}

TEST(Causes, AnInvertedAccelerometerIsNoSignOfTheDoppler) {
  io::Dataset dataset = flight();
  for (ImuSample& s : dataset.imu) s.accel_B = -s.accel_B;
  expect(said(dataset, "axes and Doppler sign"), Verdict::kWrong, "",
         "the accelerometer has the wrong sign");
}

// Too few blocks for a test of the votes; many pairs are a hint.
TEST(Causes, AFewSecondsOfRangesAgainstTheDopplerAreDoubtful) {
  const auto approaching = [](double doppler) {
    std::vector<RadarScan> scans;
    for (int k = 0; k < 150; ++k) {
      RadarScan scan;
      scan.time = Time(66'666'667LL * k);
      for (int i = 0; i < 8; ++i) {
        RadarDetection d;
        d.point_S = (15.0 + 0.7 * i - 66.7e-3 * k) * Vector3d(1.0, 0.2 * i - 0.7, 0.0).normalized();
        d.range_rate = doppler;
        scan.detections.push_back(d);
      }
      scans.push_back(scan);
    }
    return check::check_ranges(check::Scans(scans), Options{}, {});
  };
  EXPECT_EQ(approaching(-1.0).finding.verdict, Verdict::kOk);
  EXPECT_EQ(approaching(-1.0).sign, check::DopplerSign::kAsConfigured);
  const check::RangeCheck against = approaching(1.0);
  EXPECT_EQ(against.finding.verdict, Verdict::kDoubtful) << against.finding.text;
  EXPECT_EQ(against.sign, check::DopplerSign::kUnknown);
}

TEST(Causes, AnotherRangeOfTheGyroIsNamed) {
  for (const auto& [factor, text] : {std::pair(0.25, "by 4:"), std::pair(0.5, "by 2:"),
                                     std::pair(2.0, "by 0.5:"), std::pair(4.0, "by 0.25:")}) {
    io::Dataset dataset = flight();
    for (ImuSample& s : dataset.imu) s.gyro_B *= factor;
    expect(said(dataset, "gyro unit by the radar"), Verdict::kWrong, "", text);
  }
  for (const auto& [factor, unit] : {std::pair(1e3, "in mrad/s"), std::pair(5.73e4, "in mdeg/s")}) {
    io::Dataset dataset = flight();
    for (ImuSample& s : dataset.imu) s.gyro_B *= factor;
    EXPECT_PRED2(contains, said(dataset, "gyro unit").text, unit);
  }
}

TEST(Causes, ALeverArmInMillimetresIsDoubtful) {
  io::Dataset dataset = flight();
  EXPECT_EQ(find(check_it(dataset), "lever arm"), nullptr);
  dataset.radar_info.T_BS->translation = Vector3d(100.0, 0.0, -50.0);
  EXPECT_PRED2(contains, said(dataset, "lever arm").change, "in mm or cm?");
}

TEST(Causes, APeriodBetweenOneAndTwoStepsOfItsGridLosesNothing) {
  io::Dataset dataset = flight();
  const auto cut = [](std::size_t i, double hz, double step) {
    return from_seconds(step * std::floor(static_cast<double>(i) / hz / step + 1e-9));
  };
  for (std::size_t i = 0; i < dataset.scans.size(); ++i) {
    dataset.scans[i].time = Time(1'000'000'000) + cut(i, 15.0, 0.05);
  }
  for (std::size_t i = 0; i < dataset.imu.size(); ++i) {
    dataset.imu[i].time = Time(1'000'000'000) + cut(i, 700.0, 0.001);
  }
  EXPECT_PRED2(contains, said(dataset, "radar stamps").text, "(15.0 Hz)");
  EXPECT_PRED2(contains, said(dataset, "imu stamps").text, "(700 Hz), 0.0 % lost");
  dataset.imu_info.rate_hz = 1000.0;  // unless the sensor is known to be faster
  EXPECT_PRED2(contains, said(dataset, "imu stamps", Source::kFolder).text, "(1000 Hz), 30.0 %");
}

TEST(Causes, AnAccelerometerOffAtRestIsNoMissingRest) {
  io::Dataset dataset = flight();
  for (ImuSample& s : dataset.imu) s.accel_B *= 1.06;
  EXPECT_PRED2(contains, said(dataset, "accelerometer unit").change, "scale or bias is off");
  EXPECT_PRED2(contains, said(dataset, "start").text, "too far off gravity");
}

TEST(Causes, PointsOfAScanShareItsStamp) {
  io::Dataset dataset = flight();
  dataset.scans.clear();
  for (const RadarScan& scan : flight().scans) {
    for (std::size_t i = 0; i < scan.detections.size(); ++i) {
      RadarScan one;
      one.time = scan.time + Time(1000 * static_cast<std::int64_t>(i));
      one.detections = {scan.detections[i]};
      dataset.scans.push_back(one);
    }
  }
  expect(said(dataset, "radar stamps"), Verdict::kWrong, "",
         "all points of a scan must share its stamp");
  EXPECT_EQ(find(check_it(dataset), "points"), nullptr);
}

TEST(Causes, StampsOfTheRadarInMicrosecondsNeedNoOffset) {
  io::Dataset dataset = flight();
  for (ImuSample& s : dataset.imu) s.time += from_seconds(1.7e9);
  for (RadarScan& s : dataset.scans) s.time = (s.time + from_seconds(1.7e9)) / 1000;
  const Finding finding = said(dataset, "clocks", Source::kFolder);
  EXPECT_PRED2(contains, finding.text, "in us");
  EXPECT_EQ(finding.change, "multiply the stamps of the radar by 1000: they must be in ns");
  EXPECT_EQ(find(check_it(dataset), "radar stamps"), nullptr);  // nor what follows from them
}

}  // namespace
}  // namespace rio::test
