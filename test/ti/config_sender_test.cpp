// SPDX-License-Identifier: BSD-3-Clause
#include "rio/ti/config_sender.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "support/temp_dir.hpp"

namespace rio::ti::test {
namespace {

using rio::test::contains;

/// A radar that echoes, answers by `answer`, and prompts.
struct TalkingRadar {
  std::function<std::string(const std::string&)> answer = [](const std::string&) { return "Done"; };
  std::vector<std::string> lines;

  std::string reply(const std::string& sent) {
    const std::string line = sent.substr(0, sent.find('\n'));
    if (!line.empty()) lines.push_back(line);
    const std::string said = line.empty() ? "" : answer(line);
    return line + "\r\n" + (said.empty() ? "" : said + "\r\n") + "\r\nmmwDemo:/>";
  }
};

void receive(ConfigSender* sender, const std::string& text) {
  sender->receive(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
}

/// Talks until it is over, the answers in pieces of `piece` bytes.
void talk(ConfigSender* sender, TalkingRadar* radar, std::size_t piece) {
  for (int i = 0; i < 1000 && !sender->over(); ++i) {
    const std::string line = sender->to_send(Time{0});
    if (line.empty()) continue;
    EXPECT_TRUE(sender->to_send(Time{0}).empty());  // one line at a time
    const std::string reply = radar->reply(line);
    for (std::size_t at = 0; at < reply.size(); at += piece) {
      receive(sender, reply.substr(at, piece));
    }
  }
}

const char* const kText =
    "% comment\r\nsensorStop\n\nflushCfg\r\nprofileCfg 0 77 10\nsensorStart\n";

TEST(ConfigSender, SendsEveryLineAfterTheAnswerToTheOneBefore) {
  for (const std::size_t piece : {1U, 3U, 1000U}) {
    ConfigSender sender(parse_config(kText));
    TalkingRadar radar;
    talk(&sender, &radar, piece);
    EXPECT_TRUE(sender.done()) << sender.error();
    EXPECT_EQ(sender.accepted(), 4U);
    EXPECT_EQ(radar.lines, (std::vector<std::string>{"sensorStop", "flushCfg", "profileCfg 0 77 10",
                                                     "sensorStart"}));
  }
}

TEST(ConfigSender, NamesTheLineAndWhatTheRadarSays) {
  const std::vector<std::string> refusals = {"Error: Invalid usage of the CLI command\r\nError -1",
                                             "'profileCfg' is not recognized as a CLI command"};
  for (const std::string& refusal : refusals) {
    ConfigSender sender(parse_config(kText));
    TalkingRadar radar;
    radar.answer = [&](const std::string& line) {
      return line.starts_with("profile") ? refusal : "Done";
    };
    talk(&sender, &radar, 7);
    EXPECT_FALSE(sender.done());
    EXPECT_PRED2(contains, sender.error(), "line 5, profileCfg: the radar says \"");
    EXPECT_PRED2(contains, sender.error(), refusal.substr(0, refusal.find('\r')));
    EXPECT_FALSE(contains(sender.error(), "mmwDemo"));
    EXPECT_EQ(radar.lines.size(), 3U);  // nothing is sent after it
  }
}

TEST(ConfigSender, ASensorAtRestNeedNotStop) {
  ConfigSender sender(parse_config(kText));
  TalkingRadar radar;
  radar.answer = [](const std::string& line) {
    return line == "sensorStop" ? "Error -1" : "Ignored: it is\r\nDone";
  };
  talk(&sender, &radar, 1000);
  EXPECT_TRUE(sender.done()) << sender.error();
}

TEST(ConfigSender, APromptOfBeforeIsNoAnswer) {
  ConfigSender sender(parse_config("flushCfg\nsensorStart\n"));
  EXPECT_EQ(sender.to_send(Time{0}), "\n");
  receive(&sender, "'?' is not recognized as a CLI command\r\nmmwDemo:/>");  // power-on garbage
  EXPECT_EQ(sender.to_send(Time{0}), "flushCfg\n");
  receive(&sender, "\r\nmmwDemo:/>");
  EXPECT_TRUE(sender.to_send(Time{0}).empty());
  receive(&sender, "flushCfg\r\nDone\r\n\r\nmmwDemo:/>");
  EXPECT_EQ(sender.to_send(Time{0}), "sensorStart\n");
}

TEST(ConfigSender, SilenceEndsIt) {
  constexpr Time kSecond = std::chrono::seconds(1);
  ConfigSender sender(parse_config(kText));
  EXPECT_EQ(sender.to_send(Time{0}), "\n");
  EXPECT_EQ(sender.to_send(kSecond), "sensorStop\n");  // the empty line need not be answered
  EXPECT_TRUE(sender.to_send(3 * kSecond).empty());
  EXPECT_FALSE(sender.over());
  EXPECT_TRUE(sender.to_send(5 * kSecond).empty());
  EXPECT_PRED2(contains, sender.error(), "line 2, sensorStop: no answer");
}

TEST(ConfigSender, OtherDevicesAndLongLinesEndIt) {
  ConfigSender other(parse_config(kText));
  (void)other.to_send(Time{0});
  receive(&other, std::string(10000, 'x'));
  EXPECT_PRED2(contains, other.error(), "bytes without a prompt");
  ConfigSender sender(parse_config("aoaFovCfg " + std::string(300, '1')));
  TalkingRadar radar;
  talk(&sender, &radar, 1000);
  EXPECT_PRED2(contains, sender.error(), "longer than the radar reads");
}

}  // namespace
}  // namespace rio::ti::test
