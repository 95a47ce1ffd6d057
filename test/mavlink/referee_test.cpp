// SPDX-License-Identifier: BSD-3-Clause
// The bytes of node-mavlink of npm (found through NODE_PATH) for the same fields. Skipped where it
// is not installed.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

#include "mavlink/random_messages.hpp"
#include "support/temp_dir.hpp"

namespace rio::mavlink::test {
namespace {

bool runs(const std::string& command) {
  return std::system((command + " >/dev/null 2>&1").c_str()) == 0;
}

/// Appends what it visits to a line.
struct Print {
  std::string* line;
  template <class... T>
  void operator()(const T&... values) {
    (one(values), ...);
  }
  template <class T, std::size_t n>
  void one(const std::array<T, n>& values) {
    for (const T& value : values) one(value);
  }
  void one(float value) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    one(bits);
  }
  template <class T>
  void one(const T& value) {
    *line += " " + std::to_string(value);
  }
};

/// Random messages as lines for the referee, as our frames, and as payloads.
class Messages {
 public:
  template <class Message>
  void add(const char* name, int version = 2) {
    const Message message = random_message<Message>(&random_);
    lines_ += std::string(name) + " " + std::to_string(version) + " " +
              std::to_string(writer_.sequence()) + " 17 197";
    Message::visit(message, Print{&lines_});
    lines_ += "\n";
    append(&frames_, frame_of(message, &writer_));
    const auto payload = payload_of(message);
    const auto size = version == 1 ? Message::kBasicSize : Message::kSize;
    payloads_.emplace_back(payload.begin(), payload.begin() + static_cast<long>(size));
  }

  /// Of the referee.
  Bytes frames() const {
    const rio::test::TempDir dir;
    const std::string in = dir.path() / "messages";
    const std::string out = dir.path() / "frames";
    std::ofstream(in) << lines_;
    EXPECT_TRUE(runs("node " RIO_SOURCE_DIR "/test/mavlink/referee.cjs " + in + " " + out));
    std::ifstream file(out, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }
  const Bytes& ours() const { return frames_; }
  const std::vector<Bytes>& payloads() const { return payloads_; }

 private:
  sim::Random random_{99};
  Writer writer_{{17, 197}};
  std::string lines_;
  Bytes frames_;
  std::vector<Bytes> payloads_;
};

bool no_referee() {
  return !runs("node -e 'require(\"node-mavlink\")'");
}

TEST(MavlinkReferee, TheSameBytesForAThousandMessages) {
  if (no_referee()) GTEST_SKIP() << "skipped: needs node and node-mavlink in NODE_PATH";
  Messages messages;
  for (int i = 0; i < 500; ++i) messages.add<OdometryMessage>("ODOMETRY");
  for (int i = 0; i < 250; ++i) messages.add<Heartbeat>("HEARTBEAT");
  for (int i = 0; i < 250; ++i) messages.add<Timesync>("TIMESYNC");
  for (int i = 0; i < 100; ++i) messages.add<HighresImu>("HIGHRES_IMU");
  const Bytes theirs = messages.frames();
  ASSERT_EQ(theirs.size(), messages.ours().size());
  EXPECT_TRUE(theirs == messages.ours());
}

TEST(MavlinkReferee, ItsFramesOfBothVersionsAreRead) {
  if (no_referee()) GTEST_SKIP() << "skipped: needs node and node-mavlink in NODE_PATH";
  Messages messages;
  for (int i = 0; i < 200; ++i) {
    messages.add<HighresImu>("HIGHRES_IMU");
    messages.add<RawImu>("RAW_IMU");
    messages.add<ScaledImu>("SCALED_IMU");
    messages.add<Timesync>("TIMESYNC");
    messages.add<Heartbeat>("HEARTBEAT", i % 2 + 1);
  }
  Parser parser;
  const std::vector<Packet> packets = parse(&parser, messages.frames(), 13);
  ASSERT_EQ(packets.size(), messages.payloads().size());
  for (std::size_t i = 0; i < packets.size(); ++i) {
    const Bytes& expected = messages.payloads()[i];
    EXPECT_TRUE(std::equal(expected.begin(), expected.end(), packets[i].payload.begin())) << i;
    EXPECT_EQ(packets[i].sequence, i % 256);
  }
  EXPECT_EQ(parser.counters().damaged, 0U);
}

}  // namespace
}  // namespace rio::mavlink::test
