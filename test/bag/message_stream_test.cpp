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
  std::filesystem::remove(folder / "a_0.mcap");  // then they may be several
  EXPECT_ERROR(open_messages(folder), "holds several recordings; name one, as");
  dir.write("folder/a_0.mcap", part(0));
  dir.write("folder/b_12.mcap", part(0));
  EXPECT_ERROR(open_messages(folder), "holds several recordings; name one, as");
  dir.write("folder/metadata.yaml", "");
  EXPECT_EQ(read_all(folder).messages.size(), 13U);
  std::filesystem::remove(folder / "b_12.mcap");

  dir.write("folder/a_10.mcap", part(10).substr(0, 60));
  reading = read_all(folder);
  EXPECT_EQ(reading.messages.size(), 10U);
  EXPECT_PRED2(test::contains, reading.damage, "a_10.mcap: byte ");
  EXPECT_PRED2(test::contains, reading.damage,
               "; the 1 parts after it are not read, from a_11.mcap on");
  std::filesystem::remove(folder / "a_5.mcap");
  EXPECT_ERROR(open_messages(folder), "or part 5 of one is missing; name one");
  dir.write("folder/a_5.mcap", part(5));
  dir.write("folder/a_11.db3", "");
  EXPECT_ERROR(open_messages(folder), "holds several recordings; name one, as");
}

// Packed files beside the unpacked ones, and what rosbag reindex leaves.
TEST(MessageStream, OfTwoCopiesTheBetterOneIsRead) {
  const std::vector<Written> messages = test::at_rest(test::Wire::kRos1, 2);
  const TempDir dir;
  dir.write("a_0.bag", test::ros1_bag(messages, "none", 100));
  dir.write("a_0.bag.zst", "packed");
  dir.write("a_0.orig.bag", "broken");
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
  EXPECT_ERROR(open_messages(dir.write("e.gz", "\x1F\x8B\x08")), "e.gz: compressed by gzip");
  EXPECT_ERROR(open_messages(dir.write("c", "#ROSRECORD V1.2\n")), "older than version 2.0");
  EXPECT_ERROR(open_messages(dir.write("d", "\x02\x01\x04\x03\x06\x05\x08\x07 and so on")),
               "d: raw packets of a TI radar, without times: record it with rio live");
  EXPECT_ERROR(open_messages(dir.path()), "a folder without a recording");
  dir.write("imu0/data.csv", "");
  EXPECT_ERROR(open_messages(dir.path()), "a folder of CSV files, for rio replay and rio check");
}

}  // namespace
}  // namespace rio::bag
