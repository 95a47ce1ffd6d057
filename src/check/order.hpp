// SPDX-License-Identifier: BSD-3-Clause
// Items of a recording in time order, and the positions of the others.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "check/finding.hpp"
#include "rio/checks/stamp_guard.hpp"
#include "rio/types.hpp"

namespace rio::check {

/// The longest sequence, as indices, of the times in which `may_follow(one, the next)`: < or <=.
/// Invalid stamps are in none. O(n log n).
/// @param time_of time of item i
template <typename TimeOf, typename MayFollow>
std::vector<std::size_t> longest_sequence(std::size_t count, const TimeOf& time_of,
                                          const MayFollow& may_follow) {
  std::vector<std::size_t> order;  // last item of the best sequence of each length
  std::vector<std::size_t> before(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Time time = time_of(i);
    if (!is_stamp(time)) continue;
    const auto at = std::ranges::partition_point(
        order, [&](std::size_t end) { return may_follow(time_of(end), time); });
    if (at != order.begin()) before[i] = *(at - 1);
    if (at == order.end()) {
      order.push_back(i);
    } else if (time < time_of(*at)) {
      *at = i;
    }
  }
  // of these only the last one is in the longest sequence; the others are before it
  for (std::size_t k = order.size(); k-- > 1;) order[k - 1] = before[order[k]];
  return order;
}

/// The longest sequence of strictly increasing stamps, as indices: a corrupt stamp of any value
/// costs only its own item. Of equal stamps the first is used. At either end an item farther away
/// than all others span is dropped, too; if all stamps are invalid, the first item is returned.
template <typename Items>
std::vector<std::size_t> in_order(const Items& items) {
  const auto time_of = [&](std::size_t i) { return items[i].time; };
  std::vector<std::size_t> order = longest_sequence(items.size(), time_of, std::less<>{});
  if (order.empty() && items.size() > 0) order.push_back(0);
  const auto span = [&](std::size_t a, std::size_t b) {
    return to_seconds(items[order[b]].time - items[order[a]].time);
  };
  const std::size_t n = order.size();
  if (n > 3 && span(n - 2, n - 1) > span(0, n - 2)) order.pop_back();
  if (order.size() > 3 && span(0, 1) > span(1, order.size() - 1)) order.erase(order.begin());
  return order;
}

/// The items that are not in_order(), except those that repeat the stamp before them.
struct Strays {
  std::size_t count = 0;
  std::size_t first = 0;
};
template <typename Items>
Strays strays(const Items& all) {
  Strays out;
  const std::vector<std::size_t> order = in_order(all);
  std::size_t next = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (next < order.size() && order[next] == i) {
      ++next;
      continue;
    }
    const bool repeated = i > 0 && all[i].time == all[i - 1].time;
    if (!repeated && out.count++ == 0) out.first = i;
  }
  return out;
}

/// The coarsest grid that all valid stamps are on [s]; 0 without one that is not zero.
template <typename Items>
double grid_of(const Items& items) {
  std::int64_t grid = 0;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (is_stamp(items[i].time)) grid = std::gcd(grid, items[i].time.count());
  }
  return to_seconds(Time(grid));
}

/// Many items share a stamp: it lost its last digits, or they came in batches. Digits are lost at a
/// power of ten.
inline Finding cut_stamps(const char* subject, double grid, std::string change) {
  const double digits = std::log10(grid);
  if (std::abs(digits - std::round(digits)) > 1e-6) {
    return {Verdict::kWrong, subject,
            fmt::format("all stamps are multiples of {:g} s: samples come in batches that share a "
                        "stamp",
                        grid),
            (change.starts_with("--") ? change + ", or " : "") +
                "stamp each sample by itself in its driver"};
  }
  return {Verdict::kWrong, subject,
          fmt::format("all stamps are multiples of {:g} s: they lost digits when they were written",
                      grid),
          std::move(change)};
}

/// Where a clock was set back or started again: later stamps go on from there.
struct Jump {
  std::size_t count = 0;
  std::size_t first = 0;  ///< item
  double seconds = 0.0;   ///< of the first; below zero
};
inline constexpr double kBack = -0.5;  ///< [s]
template <typename Items>
Jump jumps_back(const Items& all) {
  Jump out;
  for (std::size_t i = 2; i + 1 < all.size(); ++i) {
    const double step = to_seconds(all[i].time) - to_seconds(all[i - 1].time);
    const double after = to_seconds(all[i + 1].time) - to_seconds(all[i - 1].time);
    if (step > kBack || after > kBack) continue;                           // not one corrupt stamp
    if (to_seconds(all[i].time) >= to_seconds(all[i - 2].time)) continue;  // of the last
    if (out.count++ > 0) continue;
    out.first = i;
    out.seconds = step;
  }
  return out;
}
inline std::string jump_text(const Jump& jump) {
  return ": the clock goes back " +
         (jump.count == 1 ? std::string("once") : std::to_string(jump.count) + " times") +
         ", first by " + std::to_string(-std::lround(jump.seconds)) + " s";
}
inline constexpr const char* kSplitThere =
    "split the recording there, or put all stamps on one clock that goes on";

/// "FILE:LINE" of a row of a csv file, counted from 0; empty if the file cannot be read.
inline std::string place_of(const std::filesystem::path& csv, std::size_t row) {
  std::ifstream file(csv);
  std::size_t line = 1;
  for (std::string text; std::getline(file, text); ++line) {
    const std::size_t first = text.find_first_not_of(" \t\r");
    if (first == std::string::npos || text[first] == '#') continue;
    if (row-- == 0) return csv.string() + ":" + std::to_string(line);
  }
  return "";
}

}  // namespace rio::check
