// SPDX-License-Identifier: BSD-3-Clause
// The `rio` program run as a user runs it, and a flight for it.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "support/temp_dir.hpp"

namespace rio::test {

namespace fs = std::filesystem;

struct Outcome {
  int status = 0;
  std::string output;  ///< stdout and stderr
  std::string last_line() const {
    const std::string text = output.substr(0, output.find_last_not_of('\n') + 1);
    return text.substr(text.rfind('\n') + 1);
  }
};

/// Runs a command of the shell.
inline Outcome run_command(const std::string& command) {
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  Outcome run;
  std::array<char, 4096> buffer{};
  std::size_t n = 0;
  while ((n = fread(buffer.data(), 1, buffer.size(), pipe)) > 0)
    run.output.append(buffer.data(), n);
  run.status = pclose(pipe);
  return run;
}
/// Runs the program.
inline Outcome rio(const std::string& arguments) {
  return run_command(std::string(RIO_TOOL) + " " + arguments);
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

/// A simulated flight on disk, shared by the tests.
class Tool : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    dir_ = new TempDir;
    flight_ = (dir_->path() / "flight").string();
    const Outcome run = rio("simulate " + flight_ + " --seed 9 --length 25");
    ASSERT_EQ(run.status, 0) << run.output;
  }
  static void TearDownTestSuite() { delete dir_; }
  static std::string file(const std::string& name) { return (dir_->path() / name).string(); }
  static std::size_t scans() {
    std::size_t count = 0;
    std::string last;
    for (const std::string& line : lines_of(fs::path(flight_) / "radar0/data.csv")) {
      const std::string stamp = line.substr(0, line.find(','));
      count += stamp != last ? 1 : 0;
      last = stamp;
    }
    return count;
  }
  /// A copy of the flight that a test may damage.
  static fs::path copy(const std::string& name) {
    fs::copy(flight_, file(name), fs::copy_options::recursive);
    return file(name);
  }

  inline static TempDir* dir_ = nullptr;
  inline static std::string flight_;
};

}  // namespace rio::test
