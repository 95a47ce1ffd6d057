// SPDX-License-Identifier: BSD-3-Clause
#include "experiment/spread.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace rio::experiment {

Spread Spread::of(const std::vector<double>& values) {
  if (values.empty()) return {NAN, NAN, NAN};
  const double n = static_cast<double>(values.size());
  Spread s{0.0, values.front(), 0.0};
  for (const double value : values) {
    s.mean += value / n;
    s.worst = std::isnan(value) || value > s.worst ? value : s.worst;
  }
  if (values.size() > 1) {
    for (const double value : values) s.std += (value - s.mean) * (value - s.mean) / (n - 1.0);
    s.std = std::sqrt(s.std);
  }
  return s;
}

std::string Spread::text(int decimals) const {
  return fmt::format("{} ({}) ± {}", number(mean, decimals), number(worst, decimals),
                     number(std, decimals));
}

std::string mean_with_error(const std::vector<double>& values, int decimals) {
  const Spread s = Spread::of(values);
  const double error = s.std / std::sqrt(static_cast<double>(values.size()));
  return fmt::format("{:+.{}f} ± {:.{}f}", s.mean, decimals, error, decimals);
}

MarkdownTable::MarkdownTable(const std::vector<std::string>& head) : columns_(head.size()) {
  add(head);
  add(std::vector<std::string>(columns_, "---"));
}

void MarkdownTable::add(const std::vector<std::string>& row) {
  if (row.size() != columns_) throw std::logic_error("a row of another length");
  text_ += fmt::format("| {} |\n", fmt::join(row, " | "));
}

std::string number(double value, int decimals) {
  if (std::isnan(value)) return "-";
  constexpr double kLarge = 1000.0;  // figures this large need no decimals
  return fmt::format("{:.{}f}", value, std::abs(value) < kLarge ? decimals : 0);
}

}  // namespace rio::experiment
