// SPDX-License-Identifier: BSD-3-Clause
// A port, and a set of them that is watched.
#include <gtest/gtest.h>

#include <asm/termbits.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>
#include <memory>
#include <string>
#include <vector>

#include "live/player.hpp"
#include "live/port.hpp"
#include "support/temp_dir.hpp"

namespace rio::live::test {
namespace {

using rio::test::TempDir;

/// What comes within a second, up to `count` bytes.
std::string read(Port* port, std::size_t count) {
  std::string text;
  std::uint8_t buffer[256];
  while (text.size() < count && port->fd() >= 0) {
    pollfd ask{port->fd(), POLLIN, 0};
    if (poll(&ask, 1, 1000) != 1) break;
    const std::size_t n = port->read(buffer, sizeof buffer);
    text.append(buffer, buffer + n);
  }
  return text;
}

template <class Writer>
bool write(Writer* to, const std::string& text) {
  return to->write(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
}

TEST(Port, OfAPseudoTerminalPassesEveryByteBothWays) {
  std::string all;
  for (int i = 0; i < 256; ++i) all += static_cast<char>(i);
  Pty device;
  EXPECT_FALSE(device.is_open());
  Port port(device.path(), 115200);
  ASSERT_TRUE(port.open());
  EXPECT_TRUE(device.is_open());
  ASSERT_TRUE(write(&device, all));
  EXPECT_EQ(read(&port, 256), all);
  ASSERT_TRUE(write(&port, all));
  std::uint8_t back[256];
  EXPECT_EQ(device.read(back, sizeof back), 256U);
  EXPECT_EQ(std::string(back, back + 256), all);
}

/// Also at rates that termios has no name for: the data ports of AWR2944 and xWRL6432.
TEST(Port, OpensAtAnyBaudRate) {
  for (const int baud : {1200, 921600, 1250000, 3125000, 12345678}) {
    Pty device;
    Port port(device.path() + "@" + std::to_string(baud), 115200);
    ASSERT_TRUE(port.open()) << baud;
    termios2 line{};
    ASSERT_EQ(ioctl(port.fd(), TCGETS2, &line), 0);
    EXPECT_EQ(line.c_ospeed, static_cast<speed_t>(baud));
    EXPECT_EQ(line.c_ispeed, static_cast<speed_t>(baud));
    ASSERT_TRUE(write(&device, "\x11\x13\r\n"));
    EXPECT_EQ(read(&port, 4), "\x11\x13\r\n");
  }
}

TEST(Port, ThatVanishesComesBackAsAnotherUnderTheSameName) {
  TempDir dir;
  auto device = std::make_unique<Pty>(dir.path() / "radar0" / "port");
  Port port((dir.path() / "radar0" / "port").string(), 921600);
  ASSERT_TRUE(port.open());
  ASSERT_TRUE(write(device.get(), "one"));
  EXPECT_EQ(read(&port, 3), "one");
  device.reset();
  EXPECT_EQ(read(&port, 1), "");
  EXPECT_EQ(port.state(), Port::State::kVanished);
  EXPECT_FALSE(port.open());
  device = std::make_unique<Pty>(dir.path() / "radar0" / "port");
  ASSERT_TRUE(port.open());
  ASSERT_TRUE(write(device.get(), "two"));
  EXPECT_EQ(read(&port, 3), "two");
}

TEST(Port, IsHeldAloneUntilItIsClosed) {
  Pty device;
  Port port(device.path(), 921600);
  ASSERT_TRUE(port.open());
  int alone = 0;
  ASSERT_EQ(ioctl(port.fd(), TIOCGEXCL, &alone), 0);
  EXPECT_NE(alone, 0);
  port.close();
  const int other = ::open(device.path().c_str(), O_RDWR | O_NOCTTY);
  ASSERT_EQ(ioctl(other, TIOCGEXCL, &alone), 0);
  EXPECT_EQ(alone, 0);
  ::close(other);
}

TEST(Port, OfAFileEnds) {
  TempDir dir;
  Port port(dir.write("bytes", "abc").string(), 921600);
  ASSERT_TRUE(port.open());
  EXPECT_EQ(read(&port, 100), "abc");
  EXPECT_EQ(port.state(), Port::State::kEnded);
}

TEST(Port, OfUdpHearsAndAnswers) {
  Port here("udp:34551", 0);
  Port there("udp:127.0.0.1:34551", 0);
  ASSERT_TRUE(here.open());
  ASSERT_TRUE(there.open());
  ASSERT_TRUE(write(&there, "question"));
  EXPECT_EQ(read(&here, 8), "question");
  ASSERT_TRUE(write(&here, "answer"));
  EXPECT_EQ(read(&there, 6), "answer");
}

TEST(Port, NamesThatMakeNoSense) {
  for (const char* name : {"", "@9600", "/dev/ttyS0@1199", "/dev/ttyS0@", "udp:", "udp:70000",
                           "udp:localhost:14550", "udp:127.0.0.1:"}) {
    EXPECT_THROW(Port(name, 115200), std::runtime_error) << name;
  }
  EXPECT_ERROR(Port("/tmp", 115200).open(), "is a folder");
  EXPECT_EQ(Port("/dev/ttyACM1@3000000", 921600).baud(), 3000000);
  EXPECT_EQ(Port("/dev/ttyACM1", 921600).baud(), 921600);
}

struct Watcher {
  HostClock clock;
  std::vector<std::string> messages;
  std::string bytes;
  int reopened = 0;
  PortSet ports;

  explicit Watcher(double patience)
      : ports(clock, patience, [this](const std::string& text) { messages.push_back(text); }) {}

  Watched watched(const std::string& name, bool needed) {
    return {Port(name, 921600), "radar", needed,
            [this](const std::uint8_t* data, std::size_t count, Time) {
              bytes.append(data, data + count);
            },
            [this] { ++reopened; }};
  }
  /// @return the set is over
  bool wait_for(const std::string& text) {
    bool goes_on = true;
    for (int i = 0; i < 40 && bytes != text && goes_on; ++i) goes_on = ports.wait();
    return !goes_on;
  }
};

TEST(PortSet, OpensAgainWhatWasUnplugged) {
  TempDir dir;
  const std::filesystem::path link = dir.path() / "port";
  Watcher watcher(10.0);
  watcher.ports.add(watcher.watched(link.string(), true));
  EXPECT_FALSE(watcher.wait_for("none"));  // not there yet
  auto device = std::make_unique<Pty>(link);
  EXPECT_FALSE(watcher.wait_for("none"));
  ASSERT_TRUE(write(device.get(), "one"));
  EXPECT_FALSE(watcher.wait_for("one"));
  EXPECT_EQ(watcher.reopened, 0);
  device.reset();
  EXPECT_FALSE(watcher.wait_for("none"));
  device = std::make_unique<Pty>(link);
  EXPECT_FALSE(watcher.wait_for("none"));
  EXPECT_EQ(watcher.reopened, 1);
  ASSERT_TRUE(write(device.get(), "two"));
  EXPECT_FALSE(watcher.wait_for("onetwo"));
  EXPECT_EQ(watcher.bytes, "onetwo");
  ASSERT_EQ(watcher.messages.size(), 3U);
  EXPECT_EQ(watcher.messages[0], "radar: " + link.string() + " is not there yet: it is waited for");
  EXPECT_EQ(watcher.messages[1], "radar: " + link.string() + " vanished");
  EXPECT_EQ(watcher.messages[2], "radar: " + link.string() + " is back");
}

TEST(PortSet, IsOverWhenPatienceIs) {
  TempDir dir;
  Watcher watcher(0.0);
  Pty other;
  watcher.ports.add(watcher.watched((dir.path() / "nothing").string(), true));
  watcher.ports.add(watcher.watched(other.path(), false));  // not needed
  EXPECT_TRUE(watcher.wait_for("none"));
  ASSERT_EQ(watcher.messages.size(), 1U);
  EXPECT_PRED2(rio::test::contains, watcher.messages[0], "nothing is not there");
}

TEST(PortSet, RefusesAPortTwice) {
  TempDir dir;
  Watcher watcher(0.0);
  const std::filesystem::path port = dir.write("a", "");
  std::filesystem::create_symlink(port, dir.path() / "b");
  watcher.ports.add(watcher.watched(port.string(), true));
  watcher.ports.add(watcher.watched("udp:14551", false));
  EXPECT_ERROR(watcher.ports.add(watcher.watched((dir.path() / "b").string(), true)),
               "a: given for two, radar and radar");
}

TEST(PortSet, IsOverWhenItsFilesAre) {
  TempDir dir;
  Watcher watcher(1e9);
  watcher.ports.add(watcher.watched(dir.write("a", "bytes").string(), true));
  EXPECT_FALSE(watcher.wait_for("bytes"));
  EXPECT_TRUE(watcher.wait_for("more"));
}

}  // namespace
}  // namespace rio::live::test
