// SPDX-License-Identifier: BSD-3-Clause
// include/rio/README.md is the map of the headers: what it says of them holds.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "support/matches.hpp"
#include "support/temp_dir.hpp"

namespace rio {
namespace {

namespace fs = std::filesystem;
using test::matches;
using test::text_of;

const fs::path kHeaders = fs::path(RIO_SOURCE_DIR) / "include" / "rio";

/// Paths relative to include/rio.
std::vector<fs::path> headers() {
  std::vector<fs::path> all;
  for (const auto& entry : fs::recursive_directory_iterator(kHeaders)) {
    if (entry.path().extension() == ".hpp")
      all.push_back(entry.path().lexically_relative(kHeaders));
  }
  return all;
}

std::string room_of(const fs::path& header) {
  return header.parent_path().string();
}

/// The folders whose headers each folder includes.
std::map<std::string, std::set<std::string>> includes_by_room() {
  std::map<std::string, std::set<std::string>> graph;
  for (const fs::path& header : headers()) {
    for (const std::string& other :
         matches(text_of(kHeaders / header), "#include \"rio/([a-z_/]+\\.hpp)\"")) {
      if (room_of(other) != room_of(header)) graph[room_of(header)].insert(room_of(other));
    }
  }
  return graph;
}

TEST(Map, HasEveryHeader) {
  const std::string map = text_of(kHeaders / "README.md");
  ASSERT_GT(headers().size(), 80U);
  for (const fs::path& header : headers()) {
    const bool named = map.find("`" + header.string() + "`") != std::string::npos;
    const bool with_its_room = map.find("`" + room_of(header) + "/`") != std::string::npos;
    EXPECT_TRUE(named || with_its_room) << header << " is not on the map";
  }
}

TEST(Map, NamesWhatIsThere) {
  const std::vector<std::string> named =
      matches(text_of(kHeaders / "README.md"), "`([a-z0-9_]+/[a-z0-9_]+\\.hpp)`");
  ASSERT_GT(named.size(), 40U);
  for (const std::string& header : named) {
    const bool there =
        fs::exists(kHeaders / header) || fs::exists(fs::path(RIO_SOURCE_DIR) / header);
    EXPECT_TRUE(there) << header;
  }
}

TEST(Map, IncludesPointOneWay) {
  auto graph = includes_by_room();
  const std::vector<std::string> lines =
      matches(text_of(kHeaders / "README.md"), "\n(`core` <- [^\n]*)\n");
  ASSERT_EQ(lines.size(), 2U);
  const auto expect_apart = [&graph](const std::string& from, const std::string& to) {
    EXPECT_EQ(graph[from].count(to), 0U) << from << " includes " << to;
  };
  for (const std::string& line : lines) {
    const std::vector<std::string> order = matches(line, "`([a-z]+)`");
    ASSERT_GT(order.size(), 4U) << line;
    for (std::size_t i = 0; i < order.size(); ++i) {
      for (std::size_t j = i + 1; j < order.size(); ++j) expect_apart(order[i], order[j]);
    }
  }
  for (const std::string& beside : matches(lines[1], "`([a-z]+)`")) {
    if (beside == "core") continue;
    for (const std::string& room : matches(lines[0], "`([a-z]+)`")) expect_apart(room, beside);
  }
}

}  // namespace
}  // namespace rio
