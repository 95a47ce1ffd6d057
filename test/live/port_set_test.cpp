// SPDX-License-Identifier: BSD-3-Clause
#include "live/port_set.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "live/pty.hpp"
#include "support/temp_dir.hpp"

namespace rio::live::test {
namespace {

using rio::test::TempDir;

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

void write(Pty* to, const std::string& text) {
  ASSERT_TRUE(to->write(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

TEST(PortSet, OpensAgainWhatWasUnplugged) {
  TempDir dir;
  const std::filesystem::path link = dir.path() / "port";
  Watcher watcher(10.0);
  watcher.ports.add(watcher.watched(link.string(), true));
  EXPECT_FALSE(watcher.wait_for("none"));  // not there yet
  auto device = std::make_unique<Pty>(link);
  EXPECT_FALSE(watcher.wait_for("none"));
  write(device.get(), "one");
  EXPECT_FALSE(watcher.wait_for("one"));
  EXPECT_EQ(watcher.reopened, 0);
  device.reset();
  EXPECT_FALSE(watcher.wait_for("none"));
  device = std::make_unique<Pty>(link);
  EXPECT_FALSE(watcher.wait_for("none"));
  EXPECT_EQ(watcher.reopened, 1);
  write(device.get(), "two");
  EXPECT_FALSE(watcher.wait_for("onetwo"));
  EXPECT_EQ(watcher.bytes, "onetwo");
  ASSERT_EQ(watcher.messages.size(), 2U);
  EXPECT_EQ(watcher.messages[0], "radar: " + link.string() + " vanished");
  EXPECT_EQ(watcher.messages[1], "radar: " + link.string() + " is back");
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

TEST(PortSet, IsOverWhenItsFilesAre) {
  TempDir dir;
  Watcher watcher(1e9);
  watcher.ports.add(watcher.watched(dir.write("a", "bytes").string(), true));
  EXPECT_FALSE(watcher.wait_for("bytes"));
  EXPECT_TRUE(watcher.wait_for("more"));
}

}  // namespace
}  // namespace rio::live::test
