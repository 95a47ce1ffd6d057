// SPDX-License-Identifier: BSD-3-Clause
// Faults of stamps and clocks, of one sensor or of both: the right cause is named, with what to
// paste.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "check/check_it.hpp"
#include "check/clock_steps.hpp"

namespace rio::test {
namespace {

std::vector<Time> stamps_of(const io::Dataset& dataset) {
  std::vector<Time> stamps;
  for (const RadarScan& scan : dataset.scans) stamps.push_back(scan.time);
  return stamps;
}

check::ClockSteps steps_of_both(const io::Dataset& dataset) {
  Options options;
  io::apply_sensor_info(dataset, &options);
  return check::find_clock_steps(dataset.imu, {check::Scans(dataset.scans)}, dataset.imu_info,
                                 options);
}

/// Those of the radar, and the IMU has none.
std::vector<check::ClockStep> steps_in(const io::Dataset& dataset) {
  const check::ClockSteps steps = steps_of_both(dataset);
  EXPECT_TRUE(steps.imu.empty());
  return steps.radars[0];
}

/// Both clocks step in the middle of the flight.
io::Dataset with_step_of_both(double step) {
  io::Dataset dataset = flight();
  const Time then = dataset.imu[dataset.imu.size() / 2].time;
  for (ImuSample& s : dataset.imu) s.time += s.time < then ? Time(0) : from_seconds(step);
  for (RadarScan& s : dataset.scans) s.time += s.time < then ? Time(0) : from_seconds(step);
  return dataset;
}

constexpr double kSteps[] = {0.15, -0.3, 1.5, -2.0, 40.0};  // [s]

/// A step of one clock after a third of the flight is found to the item, which is the only fault.
/// @return the flight with it
template <class Item>
io::Dataset expect_step_found(std::vector<Item> io::Dataset::*items, double step,
                              const std::string& stamps, const std::string& item) {
  io::Dataset dataset = flight();
  const std::size_t first = (dataset.*items).size() / 3;
  step_stamps(&(dataset.*items), first, step);
  const Findings findings = check_it(dataset);
  const bool back = step < -0.5;
  expect(said(findings, back ? stamps : "delay of the radar"),
         back ? Verdict::kDoubtful : Verdict::kWrong, fmt::format("from {} {} on", item, first + 1),
         "`rio replay`, which takes it out");
  EXPECT_EQ(std::ranges::count(findings, Verdict::kWrong, &Finding::verdict), back ? 0 : 1)
      << text_of(findings);
  return dataset;
}

TEST(ImuStamps, StampsInAnotherUnitAreTheOnlyFinding) {
  for (const auto& [divisor, unit] : {std::pair(1000, "us"), std::pair(1000000, "ms")}) {
    io::Dataset dataset = flight();
    for (ImuSample& s : dataset.imu) s.time /= divisor;
    for (RadarScan& s : dataset.scans) s.time /= divisor;
    EXPECT_EQ(check_it(dataset).size(), 1U) << text_of(check_it(dataset));
    expect(said(dataset, "imu stamps"), Verdict::kWrong, std::string("the stamps are in ") + unit,
           "by " + std::to_string(divisor) + ":");
  }
}

TEST(ImuStamps, StampsOfOneSensorInAnotherUnitAreThoseOfThatSensor) {
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
    EXPECT_EQ(find(check_it(of_radar), "radar stamps"), nullptr);  // nor what follows from them
    for (RadarScan& s : of_radar.scans) s.time -= epoch - epoch / divisor;  // all of the stamp
    const Findings findings = check_it(of_radar, Source::kFolder);
    EXPECT_PRED2(contains, said(findings, "clocks").text, unit);
    EXPECT_EQ(said(findings, "clocks").change,
              fmt::format("multiply the stamps of the radar by {}: they must be in ns", divisor));
    EXPECT_EQ(find(findings, "radar stamps"), nullptr);
  }
}

TEST(ImuStamps, StampsThatLostDigitsAreNoLackOfSamples) {
  for (const double grid : {0.01, 0.1, 1.0}) {
    SCOPED_TRACE(grid);
    io::Dataset dataset = flight();
    for (ImuSample& s : dataset.imu) s.time -= s.time % from_seconds(grid);
    const std::string text = "multiples of " + fmt::format("{:g}", grid) + " s: they lost digits";
    expect(said(dataset, "imu stamps"), Verdict::kWrong, text, "--imu-clock receive");
    expect(said(dataset, "imu stamps", Source::kFolder), Verdict::kWrong, text, "all digits");
  }
}

TEST(RadarStamps, ScansThatAreThereTwiceOrCutAreOfNoOtherUnitOrRate) {
  io::Dataset twice = flight();
  twice.scans.clear();
  for (const RadarScan& scan : flight().scans) {
    twice.scans.insert(twice.scans.end(), 2, scan);
    twice.scans.back().time += Time(300'000);
  }
  EXPECT_EQ(said(twice, "clocks").verdict, Verdict::kOk);
  io::Dataset cut = flight();
  for (RadarScan& scan : cut.scans) scan.time -= scan.time % from_seconds(0.1);
  const auto same = [](const RadarScan& a, const RadarScan& b) { return a.time == b.time; };
  cut.scans.erase(std::unique(cut.scans.begin(), cut.scans.end(), same), cut.scans.end());
  expect(said(cut, "radar stamps", Source::kFolder), Verdict::kDoubtful, "(10.0 Hz)",
         "rate_hz: 10.0, unless stamps are cut to 0.1 s");
}

TEST(RadarStamps, ScansThatAreSentAgainAreNamed) {
  EXPECT_EQ(find(check_it(flight()), "repeated points"), nullptr);
  const auto with_the_one_before = [](io::Dataset* d) {
    for (std::size_t i = d->scans.size() - 1; i > 0; --i) {
      const auto& before = d->scans[i - 1].detections;
      d->scans[i].detections.insert(d->scans[i].detections.end(), before.begin(), before.end());
    }
  };
  expect_said({{with_the_one_before, "repeated points", Verdict::kDoubtful,
                "also in the scan before", "each scan once and alone"}});
}

TEST(ImuStamps, APeriodBetweenOneAndTwoStepsOfItsGridLosesNothing) {
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

TEST(ImuStamps, AClockThatGoesBackIsNotTwoPublishers) {
  const io::Dataset dataset = with_step_of_both(-9.0);
  for (const char* subject : {"imu stamps", "radar stamps"}) {
    expect(said(dataset, subject, Source::kFolder), Verdict::kDoubtful,
           "the clock goes back once, first by 9 s", "split the recording there");
  }
}

TEST(ImuStamps, AStepOfTheClockIsFoundToTheSample) {
  for (const double step : kSteps) {
    SCOPED_TRACE(step);
    expect_step_found(&io::Dataset::imu, step, "imu stamps", "sample");
  }
  io::Dataset small = expect_step_found(&io::Dataset::imu, -0.045, "imu stamps", "sample");
  step_stamps(&small.imu, small.imu.size() / 2, -0.045);  // such as batches that overlap
  EXPECT_TRUE(steps_of_both(small).imu.empty());
}

TEST(Clocks, ThatGoBackTogetherStep) {
  for (const double step : {-0.3, -20.0, -1.7e9}) {
    SCOPED_TRACE(step);
    const check::ClockSteps steps = steps_of_both(with_step_of_both(step));
    EXPECT_EQ(steps.imu.size(), 1U);
    EXPECT_EQ(steps.radars[0].size(), 1U);
  }
}

TEST(Clocks, ThatGoForwardTogetherMayPause) {
  for (const double step : {0.3, 1.5, 20.0, 7200.0}) {
    SCOPED_TRACE(step);
    const check::ClockSteps steps = steps_of_both(with_step_of_both(step));
    EXPECT_TRUE(steps.imu.empty());
    EXPECT_TRUE(steps.radars[0].empty());
    expect(said(with_step_of_both(step), "clocks"), Verdict::kDoubtful,
           "both are silent for " + fmt::format("{:.1f}", step), "the clock was set forward");
  }
}

TEST(ImuStamps, APauseIsNoStepOfTheClock) {
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

TEST(RadarStamps, OnAGridHaveTheRateOfTheRadar) {
  io::Dataset dataset = flight();
  std::size_t lost = 0;
  for (std::size_t i = 0; i < dataset.scans.size(); ++i) {
    if (i % 5 == 0) ++lost;  // lost scans do not count
    const auto tick = static_cast<std::int64_t>(std::floor(static_cast<double>(i + lost) / 0.3));
    dataset.scans[i].time = dataset.imu.front().time + tick * Time(10'000'000);
  }
  dataset.radar_info.rate_hz = 30.0;
  const Finding finding = said(dataset, "radar stamps", Source::kFolder);
  expect(finding, Verdict::kOk, "(30.0 Hz)");
  dataset.radar_info.rate_hz = 20.0;
  EXPECT_EQ(said(dataset, "radar stamps", Source::kFolder).change,
            "radar0/sensor.yaml: rate_hz: 30.0");
  EXPECT_EQ(said(dataset, "radar stamps").change, "");  // a bag has no such file
}

TEST(RadarStamps, ScansOutOfOrderAreNotRepeated) {
  io::Dataset dataset = flight();
  for (std::size_t i = 10; i + 1 < dataset.scans.size(); i += 10) {
    std::swap(dataset.scans[i], dataset.scans[i + 1]);
  }
  expect_change(dataset, "radar stamps", "put the scans in the order");
  dataset = flight();
  dataset.scans[20].time = dataset.scans[19].time;
  expect_change(dataset, "radar stamps", "a stamp of its own");
}

TEST(RadarStamps, PointsOfAScanShareItsStamp) {
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

TEST(RadarStamps, StampsThatLostDigitsAreNoSlowRadar) {
  io::Dataset dataset = flight();
  for (RadarScan& s : dataset.scans) s.time -= s.time % from_seconds(1.0);
  const std::string text = "multiples of 1 s: they lost digits";
  expect(said(dataset, "radar stamps"), Verdict::kWrong, text, "--radar-clock receive");
  expect(said(dataset, "radar stamps", Source::kFolder), Verdict::kWrong, text, "all digits");
  EXPECT_EQ(find(check_it(dataset), "points"), nullptr);
}

TEST(RadarStamps, AStepOfTheClockIsFoundToTheScan) {
  for (const double step : kSteps) {
    SCOPED_TRACE(step);
    const std::vector<check::ClockStep> steps =
        steps_in(expect_step_found(&io::Dataset::scans, step, "radar stamps", "scan"));
    ASSERT_EQ(steps.size(), 1U);
    EXPECT_NEAR(to_seconds(steps[0].size), step, 0.005);  // of the jitter of the stamps
  }
}

TEST(RadarStamps, TwoStepsOfAClockAreFound) {
  io::Dataset dataset = flight();
  const std::size_t third = dataset.scans.size() / 3;
  step_stamps(&dataset.scans, third, 0.7);
  step_stamps(&dataset.scans, 2 * third, -0.5);
  const std::vector<check::ClockStep> steps = steps_in(dataset);
  ASSERT_EQ(steps.size(), 2U);
  EXPECT_EQ(steps[0].first, third);
  EXPECT_EQ(steps[1].first, 2 * third);
  EXPECT_NEAR(to_seconds(-check::without_steps(Time{0}, steps, 2 * third)), 0.2, 0.005);
}

TEST(RadarStamps, APauseOrACorruptStampIsNoStepOfAClock) {
  io::Dataset dataset = flight();
  for (std::size_t i = 60; i + 60 < dataset.scans.size(); i += 57) {
    dataset.scans.erase(dataset.scans.begin() + static_cast<std::ptrdiff_t>(i),
                        dataset.scans.begin() + static_cast<std::ptrdiff_t>(i + 5));
  }
  EXPECT_FALSE(check::possible_steps(stamps_of(dataset)).empty());
  EXPECT_TRUE(steps_in(dataset).empty());
  dataset = flight();
  std::rotate(dataset.scans.begin() + 80, dataset.scans.begin() + 90, dataset.scans.begin() + 120);
  EXPECT_TRUE(steps_in(dataset).empty());  // out of order
  dataset = flight();
  dataset.scans[100].time += from_seconds(3.0);
  dataset.scans[150].time = Time::min();
  EXPECT_TRUE(check::possible_steps(stamps_of(dataset)).empty());
}

}  // namespace
}  // namespace rio::test
