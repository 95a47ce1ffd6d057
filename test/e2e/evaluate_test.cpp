// SPDX-License-Identifier: BSD-3-Clause
// `rio evaluate` and `rio plot` as a user runs them.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>

#include "e2e/tool.hpp"
#include "support/matches.hpp"

namespace rio::test {
namespace {

TEST_F(Tool, EvaluatesAgainstPositionsAlone) {
  rio("replay " + flight_ + " --quiet --out " + file("path.tum"));
  std::ofstream positions(file("positions.txt"));
  for (const std::string& line : lines_of(file("path.tum"))) {
    std::istringstream cells(line);
    std::string t, x, y, z;
    cells >> t >> x >> y >> z;
    positions << t << ' ' << x << ' ' << y << ' ' << z << '\n';
  }
  positions.close();
  const std::string against = "evaluate " + file("positions.txt") + " " + file("path.tum");
  rio(against, {"note: the truth holds positions alone", "tilt error            - deg rmse"});
  const Json error = rio(against + " --json").json();
  EXPECT_EQ(error["norm_of_rmse_m"], 0.0);
  EXPECT_TRUE(error["yaw_error_deg"]["rmse"].is_null());
  fails(1, against + " --align origin", {"the truth has no attitude: align by yaw or se3"});

  const std::string both = " " + file("path.tum") + " " + file("path.tum");
  rio("compare" + both + " --truth " + file("positions.txt") + " --report " + file("c.html"),
      {"path | 0.00 | 0.000 | 0.000 | - | - | - |"});
  const std::string page = text_of(file("c.html"));
  EXPECT_NE(page.find("Position error"), std::string::npos);
  EXPECT_EQ(page.find("Yaw error"), std::string::npos);
  rio("plot --truth " + file("positions.txt") + " " + file("path.tum") + " --out " + file("p.svg"));
  const std::string drawing = text_of(file("p.svg"));
  EXPECT_NE(drawing.find("Position error"), std::string::npos);
  EXPECT_EQ(drawing.find("Yaw error"), std::string::npos);
}

TEST_F(Tool, EvaluateTellsOtherAxesOtherUnitsAndHowFarAnEstimateGoes) {
  const std::string tum = file("whole.tum");
  rio("replay " + flight_ + " --quiet --out " + tum);
  const auto made = [&](const std::string& name, const std::string& awk) {
    EXPECT_EQ(run_command("awk -v CONVFMT=%.9f '" + awk + "' " + tum + " > " + file(name)).code, 0);
    return file(name);
  };
  const std::string evaluate = "evaluate " + flight_ + " ";
  const Parts other = {"or another order of the quaternion"};
  expect_none(rio(evaluate + tum).output, other);
  const std::string metres = made("metres.tum", "NR % 5 == 0");
  expect_none(rio("evaluate " + metres + " " + tum).output, {"seem to be in"});
  const std::string still = made("still.tum", "{$2 = $3 = $4 = 0; print}");
  expect_none(rio("evaluate " + still + " " + still).output, {"seem to be in"});
  for (const auto& [name, factor] : {std::pair("millimetres", "1000"), {"centimetres", "100"}}) {
    const std::string by = std::string(" *= ") + factor;
    const std::string truth =
        made(name, "NR % 5 == 0 {$2" + by + "; $3" + by + "; $4" + by + "; print}");
    rio("evaluate " + truth + " " + tum,
        {std::string("they seem to be in ") + name + "; divide them by " + factor});
  }
  rio(evaluate + made("wxyz.tum", "{print $1, $2, $3, $4, $8, $5, $6, $7}"), other);
  fails(1, evaluate + made("late.tum", "{sub(/^17/, \"18\"); print}"),
        {"no time in common: " + flight_ + " is from 17", "late.tum from 18"});
  rio("evaluate " + made("far.tum", "{$2 += 5000000; print}") + " " + tum,
      {" 5000000.000 5000000.000"});
  rio(evaluate + tum + " " + made("begin.tum", "NR <= 20"),
      {"| true path [m] |", "| 25.0 |", "| 0.0 |"});
}

TEST_F(Tool, PlotsAPicture) {
  rio("replay " + flight_ + " --quiet --out " + file("p.tum"));
  rio("plot " + file("p.tum") + " --truth " + flight_ + " --out " + file("p.svg"));
  expect_parts(dir_->read("p.svg"), {"</svg>"});
  expect_none(dir_->read("p.svg"), {"nan"});
  const std::string latin = file("k\xE4se.tum");  // a name that is not UTF-8
  fs::copy_file(file("p.tum"), latin);
  rio("plot " + latin + " --out " + file("latin.svg"));
  expect_parts(dir_->read("latin.svg"), {"k\xEF\xBF\xBDse"});
  EXPECT_EQ(rio("evaluate " + flight_ + " " + latin + " --json").json()["associated"], scans());
}

}  // namespace
}  // namespace rio::test
