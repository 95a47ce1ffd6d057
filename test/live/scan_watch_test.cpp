// SPDX-License-Identifier: BSD-3-Clause
#include "live/scan_watch.hpp"

#include <gtest/gtest.h>

#include <string>

#include "ti/packets.hpp"

namespace rio::live::test {
namespace {

using ti::test::Bytes;
using ti::test::packet_of;
using ti::test::some_points;

class Watched {
 public:
  void push(const Bytes& bytes) {
    reader_.push(bytes.data(), bytes.size(), Time{0}, [](const ti::Frame& /*frame*/) {});
  }
  void push_packet(std::uint32_t version = 0x03060000) {
    ti::test::WrittenPacket packet = packet_of(number_, some_points(number_, 5));
    ++number_;
    packet.version = version;
    push(packet.bytes());
  }
  /// What is said in so many seconds, ten looks each.
  std::string wait(int seconds, const std::string& times = "") {
    std::string said;
    for (int i = 0; i < 10 * seconds; ++i) {
      now_ += std::chrono::milliseconds(100);
      const std::string message = watch_.look(reader_, now_, times);
      if (!message.empty()) said += message + "\n";
    }
    return said;
  }

 private:
  ti::PacketReader reader_;
  ScanWatch watch_;
  Time now_ = std::chrono::hours(1);
  std::uint32_t number_ = 0;
};

TEST(ScanWatch, SaysOnceAfterTenSecondsWhatWasSeen) {
  Watched radar;
  EXPECT_EQ(radar.wait(9), "");
  EXPECT_EQ(radar.wait(30), "no scan for 10 s; no byte came\n");
  const std::string text = "mmwDemo:/>sensorStart\r\nDone\r\n";
  radar.push(Bytes(text.begin(), text.end()));
  EXPECT_EQ(radar.wait(30), "");
  radar.push_packet();
  EXPECT_EQ(radar.wait(9), "scans again\n");
  EXPECT_EQ(radar.wait(30), "no scan for 10 s; no byte came\n");
  radar.push_packet();
  EXPECT_EQ(radar.wait(5), "scans again\n");
  radar.push(Bytes(80000, 0xFE));
  const std::string said = radar.wait(30);
  EXPECT_EQ(said.rfind("no scan for 10 s; 80000 bytes came: bytes, but no packet", 0), 0U) << said;
}

TEST(ScanWatch, SaysNothingWhileScansCome) {
  Watched radar;
  for (int i = 0; i < 30; ++i) {
    radar.push_packet();
    EXPECT_EQ(radar.wait(1), "");
  }
}

TEST(ScanWatch, SaysOnceThatTimesAreWrong) {
  Watched radar;
  radar.push_packet();
  EXPECT_EQ(radar.wait(1, "frames come every 66.7 ms"), "frames come every 66.7 ms\n");
  EXPECT_EQ(radar.wait(1, "frames come every 66.8 ms"), "");
}

TEST(ScanWatch, SaysAnotherFirmwareAtOnceAndOnce) {
  Watched radar;
  radar.push_packet(0x02010004);
  EXPECT_EQ(radar.wait(1), "packets of SDK 1 or 2, which are not read: load a demo of SDK 3.x\n");
  radar.push_packet(0x02010004);
  EXPECT_EQ(radar.wait(5), "");
  EXPECT_NE(radar.wait(5).find("no scan for 10 s"), std::string::npos);
}

}  // namespace
}  // namespace rio::live::test
