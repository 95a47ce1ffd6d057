// SPDX-License-Identifier: BSD-3-Clause
// `rio compare`, and the pictures of `rio plot` that it has in common with the page.
#include <gtest/gtest.h>

#include <fstream>
#include <iomanip>
#include <sstream>

#include "e2e/tool.hpp"

namespace rio::test {
namespace {

TEST_F(Tool, ComparesVariantsAndOtherEstimates) {
  const std::string tum = file("other.tum");
  rio("replay " + flight_ + " --no-check --out " + tum);
  const std::string page = file("compare.html");
  rio("compare " + flight_ + " " + tum +
          " --vary update.max_landmarks=5,40 --backend ekf --report " + page,
      {"| ekf update.max_landmarks=5 |", "| ekf update.max_landmarks=40 |", "| other |"});
  const Json data = data_of(page);
  for (const Json& plot : data.at("plots")) {  // a run has one colour in all plots
    if (plot.at("title") == "Difference of position [m]") {
      EXPECT_EQ(plot.at("curves").at(0).at("label"), "ekf update.max_landmarks=40");
      EXPECT_EQ(plot.at("curves").at(0).at("index"), 1);
    }
  }
  rio("compare " + flight_ + " --vary 'radar.T_BS.translation=[0,0,0],[0.1,0,0]'",
      {"| radar.T_BS.translation=[0,0,0] |", "| radar.T_BS.translation=[0.1,0,0] |"});
}

TEST_F(Tool, ComparesTheFilesOfViewers) {
  const std::string mcap = file("viewer.mcap");
  rio("replay " + flight_ + " --no-check --mcap " + mcap);
  const Json figures = rio("evaluate --json " + flight_ + " " + mcap).json();
  std::ostringstream drift;  // from the true path: the poses in the file are no truth
  drift << "| viewer | " << std::fixed << std::setprecision(2)
        << figures.at("final_drift_percent").get<double>() << " |";
  rio("compare " + flight_ + " " + mcap, {"| flight |", drift.str()});
  rio("compare " + mcap + " " + flight_, {"| flight |", drift.str()});
  rio("compare " + mcap + " --truth " + flight_, {drift.str()});
  fails(1, "compare " + mcap + " --preset default", {"need a recording among the runs"});
}

TEST_F(Tool, RunsOfDifferentLengthAreComparedAtTheirLastCommonTime) {
  const std::string tum = file("long.tum");
  rio("replay " + flight_ + " --no-check --out " + tum);
  const std::vector<std::string> rows = lines_of(tum);
  std::ofstream half(file("short.tum"));
  for (std::size_t i = 0; i < rows.size() / 2; ++i) half << rows[i] << '\n';
  half.close();
  const std::string table = rio("compare " + tum + " " + file("short.tum")).output;
  std::istringstream line(table.substr(table.find("| short |")));
  std::string cell;
  for (int i = 0; i < 5; ++i) std::getline(line, cell, '|');
  EXPECT_EQ(cell, " 0.000 ") << table;
}

TEST_F(Tool, ComparedRunsHaveNamesOfTheirOwn) {
  const auto copy_of = [](const std::string& folder, const std::string& tum) {
    fs::create_directories(file(folder));
    fs::copy_file(tum, file(folder + "/named.tum"));
    return file(folder + "/named.tum");
  };
  const std::string tum = file("named.tum");
  rio("replay " + flight_ + " --no-check --out " + tum);
  const std::string again = copy_of("again", tum);
  const std::string deep = copy_of("b/again", tum);
  rio("compare " + tum + " " + again,
      {"| " + fs::path(tum).parent_path().filename().string() + "/named |", "| again/named |"});
  rio("compare " + again + " " + deep, {"| " + again + " |", "| " + deep + " |"});
}

TEST_F(Tool, WhatCannotBeComparedIsToldBeforeARunFlies) {
  const std::string at_once =
      fails(1, "compare " + flight_ + " --preset default,none", {"none"}).output;
  expect_none(at_once, {"default ..."});
  expect_none(
      fails(1, "compare " + flight_ + " " RIO_SOURCE_DIR "/README.md", {"README.md"}).output,
      {" ...\n"});
  const std::string starts = "compare " + flight_ + " --init static --vary start.duration=";
  rio(starts + "600,2", {"start.duration=600 is left out: no start", "| start.duration=2 |"});
  fails(1, starts + "600", {"rio: no start: "});
  const std::string tum = file("whole.tum");
  rio("replay " + flight_ + " --no-check --out " + tum);
  std::ofstream(file("strange.tum")) << "1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n";
  fails(1, "compare " + tum + " --preset default", {"need a recording among the runs"});
  fails(1, "compare " + tum + " " + file("strange.tum"), {"no time in common: whole is from "});
  fails(1, "plot " + tum + " --out x.png", {"rsvg-convert"});
  fails(1, "plot " + tum + " --out x.jpg", {"x.jpg: an SVG is drawn"});
}

}  // namespace
}  // namespace rio::test
