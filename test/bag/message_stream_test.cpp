// SPDX-License-Identifier: BSD-3-Clause
#include "rio/bag/message_stream.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "bag/bag_writer.hpp"
#include "support/temp_dir.hpp"

namespace rio::bag {
namespace {

using test::TempDir;
using test::Written;

/// What a stream gives, with the topics spelled out.
struct Reading {
  std::vector<Written> messages;
  std::string damage;
};

Reading read_all(const std::filesystem::path& path) {
  const auto stream = open_messages(path);
  Reading reading;
  Message message;
  while (stream->next(&message)) {
    const Topic& topic = stream->topics()[message.topic];
    reading.messages.push_back(
        {topic.name, topic.type, message.received,
         std::string(reinterpret_cast<const char*>(message.data.data()), message.data.size())});
  }
  EXPECT_FALSE(stream->next(&message));
  reading.damage = stream->damage();
  return reading;
}

void expect_prefix(const std::vector<Written>& part, const std::vector<Written>& all) {
  ASSERT_LE(part.size(), all.size());
  for (std::size_t i = 0; i < part.size(); ++i) {
    ASSERT_EQ(part[i].topic, all[i].topic) << i;
    ASSERT_EQ(part[i].type, all[i].type) << i;
    ASSERT_EQ(part[i].received, all[i].received) << i;
    ASSERT_EQ(part[i].data, all[i].data) << i;
  }
}

class Format : public testing::TestWithParam<std::string> {
 protected:
  Format() {
    messages_ = test::at_rest(test::wire_of(GetParam()), 20);
    test::write_bag(file(), GetParam(), messages_);
    bytes_ = dir_.read("recording");
  }
  std::filesystem::path file() const { return dir_.path() / "recording"; }
  Reading read(const std::string& bytes) const { return read_all(dir_.write("other", bytes)); }

  TempDir dir_;
  std::vector<Written> messages_;
  std::string bytes_;
};

TEST_P(Format, EveryMessageComesBackInTheOrderOfTheFile) {
  const Reading reading = read_all(file());
  EXPECT_EQ(reading.damage, "");
  EXPECT_EQ(reading.messages.size(), messages_.size());
  expect_prefix(reading.messages, messages_);
}

TEST_P(Format, CutOffItGivesWhatStandsBeforeAndTheByte) {
  std::size_t before = 0;
  for (int part = 1; part < 20; ++part) {
    const std::size_t size = bytes_.size() * static_cast<std::size_t>(part) / 20;
    if (GetParam() == "db3" && size < 4096) continue;
    const Reading reading = read(bytes_.substr(0, size));
    EXPECT_PRED2(test::contains, reading.damage, "other: byte ");
    expect_prefix(reading.messages, messages_);
    EXPECT_GE(reading.messages.size(), before);
    before = reading.messages.size();
  }
  EXPECT_GT(before, messages_.size() / 2);
}

INSTANTIATE_TEST_SUITE_P(Bag, Format, testing::ValuesIn(test::formats()), test::format_name);

TEST(MessageStream, DamageEndsItWithWhatIsWrong) {
  const auto flip = [](std::string* bytes) { (*bytes)[bytes->size() / 2] ^= 1; };
  const auto cut = [](std::string* bytes) { bytes->resize(bytes->size() / 2); };
  const auto without_index = [](std::string* bytes) {
    bytes->replace(bytes->find("index_pos=") + 10, 8, std::string(8, '\0'));
  };
  const auto long_header = [](std::string* bytes) { bytes->replace(13, 4, "\xFF\xFF\xFF\x7F"); };
  struct Damaged {
    const char* format;
    std::size_t per_chunk;  ///< of 110 messages
    std::function<void(std::string*)> damage;
    std::size_t least, most;  ///< messages that are read
    const char* what;
  };
  const Damaged table[] = {
      {"mcap-none", 22, flip, 44, 44, "its check sum is wrong"},  // two of five chunks
      {"ros1-none", 1000, cut, 41, 59, "the file ends inside of this chunk"},
      {"mcap-none", 1000, cut, 41, 59, "the file ends inside of this chunk"},
      {"ros1-none", 100, without_index, 110, 110, "was not closed"},
      {"ros1-none", 100, long_header, 0, 0, "byte 13: a record header of more than 1 MiB"}};
  const TempDir dir;
  for (const Damaged& damaged : table) {
    SCOPED_TRACE(damaged.what);
    const std::vector<Written> messages = test::at_rest(test::wire_of(damaged.format), 10);
    test::write_bag(dir.path() / "a", damaged.format, messages, damaged.per_chunk);
    std::string bytes = dir.read("a");
    damaged.damage(&bytes);
    const Reading reading = read_all(dir.write("b", bytes));
    EXPECT_GE(reading.messages.size(), damaged.least);
    EXPECT_LE(reading.messages.size(), damaged.most);
    expect_prefix(reading.messages, messages);
    EXPECT_PRED2(test::contains, reading.damage, damaged.what);
  }
}

TEST(MessageStream, McapMayHoldMessagesOfRos1) {
  const std::vector<Written> messages = test::at_rest(test::Wire::kRos1, 2);
  const TempDir dir;
  const auto stream = open_messages(dir.write("a", test::mcap(messages, "none", 100, "ros1")));
  Message message;
  ASSERT_TRUE(stream->next(&message));
  EXPECT_EQ(stream->topics()[0].encoding, Encoding::kRos1);
  EXPECT_EQ(stream->format(), "MCAP");
}

TEST(MessageStream, AFolderOfPartsIsReadFileByFile) {
  const std::vector<Written> messages = test::at_rest(test::Wire::kCdr, 12);
  const TempDir dir;
  const auto part = [&](std::size_t i) {  // one message each
    return test::mcap({messages[i]}, "none", 1);
  };
  const auto folder = dir.path() / "folder";
  dir.write("folder/a_0.mcap", part(0));
  EXPECT_TRUE(is_recording(folder));
  EXPECT_EQ(read_all(folder).messages.size(), 1U);
  for (std::size_t i = 1; i < 12; ++i)
    dir.write("folder/a_" + std::to_string(i) + ".mcap", part(i));
  Reading reading = read_all(folder);
  EXPECT_EQ(reading.messages.size(), 12U);
  expect_prefix(reading.messages, messages);
  EXPECT_EQ(open_messages(folder)->format(), "folder of 12 files, one recording");
  std::filesystem::remove(folder / "a_0.mcap");
  reading = read_all(folder);
  EXPECT_EQ(reading.messages.size(), 11U);
  EXPECT_PRED2(test::contains, reading.damage,
               "folder: part 0 is missing, the recording begins with a_1.mcap");
  dir.write("folder/a_0.mcap", part(0));
  dir.write("folder/b_12.mcap", part(0));
  EXPECT_ERROR(open_messages(folder), "holds several recordings; name one, as");
  dir.write("folder/metadata.yaml", "");
  EXPECT_EQ(read_all(folder).messages.size(), 13U);
  std::filesystem::remove(folder / "b_12.mcap");
  dir.write("folder/metadata.yaml",
            "rosbag2_bagfile_information: {relative_file_paths: [a_0.mcap, a_11.mcap, a_12.mcap]}");
  reading = read_all(folder);
  EXPECT_EQ(reading.messages.size(), 12U);
  EXPECT_PRED2(test::contains, reading.damage, "folder: a_12.mcap of metadata.yaml is missing");
  dir.write("folder/metadata.yaml", "");

  dir.write("folder/a_10.mcap", part(10).substr(0, 60));
  reading = read_all(folder);
  EXPECT_EQ(reading.messages.size(), 10U);
  EXPECT_PRED2(test::contains, reading.damage, "a_10.mcap: byte ");
  EXPECT_PRED2(test::contains, reading.damage,
               "; the 1 parts after it are not read, from a_11.mcap on");
  dir.write("folder/a_5.mcap", "");
  reading = read_all(folder);
  EXPECT_EQ(reading.messages.size(), 5U);
  EXPECT_PRED2(test::contains, reading.damage, "a_5.mcap: is empty; the 6 parts after it are not");
  std::filesystem::remove(folder / "a_5.mcap");
  std::filesystem::remove(folder / "a_6.mcap");
  reading = read_all(folder);
  EXPECT_EQ(reading.messages.size(), 5U);
  EXPECT_PRED2(test::contains, reading.damage,
               "folder: parts 5 to 6 are missing; the 5 parts after");
  dir.write("folder/a_5.mcap", part(5));
  dir.write("folder/a_6.mcap", part(6));
  dir.write("folder/a_11.bag",
            test::ros1_bag(test::at_rest(test::Wire::kRos1, 2), "none", 100));  // of another kind
  EXPECT_ERROR(open_messages(folder), "holds several recordings; name one, as");
}

TEST(MessageStream, FlightsThatAreNumberedAreNoParts) {
  std::vector<Written> messages = test::at_rest(test::Wire::kRos1, 2);
  const TempDir dir;
  for (const char* name : {"flight_1.bag", "flight_2.bag", "flight_4.bag"}) {
    dir.write(name, test::ros1_bag(messages, "none", 100));
    for (Written& m : messages) m.received += Time(60'000'000'000);
  }
  EXPECT_ERROR(open_messages(dir.path()),
               "holds several recordings, or part 3 is missing; name one, as");
}

TEST(MessageStream, AFolderMayHoldTheFolderOfTheRecording) {
  const std::vector<Written> messages = test::at_rest(test::Wire::kRos1, 2);
  const TempDir dir;
  dir.write("flight/bags/a_0.bag", test::ros1_bag({messages[0]}, "none", 100));
  dir.write("flight/bags/a_1.bag", test::ros1_bag({messages[1]}, "none", 100));
  dir.write("flight/notes/text", "windy");
  EXPECT_TRUE(is_recording(dir.path() / "flight"));
  EXPECT_EQ(read_all(dir.path() / "flight").messages.size(), 2U);
  EXPECT_FALSE(is_recording(dir.path()));
}

TEST(MessageStream, SensorsRecordedApartAreReadByTheTimesOfTheirMessages) {
  const std::vector<Written> messages = test::at_rest(test::Wire::kRos1, 20);
  const TempDir dir;
  std::vector<Written> of[2];
  for (const Written& m : messages) of[m.topic == "/imu" ? 0 : 1].push_back(m);
  of[0].insert(of[0].begin(), {"/rosout", "rosgraph_msgs/Log", of[0][0].received, "text"});
  of[1].push_back({"/rosout", "rosgraph_msgs/Log", of[1].back().received, "text"});
  dir.write("imu.bag", test::ros1_bag(of[0], "none", 50));
  dir.write("radar.bag", test::ros1_bag(of[1], "none", 7));
  const Reading reading = read_all(dir.path());
  EXPECT_EQ(open_messages(dir.path())->format(), "folder of 2 recordings at the same time");
  std::vector<Written> sensors = reading.messages;
  std::erase_if(sensors, [](const Written& m) { return m.topic == "/rosout"; });
  EXPECT_EQ(sensors.size(), messages.size());
  EXPECT_EQ(reading.messages.size(), messages.size() + 2);
  expect_prefix(sensors, messages);

  std::filesystem::remove(dir.path() / "imu.bag");  // in parts
  const auto middle = of[0].begin() + 60;
  dir.write("imu_0.bag", test::ros1_bag({of[0].begin(), middle}, "none", 50));
  dir.write("imu_1.bag", test::ros1_bag({middle, of[0].end()}, "none", 50));
  EXPECT_EQ(read_all(dir.path()).messages.size(), messages.size() + 2);

  dir.write("copy.bag", test::ros1_bag(messages, "none", 50));
  EXPECT_ERROR(read_all(dir.path()), "holds several recordings; name one, as");
  for (Written& m : of[1]) m.received += Time(3'600'000'000'000);  // of another flight
  std::filesystem::remove(dir.path() / "copy.bag");
  dir.write("radar.bag", test::ros1_bag(of[1], "none", 7));
  EXPECT_ERROR(open_messages(dir.path()), "holds several recordings; name one, as");
}

// Packed files beside the unpacked ones, and what rosbag reindex leaves.
TEST(MessageStream, OfTwoCopiesTheBetterOneIsRead) {
  const std::vector<Written> messages = test::at_rest(test::Wire::kRos1, 2);
  const TempDir dir;
  dir.write("a_0.bag", test::ros1_bag(messages, "none", 100));
  dir.write("a_0.bag.zst", "packed");
  dir.write("a_0.orig.bag", "broken");
  dir.write("._a_0.bag", "of macOS");
  EXPECT_EQ(read_all(dir.path()).messages.size(), messages.size());
}

TEST(MessageStream, APartThatWasNotClosedIsNamed) {
  const std::vector<Written> messages = test::at_rest(test::Wire::kRos1, 2);
  const TempDir dir;
  dir.write("a_0.bag", test::ros1_bag(messages, "none", 100));
  dir.write("a_1.bag.active", test::ros1_bag(messages, "none", 100));
  const Reading reading = read_all(dir.path());
  EXPECT_EQ(reading.messages.size(), messages.size());
  EXPECT_PRED2(test::contains, reading.damage, "a_1.bag.active was not closed and is not read");
}

TEST(MessageStream, OtherFilesAreRefused) {
  const TempDir dir;
  EXPECT_ERROR(open_messages(dir.path() / "none"), "none: no such file");
  EXPECT_ERROR(open_messages(dir.write("a", "hello")), "a: is no recording");
  EXPECT_ERROR(open_messages(dir.write("b", "")), "b: is empty");
  struct Other {
    std::string bytes;
    const char* what;
  };
  const Other table[] = {
      {"\x1F\x8B\x08", "c: compressed by gzip: unpack it first"},
      {"#ROSRECORD V1.2\n", "c: a bag older than version 2.0"},
      {"#ROSBAG V1.1\n", "c: a bag older than version 2.0"},
      {"\x02\x01\x04\x03\x06\x05\x08\x07 and so on",
       "c: raw packets of a TI radar, without times: record it with rio live"},
      {"<!DOCTYPE html><html><title>Sign in</title>", "c: a page of HTML, sent in place of"},
      {" \r\n<HTML>", "c: a page of HTML, sent in place of the file: download it again"},
      {"<?xml version=\"1.0\"?><Error>", "c: XML, often the error of a server"},
      {"{\"message\": \"Not Found\"}", "c: JSON, often the error of a server"},
      {"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n",
       "c: a pointer of git LFS, not the file itself: git lfs pull"},
      {std::string(5000, '\0'), "c: zeros where it begins"}};
  for (const Other& other : table) {
    EXPECT_ERROR(open_messages(dir.write("c", other.bytes)), other.what);
  }
  EXPECT_ERROR(open_messages(dir.path()), "a folder without a recording");
  dir.write("imu0/data.csv", "");
  EXPECT_ERROR(open_messages(dir.path()), "a folder of CSV files, for rio replay and rio check");
}

}  // namespace
}  // namespace rio::bag
