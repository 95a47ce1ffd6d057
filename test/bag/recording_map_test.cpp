// SPDX-License-Identifier: BSD-3-Clause
// The file of `--map`.
#include "rio/bag/recording_map.hpp"

#include <gtest/gtest.h>

#include "support/temp_dir.hpp"

namespace rio::bag {
namespace {

class RecordingMapTest : public testing::Test {
 protected:
  RecordingRequest load(const std::string& text) {
    return load_recording_map(dir_.write("map.yaml", text));
  }
  test::TempDir dir_;
};

TEST_F(RecordingMapTest, ReadsEveryKey) {
  const RecordingRequest r = load(
      "imu: {topic: /imu/data, clock: carried, offset: 3 ms, gyro_unit: deg/s, accel_unit: mg}\n"
      "radar:\n  topic: /scan\n  clock: trigger\n  trigger: /tick\n  trigger_match: earlier\n"
      "  offset: -0.5\n  points: ti\n  axes: rdf\n  approaching: true\n"
      "  fields:\n    snr: power*0.1\n    doppler: [rdot*-1, velocity]\n");
  EXPECT_EQ(r.imu_topic, "/imu/data");
  EXPECT_EQ(r.imu_clock, Clock::kCarried);
  EXPECT_EQ(r.imu_offset, 3e-3);
  EXPECT_NEAR(r.gyro_unit, 0.017453292519943295, 1e-15);
  EXPECT_NEAR(r.accel_unit, 9.80665e-3, 1e-15);
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
