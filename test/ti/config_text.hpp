// SPDX-License-Identifier: BSD-3-Clause
// The configuration of the project, also with other lines.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "rio/ti/config.hpp"
#include "support/temp_dir.hpp"

namespace rio::ti::test {

inline std::string committed() {
  return rio::test::text_of(RIO_SOURCE_DIR "/data/awr1843boost_odometry.cfg");
}

inline std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find("\n" + what);
  EXPECT_NE(at, std::string::npos) << what;
  return at == std::string::npos ? text : text.replace(at + 1, what.size(), by);
}

inline ConfigFigures figures_of(const std::string& text) {
  ConfigFigures figures;
  std::string why;
  EXPECT_TRUE(derive(parse_config(text), &figures, &why)) << why;
  return figures;
}

}  // namespace rio::ti::test
