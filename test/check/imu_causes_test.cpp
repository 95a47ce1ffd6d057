// SPDX-License-Identifier: BSD-3-Clause
// Faults of the IMU with a cause that another one resembles: the right one is named,
// with what to paste.
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "check/check_it.hpp"
#include "rio/io/units.hpp"

namespace rio::test {
namespace {

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
  expect_said({{of_samples([=](ImuSample& s) { s.accel_B -= at_rest; }), "accelerometer unit",
                Verdict::kWrong, "gravity was removed", "raw accelerometer"},
               {of_samples([](ImuSample& s) { s.accel_B.setZero(); }), "accelerometer unit",
                Verdict::kWrong, "it is not measured", "raw accelerometer"}});
}

TEST(ImuCauses, ExchangedColumnsAreOneFault) {
  io::Dataset dataset = flight();
  each_sample(&dataset, [](ImuSample& s) { std::swap(s.gyro_B, s.accel_B); });
  const Findings findings = check_it(dataset);
  for (const Finding& f : findings) {
    EXPECT_EQ(f.verdict, f.subject == "accelerometer unit" ? Verdict::kWrong : Verdict::kOk)
        << text_of(findings);
  }
}

TEST(ImuCauses, ExchangedColumnsMayBeInAnotherUnit) {
  for (const auto& [factor, unit] : {std::pair(1.0 / 9.80665, "g"), std::pair(102.0, "mg")}) {
    const auto exchange = [k = factor](ImuSample& s) {
      std::swap(s.gyro_B, s.accel_B);
      s.gyro_B *= k;
    };
    expect_said({{of_samples(exchange), "accelerometer unit", Verdict::kWrong,
                  std::string("exchanged, and the accelerometer is in ") + unit,
                  std::string(", then --accel-unit ") + unit}});
  }
}

TEST(ImuCauses, SignsOfTheGyroAreNoDelay) {
  for (const auto& [signs, text] : {std::pair(Vector3d(-1, -1, -1), "negate all axes of the gyro"),
                                    std::pair(Vector3d(1, 1, -1), "negate z of the gyro"),
                                    std::pair(Vector3d(1, -1, -1), "negate y and z of the gyro")}) {
    io::Dataset dataset = flight();
    each_sample(&dataset, [k = signs](ImuSample& s) { s.gyro_B = k.asDiagonal() * s.gyro_B; });
    const Findings findings = check_it(dataset);
    EXPECT_PRED2(contains, said(findings, "axes of the IMU").change, text);
    EXPECT_EQ(find(findings, "delay of the radar"), nullptr);
  }
}

TEST(ImuCauses, AxesOfTheImuAreNoMounting) {
  const auto rates = [](int x, int y, int z) {
    return of_samples([=](ImuSample& s) { s.gyro_B = {s.gyro_B[x], s.gyro_B[y], s.gyro_B[z]}; });
  };
  const auto rdf = in_axes([](const Vector3d& v) { return Vector3d(-v.y(), -v.z(), v.x()); });
  const auto left_handed =
      in_axes([](const Vector3d& v) { return Vector3d(v.x(), -v.y(), v.z()); });
  const std::string order = "take the rates of the gyro in the order ";
  expect_said({
      {rates(1, 0, 2), "axes of the IMU", Verdict::kWrong, "", order + "(y, x, z)"},
      {rates(0, 2, 1), "axes of the IMU", Verdict::kWrong, "", order + "(x, z, y)"},
      {rates(2, 0, 1), "axes of the IMU", Verdict::kWrong, "", order + "(y, z, x)"},
      {left_handed, "axes of the IMU", Verdict::kWrong, "y of the IMU has the wrong",
       "y of the IMU has the wrong"},
      {of_samples([](ImuSample& s) { s.accel_B *= -1.0; }), "axes and Doppler sign",
       Verdict::kWrong, "", "--accel-unit -m/s^2 (-UNIT if one is given): the accelerometer has"},
      {rdf, "axes and Doppler sign", Verdict::kWrong, "the IMU is in rdf", "--imu-axes rdf"},
  });
  io::Dataset dataset = flight();
  rdf(&dataset);
  expect_change(dataset, "axes and Doppler sign", "--imu-axes rdf", Source::kFolder);
  dataset.radar_info.is_from_tree = true;
  expect_change(dataset, "axes and Doppler sign", "radar: {T_BS");
}

TEST(ImuCauses, AnotherUnitOrRangeOfTheGyroIsNamed) {
  const auto rates = [](double k) { return of_samples([k](ImuSample& s) { s.gyro_B *= k; }); };
  expect_said({
      {rates(0.25), "gyro unit by the radar", Verdict::kWrong, "", "by 4:"},
      {rates(0.5), "gyro unit by the radar", Verdict::kWrong, "", "by 2:"},
      {rates(2.0), "gyro unit by the radar", Verdict::kWrong, "", "by 0.5:"},
      {rates(4.0), "gyro unit by the radar", Verdict::kWrong, "", "by 0.25:"},
      {rates(1e3), "gyro unit", Verdict::kWrong, "in mrad/s"},
      {rates(5.73e4), "gyro unit", Verdict::kWrong, "in mdeg/s"},
      {rates(9.55), "gyro unit", Verdict::kWrong, "in rpm"},
      {rates(573.0), "gyro unit", Verdict::kWrong, "in 0.1 deg/s"},
      {rates(57.3 * 131.0), "gyro unit", Verdict::kWrong, "of about 131"},
  });
}

TEST(ImuCauses, HeightsAndOtherUnitsAreNoPressures) {
  io::Dataset dataset = flight();
  for (const auto& [pressure, change] :
       {std::pair(120.0, "heights in m"), std::pair(1003.0, "by 100 if they are in hPa"),
        std::pair(98.0, "by 1000 if they are in kPa")}) {
    dataset.baro.assign(10, {dataset.imu.front().time, pressure});
    expect(said(dataset, "barometer"), Verdict::kWrong, "no air pressure in Pa", change);
  }
  for (io::BaroSample& sample : dataset.baro) sample.pressure = 98e3;
  expect_ok(dataset);
}

// Of plane turns the specific force is v w: either may be wrong.
TEST(ImuCauses, RangeOfTheGyroOfADriveMayBeTheScaleOfTheDoppler) {
  sim::Scenario scenario;
  scenario.path.ground = true;
  scenario.path.length = 60.0;
  io::Dataset dataset = flown(scenario);
  expect_ok(dataset);
  each_sample(&dataset, [](ImuSample& s) { s.gyro_B *= 2.0; });
  expect(said(dataset, "Doppler scale"), Verdict::kWrong, "0.5 times the rates of the gyro",
         "multiply the rates of the gyro by 0.5");
}

TEST(ImuCauses, SamplesInBatchesHaveNoOtherUnitOfStamps) {
  for (const std::int64_t apart : {60'000, 0}) {  // in a batch of ten [ns]
    const auto batches = [apart](io::Dataset* d) {
      const Time first = d->imu.front().time;
      const Time period = std::chrono::milliseconds(50);
      for (std::size_t i = 0; i < d->imu.size(); ++i) {
        Time& time = d->imu[i].time;
        time = i % 10 == 0 ? time - (time - first) % period : d->imu[i - 1].time + Time(apart);
      }
    };
    expect_said({{batches, "imu stamps", Verdict::kWrong, "batches",
                  "stamp each sample by itself in its driver"}});
  }
}

TEST(ImuCauses, SamplesThatAreThereTwiceLostNoDigits) {
  const auto twice = [](io::Dataset* d) {
    std::vector<ImuSample> samples;
    for (const ImuSample& sample : d->imu) samples.insert(samples.end(), 2, sample);
    d->imu = samples;
  };
  expect_said({{twice, "imu stamps", Verdict::kDoubtful, "with the values of the one before",
                "two recordings of it joined"}});
}

TEST(ImuCauses, EveryUnitOfTheAccelerometerCanBePasted) {
  for (const char* unit : {"g", "mg", "cm/s^2", "ft/s^2"}) {
    const double factor = io::parse_quantity(std::string("1 ") + unit, "m/s^2");
    io::Dataset dataset = flight();
    each_sample(&dataset, [=](ImuSample& s) { s.accel_B /= factor; });
    const Finding finding = said(dataset, "accelerometer unit");
    EXPECT_EQ(finding.change, std::string("--accel-unit ") + unit) << finding.text;
  }
}

TEST(ImuCauses, OddSamples) {
  const auto off_at_rest = of_samples([](ImuSample& s) { s.accel_B *= 1.06; });
  const auto raw_counts = of_samples([](ImuSample& s) {
    s.accel_B *= 2048.0 / 9.81;
    s.gyro_B *= 16.4 * 180.0 / kHalfTurn;
  });
  const auto each_150th = [](const std::function<void(ImuSample&)>& change) {
    return of_samples([change, i = 0](ImuSample& s) mutable {
      if (++i % 150 == 0) change(s);
    });
  };
  const auto spikes = each_150th([](ImuSample& s) { s.accel_B.x() = 600.0; });
  const auto zeros = each_150th([](ImuSample& s) { s = {s.time}; });
  expect_said({
      {of_samples([](ImuSample& s) { s.gyro_B.x() = s.accel_B.z() = 9.81; }), "imu saturation",
       Verdict::kDoubtful, "never changes: gyro x, accelerometer z", "does not fill these in"},
      {[](io::Dataset* d) { d->imu[900].accel_B.x() = 1e300; }, "accelerometer unit", Verdict::kOk,
       ""},
      {off_at_rest, "accelerometer unit", Verdict::kDoubtful, "", "scale or bias is off"},
      {off_at_rest, "start", Verdict::kDoubtful, "too far off gravity"},
      {raw_counts, "gyro unit", Verdict::kWrong, "raw counts", "data sheet"},
      {spikes, "accelerometer unit", Verdict::kOk, ""},
      {spikes, "imu saturation", Verdict::kOk, "single ones are all zero or beyond the range"},
      {zeros, "start", Verdict::kOk, ""},
  });
}

}  // namespace
}  // namespace rio::test
