// SPDX-License-Identifier: BSD-3-Clause
// The alarm for unintended slowness: the instructions of the first seconds of the sample flight,
// counted by valgrind, against those of record in counts.txt. Unlike times they are the same on a
// busy machine; between compilers and their flags they differ, so that others than those of record
// are skipped.
//
// More than 5 % off, in either direction, is red. To accept a change, or to add a compiler:
//     RIO_ACCEPT_CHANGE=1 ./test/run.sh -R instructions
// rewrites the lines of this compiler; commit them with the change and say why.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "support/measured.hpp"

namespace rio {
namespace {

constexpr double kTolerance = 0.05;
const std::string kRecord = std::string(RIO_SOURCE_DIR) + "/test/instructions/counts.txt";
/// What the counts are of: compiler, its flags, Eigen and processor.
const std::string kBuild = RIO_BUILD;

std::string output_of(const std::string& command) {
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  std::string output;
  std::array<char, 4096> buffer{};
  std::size_t n = 0;
  while ((n = fread(buffer.data(), 1, buffer.size(), pipe)) > 0) output.append(buffer.data(), n);
  return pclose(pipe) == 0 ? output : "failed: " + output;
}

bool has_valgrind() {
  return output_of("valgrind --version").starts_with("valgrind-");
}

/// "==12== I   refs:      1,234,567" as a number.
std::optional<double> instructions_in(const std::string& output) {
  const std::size_t at = output.find("refs:");
  if (output.starts_with("failed: ") || at == std::string::npos) return std::nullopt;
  std::string digits;
  for (const char c : output.substr(at + 5, output.find('\n', at) - at - 5)) {
    if (c >= '0' && c <= '9') digits += c;
  }
  return std::stod(digits);
}

/// Lines "BUILD, BACKEND: COUNT" after comments.
std::vector<std::string> read_record() {
  std::vector<std::string> lines;
  std::ifstream file(kRecord);
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

void compare(const std::string& backend, int seconds) {
  std::vector<std::string> record = read_record();
  const std::string what = kBuild + ", " + backend + ": ";
  auto own = std::find_if(record.begin(), record.end(),
                          [&](const std::string& line) { return line.starts_with(what); });
  const bool accept = std::getenv("RIO_ACCEPT_CHANGE") != nullptr;
  if (!accept && own == record.end()) GTEST_SKIP() << "no counts of record for " << what;
  if (!has_valgrind()) GTEST_SKIP() << "needs the package valgrind";
  const std::string output =
      output_of("valgrind --tool=cachegrind --cache-sim=no --cachegrind-out-file=/dev/null " +
                std::string(RIO_FLIGHT_LOAD) + " " + RIO_SOURCE_DIR + "/data/sample_flight " +
                backend + " " + std::to_string(seconds));
  const std::optional<double> count = instructions_in(output);
  ASSERT_TRUE(count) << output;
  if (accept) {
    if (own == record.end()) own = record.insert(own, what);
    *own = what + std::to_string(static_cast<std::int64_t>(*count));
    std::ofstream file(kRecord);
    for (const std::string& line : record) file << line << "\n";
    return;
  }
  SCOPED_TRACE("of record: " + *own + "; now: " + output);
  const double ratio = *count / std::stod(own->substr(what.size()));
  test::expect_near(backend + ": instructions over those of record", ratio, 1.0, kTolerance);
}

TEST(Instructions, OfTheFilterAreThoseOfRecord) {
  compare("ekf", 20);
}
TEST(Instructions, OfTheSmootherAreThoseOfRecord) {
  compare("smoother", 12);
}

}  // namespace
}  // namespace rio
