// SPDX-License-Identifier: BSD-3-Clause
// Faults of the IMU and of clocks with a cause that another one resembles: the right one is named,
// with what to paste.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "check/check_it.hpp"
#include "check/clock_steps.hpp"
#include "check/flown.hpp"
#include "support/temp_dir.hpp"

namespace rio::test {
namespace {

/// The flight with other samples of the IMU.
template <class Change>
io::Dataset with_imu(const Change& change) {
  io::Dataset dataset = flight();
  for (ImuSample& s : dataset.imu) change(s);
  return dataset;
}

TEST(ImuCauses, AStartThatIsLateOrNeverComesNamesMaxWait) {
  expect(said(flight(), "start"), Verdict::kOk, "");
  io::Dataset moving = flight();
  moving.imu.erase(moving.imu.begin(), moving.imu.begin() + 2000);
  const Time begin = moving.imu.front().time;
  std::erase_if(moving.scans, [begin](const RadarScan& s) { return s.time < begin; });
  const Finding late = said(moving, "start");  // at rest in the end
  expect(late, Verdict::kDoubtful, " scans are before it, and dropped");
  EXPECT_TRUE(late.change.starts_with("start: {max_wait: 3}")) << late.change;
  Options options;
  io::apply_sensor_info(moving, &options);
  options.start.max_wait = 3.0;
  const Findings waited = check::check_recording(moving, options, Source::kBag);
  EXPECT_EQ(find(waited, "start")->verdict, Verdict::kOk);
  moving.imu.resize(moving.imu.size() - 2000);
  const Finding none = said(moving, "start");
  expect(none, Verdict::kDoubtful, "no standstill of 1.5 s");
  EXPECT_EQ(none.change, late.change);
}

TEST(ImuCauses, GravityThatWasRemovedIsNoUnit) {
  const Vector3d at_rest = flight().imu[100].accel_B;
  const io::Dataset dataset = with_imu([&](ImuSample& s) { s.accel_B -= at_rest; });
  expect(said(dataset, "accelerometer unit"), Verdict::kWrong, "gravity was removed",
         "raw accelerometer");
}

TEST(ImuCauses, ExchangedColumnsAreOneFault) {
  const Findings findings =
      check_it(with_imu([](ImuSample& s) { std::swap(s.gyro_B, s.accel_B); }));
  for (const Finding& f : findings) {
    EXPECT_EQ(f.verdict, f.subject == "accelerometer unit" ? Verdict::kWrong : Verdict::kOk)
        << text_of(findings);
  }
}

TEST(ImuCauses, StampsInAnotherUnitAreTheOnlyFinding) {
  for (const auto& [divisor, unit] : {std::pair(1000, "us"), std::pair(1000000, "ms")}) {
    io::Dataset dataset = flight();
    for (ImuSample& s : dataset.imu) s.time /= divisor;
    for (RadarScan& s : dataset.scans) s.time /= divisor;
    EXPECT_EQ(check_it(dataset).size(), 1U) << text_of(check_it(dataset));
    expect(said(dataset, "imu stamps"), Verdict::kWrong, std::string("the stamps are in ") + unit,
           "by " + std::to_string(divisor) + ":");
  }
}

TEST(ImuCauses, AClockThatGoesBackIsNotTwoPublishers) {
  io::Dataset dataset = flight();
  const Time half = dataset.imu[dataset.imu.size() / 2].time;
  for (ImuSample& s : dataset.imu) s.time -= s.time > half ? from_seconds(9.0) : Time(0);
  for (RadarScan& s : dataset.scans) s.time -= s.time > half ? from_seconds(9.0) : Time(0);
  for (const char* subject : {"imu stamps", "radar stamps"}) {
    expect(said(dataset, subject, Source::kFolder), Verdict::kDoubtful,
           "the clock goes back once, first by 9 s", "split the recording there");
  }
}

TEST(ImuCauses, SignsOfTheGyroAreNoDelay) {
  for (const auto& [signs, text] : {std::pair(Vector3d(-1, -1, -1), "negate all axes of the gyro"),
                                    std::pair(Vector3d(1, 1, -1), "negate z of the gyro"),
                                    std::pair(Vector3d(1, -1, -1), "negate y and z of the gyro")}) {
    const io::Dataset dataset =
        with_imu([k = signs](ImuSample& s) { s.gyro_B = s.gyro_B.cwiseProduct(k).eval(); });
    expect_change(dataset, "axes of the IMU", text);
    EXPECT_EQ(find(check_it(dataset), "delay of the radar"), nullptr);
  }
}

TEST(ImuCauses, AGyroInOtherAxesThanTheAccelerometerIsNoMounting) {
  const std::pair<std::array<int, 3>, const char*> cases[] = {
      {{1, 0, 2}, "take the rates of the gyro in the order (y, x, z)"},
      {{0, 2, 1}, "take the rates of the gyro in the order (x, z, y)"},
      {{2, 0, 1}, "take the rates of the gyro in the order (y, z, x)"}};
  for (const auto& [order, text] : cases) {
    const io::Dataset dataset = with_imu([k = order](ImuSample& s) {
      s.gyro_B = Vector3d(s.gyro_B[k[0]], s.gyro_B[k[1]], s.gyro_B[k[2]]);
    });
    expect_change(dataset, "axes of the IMU", text);
  }
}

TEST(ImuCauses, AnImuInOtherKnownAxesNeedsNoMounting) {
  const auto in_rdf = [](const Vector3d& v) { return Vector3d(-v.y(), -v.z(), v.x()); };
  const io::Dataset dataset = with_imu([&](ImuSample& s) {
    s = {s.time, in_rdf(s.gyro_B), in_rdf(s.accel_B)};
  });
  expect(said(dataset, "axes and Doppler sign"), Verdict::kWrong, "the IMU is in rdf",
         "--imu-axes rdf");
  expect_change(dataset, "axes and Doppler sign", "T_BS", Source::kFolder);  // which has no option
}

TEST(ImuCauses, AnInvertedAccelerometerIsNoSignOfTheDoppler) {
  expect(said(with_imu([](ImuSample& s) { s.accel_B *= -1.0; }), "axes and Doppler sign"),
         Verdict::kWrong, "", "the accelerometer has the wrong sign");
}

TEST(ImuCauses, AnotherRangeOfTheGyroIsNamed) {
  for (const auto& [factor, text] : {std::pair(0.25, "by 4:"), std::pair(0.5, "by 2:"),
                                     std::pair(2.0, "by 0.5:"), std::pair(4.0, "by 0.25:")}) {
    expect(said(with_imu([k = factor](ImuSample& s) { s.gyro_B *= k; }), "gyro unit by the radar"),
           Verdict::kWrong, "", text);
  }
  for (const auto& [factor, unit] :
       {std::pair(1e3, "in mrad/s"), std::pair(5.73e4, "in mdeg/s"), std::pair(9.55, "in rpm"),
        std::pair(573.0, "in 0.1 deg/s"), std::pair(57.3 * 131.0, "of about 131")}) {
    const io::Dataset dataset = with_imu([k = factor](ImuSample& s) { s.gyro_B *= k; });
    EXPECT_PRED2(contains, said(dataset, "gyro unit").text, unit);
  }
}

TEST(ImuCauses, APeriodBetweenOneAndTwoStepsOfItsGridLosesNothing) {
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

TEST(ImuCauses, AnAccelerometerOffAtRestIsNoMissingRest) {
  const io::Dataset dataset = with_imu([](ImuSample& s) { s.accel_B *= 1.06; });
  expect_change(dataset, "accelerometer unit", "scale or bias is off");
  EXPECT_PRED2(contains, said(dataset, "start").text, "too far off gravity");
}

TEST(ImuCauses, StampsOfOneSensorInAnotherUnitAreThoseOfThatSensor) {
  io::Dataset dataset = flight();
  const Time epoch = from_seconds(1.7e9);
  for (RadarScan& s : dataset.scans) s.time += epoch;
  io::Dataset of_imu = dataset;
  for (ImuSample& s : of_imu.imu) s.time = epoch + s.time / 1000;
  EXPECT_EQ(said(of_imu, "imu stamps").change,
            "--imu-clock receive, or multiply the stamps of the IMU by 1000: they must be in ns");
  for (const auto& [divisor, unit] : {std::pair(1000, "in us"), std::pair(1000000, "in ms")}) {
    io::Dataset of_radar = dataset;
    for (ImuSample& s : of_radar.imu) s.time += epoch;
    for (RadarScan& s : of_radar.scans) s.time = epoch + (s.time - epoch) / divisor;
    expect(said(of_radar, "clocks"), Verdict::kWrong, unit, "--radar-clock receive");
    EXPECT_EQ(find(check_it(of_radar), "radar stamps"), nullptr);
  }
}

TEST(ImuCauses, StampsOfTheRadarInMicrosecondsNeedNoOffset) {
  io::Dataset dataset = flight();
  for (ImuSample& s : dataset.imu) s.time += from_seconds(1.7e9);
  for (RadarScan& s : dataset.scans) s.time = (s.time + from_seconds(1.7e9)) / 1000;
  const Finding finding = said(dataset, "clocks", Source::kFolder);
  EXPECT_PRED2(contains, finding.text, "in us");
  EXPECT_EQ(finding.change, "multiply the stamps of the radar by 1000: they must be in ns");
  EXPECT_EQ(find(check_it(dataset), "radar stamps"), nullptr);  // nor what follows from them
}

TEST(ImuCauses, AStepOfItsClockIsFoundToTheSample) {
  for (const double step : {0.15, -0.3, 1.5, -2.0, 40.0}) {
    SCOPED_TRACE(step);
    io::Dataset dataset = flight();
    const std::size_t first = dataset.imu.size() / 3;
    for (std::size_t i = first; i < dataset.imu.size(); ++i) {
      dataset.imu[i].time += from_seconds(step);
    }
    const Findings findings = check_it(dataset);
    const bool back = step < -0.5;
    expect(said(findings, back ? "imu stamps" : "delay of the radar"),
           back ? Verdict::kDoubtful : Verdict::kWrong, fmt::format("from sample {} on", first + 1),
           "`rio replay`, which takes it out");
    EXPECT_EQ(std::ranges::count(findings, Verdict::kWrong, &Finding::verdict), back ? 0 : 1)
        << text_of(findings);
  }
}

/// The steps found where both clocks step in the middle of the flight.
check::ClockSteps steps_of_both(double step) {
  io::Dataset dataset = flight();
  const Time then = dataset.imu[dataset.imu.size() / 2].time;
  const auto move = [&](auto* items) {
    for (auto& item : *items) {
      if (item.time >= then) item.time += from_seconds(step);
    }
  };
  move(&dataset.imu);
  move(&dataset.scans);
  Options options;
  io::apply_sensor_info(dataset, &options);
  return check::find_clock_steps(dataset.imu, {check::Scans(dataset.scans)}, dataset.imu_info,
                                 options);
}

TEST(ImuCauses, ClocksThatGoBackTogetherStep) {
  for (const double step : {-0.3, -20.0, -1.7e9}) {
    SCOPED_TRACE(step);
    const check::ClockSteps steps = steps_of_both(step);
    EXPECT_EQ(steps.imu.size(), 1U);
    EXPECT_EQ(steps.radars[0].size(), 1U);
  }
}

TEST(ImuCauses, ClocksThatGoForwardTogetherMayPause) {
  for (const double step : {0.3, 1.5, 20.0, 7200.0}) {
    SCOPED_TRACE(step);
    const check::ClockSteps steps = steps_of_both(step);
    EXPECT_TRUE(steps.imu.empty());
    EXPECT_TRUE(steps.radars[0].empty());
  }
}

TEST(ImuCauses, APauseIsNoStepOfItsClock) {
  for (const bool of_both : {false, true}) {
    io::Dataset dataset = flight();
    const Time begin = dataset.imu[dataset.imu.size() / 2].time;
    const auto lost = [&](Time t) { return t > begin && t < begin + from_seconds(0.5); };
    std::erase_if(dataset.imu, [&](const ImuSample& s) { return lost(s.time); });
    if (of_both) std::erase_if(dataset.scans, [&](const RadarScan& s) { return lost(s.time); });
    const Findings findings = check_it(dataset);
    EXPECT_FALSE(contains(text_of(findings), "a clock steps")) << text_of(findings);
  }
}

}  // namespace
}  // namespace rio::test
