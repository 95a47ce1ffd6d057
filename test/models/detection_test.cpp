// SPDX-License-Identifier: BSD-3-Clause
#include "rio/models/detection.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cfenv>
#include <limits>

#include "support/constants.hpp"
#include "support/random_state.hpp"

namespace rio {
namespace {

// Turns boresight by azimuth about z after elevation about -y.
Vector3d polar(double range, double azimuth, double elevation) {
  return range * (Eigen::AngleAxisd(azimuth, Vector3d::UnitZ()) *
                  Eigen::AngleAxisd(-elevation, Vector3d::UnitY()) * Vector3d::UnitX());
}

RadarDetection raw_detection(double range, double azimuth, double elevation, double snr_db = 10.0) {
  return {.point_S = polar(range, azimuth, elevation), .range_rate = -1.0, .snr_db = snr_db};
}

RadarOptions fine_radar() {
  return {.sigma_range = 0.03,
          .sigma_azimuth = 0.004,
          .sigma_elevation = 0.008,
          .weak_snr_db = -200.0,  // all alike
          .range_resolution = 0.1};
}

// Xu et al., eq. 4: the same covariance in the tangent plane of every direction.
TEST(Detection, WithoutGrowthTheDirectionNoiseIsTheSameEverywhere) {
  RadarOptions o = fine_radar();
  for (const auto& [azimuth, elevation] : {std::pair(0.0, 0.0), {0.9, 0.0}, {-0.4, 0.8}}) {
    const RadarDetection raw = raw_detection(4.0, azimuth, elevation);
    o.angle_growth = false;
    const Detection constant = make_detection(raw, o);
    EXPECT_NEAR(constant.sigma_azimuth_S.norm(), o.sigma_azimuth, 1e-15);
    EXPECT_NEAR(constant.sigma_elevation_S.norm(), o.sigma_elevation, 1e-15);
    o.angle_growth = true;
    const Detection grown = make_detection(raw, o);
    EXPECT_NEAR(grown.sigma_elevation_S.norm(), o.sigma_elevation / std::cos(elevation), 1e-15);
    EXPECT_NEAR(grown.sigma_azimuth_S.norm(),
                o.sigma_azimuth * std::cos(elevation) / std::cos(azimuth), 1e-15);
  }
}

TEST(Detection, FieldsFollowFromThePoint) {
  const RadarOptions o{.sigma_range = 0.02,
                       .sigma_doppler = 0.03,
                       .range_resolution = 0.06,
                       .doppler_resolution = 0.12};
  const RadarDetection raw = raw_detection(4.0, 0.3, -0.2, 17.0);
  const Detection d = make_detection(raw, o);
  EXPECT_EQ(d.point_S, raw.point_S);
  EXPECT_NEAR(d.range, 4.0, 1e-14);
  EXPECT_NEAR((d.direction_S - polar(1.0, 0.3, -0.2)).norm(), 0.0, 1e-15);
  EXPECT_EQ(d.range_rate, -1.0);
  EXPECT_EQ(d.snr_db, 17.0);
  EXPECT_NEAR(d.sigma_range * d.sigma_range, 0.0004 + 0.0036 / 12.0, 1e-15);
  EXPECT_NEAR(d.sigma_doppler * d.sigma_doppler, 0.0009 + 0.0144 / 12.0, 1e-15);
}

TEST(Detection, OwnSigmasReplaceTheOptionsDownToWhatThoseMayBe) {
  RadarOptions o;
  o.weak_snr_db = 10.0;
  RadarDetection raw = raw_detection(4.0, 0.3, -0.2, 5.0);
  const Detection by_options = make_detection(raw, o);
  raw.sigma_range = 0.05;
  raw.sigma_azimuth = 0.003;
  const Detection some = make_detection(raw, o);
  EXPECT_EQ(some.sigma_range, 0.05);
  EXPECT_NEAR(some.sigma_azimuth_S.norm(), 0.003 * std::cos(0.2), 1e-15);
  EXPECT_EQ(some.sigma_elevation_S, by_options.sigma_elevation_S);
  EXPECT_EQ(some.sigma_doppler, by_options.sigma_doppler);
  raw.sigma_elevation = 0.0006;
  raw.sigma_doppler = 0.01;
  const Detection all = make_detection(raw, o);
  EXPECT_NEAR(all.sigma_elevation_S.norm(), 0.0006, 1e-15);
  EXPECT_EQ(all.sigma_doppler, 0.01);
  raw.sigma_range = raw.sigma_azimuth = raw.sigma_elevation = raw.sigma_doppler = 1e-200;
  const Detection least = make_detection(raw, o);
  EXPECT_EQ(least.sigma_range, 1e-4);
  EXPECT_EQ(least.sigma_doppler, 1e-4);
  EXPECT_NEAR(least.sigma_azimuth_S.norm(), 1e-5 * std::cos(0.2), 1e-12);
  EXPECT_NEAR(least.sigma_elevation_S.norm(), 1e-5, 1e-12);
}

TEST(Detection, NoiseStaysFiniteEverywhere) {
  const RadarOptions o = fine_radar();
  test::Random random(2);
  for (int i = 0; i < 200; ++i) {
    Vector3d point_S = 3.0 * (i == 0 ? Vector3d(Vector3d::UnitZ()) : random.direction());
    if (i == 1) point_S = Vector3d(0.0, 2.0, 0.0);
    const Detection d = make_detection({.point_S = point_S}, o);
    const Vector3d eigen =
        Eigen::SelfAdjointEigenSolver<Matrix3d>(point_covariance(d)).eigenvalues();
    EXPECT_TRUE(eigen.allFinite());
    EXPECT_GT(eigen[0], 5e-6);       // none is exact: at least 3 m * 0.004 rad / 4 = 3 mm
    EXPECT_LT(eigen[2], 0.2 * 0.2);  // 3 m * 0.008 rad * 4 is 0.1 m
    EXPECT_LT((direction_covariance(d) * d.direction_S).norm(), 1e-15);  // of a unit vector
    Matrix3d basis;
    basis << d.direction_S, d.sigma_azimuth_S.normalized(), d.sigma_elevation_S.normalized();
    EXPECT_TRUE(basis.isUnitary(1e-12)) << d.direction_S.transpose();
  }
}

TEST(Detection, FingerprintsDifferInEveryNumberAndAreZeroAtRest) {
  DetectionList list;
  EXPECT_EQ(fingerprint(list), 0U);
  for (int i = 0; i < 3; ++i) {
    list.items.push_back(make_detection({{3.0 + i, 1.0, 0.5}, 0.1 * i}, fine_radar()));
  }
  const std::uint64_t print = fingerprint(list);
  EXPECT_NE(print, 0U);
  EXPECT_EQ(fingerprint(list), print);
  for (int k = 0; k < 5; ++k) {
    DetectionList other = list;
    Detection& d = other.items[1];
    double& value = k < 3 ? d.point_S[k] : k == 3 ? d.range_rate : d.snr_db;
    value += 1e-12;
    EXPECT_NE(fingerprint(other), print) << k;
  }
  DetectionList fewer = list;
  fewer.items.erase(fewer.items.begin() + 2);
  EXPECT_NE(fingerprint(fewer), print);
  for (Detection& d : list.items) d.range_rate = 0.0;
  EXPECT_EQ(fingerprint(list), 0U);
}

TEST(DetectionFilter, RangeStrengthAndFieldOfView) {
  RadarOptions o;
  o.min_range = 1.0;
  o.max_range = 10.0;
  o.min_snr_db = 8.0;
  o.fov_azimuth = 120.0 * kDegree;
  o.fov_elevation = 30.0 * kDegree;
  RadarScan scan;
  scan.time = Time(42);
  scan.detections = {
      raw_detection(0.9, 0.0, 0.0),
      raw_detection(1.1, 0.0, 0.0),  // kept
      raw_detection(9.9, 0.0, 0.0),  // kept
      raw_detection(10.1, 0.0, 0.0),
      raw_detection(2.1, 0.0, 0.0, 7.9),
      raw_detection(2.2, 0.0, 0.0, 8.0),                     // kept
      raw_detection(3.1, 59.0 * kDegree, 14.0 * kDegree),    // kept
      raw_detection(3.2, -59.0 * kDegree, -14.0 * kDegree),  // kept
      raw_detection(3.3, 61.0 * kDegree, 0.0),
      raw_detection(3.4, -61.0 * kDegree, 0.0),
      raw_detection(3.5, 0.0, 16.0 * kDegree),
      raw_detection(3.6, 0.0, -16.0 * kDegree),
      raw_detection(3.7, 180.0 * kDegree, 0.0),
  };
  DetectionList out;
  filter_detections(scan, o, 128, out);
  std::vector<double> ranges;
  for (const Detection& d : out.items) ranges.push_back(std::round(1e3 * d.range) / 1e3);
  EXPECT_EQ(ranges, (std::vector<double>{1.1, 9.9, 2.2, 3.1, 3.2}));
  EXPECT_EQ(out.time, scan.time);
  EXPECT_EQ(out.received, 13);
  EXPECT_EQ(out.non_finite, 0);
  filter_detections(RadarScan{}, o, 128, out);  // reuse leaves nothing behind
  EXPECT_EQ(out.received, 0);
  EXPECT_TRUE(out.items.empty());
}

// Not finite, or no radar says it. What is beyond the range is left out, but no wrong number.
TEST(DetectionFilter, CountsAndDropsImpossibleNumbers) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  struct Fault {
    const char* name;
    void (*make)(RadarDetection*);
    int counted = 1;
  };
  for (const Fault& fault : {
           Fault{"x", [](RadarDetection* d) { d->point_S.x() = kNan; }},
           Fault{"z", [](RadarDetection* d) { d->point_S.z() = kInfinity; }},
           Fault{"rate", [](RadarDetection* d) { d->range_rate = kNan; }},
           Fault{"infinite rate", [](RadarDetection* d) { d->range_rate = -kInfinity; }},
           Fault{"large rate", [](RadarDetection* d) { d->range_rate = -1e299; }},
           Fault{"snr", [](RadarDetection* d) { d->snr_db = kNan; }},
           Fault{"large snr", [](RadarDetection* d) { d->snr_db = 1e4; }},
           Fault{"negative sigma", [](RadarDetection* d) { d->sigma_range = -0.1; }},
           Fault{"sigma", [](RadarDetection* d) { d->sigma_elevation = kNan; }},
           Fault{"infinite sigma", [](RadarDetection* d) { d->sigma_doppler = kInfinity; }},
           Fault{"large sigma", [](RadarDetection* d) { d->sigma_doppler = 1e200; }},
           Fault{"far", [](RadarDetection* d) { d->point_S.y() = -1.1e4; }, 0},
           Fault{"with a square beyond all numbers",
                 [](RadarDetection* d) { d->point_S.y() = -1e154; }, 0},
           Fault{"farther", [](RadarDetection* d) { d->point_S.x() = 1e300; }, 0},
       }) {
    SCOPED_TRACE(fault.name);
    RadarScan scan;
    scan.detections.assign(2, raw_detection(5.0, 0.1, 0.1));
    fault.make(&scan.detections[0]);
    DetectionList out;
    std::feclearexcept(FE_ALL_EXCEPT);
    filter_detections(scan, RadarOptions{}, 128, out);
    // nothing overflows where exceptions are trapped
    if (fault.counted == 0) {
      EXPECT_EQ(std::fetestexcept(FE_INVALID | FE_OVERFLOW | FE_DIVBYZERO), 0);
    }
    EXPECT_EQ(out.received, 2);
    EXPECT_EQ(out.non_finite, fault.counted);
    EXPECT_EQ(out.items.size(), 1U);
  }
}

// Against a sort, up to the capacity.
TEST(DetectionFilter, KeepsTheStrongestInTheirOrder) {
  RadarScan scan;
  test::Random random(3);
  std::vector<double> strengths;
  for (int i = 0; i < 1600; ++i) {
    scan.detections.push_back(raw_detection(1.0 + 0.01 * i, 0.0, 0.0, random.uniform(1.0, 40.0)));
    scan.detections.back().range_rate = 0.5 * i;  // no two of one reflector
    strengths.push_back(scan.detections.back().snr_db);
  }
  std::sort(strengths.rbegin(), strengths.rend());
  DetectionList out;
  filter_detections(scan, RadarOptions{}, static_cast<int>(kMaxDetections), out);
  ASSERT_EQ(out.items.size(), kMaxDetections);
  for (std::size_t i = 0; i < out.items.size(); ++i) {
    EXPECT_GE(out.items[i].snr_db, strengths[kMaxDetections - 1]);
    EXPECT_TRUE(i == 0 || out.items[i].range > out.items[i - 1].range);
  }
}

// A driver pads its messages with one detection: forty of them measure what one does.
TEST(DetectionFilter, TheSamePointAndRangeRateCountsOnce) {
  RadarScan scan;
  scan.detections.assign(40, raw_detection(2.0, 0.1, 0.0, 20.0));
  scan.detections[7].range_rate = 0.3;  // another reflector at one place
  scan.detections[8].point_S.z() = 0.01;
  DetectionList out;
  filter_detections(scan, RadarOptions{}, 128, out);
  EXPECT_EQ(out.received, 40);
  EXPECT_EQ(out.items.size(), 3U);
}

// Where there are more than fit, the detections of one reflector would be counted many times.
TEST(DetectionFilter, OfTooManyOneAReflectorStays) {
  const RadarOptions radar;
  test::Random random(4);
  RadarScan scan;
  for (int i = 0; i < 600; ++i) {
    const int column = i % 5;
    const int row = i / 5 % 4;
    const int repetition = i / 20;
    RadarDetection d = raw_detection(2.0 + row + random.normal(0.3 * radar.sigma_range),
                                     0.25 * column - 0.5 + random.normal(0.3 * radar.sigma_azimuth),
                                     0.0, 10.0 + repetition);
    d.range_rate = random.normal(0.3 * radar.sigma_doppler);
    scan.detections.push_back(d);
  }
  DetectionList out;
  filter_detections(scan, radar, 128, out);
  ASSERT_EQ(out.items.size(), 20U);
  for (std::size_t i = 0; i < 20; ++i) EXPECT_EQ(out.items[i].snr_db, 39.0);  // the strongest
  filter_detections(scan, radar, 20, out);
  EXPECT_EQ(out.items.size(), 20U);
  scan.detections.resize(100);  // as many as fit are no crowd
  filter_detections(scan, radar, 128, out);
  EXPECT_EQ(out.items.size(), 100U);
}

}  // namespace
}  // namespace rio
