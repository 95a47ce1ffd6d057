// SPDX-License-Identifier: BSD-3-Clause
// What the fields of a cloud are taken for, and the file of `--map`.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "bag/ros_message.hpp"
#include "rio/bag/point_fields.hpp"
#include "rio/bag/recording.hpp"
#include "support/temp_dir.hpp"

namespace rio::bag {
namespace {

using Fields = std::vector<test::CloudField>;

/// Fields four bytes apart, by their names: float32, or with the number of their type behind a
/// colon.
Fields fields_of(const std::string& names) {
  Fields fields;
  std::istringstream words(names);
  for (std::string name; words >> name;) {
    const std::size_t colon = std::min(name.find(':'), name.size());
    const auto type = static_cast<std::uint8_t>(colon + 1 < name.size() ? name.back() - '0' : 7);
    fields.push_back({name.substr(0, colon), static_cast<std::uint32_t>(4 * fields.size()), type});
  }
  return fields;
}

/// What a cloud is taken for.
struct Taken {
  std::vector<RadarDetection> detections;
  std::size_t left_out = 0;
  std::string text;
};

Taken read(const Fields& fields, const test::Points& points, const PointRequest& request = {}) {
  const std::string bytes = cloud_message(test::Wire::kRos1, Time(0), fields, points, 64);
  const PointCloud cloud = decode_cloud(Encoding::kRos1, test::bytes_of(bytes));
  const PointMap map(cloud.fields, request);
  Taken taken;
  taken.left_out = map.convert(cloud, &taken.detections);
  taken.text = map.text();
  return taken;
}

/// The detection of a point with the values 1, 2, 3...
RadarDetection counted(const std::string& names, const PointRequest& request = {}) {
  return read(fields_of(names), {{1, 2, 3, 4, 5, 6, 7, 8}}, request).detections.at(0);
}

PointRequest rules(const std::vector<PointRequest::Rule>& fields) {
  PointRequest request;
  request.fields = fields;
  return request;
}

/// "x y z range_rate, snr_db, noise_db"
std::string text_of(const RadarDetection& d) {
  std::ostringstream text;
  for (const double x : d.point_S) text << x << " ";
  text << d.range_rate << ", " << d.snr_db << ", " << d.noise_db;
  return text.str();
}

TEST(PointFields, KnownCloudsAreTakenForWhatTheyAre) {
  constexpr const char* kColoradar = "x y z intensity doppler range";
  struct Known {
    const char* fields;  ///< of the values 1, 2, 3...
    const char* detection;
    const char* told;
    const char* preset = "";  ///< of the request
    const char* axes = "";
  };
  const Known table[] = {
      {"x y z intensity velocity", "1 2 3 5, 4, 0",
       "preset ti: x=x y=y z=z doppler=velocity snr=intensity; axes x forward, y left, z up; "
       "doppler positive = receding"},
      // the chip's y is forward, its x is to the right
      {"x y z snr_db noise_db v_doppler_mps", "2 -1 3 6, 4, 5", "preset rio"},
      {"x y z doppler snr:3 noise:3", "2 -1 3 4, 0.5, 0.6", "preset mav"},
      {"x y z doppler snr noise", "1 2 3 4, 5, 6", "by their names"},  // floats: not mav_sensors
      {kColoradar, "2 -1 3 5, 4, 0", "preset coloradar"},
      {kColoradar, "2 -1 3 5, 4, 0", "ibcn has the same fields in forward, left, up: --axes flu"},
      {kColoradar, "1 2 3 5, 4, 0", "preset coloradar", "", "flu"},
      {"x y z alpha beta power doppler range", "3 -1 -2 7, 6, 0", "preset msc"},
      {"x y z h s v", "1 2 3 4, 0, 0", "no SNR"},
      {"x y z : intensity", "2 -1 3 4, 5, 0", "doppler=@12", "pointxyzi"},  // in the padding
      {"x y z a b c", "1 2 3 4, 6, 0", "preset eagle", "eagle"},
      {"X Y Z rdot Power id", "1 2 3 4, 5, 0",
       "by their names: x=X y=Y z=Z doppler=rdot snr=Power; axes"}};
  for (const Known& known : table) {
    SCOPED_TRACE(known.told);
    PointRequest request;
    request.preset = known.preset;
    request.axes = known.axes;
    EXPECT_EQ(text_of(counted(known.fields, request)), known.detection);
    const std::string told = read(fields_of(known.fields), {}, request).text;
    EXPECT_PRED2(test::contains, told, known.told);
    EXPECT_FALSE(request.axes == "flu" && test::contains(told, "ibcn"));
  }
  EXPECT_ERROR(counted("x y z : intensity"), "no Doppler");
}

TEST(PointFields, Ars548IsPolarWithItsSigmas) {
  const RadarDetection d =
      read(fields_of(
               "azimuth azimuthSTD elevation elevationSTD range rangeSTD velocity velocitySTD"),
           {{0.5, 0.01, -0.25, 0.02, 10.0, 0.1, 3.0, 0.05}})
          .detections.at(0);
  EXPECT_NEAR(d.point_S.x(), 10.0 * std::cos(0.25) * std::cos(0.5), 1e-9);
  EXPECT_NEAR(d.point_S.y(), 10.0 * std::cos(0.25) * std::sin(0.5), 1e-9);
  EXPECT_NEAR(d.point_S.z(), -10.0 * std::sin(0.25), 1e-9);
  EXPECT_EQ(d.range_rate, 3.0);
  EXPECT_NEAR(d.sigma_range, 0.1, 1e-7);
  EXPECT_NEAR(d.sigma_azimuth, 0.01, 1e-7);
  EXPECT_NEAR(d.sigma_elevation, 0.02, 1e-7);
  EXPECT_NEAR(d.sigma_doppler, 0.05, 1e-7);
}

TEST(PointFields, WhatIsMissingOrAmbiguousIsAnErrorWithTheFields) {
  EXPECT_ERROR(counted("x y z foo"), "no Doppler; name it with --field doppler=NAME");
  EXPECT_ERROR(counted("x y z foo"),
               "(fields found: x float32 @0, y float32 @4, z float32 @8, foo float32 @12)");
  EXPECT_ERROR(counted("x y doppler"), "neither x y z nor range");
  EXPECT_ERROR(counted("x y z doppler velocity"),
               "two fields may be the doppler, \"doppler\" and \"velocity\"");
  EXPECT_EQ(counted("x y z doppler velocity", rules({{"doppler=velocity", ""}})).range_rate, 5.0);
  EXPECT_EQ(counted("x y z radial_speed power rcs noise SNR").snr_db, 8.0);
}

TEST(PointFields, WhatTheUserSaysWins) {
  PointRequest request = rules({{"doppler=a*0.5", ""}, {"snr=b*0.1", ""}});
  request.approaching = true;
  request.axes = "rdf";
  const RadarDetection d = counted("x y z a b", request);
  EXPECT_EQ(d.point_S, Vector3d(3, -1, -2));
  EXPECT_EQ(d.range_rate, -2.0);
  EXPECT_EQ(d.snr_db, 0.5);
  request.axes = "frd";
  EXPECT_EQ(counted("x y z a b", request).point_S, Vector3d(1, -2, -3));
  request.axes = "xyz";
  EXPECT_ERROR(counted("x y z a b", request), "no such axes");
  for (const auto& wrong : {std::pair("speed=a", "\"speed\" is no quantity"),
                            std::pair("doppler", "should be QUANTITY=FIELD"),
                            std::pair("doppler=c", "no field \"c\" for the doppler"),
                            std::pair("doppler=#5", "no field \"#5\" for the doppler"),
                            std::pair("doppler=a*b", "no scale"),
                            std::pair("doppler=@62", "\"@62\" is outside of a point")}) {
    EXPECT_ERROR(counted("x y z a b", rules({{wrong.first, ""}})), wrong.second);
  }
  request = {};
  request.preset = "none";
  EXPECT_ERROR(counted("x y z a b", request), "no such preset of points");
}

TEST(PointFields, OfSeveralNamesTheOneThatIsThereCounts) {
  PointRequest request = rules({{"doppler=v", ""}, {"doppler=rdot*-1,speed", "map.yaml:7"}});
  request.where = "map.yaml:2";
  EXPECT_EQ(counted("x y z v rdot", request).range_rate, -5.0);
  EXPECT_EQ(counted("x y z v speed", request).range_rate, 5.0);
  EXPECT_ERROR(counted("x y z v", request),
               "map.yaml:7: points: no field \"rdot*-1,speed\" for the doppler (fields found: x f");
  EXPECT_ERROR(counted("x y z rdot speed", request),
               "map.yaml:7: points: two fields may be the doppler, \"rdot*-1\" and \"speed\"");
  EXPECT_ERROR(counted("x y rdot", request), "map.yaml:2: points: neither x y z nor range");
}

TEST(PointFields, PointsThatAreNotFiniteAreLeftOut) {
  const Taken taken =
      read(test::ti_fields(), {{1, 2, 3, 4, 5}, {NAN, 2, 3, 4, 5}, {1, 2, 3, 4, INFINITY}});
  EXPECT_EQ(taken.detections.size(), 1U);
  EXPECT_EQ(taken.left_out, 2U);
}

TEST(PointFields, APointWithoutSnrIsUsed) {
  const Taken taken = read(fields_of("x y z doppler snr"), {{1, 2, 3, 4, NAN}, {1, 2, 3, 4, 5}});
  ASSERT_EQ(taken.detections.size(), 2U);
  EXPECT_EQ(taken.detections[0].snr_db, 0.0);
  EXPECT_EQ(taken.detections[1].snr_db, 5.0);
}

class RecordingMapTest : public testing::Test {
 protected:
  RecordingRequest load(const std::string& text) {
    return load_recording_map(dir_.write("map.yaml", text));
  }
  test::TempDir dir_;
};

TEST_F(RecordingMapTest, ReadsEveryKey) {
  const RecordingRequest r = load(
      "imu: {topic: /imu/data, clock: carried, offset: 3 ms, gyro_unit: deg/s, accel_unit: -mg}\n"
      "radar:\n  topic: /scan\n  clock: trigger\n  trigger: /tick\n  trigger_match: earlier\n"
      "  offset: -0.5\n  points: ti\n  axes: rdf\n  approaching: true\n"
      "  fields:\n    snr: power*0.1\n    doppler: [rdot*-1, velocity]\n");
  EXPECT_EQ(r.imu_topic, "/imu/data");
  EXPECT_EQ(r.imu_clock, Clock::kCarried);
  EXPECT_EQ(r.imu_offset, 3e-3);
  EXPECT_NEAR(r.gyro_unit, 0.017453292519943295, 1e-15);
  EXPECT_NEAR(r.accel_unit, -9.80665e-3, 1e-15);
  EXPECT_EQ(r.radar_topic, "/scan");
  EXPECT_EQ(r.radar_clock, Clock::kTrigger);
  EXPECT_EQ(r.trigger_topic, "/tick");
  EXPECT_EQ(r.trigger_match, TriggerMatch::kEarlier);
  EXPECT_EQ(r.radar_offset, -0.5);
  EXPECT_EQ(r.points.preset, "ti");
  EXPECT_EQ(r.points.axes, "rdf");
  EXPECT_TRUE(r.points.approaching);
  ASSERT_EQ(r.points.fields.size(), 2U);
  EXPECT_EQ(r.points.fields[0].text, "snr=power*0.1");
  EXPECT_EQ(r.points.fields[1].text, "doppler=rdot*-1,velocity");
  EXPECT_PRED2(test::contains, r.points.fields[1].where, "map.yaml:13");
}

TEST_F(RecordingMapTest, WhatIsNotSaidStays) {
  for (const char* text : {"# nothing\n", "imu:\n", "radar: {topic: /scan}\n"}) {
    const RecordingRequest r = load(text);
    EXPECT_EQ(r.imu_clock, Clock::kAuto) << text;
    EXPECT_EQ(r.gyro_unit, 1.0) << text;
    EXPECT_TRUE(r.points.fields.empty()) << text;
  }
}

TEST_F(RecordingMapTest, NamesTheLineOfWhatIsWrong) {
  EXPECT_ERROR(load("imu: {topic: /imu}\nradar: {topics: /r}\n"),
               "map.yaml:2: unknown key \"radar.topics\", did you mean \"radar.topic\"?");
  EXPECT_ERROR(
      load("imu:\n  clock: mine\n"),
      "map.yaml:2: imu.clock: auto or header or receive or carried or trigger is expected");
  EXPECT_ERROR(load("imu:\n  topic: /a\n  gyro_unit: deg\n"),
               "map.yaml:3: imu.gyro_unit: \"1 deg\"");
  EXPECT_ERROR(load("radar:\n  offset: 3 m\n"), "map.yaml:2: radar.offset: ");
  EXPECT_ERROR(load("imu: {topic: [a, b]}\n"), "map.yaml:1: imu.topic: a text is expected");
  EXPECT_ERROR(load("radar:\n  fields: doppler\n"), "map.yaml:2: radar.fields: a map is expected");
  for (const char* source : {"", "[]", "{a: b}", "[a, [b]]"}) {
    EXPECT_ERROR(load(std::string("radar:\n  fields:\n    doppler: ") + source + "\n"),
                 "map.yaml:3: the name of a field, or a list of them, is expected");
  }
}

}  // namespace
}  // namespace rio::bag
