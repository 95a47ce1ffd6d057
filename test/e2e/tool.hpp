// SPDX-License-Identifier: BSD-3-Clause
// The `rio` program run as a user runs it, and a flight for it.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "support/temp_dir.hpp"

namespace rio::test {

namespace fs = std::filesystem;

using Json = nlohmann::json;

struct Outcome {
  int code = 0;        ///< exit code; -1 after a signal
  std::string output;  ///< stdout and stderr
  std::string last_line() const {
    const std::string text = output.substr(0, output.find_last_not_of('\n') + 1);
    return text.substr(text.rfind('\n') + 1);
  }
  /// The line of JSON, wherever it stands beside what is on stderr.
  Json json() const {
    std::istringstream lines(output);
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with('{')) return Json::parse(line);
    }
    ADD_FAILURE() << "no JSON in\n" << output;
    return {};
  }
};

/// Runs a command of the shell.
inline Outcome run_command(const std::string& command) {
  FILE* pipe = popen(("{ " + command + "\n} 2>&1").c_str(), "r");
  Outcome run;
  std::array<char, 4096> buffer{};
  std::size_t n = 0;
  while ((n = fread(buffer.data(), 1, buffer.size(), pipe)) > 0)
    run.output.append(buffer.data(), n);
  const int status = pclose(pipe);
  run.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return run;
}

/// Parts of a text; on failure the text is shown.
using Parts = std::vector<std::string>;
inline void expect_parts(const std::string& text, const Parts& parts, bool there = true) {
  for (const std::string& part : parts) {
    EXPECT_EQ(contains(text, part), there) << '"' << part << "\" in\n" << text;
  }
}
inline void expect_none(const std::string& text, const Parts& parts) {
  expect_parts(text, parts, false);
}

/// Runs the program, whatever becomes of it.
inline Outcome try_rio(const std::string& arguments) {
  return run_command(std::string(RIO_TOOL) + " " + arguments);
}
/// Runs the program, which must end with this exit code and say all of these parts.
inline Outcome fails(int code, const std::string& arguments, const Parts& parts) {
  SCOPED_TRACE("rio " + arguments);
  Outcome run = try_rio(arguments);
  EXPECT_EQ(run.code, code) << run.output;
  expect_parts(run.output, parts);
  return run;
}
/// The same, with success.
inline Outcome rio(const std::string& arguments, const Parts& parts = {}) {
  return fails(0, arguments, parts);
}

/// Lines that are no comments.
inline std::vector<std::string> lines_of(const fs::path& file) {
  std::ifstream in(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) {
    if (line[0] != '#') lines.push_back(line);
  }
  return lines;
}

/// The data in a page.
inline Json data_of(const fs::path& page) {
  const std::string begin = "<script type='application/json' id='data'>";
  const std::string text = text_of(page);
  const std::size_t at = text.find(begin) + begin.size();
  return Json::parse(text.substr(at, text.find("</script>", at) - at));
}

/// Norm of RMSE of an estimated path [m].
inline double path_error(const std::string& truth, const std::string& estimate,
                         const std::string& options = "") {
  return rio("evaluate " + truth + " " + estimate + options + " --json").json()["norm_of_rmse_m"];
}

/// A simulated flight on disk, shared by the tests.
class Tool : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    dir_ = new TempDir;
    flight_ = (dir_->path() / "flight").string();
    rio("simulate " + flight_ + " --seed 9 --length 25");
  }
  static void TearDownTestSuite() { delete dir_; }
  static std::string file(const std::string& name) { return (dir_->path() / name).string(); }
  /// The stamps of its scans, as written.
  static std::set<std::string> stamps() {
    std::set<std::string> stamps;
    for (const std::string& line : lines_of(fs::path(flight_) / "radar0/data.csv")) {
      stamps.insert(line.substr(0, line.find(',')));
    }
    return stamps;
  }
  static std::size_t scans() { return stamps().size(); }
  /// A copy of the flight that a test may damage.
  static fs::path copy(const std::string& name) {
    fs::copy(flight_, file(name), fs::copy_options::recursive);
    return file(name);
  }

  /// A copy in which an awk program has changed the rows of a file.
  static std::string changed(const std::string& name, const std::string& csv,
                             const std::string& awk) {
    const fs::path folder = copy(name);
    const std::string file = (folder / csv).string();
    const std::string command =
        "awk -F, -v OFS=, -v CONVFMT=%.12g -v OFMT=%.12g '/^#/ {print; next} {" + awk +
        "; print}' " + file + " > " + file + ".new && mv " + file + ".new " + file;
    EXPECT_EQ(run_command(command).code, 0) << command;
    return folder.string();
  }

  /// A copy with the first half of the rows of a file.
  static std::string halved(const std::string& name, const std::string& csv) {
    const std::size_t rows = lines_of(fs::path(flight_) / csv).size() / 2;
    return changed(name, csv, "if (NR > " + std::to_string(rows) + ") exit");
  }

  inline static TempDir* dir_ = nullptr;
  inline static std::string flight_;
};

}  // namespace rio::test
