// SPDX-License-Identifier: BSD-3-Clause
// A flight as recordings of ROS through the `rio` program: info, convert, replay.
#include <gtest/gtest.h>

#include <algorithm>

#include "bag/bag_writer.hpp"
#include "e2e/tool.hpp"
#include "rio/bag/messages.hpp"
#include "rio/io/dataset.hpp"
#include "support/measured.hpp"
#include "support/same_recording.hpp"

namespace rio::test {
namespace {

/// The flight as a node would have recorded it: received 20 ms after its stamps.
std::vector<Written> messages_of(const io::Dataset& data, Wire::Kind kind) {
  const Time delay(20'000'000);
  std::vector<Written> messages;
  std::size_t scan = 0;
  for (const ImuSample& sample : data.imu) {
    for (; scan < data.scans.size() && data.scans[scan].time < sample.time; ++scan) {
      Points points;
      for (const RadarDetection& d : data.scans[scan].detections) {
        const Vector3d& p = d.point_S;
        points.push_back({p.x(), p.y(), p.z(), d.snr_db, d.range_rate});
      }
      const Time time = data.scans[scan].time;
      messages.push_back({"/radar", "sensor_msgs/PointCloud2", time + delay,
                          cloud_message(kind, time, ti_fields(), points, 32)});
    }
    messages.push_back({"/imu", "sensor_msgs/Imu", sample.time + delay, imu_message(kind, sample)});
  }
  return messages;
}

class Bag : public Tool {
 protected:
  /// The flight in a format, and options with the mounting of its radar.
  static std::string recorded(const std::string& format) {
    const io::Dataset data = io::read_dataset(flight_);
    write_bag(file(format), format, messages_of(data, wire_of(format)), 500);
    const Pose& T = *data.radar_info.T_BS;
    std::ofstream options(file("mounting.yaml"));
    options.precision(17);
    options << "radar: {T_BS: {translation: [" << T.translation.x() << ", " << T.translation.y()
            << ", " << T.translation.z() << "], quaternion_wxyz: [" << T.rotation.w() << ", "
            << T.rotation.x() << ", " << T.rotation.y() << ", " << T.rotation.z() << "]}}\n";
    return file(format);
  }
  static Outcome replay(const std::string& recording, const std::string& out) {
    return rio("replay " + recording + " --quiet --init static --config " + file("mounting.yaml") +
               " --out " + file(out));
  }
};

TEST_F(Bag, EveryFormatReplaysAsItsConvertedFolderDoes) {
  std::string first;
  for (const std::string& format : formats()) {
    SCOPED_TRACE(format);
    const std::string recording = recorded(format);
    const std::string folder = file(format + "_asl");
    rio("convert " + recording + " " + folder, {"T_BS"});
    replay(folder, "folder.tum");
    replay(recording, "bag.tum");
    const std::string tum = dir_->read("bag.tum");
    EXPECT_EQ(tum, dir_->read("folder.tum"));
    EXPECT_EQ(tum, first.empty() ? tum : first);
    first = tum;
    EXPECT_GT(lines_of(file("bag.tum")).size(), scans() / 2);
  }
  const double error = path_error(flight_, file("bag.tum"), " --align yaw");
  expect_below("error of the replayed bag [m]", error, 0.5);
}

TEST_F(Bag, InfoTellsTopicsAndConvertDoesNotOverwrite) {
  const std::string recording = recorded("ros1-none");
  rio("info " + recording, {"/radar  sensor_msgs/PointCloud2", "points preset ti"});
  const std::string convert = "convert " + recording + " " + file("kept");
  rio(convert);
  const std::string mine = dir_->read("kept/imu0/data.csv");
  fails(1, convert + " --imu-offset 1s", {"holds a recording already; --force overwrites it"});
  fails(1, "convert " + recording + " /proc/nothing/here", {"rio: /proc/nothing/here"});
  fails(1, "replay " + recording + " --quiet --truth /pose", {"no topic /pose; there are"});
  EXPECT_EQ(dir_->read("kept/imu0/data.csv"), mine);
  rio(convert + " --imu-offset 1s --force");
  EXPECT_NE(dir_->read("kept/imu0/data.csv"), mine);
  rio("convert --field snr=intensity*0.1 --field noise=z " + recording + " " + file("fields"),
      {"doppler=velocity snr=intensity*0.1 noise=z"});
}

TEST_F(Bag, AMapSaysWhatTheCommandLineWouldAndTheCommandLineWins) {
  const std::string recording = recorded("ros1-none");
  const std::string map = dir_->write("map.yaml",
                                      "imu: {offset: 1 s, clock: receive}\n"
                                      "radar:\n  topic: /radar\n  fields:\n"
                                      "    snr: [power, intensity*0.1]\n    noise: z\n");
  const auto same = [](const std::string& a, const std::string& b) {
    for (const char* data : {"/radar0/data.csv", "/imu0/data.csv"}) {
      EXPECT_EQ(lines_of(file(a) + data), lines_of(file(b) + data)) << data;
    }
  };
  const std::string convert = "convert " + recording + " ";
  const std::string fields = " --field snr=intensity*0.1 --field noise=z";
  rio(convert + file("by_map") + " --map " + map, {"doppler=velocity snr=intensity*0.1 noise=z",
                                                   "stamped when they were received, and by 1 s"});
  rio(convert + file("by_line") + " --imu-clock receive --imu-offset 1s" + fields);
  same("by_map", "by_line");
  rio(convert + file("both") + " --imu-clock auto --imu-offset 0 --field noise=x --map " + map);
  rio(convert + file("won") + fields + " --field noise=x");
  same("both", "won");
}

TEST_F(Bag, AMapThatDoesNotFitIsAnErrorWithItsLine) {
  const std::string convert = "convert " + recorded("ros1-none") + " ";
  const fs::path bad = dir_->write("bad.yaml", "radar:\n  points: mine\n");
  fails(1, convert + file("bad") + " --map " + bad.string(),
        {"bad.yaml:2: no such preset of points: \"mine\""});
  EXPECT_FALSE(fs::exists(file("bad")));
}

TEST_F(Bag, ADamagedFileIsUsedAsFarAsItGoesAndIsAnError) {
  recorded("ros1-none");
  const std::string bytes = dir_->read("ros1-none");
  dir_->write("cut", bytes.substr(0, bytes.size() / 2));
  for (const std::string& command :
       {"info " + file("cut"), "convert " + file("cut") + " " + file("c"),
        "replay " + file("cut") + " --quiet --config " + file("mounting.yaml") + " --out " +
            file("cut.tum")}) {
    fails(1, command, {"cut: byte ", "What stands before was used."});
  }
  EXPECT_GT(io::read_dataset(file("c")).scans.size(), scans() / 3);
  EXPECT_GT(lines_of(file("cut.tum")).size(), scans() / 4);
}

TEST_F(Bag, TruthAndBarometerOfABagAreThoseOfItsFolder) {
  const io::Dataset data = io::read_dataset(flight_);
  std::vector<Written> messages = messages_of(data, Wire::kRos1);
  for (const NavState& state : data.ground_truth) {
    Wire pose(Wire::kRos1);
    pose.header(state.time, "map").all(state.p_WB).all(state.q_WB.coeffs());
    messages.push_back({"/truth", bag::kPoseType, state.time, pose.bytes});
    const double pressure = 1e5 * std::exp(-state.p_WB.z() / 8573.0);
    messages.push_back({"/baro", bag::kPressureType, state.time,
                        pressure_message(Wire::kRos1, state.time, pressure)});
  }
  write_bag(file("truth.bag"), "ros1-none", messages, 500);
  recorded("ros1-none");  // the mounting
  const std::string bag = file("truth.bag");
  rio("convert " + bag + " " + file("of_truth"));
  const io::Dataset folder = io::read_dataset(file("of_truth"));
  EXPECT_EQ(folder.ground_truth.size(), data.ground_truth.size());
  EXPECT_EQ(folder.baro.size(), data.ground_truth.size());
  for (const char* init : {" --init static", " --init groundtruth"}) {
    const std::string how =
        " --barometer --quiet --config " + file("mounting.yaml") + init + " --out ";
    rio("replay " + bag + how + file("a.tum"), {"aiding: ", "barometer: offset "});
    rio("replay " + file("of_truth") + how + file("b.tum"));
    EXPECT_EQ(dir_->read("a.tum"), dir_->read("b.tum"));
  }
  const std::string replay = "replay " + bag + " --config " + file("mounting.yaml");
  const Json json = rio(replay + " --barometer --json --report " + file("baro.html")).json();
  EXPECT_GT(json["barometer"]["sigma_m"], 0.0);
  EXPECT_GT(json["barometer"]["nis"], 0.0);
  expect_parts(text_of(file("baro.html")), {"<dt>Barometer</dt><dd>offset "});
  fails(1, replay + " --imu-offset inf", {"--imu-offset inf: no offset of stamps"});
  fails(1, "compare " + bag + " --config " + file("mounting.yaml") + " --truth-topic /none",
        {"no topic /none of type "});
  EXPECT_LT(path_error(flight_, bag, " --topic /truth"), 1e-6);
  rio("plot " + bag + " --out " + file("bag.svg"));
  fails(1, "evaluate " + bag + " " + flight_ + " --topic /truth", {"is no bag, so has no topic /"});
  const double error = path_error(bag, file("a.tum"), " --align yaw --truth /truth");
  EXPECT_NEAR(error, path_error(flight_, file("a.tum"), " --align yaw"), 1e-6);
  EXPECT_LT(error, 0.5);
}

TEST_F(Bag, OfTheOptionsOfABagSensorsAloneGoWithAFolder) {
  const std::string how = "replay " + flight_ + " --no-check --quiet --out ";
  rio(how + file("own.tum"));
  rio(how + file("said.tum") + " --sensors " + flight_);
  EXPECT_EQ(dir_->read("own.tum"), dir_->read("said.tum"));
  fs::create_directories(file("sensors/imu0"));
  fs::create_directories(file("sensors/radar0"));
  dir_->write("sensors/radar0/sensor.yaml", "max_range_m: 3\n");
  rio(how + file("near.tum") + " --sensors " + file("sensors"));
  EXPECT_NE(dir_->read("own.tum"), dir_->read("near.tum"));
  const Parts none = {"options of a bag are given, but it is none"};
  fails(1, "replay " + flight_ + " --points ti", none);
  fails(1, "convert " + flight_ + " " + file("x") + " --imu /imu", none);
}

TEST_F(Bag, AFolderOfARadarWithoutTheOneBeforeIsNamed) {
  fs::copy(copy("gap") / "radar0", file("gap/radar2"));
  const io::Dataset data = io::read_dataset(file("gap"));
  EXPECT_TRUE(data.other_radars.empty());
  EXPECT_EQ(std::count(data.notes.begin(), data.notes.end(),
                       file("gap/radar2") +
                           " is not read: there is no radar1; number the radars without a gap"),
            1);
  expect_parts(try_rio("info " + file("gap")).output, {"a folder of CSV files, for rio replay"});
}

TEST_F(Bag, FolderAsMcapHoldsWhatTheFolderHolds) {
  const std::string mcap = file("of_folder.mcap");
  const std::string convert = "convert " + flight_ + " " + mcap;
  rio(convert, {"--sensors " + flight_});
  rio("convert " + mcap + " " + file("back"));
  expect_same_recording(io::read_dataset(file("back")), io::read_dataset(flight_), 1e-5, 1e-6,
                        [](const RadarDetection& a, const RadarDetection& b) {
                          ASSERT_NEAR(a.snr_db, b.snr_db, 0.0501);  // 0.1 dB
                          ASSERT_NEAR(a.noise_db, b.noise_db, 0.0501);
                        });
  fails(1, "convert " + mcap + " " + mcap + " --force", {"would replace an input"});
  fails(1, convert, {"holds a recording already; --force overwrites it"});
  rio(convert + " --force");
  fs::copy(copy("two") / "radar0", file("two/radar1"));
  const std::string how =
      file("two.mcap") + " --sensors " + file("two") + " --radar /radar0,/radar1";
  const std::string each = std::to_string(scans());
  expect_none(rio("convert " + file("two") + " " + file("two.mcap"),
                  {"`rio replay " + how + "`", each + " + " + each + " scans"})
                  .output,
              {"sigmas"});
  rio("convert " + changed("sigmas", "radar0/data.csv", "$8 = $9 = $10 = $11 = 0.1") + " " +
          file("sigmas.mcap"),
      {"; the ground truth; the sigmas of single points"});
  rio("replay " + how + " --no-check --quiet --out " + file("two.tum"));
}

TEST_F(Bag, CalibratesAsItsFolderDoes) {
  const std::string bag = recorded("ros1-none");
  rio("convert " + bag + " " + file("to_calibrate"));
  const std::string how = " --json --config " + file("mounting.yaml");
  const Json of_folder = rio("calibrate " + file("to_calibrate") + how).json();
  const Json of_bag = rio("calibrate " + bag + " --radar /radar" + how).json();
  for (const char* part : {"T_BS", "parameters"}) EXPECT_EQ(of_folder[part], of_bag[part]) << part;
}

}  // namespace
}  // namespace rio::test
