// SPDX-License-Identifier: BSD-3-Clause
#include "rio/bag/point_fields.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "bag/ros_message.hpp"
#include "support/temp_dir.hpp"

namespace rio::bag {
namespace {

/// One cloud and what it is taken for.
struct Case {
  Case(std::vector<test::CloudField> f, test::Points p, std::uint32_t s)
      : fields(std::move(f)), points(std::move(p)), step(s) {}

  std::vector<RadarDetection> read(const PointRequest& request = {}) {
    bytes = cloud_message(test::Wire::kRos1, Time(0), fields, points, step);
    const PointCloud cloud = decode_cloud(
        Encoding::kRos1, {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
    const PointMap map(cloud.fields, request);
    text = map.text();
    std::vector<RadarDetection> detections;
    left_out = map.convert(cloud, &detections);
    return detections;
  }
  std::vector<test::CloudField> fields;
  test::Points points;
  std::uint32_t step;
  std::string bytes;
  std::string text;
  std::size_t left_out = 0;
};

/// Float fields four bytes apart.
Case floats(const std::vector<std::string>& names, const std::vector<double>& values) {
  std::vector<test::CloudField> fields;
  for (const std::string& name : names) {
    fields.push_back({name, static_cast<std::uint32_t>(4 * fields.size())});
  }
  return {fields, {values}, 64};
}

TEST(PointFields, TiDriver) {
  Case c{test::ti_fields(), {{1, 2, 3, 12.5, -0.25}}, 32};
  const RadarDetection d = c.read().at(0);
  EXPECT_EQ(d.point_S, Vector3d(1, 2, 3));
  EXPECT_EQ(d.range_rate, -0.25);
  EXPECT_EQ(d.snr_db, 12.5);
  EXPECT_EQ(d.noise_db, 0.0);
  EXPECT_EQ(c.text,
            "preset ti: x=x y=y z=z doppler=velocity snr=intensity; axes x forward, y left, z up; "
            "doppler positive = receding");
}

TEST(PointFields, EkfRioInTheAxesOfTheChip) {
  Case c = floats({"x", "y", "z", "snr_db", "noise_db", "v_doppler_mps"}, {1, 2, 3, 12, 40, -2});
  const RadarDetection d = c.read().at(0);
  EXPECT_EQ(d.point_S, Vector3d(2, -1, 3));  // the chip's y is forward, its x is to the right
  EXPECT_EQ(d.range_rate, -2.0);
  EXPECT_EQ(d.noise_db, 40.0);
  EXPECT_PRED2(test::contains, c.text, "preset rio");
}

TEST(PointFields, MavSensorsGiveTenthsOfDecibels) {
  Case c{{{"x", 0}, {"y", 4}, {"z", 8}, {"doppler", 12}, {"snr", 16, 3}, {"noise", 18, 3}},
         {{1, 2, 3, -2, 125, 400}},
         20};
  const RadarDetection d = c.read().at(0);
  EXPECT_EQ(d.point_S, Vector3d(2, -1, 3));
  EXPECT_NEAR(d.snr_db, 12.5, 1e-12);
  EXPECT_NEAR(d.noise_db, 40.0, 1e-12);
  Case decibels = floats({"x", "y", "z", "doppler", "snr", "noise"}, {1, 2, 3, -2, 12.5, 40});
  EXPECT_EQ(decibels.read().at(0).snr_db, 12.5);  // not those of mav_sensors: floats
  EXPECT_PRED2(test::contains, decibels.text, "by their names");
}

TEST(PointFields, ColoRadarMscAndAltos) {
  Case coloradar = floats({"x", "y", "z", "intensity", "doppler", "range"}, {1, 2, 3, 4, 5, 9});
  EXPECT_EQ(coloradar.read().at(0).point_S, Vector3d(2, -1, 3));
  EXPECT_PRED2(test::contains, coloradar.text, "preset coloradar");
  EXPECT_PRED2(test::contains, coloradar.text,
               "ibcn has the same fields in forward, left, up: --axes flu");
  PointRequest flu;
  flu.axes = "flu";
  EXPECT_EQ(coloradar.read(flu).at(0).point_S, Vector3d(1, 2, 3));
  EXPECT_EQ(coloradar.text.find("ibcn"), std::string::npos);
  Case msc = floats({"x", "y", "z", "alpha", "beta", "power", "doppler", "range"},
                    {1, 2, 3, 40, 50, 60, 7, 8});
  EXPECT_EQ(msc.read().at(0).snr_db, 60.0);
  EXPECT_EQ(msc.read().at(0).point_S, Vector3d(3, -1, -2));
  EXPECT_PRED2(test::contains, msc.text, "preset msc");
  Case altos = floats({"x", "y", "z", "h", "s", "v"}, {1, 2, 3, 4, 5, 6});
  EXPECT_EQ(altos.read().at(0).range_rate, 4.0);
  EXPECT_PRED2(test::contains, altos.text, "no SNR");
}

TEST(PointFields, Ars548IsPolarWithItsSigmas) {
  Case c = floats({"azimuth", "azimuthSTD", "elevation", "elevationSTD", "range", "rangeSTD",
                   "velocity", "velocitySTD"},
                  {0.5, 0.01, -0.25, 0.02, 10.0, 0.1, 3.0, 0.05});
  const RadarDetection d = c.read().at(0);
  EXPECT_NEAR(d.point_S.x(), 10.0 * std::cos(0.25) * std::cos(0.5), 1e-9);
  EXPECT_NEAR(d.point_S.y(), 10.0 * std::cos(0.25) * std::sin(0.5), 1e-9);
  EXPECT_NEAR(d.point_S.z(), -10.0 * std::sin(0.25), 1e-9);
  EXPECT_EQ(d.range_rate, 3.0);
  EXPECT_NEAR(d.sigma_range, 0.1, 1e-7);
  EXPECT_NEAR(d.sigma_azimuth, 0.01, 1e-7);
  EXPECT_NEAR(d.sigma_elevation, 0.02, 1e-7);
  EXPECT_NEAR(d.sigma_doppler, 0.05, 1e-7);
}

TEST(PointFields, ADopplerHiddenInThePaddingIsReadWhenAskedFor) {
  Case c{{{"x", 0}, {"y", 4}, {"z", 8}, {"", 12}, {"intensity", 16}}, {{1, 2, 3, -1.5, 8}}, 32};
  EXPECT_ERROR(c.read(), "no Doppler");
  PointRequest request;
  request.preset = "pointxyzi";
  EXPECT_EQ(c.read(request).at(0).range_rate, -1.5);
}

TEST(PointFields, TheChannelsOfTheEagleAreTakenByTheirPlace) {
  Case c = floats({"x", "y", "z", "a", "b", "c"}, {1, 2, 3, -0.5, 5, 30});
  PointRequest request;
  request.preset = "eagle";
  const RadarDetection d = c.read(request).at(0);
  EXPECT_EQ(d.point_S, Vector3d(1, 2, 3));
  EXPECT_EQ(d.range_rate, -0.5);
  EXPECT_EQ(d.snr_db, 30.0);
  EXPECT_ERROR(floats({"x", "y", "z"}, {1, 2, 3}).read(request), "no field \"#3\" for the doppler");
}

TEST(PointFields, UnknownCloudsAreMatchedByName) {
  Case c = floats({"X", "Y", "Z", "rdot", "Power", "id"}, {1, 2, 3, 4, 5, 6});
  const RadarDetection d = c.read().at(0);
  EXPECT_EQ(d.point_S, Vector3d(1, 2, 3));
  EXPECT_EQ(d.range_rate, 4.0);
  EXPECT_EQ(d.snr_db, 5.0);
  EXPECT_PRED2(test::contains, c.text, "by their names: x=X y=Y z=Z doppler=rdot snr=Power; axes");
}

TEST(PointFields, WhatIsMissingOrAmbiguousIsAnErrorWithTheFields) {
  EXPECT_ERROR(floats({"x", "y", "z", "foo"}, {1, 2, 3, 4}).read(),
               "no Doppler; name it with --field doppler=NAME");
  EXPECT_ERROR(floats({"x", "y", "z", "foo"}, {1, 2, 3, 4}).read(),
               "(fields found: x float32 @0, y float32 @4, z float32 @8, foo float32 @12)");
  EXPECT_ERROR(floats({"x", "y", "doppler"}, {1, 2, 3}).read(), "neither x y z nor range");
  Case two = floats({"x", "y", "z", "doppler", "velocity"}, {1, 2, 3, 4, 5});
  EXPECT_ERROR(two.read(), "two fields may be the doppler, \"doppler\" and \"velocity\"");
  PointRequest request;
  request.fields = {{"doppler=velocity", ""}};
  EXPECT_EQ(two.read(request).at(0).range_rate, 5.0);
}

TEST(PointFields, WhatTheUserSaysWins) {
  Case c = floats({"x", "y", "z", "a", "b"}, {1, 2, 3, 4, 5});
  PointRequest request;
  request.fields = {{"doppler=a*0.5", ""}, {"snr=b*0.1", ""}};
  request.approaching = true;
  request.axes = "rdf";
  const RadarDetection d = c.read(request).at(0);
  EXPECT_EQ(d.point_S, Vector3d(3, -1, -2));
  EXPECT_EQ(d.range_rate, -2.0);
  EXPECT_EQ(d.snr_db, 0.5);
  request.axes = "frd";
  EXPECT_EQ(c.read(request).at(0).point_S, Vector3d(1, -2, -3));
  request.axes = "xyz";
  EXPECT_ERROR(c.read(request), "no such axes");
  request.axes = "";
  request.fields = {{"speed=a", ""}};
  EXPECT_ERROR(c.read(request), "\"speed\" is no quantity");
  request.fields = {{"doppler", ""}};
  EXPECT_ERROR(c.read(request), "should be QUANTITY=FIELD");
  request.fields = {{"doppler=c", ""}};
  EXPECT_ERROR(c.read(request), "no field \"c\" for the doppler");
  request.fields = {{"doppler=a*b", ""}};
  EXPECT_ERROR(c.read(request), "no scale");
  request.fields = {{"doppler=@62", ""}};
  EXPECT_ERROR(c.read(request), "\"@62\" is outside of a point");
  request.fields.clear();
  request.preset = "none";
  EXPECT_ERROR(c.read(request), "no such preset of points");
}

TEST(PointFields, OfSeveralNamesTheOneThatIsThereCounts) {
  PointRequest request;
  request.where = "map.yaml:2";
  request.fields = {{"doppler=v", ""}, {"doppler=rdot*-1,speed", "map.yaml:7"}};
  Case c = floats({"x", "y", "z", "v", "rdot"}, {1, 2, 3, 4, 5});
  EXPECT_EQ(c.read(request).at(0).range_rate, -5.0);
  Case s = floats({"x", "y", "z", "v", "speed"}, {1, 2, 3, 4, 5});
  EXPECT_EQ(s.read(request).at(0).range_rate, 5.0);
  EXPECT_ERROR(floats({"x", "y", "z", "v"}, {1, 2, 3, 4}).read(request),
               "map.yaml:7: points: no field \"rdot*-1,speed\" for the doppler (fields found: x f");
  EXPECT_ERROR(floats({"x", "y", "z", "rdot", "speed"}, {1, 2, 3, 4, 5}).read(request),
               "map.yaml:7: points: two fields may be the doppler, \"rdot*-1\" and \"speed\"");
  EXPECT_ERROR(floats({"x", "y", "rdot"}, {1, 2, 3}).read(request),
               "map.yaml:2: points: neither x y z nor range");
}

TEST(PointFields, PointsThatAreNotFiniteAreLeftOut) {
  Case c{test::ti_fields(), {{1, 2, 3, 4, 5}, {NAN, 2, 3, 4, 5}, {1, 2, 3, 4, INFINITY}}, 32};
  EXPECT_EQ(c.read().size(), 1U);
  EXPECT_EQ(c.left_out, 2U);
}

}  // namespace
}  // namespace rio::bag
