// SPDX-License-Identifier: BSD-3-Clause
// Faults of the radar with a cause that another one resembles: the right one is named, with what to
// paste.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

#include "check/check_it.hpp"
#include "check/motion.hpp"
#include "check/points_check.hpp"
#include "rio/core/so3.hpp"

namespace rio::test {
namespace {

/// The flight with other detections.
io::Dataset with_detections(const std::function<void(RadarDetection&)>& change) {
  io::Dataset dataset = flight();
  each_detection(&dataset, change);
  return dataset;
}

TEST(RadarCauses, AnSnrThatIsNoDecibelsIsNotAWeakRadar) {
  for (const auto& [scale, factor] : {std::pair(10.0, "0.1"), std::pair(100.0, "0.01")}) {
    io::Dataset dataset = with_detections([k = scale](RadarDetection& d) { d.snr_db *= k; });
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

TEST(RadarCauses, AnAngleCountedTheOtherWayIsNoRadarUpsideDown) {
  sim::Scenario scenario = scenario_named("indoor-1");
  scenario.path.ground = true;  // which cannot tell the two apart, if the radar looks ahead
  scenario.path.length = 50.0;
  scenario.radar.T_BS.rotation.setIdentity();
  io::Dataset dataset = flown(scenario);
  dataset.radar_info.T_BS->rotation.setIdentity();
  dataset.radar_info.axes = "flu";
  dataset.radar_info.fields = {{"range", "r"}, {"azimuth", "phi*0.5"}, {"elevation", "theta"}};
  EXPECT_EQ(said(dataset, "axes and Doppler sign").verdict, Verdict::kOk);
  each_detection(&dataset, [](RadarDetection& d) { d.point_S.y() *= -1.0; });
  expect(said(dataset, "axes and Doppler sign"), Verdict::kDoubtful,
         "turned by 180 deg about the x axis of the body", "--field azimuth=phi*-0.5");
  dataset.radar_info.fields = {{"x", "x"}, {"y", "y"}, {"z", "z"}};
  expect_change(dataset, "axes and Doppler sign", "radar: {T_BS: {translation: [0.1000,");
  io::Dataset in_air = with_detections([](RadarDetection& d) { d.point_S.y() *= -1.0; });
  in_air.radar_info.fields = dataset.radar_info.fields;
  in_air.radar_info.axes = "flu";
  EXPECT_EQ(said(in_air, "axes and Doppler sign").change, "--field y=y*-1");
  in_air.radar_info.axes = "ti";  // whose x is to the right
  EXPECT_EQ(said(in_air, "axes and Doppler sign").change, "--field x=x*-1");
  in_air = with_detections([](RadarDetection& d) { std::swap(d.point_S.y(), d.point_S.z()); });
  in_air.radar_info.fields = dataset.radar_info.fields;
  in_air.radar_info.axes = "flu";
  EXPECT_EQ(said(in_air, "axes and Doppler sign").change, "--field y=z*1 --field z=y*1");
}

/// With this share of its motion subtracted from the Doppler, by the velocity that most points of
/// the scan agree on.
io::Dataset compensated(io::Dataset dataset, double share, double noise) {
  Options options;
  io::apply_sensor_info(dataset, &options);
  std::size_t k = 0;
  const std::vector<check::RadarSpeed> speeds =
      check::radar_speeds(check::Scans(dataset.scans), options);
  for (RadarScan& scan : dataset.scans) {
    while (k + 1 < speeds.size() && speeds[k].time < scan.time) ++k;
    for (std::size_t i = 0; i < scan.detections.size(); ++i) {
      RadarDetection& d = scan.detections[i];
      d.range_rate += share * d.point_S.normalized().dot(speeds[k].v_S) +
                      noise * std::sin(static_cast<double>(7 * k * k + 13 * i * i + k * i));
    }
  }
  return dataset;
}

TEST(RadarCauses, ADopplerWithoutTheMotionOfTheVehicleIsNamed) {
  for (const auto& [share, noise] :
       {std::pair(1.0, 0.0), std::pair(1.0, 0.15), std::pair(0.9, 0.0), std::pair(0.8, 0.0)}) {
    SCOPED_TRACE(testing::Message() << share << " of it, noise of " << noise);
    const Findings findings = check_it(compensated(flight(), share, noise));
    expect(said(findings, "Doppler"), Verdict::kWrong, "the motion of the radar",
           "the driver subtracts the motion of the vehicle");
    EXPECT_EQ(std::ranges::count(findings, Verdict::kWrong, &Finding::verdict), 1)
        << text_of(findings);
  }
  const Findings slow = check_it(compensated(flown("outdoor", 80.0), 1.0, 0.0));
  expect(said(slow, "Doppler"), Verdict::kWrong, "the motion of the radar");
  EXPECT_EQ(find(slow, "Doppler by the ranges"), nullptr);
}

TEST(RadarCauses, AFactorOfTheDopplerIsNamed) {
  io::Dataset dataset = flight();
  const Time end = dataset.imu.front().time + from_seconds(18.0);
  std::erase_if(dataset.imu, [end](const ImuSample& s) { return s.time > end; });
  std::erase_if(dataset.scans, [end](const RadarScan& s) { return s.time > end; });
  for (const auto& [factor, text, change] :
       {std::tuple(0.5, "half the range rate", "*2"),
        std::tuple(2.0, "twice the range rate", "*0.5"), std::tuple(3.6, "in km/h", "*0.2778")}) {
    io::Dataset scaled = dataset;
    each_detection(&scaled, [k = factor](RadarDetection& d) { d.range_rate *= k; });
    expect(said(scaled, "Doppler scale"), Verdict::kWrong, text,
           std::string("--field doppler=NAME") + change);
  }
  each_detection(&dataset, [](RadarDetection& d) { d.range_rate *= 1000.0; });
  expect(said(dataset, "Doppler"), Verdict::kWrong, "in mm/s", "*0.001");
}

TEST(RadarCauses, ACoarseDopplerIsNotHalfTheRangeRate) {
  sim::Scenario scenario = scenario_named("rough-ground");
  for (scenario.seed = 1; scenario.seed <= 9; ++scenario.seed) {
    const Findings findings = check_it(flown(scenario));
    EXPECT_NE(worst(findings), Verdict::kWrong) << scenario.seed << "\n" << text_of(findings);
  }
}

TEST(RadarCauses, MoversAreNeitherTheRadarNorAHighThreshold) {
  const auto that_agree = [](io::Dataset* dataset) {
    double time = 0.0;
    std::size_t i = 0;
    for (RadarScan& scan : dataset->scans) {
      time += 1.0 / 15.0;
      for (RadarDetection& d : scan.detections) {
        if (++i % 5 < 3) d.range_rate = std::sin(time) * d.point_S.normalized().x();
      }
    }
  };
  const auto tracks = of_detections([i = 0](RadarDetection& d) mutable {
    if (++i % 7 != 0) d.range_rate = 1.4 * std::sin(1.7 * i);
  });
  expect_said({{that_agree, "axes and Doppler sign", Verdict::kDoubtful,
                "the velocity of the others is", "most points move"},
               {tracks, "points", Verdict::kDoubtful, "", "most points move"}});
}

TEST(RadarCauses, PointsInOtherKnownAxesNeedNoMounting) {
  // forward left up, read as if they were those of the chip
  io::Dataset dataset = with_detections([](RadarDetection& d) {
    d.point_S = Vector3d(d.point_S.y(), -d.point_S.x(), d.point_S.z());
  });
  dataset.radar_info.axes = "ti";
  EXPECT_EQ(said(dataset, "axes and Doppler sign").change, "--axes flu");
  dataset.radar_info.is_from_tree = true;  // the option would turn the mounting as well
  expect_change(dataset, "axes and Doppler sign", "]}} with --axes flu");
  dataset.radar_info.axes = "";
  expect_change(dataset, "axes and Doppler sign", "T_BS");
  const io::Dataset folder = with_detections([](RadarDetection& d) {  // its axes are known
    d.point_S = Vector3d(-d.point_S.y(), d.point_S.x(), d.point_S.z());
  });
  EXPECT_EQ(said(folder, "axes and Doppler sign", Source::kFolder).change, "--axes ti");
}

TEST(RadarCauses, OtherAxesAndTheOtherSignAreNoMirror) {
  const Vector3d flips(1.0, -1.0, -1.0);
  for (const char* axes : {"frd", "ti"}) {
    io::Dataset dataset = with_detections([&](RadarDetection& d) {
      const Vector3d p = d.point_S;
      d.point_S = axes[0] == 'f' ? p.cwiseProduct(flips) : Vector3d(-p.y(), p.x(), p.z());
      d.range_rate = -d.range_rate;
    });
    dataset.radar_info.axes = "flu";
    dataset.radar_info.fields = {{"x", "x"}, {"y", "y"}, {"z", "z"}};
    EXPECT_EQ(said(dataset, "axes and Doppler sign").change,
              std::string("--approaching (without it, if it is given) and --axes ") + axes);
  }
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
      const Vector3d wall_S(4.0 + noise, 0.5 * i - 3.0, 0.2 * (i % 5) - 0.4);
      const Vector3d person_S(3.0 + 2.0 * walked, 0.5 + noise, noise);
      const double rate = person ? 1.2 * std::cos(0.04 * k) + noise : 0.0;
      scan.detections.push_back({person ? person_S : wall_S, rate, 20.0});
    }
    out.scans.push_back(scan);
  }
  return out;
}

TEST(RadarCauses, AStandingVehicleHasNoMotionToShow) {
  io::Dataset dataset = standing(0.0175);
  expect_ok(dataset);
  each_detection(&dataset, [](RadarDetection& d) { d.range_rate = 0.0; });
  expect_ok(dataset);
}

TEST(RadarCauses, AnUnknownMountingIsNotJudged) {
  const Quaternion turn =
      quaternion_exp(Vector3d(0.0, 0.0, -0.5 * kHalfTurn)) * flight().radar_info.T_BS->rotation;
  io::Dataset dataset = with_detections([&](RadarDetection& d) { d.point_S = turn * d.point_S; });
  dataset.radar_info.T_BS.reset();
  EXPECT_EQ(said(dataset, "axes and Doppler sign").verdict, Verdict::kWrong);
  dataset.radar_info.prior_rotation = kHalfTurn;
  const Finding finding = said(dataset, "axes and Doppler sign");
  expect(finding, Verdict::kOk, "the mounting is unknown: it is found in flight");
  EXPECT_PRED2(contains, finding.text, "turned by 90 deg about the z axis of the body");
  each_detection(&dataset, [&](RadarDetection& d) { d.range_rate = -d.range_rate; });
  EXPECT_EQ(said(dataset, "axes and Doppler sign").verdict, Verdict::kWrong);
}

// Too few blocks for a test of the votes; many pairs are a hint.
TEST(RadarCauses, AFewSecondsOfRangesAgainstTheDopplerAreDoubtful) {
  const auto approaching = [](double doppler) {
    std::vector<RadarScan> scans;
    for (int k = 0; k < 150; ++k) {
      RadarScan scan;
      scan.time = Time(66'666'667LL * k);
      for (int i = 0; i < 8; ++i) {
        const Vector3d direction_S = Vector3d(1.0, 0.2 * i - 0.7, 0.0).normalized();
        scan.detections.push_back({(15.0 + 0.7 * i - 66.7e-3 * k) * direction_S, doppler});
      }
      scans.push_back(scan);
    }
    return check::check_ranges(check::Scans(scans), Options{}, {});
  };
  EXPECT_EQ(approaching(-1.0).finding.verdict, Verdict::kOk);
  EXPECT_EQ(approaching(-1.0).sign, check::DopplerSign::kAsConfigured);
  const check::RangeCheck against = approaching(1.0);
  EXPECT_EQ(against.finding.verdict, Verdict::kDoubtful) << against.finding.text;
  EXPECT_EQ(against.sign, check::DopplerSign::kLeansOpposite);
}

TEST(RadarCauses, OddValuesOfOneField) {
  EXPECT_EQ(find(check_it(flight()), "lever arm"), nullptr);
  const double bin = *flight().radar_info.doppler_resolution;
  const auto lever_in_mm = [](io::Dataset* d) {
    d->radar_info.T_BS->translation = {100.0, 0.0, -50.0};
  };
  /// The marks of a driver are no unit.
  const auto mark = [](double RadarDetection::*field, double value) {
    return of_detections([=, count = 0](RadarDetection& d) mutable {
      if (count++ % 50 == 0) d.*field = value;
    });
  };
  expect_said({
      {lever_in_mm, "lever arm", Verdict::kDoubtful, "", "in mm or cm?"},
      {of_detections([](RadarDetection& d) { d.point_S.z() = 0.0; }), "points", Verdict::kDoubtful,
       "all points have z = 0", "a radar that measures elevation"},
      {of_detections([](RadarDetection& d) { d.range_rate = 0.0; }), "Doppler", Verdict::kWrong, "",
       "--field doppler=NAME"},
      {of_detections([=](RadarDetection& d) { d.range_rate += bin; }), "Doppler", Verdict::kWrong,
       "off by +1.0 steps of its grid"},
      {of_detections([=](RadarDetection& d) { d.range_rate -= 0.5 * bin; }), "Doppler",
       Verdict::kWrong, "off by -0.5 steps of its grid"},
      {mark(&RadarDetection::range_rate, -1000.0), "Doppler", Verdict::kDoubtful,
       "2 % of the points are beyond 100 m/s", "leave these points out"},
      {mark(&RadarDetection::snr_db, 3276.7), "points", Verdict::kDoubtful,
       "an SNR of 3276.7: a mark of the driver", "leave these points out"},
      {[](io::Dataset* d) {
         for (RadarScan& scan : d->scans) scan.detections.resize(64, {{999.0, 999.0, 999.0}, 0.0});
       },
       "distances", Verdict::kOk, "half of the points within"},
  });
}

}  // namespace
}  // namespace rio::test
