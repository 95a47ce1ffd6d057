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

/// A folder with recordings.
class Folder : public testing::Test {
 protected:
  void write(const std::string& name, const std::vector<Written>& messages) const {
    dir_.write(name, test::ros1_bag(messages, "none", 50));
  }
  void remove(const char* name) const { std::filesystem::remove(dir_.path() / name); }
  /// What is read of the folder.
  Reading expect(std::size_t messages, const std::string& damage) const {
    Reading reading = read_all(dir_.path());
    EXPECT_EQ(reading.messages.size(), messages) << damage;
    EXPECT_PRED2(test::contains, reading.damage, damage);
    return reading;
  }

  static constexpr const char* kSeveral = "holds several recordings; name one, as";
  TempDir dir_;
  const std::vector<Written> messages_ = test::at_rest(test::Wire::kRos1, 20);
};

TEST_F(Folder, OfPartsIsReadFileByFile) {
  const auto part = [this](std::size_t i) { return test::mcap({messages_[i]}, "none", 1, "ros1"); };
  const auto write_part = [&](std::size_t i, std::size_t bytes = std::string::npos) {
    dir_.write("a_" + std::to_string(i) + ".mcap", part(i).substr(0, bytes));
  };
  write_part(0);
  EXPECT_TRUE(is_recording(dir_.path()));
  expect(1, "");
  for (std::size_t i = 1; i < 12; ++i) write_part(i);
  expect_prefix(expect(12, "").messages, messages_);
  EXPECT_EQ(open_messages(dir_.path())->format(), "folder of 12 files, one recording");
  remove("a_0.mcap");
  expect(11, ": part 0 is missing, the recording begins with a_1.mcap");
  write_part(0);
  dir_.write("b_12.mcap", part(0));
  EXPECT_ERROR(open_messages(dir_.path()), kSeveral);
  dir_.write("metadata.yaml", "");
  expect(13, "");
  remove("b_12.mcap");
  dir_.write(
      "metadata.yaml",
      "rosbag2_bagfile_information: {relative_file_paths: [a_0.mcap, a_11.mcap, a_12.mcap]}");
  expect(12, ": a_12.mcap of metadata.yaml is missing");
  dir_.write("metadata.yaml", "");

  write_part(10, 60);
  const Reading cut = expect(10, "; the 1 parts after it are not read, from a_11.mcap on");
  EXPECT_PRED2(test::contains, cut.damage, "a_10.mcap: byte ");
  write_part(5, 0);
  expect(5, "a_5.mcap: is empty; the 6 parts after it are not");
  remove("a_5.mcap");
  remove("a_6.mcap");
  expect(5, ": parts 5 to 6 are missing; the 5 parts after");
  write_part(5);
  write_part(6);
  write("a_11.bag", messages_);  // of another kind
  EXPECT_ERROR(open_messages(dir_.path()), kSeveral);
}

TEST_F(Folder, OfNumberedFlightsHoldsSeveral) {
  std::vector<Written> messages = messages_;
  for (const char* name : {"flight_1.bag", "flight_2.bag", "flight_4.bag"}) {
    write(name, messages);
    for (Written& m : messages) m.received += Time(60'000'000'000);
  }
  EXPECT_ERROR(open_messages(dir_.path()),
               "holds several recordings, or part 3 is missing; name one, as");
}

TEST_F(Folder, MayHoldTheFolderOfTheRecording) {
  write("flight/bags/a_0.bag", {messages_[0]});
  write("flight/bags/a_1.bag", {messages_[1]});
  dir_.write("flight/notes/text", "windy");
  EXPECT_TRUE(is_recording(dir_.path() / "flight"));
  EXPECT_EQ(read_all(dir_.path() / "flight").messages.size(), 2U);
  EXPECT_FALSE(is_recording(dir_.path()));
}

TEST_F(Folder, OfSensorsRecordedApartIsReadByTheTimesOfTheirMessages) {
  std::vector<Written> of[2];
  for (const Written& m : messages_) of[m.topic == "/imu" ? 0 : 1].push_back(m);
  of[0].insert(of[0].begin(), {"/rosout", "rosgraph_msgs/Log", of[0][0].received, "text"});
  of[1].push_back({"/rosout", "rosgraph_msgs/Log", of[1].back().received, "text"});
  write("imu.bag", of[0]);
  write("radar.bag", of[1]);
  EXPECT_EQ(open_messages(dir_.path())->format(), "folder of 2 recordings at the same time");
  std::vector<Written> sensors = expect(messages_.size() + 2, "").messages;
  std::erase_if(sensors, [](const Written& m) { return m.topic == "/rosout"; });
  EXPECT_EQ(sensors.size(), messages_.size());
  expect_prefix(sensors, messages_);

  remove("imu.bag");  // in parts
  const auto middle = of[0].begin() + 60;
  write("imu_0.bag", {of[0].begin(), middle});
  write("imu_1.bag", {middle, of[0].end()});
  expect(messages_.size() + 2, "");

  write("copy.bag", messages_);
  EXPECT_ERROR(read_all(dir_.path()), kSeveral);
  remove("copy.bag");
  for (Written& m : of[1]) m.received += Time(3'600'000'000'000);  // of another flight
  write("radar.bag", of[1]);
  EXPECT_ERROR(open_messages(dir_.path()), kSeveral);
}

// Packed files beside the unpacked ones, and what rosbag reindex leaves.
TEST_F(Folder, OfTwoCopiesGivesTheBetterOne) {
  write("a_0.bag", messages_);
  dir_.write("a_0.bag.zst", "packed");
  dir_.write("a_0.orig.bag", "broken");
  dir_.write("._a_0.bag", "of macOS");
  expect(messages_.size(), "");
}

TEST_F(Folder, NamesAPartThatWasNotClosed) {
  write("a_0.bag", messages_);
  write("a_1.bag.active", messages_);
  expect(messages_.size(), "a_1.bag.active was not closed and is not read");
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
