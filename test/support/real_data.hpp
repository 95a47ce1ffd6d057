// SPDX-License-Identifier: BSD-3-Clause
// Real recordings, for tests that are skipped where there are none.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace rio::test {

/// What is called `name` in the folder RIO_TEST_DATA; empty if it is not there.
inline std::filesystem::path real_data(const std::string& name) {
  const char* folder = std::getenv("RIO_TEST_DATA");
  if (folder == nullptr) return {};
  const std::filesystem::path path = std::filesystem::path(folder) / name;
  return std::filesystem::exists(path) ? path : std::filesystem::path();
}

/// Why a test is skipped without.
inline constexpr const char* kNoRealData =
    "skipped: needs real recordings, a folder RIO_TEST_DATA with them";

}  // namespace rio::test
