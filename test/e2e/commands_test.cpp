// SPDX-License-Identifier: BSD-3-Clause
// The manual page and the completions that the program writes of itself; `rio experiment` and the
// page of results that it writes; `rio ti-config` and its options pasted into a file.
#include <gtest/gtest.h>

#include <filesystem>
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

TEST_F(Tool, ExperimentAllWritesEveryTableOnce) {
  const std::string out = " --out " + file("all");
  const std::string block = "<!-- rio experiment consistency -->\nold\n<!-- end -->\n";
  const fs::path page = dir_->write("all.md", "before\n" + block + "after\n");
  const std::string command = "experiment all --seeds 2" + out + " --update " + page.string();
  EXPECT_NE(try_rio("experiment all" + out).code, 0);  // no page
  rio(command, {"consistency: 100 %\n", "| default | heading |"});
  const std::string written = dir_->read("all.md");
  expect_parts(written, {"| default | heading |"});
  expect_none(written, {"old"});
  EXPECT_EQ(rio(command).output, "consistency: written by this program already\n");
  dir_->write("all.md", written + "<!-- rio experiment none -->\n<!-- end -->\n");
  expect_parts(try_rio(command).output, {"no such experiment: none"});
}

TEST_F(Tool, ExperimentPrintsAndLeavesReportDataAndChart) {
  const fs::path out = file("experiment");
  const std::string begin = "before\n<!-- rio experiment consistency -->\n";
  const std::string end = "<!-- end -->\nafter\n";
  const fs::path page = dir_->write("page.md", begin + "old\n" + end);
  const Outcome run = rio("experiment consistency --seeds 2 --threads 1 --out " + out.string() +
                              " --update " + page.string(),
                          {"| default | heading |"});
  for (const char* name : {"consistency.md", "consistency.csv", "consistency.svg"}) {
    EXPECT_GT(fs::file_size(out / name), 500U) << name;
  }
  EXPECT_EQ(text_of(page), begin + "\n" + run.output + "\n" + end);
}

TEST_F(Tool, ExperimentRefusesWhatItCannotDo) {
  EXPECT_NE(try_rio("experiment nonsense").code, 0);
  const fs::path page = dir_->write("no_block.md", "nothing here\n");
  fails(1, "experiment consistency --seeds 1 --out " + file("x") + " --update " + page.string(),
        {"no block"});
  EXPECT_EQ(text_of(page), "nothing here\n");
}

TEST(Results, HaveABlockForEveryExperiment) {
  const std::string readme = text_of(RIO_SOURCE_DIR "/data/results/README.md");
  const std::string help = try_rio("experiment --help").output;
  for (const std::string name : {"icra2023", "iros2024", "consistency", "ablation", "ablation-real",
                                 "robustness", "faults", "checks"}) {
    expect_parts(help, {name});
    const std::size_t block = readme.find("<!-- rio experiment " + name + " -->\n");
    ASSERT_NE(block, std::string::npos) << name;
    // filled: a table follows before the end of the block
    EXPECT_LT(readme.find("| --- |", block), readme.find("<!-- end -->", block)) << name;
  }
}

class TiConfigTool : public Tool {
 protected:
  static std::string good() { return RIO_SOURCE_DIR "/data/awr1843boost_odometry.cfg"; }

  /// The good one with a line more.
  static std::string spoiled(const std::string& line) {
    std::string path = file("spoiled.cfg");
    fs::copy_file(good(), path, fs::copy_options::overwrite_existing);
    std::ofstream(path, std::ios::app) << line << "\n";
    return path;
  }
};

TEST_F(TiConfigTool, FiguresOfAGoodOneAndItsOptions) {
  const std::string text = rio("ti-config " + good(), {"+-5.364 m/s", "20.00 Hz", "side info on",
                                                       "Nothing is wrong", "radar:"})
                               .output;
  std::ofstream(file("options.yaml")) << text.substr(text.find("radar:"));
  const Outcome replay = try_rio("replay --quiet " + flight_ + " --config " + file("options.yaml"));
  expect_none(replay.output, {"options.yaml:"});  // no error
  EXPECT_NE(replay.code, 1) << replay.output;
}

TEST_F(TiConfigTool, SaysWhatIsWrongAndExitsWithThree) {
  fails(3, "ti-config " + spoiled("clutterRemoval -1 1"),
        {"clutter removal: ", "-> clutterRemoval -1 0"});
  fails(3, "ti-config --speed 12 " + good(), {"the vehicle flies 12 m/s"});
}

TEST_F(TiConfigTool, JsonHoldsTheSame) {
  const Json json = fails(3, "ti-config --json " + spoiled("bmpCfg \xff"), {}).json();
  EXPECT_NEAR(json["figures"]["max_speed_mps"].get<double>(), 5.3635, 1e-3);
  EXPECT_EQ(json["findings"][0]["subject"], "unknown command");
}

TEST_F(TiConfigTool, NamesOtherFirmwareInsteadOfJudging) {
  const Outcome run = fails(3, "ti-config " + spoiled("ddmPhaseShiftAntOrder 0 2 3 1"),
                            {"AWR2944", "not of the out-of-box demo of SDK 3.x: not judged"});
  expect_none(run.output, {"wrong", "take the line out", "speed ", "radar:"});
  fails(1,
        "live --sensors " + flight_ + " --radar-cfg " + file("spoiled.cfg") + " --radar " +
            file("no") + " --imu " + file("no") + " --patience 0",
        {"the frame rate is that of --sensors"});
}

TEST_F(TiConfigTool, WrongCommandLines) {
  fails(1, "ti-config " + file("nothing.cfg"), {"nothing.cfg"});
  fails(1, "ti-config " + flight_, {flight_ + ": is a folder"});
  fails(2, "ti-config", {"FILE"});
  fails(2, "ti-config --speed 0 " + good(), {"--speed"});
}

}  // namespace
}  // namespace rio::test
