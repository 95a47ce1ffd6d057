// SPDX-License-Identifier: BSD-3-Clause
// Mean, worst and standard deviation of a figure over runs, and Markdown tables of them.
#pragma once

#include <string>
#include <vector>

namespace rio::experiment {

/// A figure over runs; NaN without runs.
struct Spread {
  double mean = 0.0;
  double worst = 0.0;  ///< the largest; NaN if one run has none
  double std = 0.0;    ///< of the sample (divides by n - 1); 0 for one run

  static Spread of(const std::vector<double>& values);
  /// Of a member.
  template <class Item>
  static Spread of(const std::vector<Item>& items, double Item::*value) {
    std::vector<double> values;
    for (const Item& item : items) values.push_back(item.*value);
    return of(values);
  }

  /// "mean (worst) ± std".
  std::string text(int decimals) const;
};

/// "+0.12 ± 0.03": mean and standard error.
std::string mean_with_error(const std::vector<double>& values, int decimals);

/// A Markdown table; every row must have as many cells as the head.
class MarkdownTable {
 public:
  explicit MarkdownTable(const std::vector<std::string>& head);
  void add(const std::vector<std::string>& row);
  const std::string& text() const { return text_; }

 private:
  std::size_t columns_;
  std::string text_;
};

/// A number with decimals, "-" for NaN.
std::string number(double value, int decimals);

}  // namespace rio::experiment
