// SPDX-License-Identifier: BSD-3-Clause
// A table of rounded numbers as a file, and the comparison of two of them that forgives what
// rounding does: two compilers may round one number to neighbouring last digits.
#pragma once

#include <cmath>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "rio/io/csv.hpp"
#include "rio/io/text_file.hpp"

namespace rio::test {

/// One value of a row, as text; an exact one, such as a count, is not forgiven its last digit.
struct Cell {
  std::string column;
  std::string text;
  bool exact = false;
};

using Row = std::vector<Cell>;
/// Names of the columns, then the rows.
using Texts = std::vector<std::vector<std::string>>;

inline Texts texts_of(const std::vector<Row>& rows) {
  Texts result;
  if (!rows.empty()) result.emplace_back();
  for (const Cell& cell : rows.empty() ? Row{} : rows.front()) result[0].push_back(cell.column);
  for (const Row& row : rows) {
    result.emplace_back();
    for (const Cell& cell : row) result.back().push_back(cell.text);
  }
  return result;
}

/// @throws std::runtime_error if the file is missing or empty
inline Texts read_table(const std::filesystem::path& path) {
  std::istringstream lines(io::read_text(path));
  Texts result;
  for (std::string line; std::getline(lines, line);) {
    result.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) result.back().push_back(cell);
  }
  return result;
}

/// @throws std::runtime_error if the file cannot be written
inline void write_table(const std::filesystem::path& path, const std::vector<Row>& rows) {
  io::TextFile file(path);
  for (const std::vector<std::string>& row : texts_of(rows)) {
    for (std::size_t i = 0; i < row.size(); ++i) file.write((i == 0 ? "" : ",") + row[i]);
    file.write("\n");
  }
  file.close();
}

/// What one unit of the last digit is worth: 0.01 for "3.14", 1e-4 for "1.23e-02".
inline double last_digit(const std::string& text) {
  const std::size_t e = text.find('e');
  const std::string mantissa = text.substr(0, e);
  const int exponent = e == std::string::npos ? 0 : std::stoi(text.substr(e + 1));
  const std::size_t point = mantissa.find('.');
  const int decimals =
      point == std::string::npos ? 0 : static_cast<int>(mantissa.size() - point) - 1;
  return std::pow(10.0, exponent - decimals);
}

/// Equal, or, unless exact, apart by no more than one unit of the last digit of the larger one.
inline bool agree(const std::string& was, const std::string& is, bool exact) {
  if (was == is) return true;
  if (exact) return false;
  const double a = std::stod(was);
  const double b = std::stod(is);
  constexpr double kDecimalFraction = 1.0 + 1e-6;  // decimal fractions are not exact in binary
  const double unit = last_digit(std::abs(a) > std::abs(b) ? was : is);
  return std::abs(a - b) <= kDecimalFraction * unit;
}

/// The first value that does not agree, in words; nothing if all agree. A row is named by its
/// number, from 1, and its first value.
inline std::optional<std::string> first_difference(const Texts& was, const std::vector<Row>& is) {
  const Texts now = texts_of(is);
  if (was.empty() || now.empty() || was[0] != now[0]) return "the columns are not the same";
  for (std::size_t i = 0; i < is.size() && i + 1 < was.size(); ++i) {
    if (was[i + 1].size() != is[i].size()) return "row " + std::to_string(i + 1) + " is not whole";
    for (std::size_t k = 0; k < is[i].size(); ++k) {
      const Cell& cell = is[i][k];
      if (agree(was[i + 1][k], cell.text, cell.exact)) continue;
      return "row " + std::to_string(i + 1) + " (" + is[i][0].column + " = " + is[i][0].text +
             "), column " + cell.column + ": was " + was[i + 1][k] + ", is " + cell.text;
    }
  }
  if (was.size() == now.size()) return std::nullopt;
  return "number of rows: was " + std::to_string(was.size() - 1) + ", is " +
         std::to_string(is.size());
}

}  // namespace rio::test
