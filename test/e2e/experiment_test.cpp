// SPDX-License-Identifier: BSD-3-Clause
// `rio experiment` as a user runs it, and the page of results that it writes.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "e2e/tool.hpp"

namespace rio::test {
namespace {

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
  for (const std::string name : {"icra2023", "iros2024", "uncertainty", "consistency", "ablation",
                                 "ablation-real", "robustness", "faults", "checks"}) {
    expect_parts(help, {name});
    const std::size_t block = readme.find("<!-- rio experiment " + name + " -->\n");
    ASSERT_NE(block, std::string::npos) << name;
    // filled: a table follows before the end of the block
    EXPECT_LT(readme.find("| --- |", block), readme.find("<!-- end -->", block)) << name;
  }
}

}  // namespace
}  // namespace rio::test
