// SPDX-License-Identifier: BSD-3-Clause
// The figures of README.md are those of data/results/README.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

namespace rio {
namespace {

namespace fs = std::filesystem;

std::string text_of(const char* name) {
  std::ostringstream text;
  text << std::ifstream(fs::path(RIO_SOURCE_DIR) / name).rdbuf();
  return text.str();
}

/// Line breaks are spaces.
std::string readme() {
  return std::regex_replace(text_of("README.md"), std::regex("\\s+"), " ");
}

using Cells = std::vector<std::string>;

/// The rows of the tables in a section or block of the results that begin with these cells.
std::vector<Cells> rows(const std::string& begin, const Cells& first) {
  static const std::string results = text_of("data/results/README.md");
  const std::size_t at = results.find(begin);
  EXPECT_NE(at, std::string::npos) << begin;
  std::istringstream text(results.substr(at, results.find("\n## ", at + begin.size()) - at));
  std::vector<Cells> found;
  for (std::string line; std::getline(text, line);) {
    if (line.rfind("| ", 0) != 0) continue;
    Cells cells;
    std::istringstream row(line.substr(2));
    for (std::string cell; std::getline(row, cell, '|');) {
      while (!cell.empty() && cell.back() == ' ') cell.pop_back();
      cells.push_back(cell.substr(std::min(cell.find_first_not_of(' '), cell.size())));
    }
    bool fits = cells.size() > first.size();
    for (std::size_t i = 0; i < first.size() && fits; ++i) fits = cells[i] == first[i];
    if (fits) found.push_back(cells);
  }
  EXPECT_FALSE(found.empty()) << begin;
  return found;
}

Cells row(const std::string& begin, const Cells& first) {
  const std::vector<Cells> found = rows(begin, first);
  return found.empty() ? Cells(20, "nothing") : found.front();
}

double mean(const std::string& cell) {
  return std::atof(cell.c_str());
}
/// In brackets.
double worst(const std::string& cell) {
  return std::atof(cell.c_str() + cell.find('(') + 1);
}

/// The pattern, in which groups are figures, stands in the README, and each is the value rounded.
void expect_figures(const std::string& pattern, const std::vector<double>& values) {
  const std::string text = readme();
  std::smatch match;
  ASSERT_TRUE(std::regex_search(text, match, std::regex(pattern))) << pattern;
  ASSERT_EQ(match.size(), values.size() + 1) << pattern;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::string said = match[i + 1];
    const std::size_t point = said.find('.');
    const std::size_t decimals = point == std::string::npos ? 0 : said.size() - point - 1;
    const double unit = std::pow(10.0, -static_cast<double>(decimals));
    EXPECT_NEAR(std::atof(said.c_str()), values[i], 0.501 * unit) << match[0];
  }
}

constexpr const char* kFlights = "## The flights of the 2023 paper";
constexpr const char* kNumber = "([0-9.]*[0-9])";

/// "#" is a figure.
std::string pattern(std::string text) {
  for (const char* special : {"(", ")", "*", "+"}) {
    for (std::size_t at = 0; (at = text.find(special, at)) != std::string::npos; at += 2) {
      text.insert(at, "\\");
    }
  }
  for (std::size_t at = 0; (at = text.find('#', at)) != std::string::npos;) {
    text.replace(at, 1, kNumber);
  }
  return text;
}

TEST(Readme, AccuracyOfItsFirstScreenIsThatOfTheResults) {
  const std::string flights = row(kFlights, {"all"}).at(3);
  expect_figures(
      pattern(
          "**Accuracy**, error in % of the distance travelled: # % at the end of simulated flights "
          "of 128 to 175 m (worst # %)"),
      {mean(flights), worst(flights)});
}

TEST(Readme, CostOfItsFirstScreenIsThatOfTheResults) {
  const double filter = mean(row("## Speed", {"filter, 27"})[2]);
  const double window = mean(row("## Speed", {"window, 27"})[2]);
  const std::string results = text_of("data/results/README.md");
  std::smatch memory;
  ASSERT_TRUE(std::regex_search(results, memory,
                                std::regex("takes ([0-9.]+) MB with the filter and ([0-9.]+) MB")));
  expect_figures(
      pattern("# ms a scan with the filter, # ms with the smoother; # and # MB of memory"),
      {filter, window, std::stod(memory[1]), std::stod(memory[2])});
}

TEST(Readme, LimitsOfItsFirstScreenAreThoseOfTheResults) {
  const auto nees = [](const char* scenario) {
    return mean(row("<!-- rio experiment robustness", {scenario}).at(5));
  };
  EXPECT_NEAR(nees("people"), 3.0, 0.5);  // "a factor of three in variance"
  EXPECT_LT(nees("rough-imu"), 1.5);      // not named
  EXPECT_NE(readme().find("overconfident by a factor of three in variance"), std::string::npos);
}

TEST(Readme, FlightsOfThePaperAreThoseOfTheResults) {
  const Cells all = row(kFlights, {"all"});
  expect_figures(pattern("`default` ends off by # % of the distance on average (worst # %), "
                         "`published-ekf` by # % (# %)"),
                 {mean(all[3]), worst(all[3]), mean(all[5]), worst(all[5])});
  const double times = std::atof(all[6].c_str() + all[6].find("default") + 8);
  expect_figures(pattern("`default` is # times what the same data would allow"), {times});
}

TEST(Readme, ScenariosAreThoseOfTheResults) {
  double least = 1e9;
  double most = 0.0;
  double all = 0.0;
  for (const Cells& cells : rows("<!-- rio experiment robustness", {})) {
    if (cells[0] == "scenario" || cells[0] == "---" || cells[0] == "hover" ||
        cells[0] == "rough-ground") {
      continue;
    }
    least = std::min(least, mean(cells[3]));
    most = std::max(most, mean(cells[3]));
    all = std::max(all, worst(cells[3]));
  }
  expect_figures(
      pattern("twenty seeds each: # to # % of the distance on average (worst flight # %)"),
      {least, most, all});
  const std::string hover = row("<!-- rio experiment robustness", {"hover"})[2];
  expect_figures(pattern("hover end # m off (worst # m)"), {mean(hover), worst(hover)});
  const Cells ground = row("<!-- rio experiment robustness", {"rough-ground"});
  expect_figures(pattern("vehicle in view, by # % (worst # %"),
                 {mean(ground[3]), worst(ground[3])});
  EXPECT_NEAR(std::atof(ground[5].c_str()), 6.0, 0.5);  // "overconfident by six in variance"
}

TEST(Readme, TheEndOfADayIsThatOfTheResults) {
  const std::string position = row("## A day in one go", {"24.00"})[2];
  expect_figures(
      pattern("position ends # m off at a sigma of # m"),
      {std::atof(position.c_str()), std::atof(position.substr(position.find('/') + 1).c_str())});
  const Cells largest = row("## A day in one go", {"position: largest NEES of a row"});
  expect_figures(pattern("largest NEES of the position #)"), {mean(largest[1])});
}

}  // namespace
}  // namespace rio
