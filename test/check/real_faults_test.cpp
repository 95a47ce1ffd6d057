// SPDX-License-Identifier: BSD-3-Clause
// The faults of check/faults.hpp in a real recording, ti_demo: carried by hand, a few points a
// scan. Skipped without RIO_TEST_DATA, a folder with it.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>

#include "check/check_it.hpp"
#include "support/measured.hpp"

namespace rio::test {
namespace {

/// What its motion does not tell.
const std::set<std::string> kNotTold = {};

TEST(CheckOfARealRecording, NamesTheFaultsItsMotionTells) {
  const char* data = std::getenv("RIO_TEST_DATA");
  const auto recording = std::filesystem::path(data != nullptr ? data : "") / "ti_demo";
  if (data == nullptr || !std::filesystem::exists(recording)) {
    GTEST_SKIP() << "needs RIO_TEST_DATA, a folder with the recording ti_demo";
  }
  const io::Dataset healthy = io::read_dataset(recording);
  const Findings fine = check_it(healthy);
  EXPECT_NE(worst(fine), Verdict::kWrong) << text_of(fine);
  int named = 0;
  for (const Fault& fault : faults()) {
    io::Dataset damaged = healthy;
    fault.make(&damaged);
    const Findings findings = check_it(damaged);
    const bool is_named = check::naming(findings, fault) != nullptr;
    EXPECT_EQ(is_named, kNotTold.count(fault.name) == 0) << fault.name << "\n" << text_of(findings);
    named += is_named ? 1 : 0;
  }
  measured(
      "ti_demo: faults named", named,
      std::to_string(faults().size() - kNotTold.size()) + " of " + std::to_string(faults().size()));
}

}  // namespace
}  // namespace rio::test
