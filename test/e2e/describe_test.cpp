// SPDX-License-Identifier: BSD-3-Clause
// The manual page and the completions that the program writes of itself.
#include <gtest/gtest.h>

#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "e2e/tool.hpp"
#include "support/matches.hpp"

namespace rio::test {
namespace {

/// All that fits, without repetition.
std::set<std::string> words(const std::string& text, const char* pattern) {
  const std::vector<std::string> all = matches(text, pattern);
  return {all.begin(), all.end()};
}

/// As the help lists them.
std::set<std::string> commands() {
  const std::string help = rio("--help").output;
  return words(help.substr(help.find("Subcommands:")), "\n  ([a-z-]+) ");
}

TEST(Describe, TheManualNamesEveryCommandAndFlag) {
  std::string text = rio("describe man").output;
  for (std::size_t at; (at = text.find("\\-")) != std::string::npos;) text.erase(at, 1);
  EXPECT_GT(commands().size(), 12U);
  EXPECT_EQ(commands().count("describe"), 0U);
  for (const std::string& command : commands()) {
    const std::size_t begin = text.find(".SS rio " + command + " ");
    ASSERT_NE(begin, std::string::npos) << command;
    const std::string section = text.substr(begin, text.find("\n.S", begin) - begin);
    if (command == "experiment") continue;  // has a help of its own
    const auto flags = words(rio(command + " --help").output, "\n  (?:-h,)?(--[a-z-]+)");
    EXPECT_FALSE(flags.empty()) << command;
    for (const std::string& flag : flags) expect_parts(section, {"\n.B " + flag + " "});
  }
  // troff knows the requests that are used, and no line of text is taken for one
  const std::set<std::string> requests = words(text, "\n\\.([A-Z]+)");
  EXPECT_EQ(requests, (std::set<std::string>{"B", "SH", "SS", "TP"}));
}

/// What bash offers for the last word of a line.
std::string completed(const std::string& words) {
  const std::string script = std::string(RIO_TOOL) + " describe bash";
  return run_command("bash -c 'source <(" + script + "); COMP_WORDS=(" + words +
                     "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _rio; echo ${COMPREPLY[@]}'")
      .output;
}

TEST(Describe, BashCompletesCommandsFlagsAndTheirWords) {
  EXPECT_EQ(run_command("bash -c '" RIO_TOOL " describe bash | bash -n'").code, 0);
  EXPECT_EQ(completed("rio rep"), "replay\n");
  EXPECT_EQ(completed("rio replay --bar"), "--barometer\n");
  EXPECT_EQ(completed("rio replay --backend sm"), "smoother\n");
  EXPECT_EQ(completed("rio info some"), "\n");
  std::istringstream all(completed("rio \"\""));
  std::set<std::string> offered;
  for (std::string word; all >> word;) offered.insert(word);
  for (const std::string& command : commands()) EXPECT_EQ(offered.count(command), 1U) << command;
}

}  // namespace
}  // namespace rio::test
