// SPDX-License-Identifier: BSD-3-Clause
// A recording as it came from the sensors, through the `rio` program.
#include <gtest/gtest.h>

#include <algorithm>

#include "bag/bag_writer.hpp"
#include "e2e/tool.hpp"
#include "rio/bag/messages.hpp"
#include "rio/io/dataset.hpp"
#include "support/measured.hpp"
#include "support/real_data.hpp"

namespace rio::test {
namespace {

/// The recording as it came from the sensors, beside its corrected copy.
class RealBag : public Tool {
 protected:
  void SetUp() override {
    if (demo_.empty()) GTEST_SKIP() << kNoRealData;
  }
  /// As a folder with the mounting and the noise of the copy.
  std::string converted(const std::string& name, const std::string& options) const {
    rio("convert " + bag_ + " " + file(name) + options);
    for (const char* sensor : {"/imu0/sensor.yaml", "/radar0/sensor.yaml"}) {
      fs::copy_file(demo_.string() + sensor, file(name) + sensor,
                    fs::copy_options::overwrite_existing);
    }
    return file(name);
  }

  const fs::path demo_ = real_data("ti_demo/ti_demo.bag").parent_path();
  const std::string bag_ = (demo_ / "ti_demo.bag").string();
};

TEST_F(RealBag, ItsTriggersGiveTheTimesOfItsCorrectedCopy) {
  const std::string triggered =
      converted("triggered", " --map " RIO_SOURCE_DIR "/data/config/map_ti_triggered.yaml");
  const io::Dataset copy = io::read_dataset(demo_);
  const io::Dataset bag = io::read_dataset(triggered);
  ASSERT_EQ(bag.imu.size(), copy.imu.size());
  ASSERT_EQ(bag.scans.size(), copy.scans.size());
  double apart = 0.0;
  for (std::size_t i = 0; i < copy.imu.size(); ++i) {
    apart = std::max(apart, std::abs(to_seconds(bag.imu[i].time - copy.imu[i].time)));
  }
  for (std::size_t i = 0; i < copy.scans.size(); ++i) {
    apart = std::max(apart, std::abs(to_seconds(bag.scans[i].time - copy.scans[i].time)));
    EXPECT_EQ(bag.scans[i].detections.size(), copy.scans[i].detections.size()) << i;
  }
  expect_below("stamps off those of the copy at most [s]", apart, 1e-6);
  rio("replay " + triggered + " --quiet --out " + file("bag.tum"));
  rio("replay " + demo_.string() + " --quiet --out " + file("copy.tum"));
  const double error = path_error(file("copy.tum"), file("bag.tum"));
  expect_below("trajectory off that of the copy [m]", error, 1e-4);  // it holds nine digits
}

/// The IMU and the radar of a bag of ROS 1, serialised anew for ROS 2.
std::vector<Written> as_ros2(const fs::path& path) {
  const auto stream = bag::open_messages(path);
  std::vector<Written> messages;
  bag::Message message;
  while (stream->next(&message)) {
    const bag::Topic& topic = stream->topics()[message.topic];
    if (topic.type == bag::kImuType) {
      const ImuSample sample = bag::decode_imu_of(topic, message.data).sample;
      messages.push_back(
          {topic.name, topic.type, message.received, imu_message(Wire::kCdr, sample)});
    } else if (topic.type == bag::kCloudType) {
      const bag::PointCloud cloud = bag::decode_cloud(topic.encoding, message.data);
      std::vector<CloudField> fields;
      for (const bag::PointField& f : cloud.fields)
        fields.push_back({f.name, f.offset, f.datatype});
      Points points;
      for (std::uint64_t i = 0; i < cloud.size(); ++i) {
        points.emplace_back();
        for (const CloudField& f : fields) {
          points.back().push_back(
              bag::number_of_type(cloud.point(i).data() + f.offset, f.type, cloud.big_endian));
        }
      }
      messages.push_back(
          {topic.name, topic.type, message.received,
           cloud_message(Wire::kCdr, cloud.header.stamp, fields, points, cloud.point_step)});
    }
  }
  EXPECT_EQ(stream->damage(), "");
  return messages;
}

TEST_F(RealBag, IsTheSameInEveryFormat) {
  rio("info " + bag_, {"11152 messages", "8270", "412 of 412 are zero"});  // as rosbag counts them

  const std::string how = " --radar-offset \"-122 ms\"";  // the delay of its driver
  const Json json = rio("replay " + converted("demo", how) + " --quiet --json").json();
  const double off = json["first_to_last_m"];
  // perturbed copies of it: 0.11, worst 0.37
  expect_below("from the first to the last position [m]", off, 0.4);

  // without its mounting, so that the estimate may end lost; the trajectory is written all the same
  const auto replays = [&how](const std::string& recording, const std::string& out) {
    const Outcome run = try_rio("replay " + recording + how + " --quiet --out " + out);
    EXPECT_TRUE(run.code == 0 || run.code == 3) << run.output;
  };
  replays(bag_, file("a.tum"));
  const std::vector<Written> messages = as_ros2(bag_);
  for (const std::string& format : formats()) {
    if (format.starts_with("ros1")) continue;
    write_bag(file("b"), format, messages, 500);
    replays(file("b"), file("b.tum"));
    EXPECT_EQ(dir_->read("a.tum"), dir_->read("b.tum")) << format;
    fs::remove(file("b"));
  }
}

}  // namespace
}  // namespace rio::test
