// SPDX-License-Identifier: BSD-3-Clause
// Faults of the IMU with a cause that another one resembles: the right one is named,
// with what to paste.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <utility>

#include "check/check_it.hpp"
#include "rio/io/units.hpp"

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

TEST(ImuCauses, ExchangedColumnsMayBeInAnotherUnit) {
  for (const auto& [factor, unit] : {std::pair(1.0 / 9.80665, "g"), std::pair(102.0, "mg")}) {
    const io::Dataset dataset = with_imu([k = factor](ImuSample& s) {
      std::swap(s.gyro_B, s.accel_B);
      s.gyro_B *= k;
    });
    expect(said(dataset, "accelerometer unit"), Verdict::kWrong,
           std::string("exchanged, and the accelerometer is in ") + unit,
           std::string(", then --accel-unit ") + unit);
  }
}

TEST(ImuCauses, SamplesInBatchesHaveNoOtherUnitOfStamps) {
  for (const std::int64_t apart : {60'000, 0}) {  // in a batch of ten [ns]
    io::Dataset dataset = flight();
    const Time first = dataset.imu.front().time;
    for (std::size_t i = 0; i < dataset.imu.size(); ++i) {
      const auto in_batch = static_cast<std::int64_t>(i % 10);
      dataset.imu[i].time =
          first + (dataset.imu[i - i % 10].time - first) / 50'000'000 * 50'000'000;
      if (i % 10 > 0) dataset.imu[i].time = dataset.imu[i - i % 10].time + Time(in_batch * apart);
    }
    expect(said(dataset, "imu stamps"), Verdict::kWrong, "batches",
           "stamp each sample by itself in its driver");
  }
}

TEST(ImuCauses, SamplesThatAreThereTwiceLostNoDigits) {
  io::Dataset dataset = flight();
  std::vector<ImuSample> twice;
  for (const ImuSample& sample : dataset.imu) twice.insert(twice.end(), 2, sample);
  dataset.imu = twice;
  expect(said(dataset, "imu stamps"), Verdict::kDoubtful, "with the values of the one before",
         "two recordings of it joined");
}

TEST(ImuCauses, EveryUnitOfTheAccelerometerCanBePasted) {
  for (const char* unit : {"g", "mg", "cm/s^2", "ft/s^2"}) {
    const double factor = io::parse_quantity(std::string("1 ") + unit, "m/s^2");
    const io::Dataset dataset = with_imu([=](ImuSample& s) { s.accel_B /= factor; });
    const Finding finding = said(dataset, "accelerometer unit");
    EXPECT_EQ(finding.change, std::string("--accel-unit ") + unit) << finding.text;
  }
}

TEST(ImuCauses, AnAxisWithoutNoiseIsNoSmallRange) {
  const io::Dataset dataset = with_imu([](ImuSample& s) { s.gyro_B.x() = s.accel_B.z() = 9.81; });
  expect(said(dataset, "imu saturation"), Verdict::kDoubtful,
         "never changes: gyro x, accelerometer z", "does not fill these in");
}

TEST(ImuCauses, AValueOutOfAllReasonIsOneSampleLess) {
  io::Dataset dataset = flight();
  dataset.imu[900].accel_B.x() = 1e300;
  const Findings findings = check_it(dataset);
  EXPECT_EQ(find(findings, "accelerometer unit")->verdict, Verdict::kOk) << text_of(findings);
}

TEST(ImuCauses, AnAccelerometerOffAtRestIsNoMissingRest) {
  const io::Dataset dataset = with_imu([](ImuSample& s) { s.accel_B *= 1.06; });
  expect_change(dataset, "accelerometer unit", "scale or bias is off");
  EXPECT_PRED2(contains, said(dataset, "start").text, "too far off gravity");
}

}  // namespace
}  // namespace rio::test
