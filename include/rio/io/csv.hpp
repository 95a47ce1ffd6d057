// SPDX-License-Identifier: BSD-3-Clause
// Reads tables of numbers row by row, without holding the file in memory. Only blank lines, #
// comments and a heading of names are skipped silently.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rio::io {

/// The contents of a file; throws std::runtime_error if it is missing, a folder, or empty.
std::string read_text(const std::filesystem::path& path);

/// What a file is by its first bytes, 32 or more, and what to do, if it is not what its name says,
/// as downloads and power failures leave files: "a page of HTML...: download it again"; empty if it
/// is none of those known.
std::string_view foreign_file(std::string_view head);

/// Every error is a std::runtime_error that begins "FILE:LINE: ". All rows must have as many cells
/// as the first, so a truncated row is an error, and a decimal comma is found by the columns of a #
/// header; CRLF and a last line without newline are accepted.
class CsvReader {
 public:
  /// @param separator ',' or ' '; a space stands for any run of blanks and tabs
  /// @param may_be_cut a last line that is no whole row ends the table, see cut()
  explicit CsvReader(const std::filesystem::path& path, char separator = ',',
                     bool may_be_cut = false);

  /// What the first columns are read as, without units, components of vectors as "qw" or "ax": a
  /// heading that has one of these at another place, or another usual quantity in theirs, is an
  /// error. Before the first row.
  void expect_names(std::vector<std::string_view> names) { expected_names_ = std::move(names); }

  /// The heading of column i, as it stands there; empty without one.
  std::string_view heading(std::size_t i) const {
    return i < heading_.size() ? std::string_view(heading_[i]) : std::string_view();
  }

  /// Moves to the next row; false at the end of the file.
  bool next();

  /// Empty, or "FILE:LINE: ..." of a last line that is cut.
  const std::string& cut() const { return cut_; }

  std::size_t columns() const { return cells_.size(); }
  /// Cell i without surrounding blanks; throws if the row has no such cell.
  std::string_view cell(std::size_t i) const;
  bool is_empty(std::size_t i) const { return cell(i).empty(); }
  /// A decimal number, nan and inf included.
  double number(std::size_t i) const;
  /// An exact integer.
  std::int64_t integer(std::size_t i) const;
  /// Decimal seconds to exact nanoseconds; further digits are rounded.
  std::int64_t seconds_to_ns(std::size_t i) const;

  /// "FILE:LINE" of the current row.
  std::string place() const;
  /// Throws "FILE:LINE: what" for the current row.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  /// The next line, without its end; false at the end of the file. Valid until the next call.
  bool next_line(std::string_view* line);
  void read_on();
  void split(std::string_view line);
  void expect_columns();
  void compare_names() const;
  bool is_heading() const;
  bool repeats_heading() const;
  bool is_cut();
  /// Of a cell that is no number: the columns of the file are separated by something else.
  std::string other_separator(std::size_t i) const;
  [[noreturn]] void fail_on_cell(std::size_t i, const char* what) const;

  std::string name_;
  std::ifstream stream_;
  std::string text_;  ///< read and not yet discarded
  char separator_;
  bool may_be_cut_;
  bool last_is_empty_ = false;  ///< the last cell of the last row
  std::string cut_;
  std::size_t position_ = 0;  ///< in text_, of the next line
  std::size_t line_ = 0;
  std::vector<std::string> heading_;  ///< cells of the last comment or heading before the first row
  std::vector<std::string_view> expected_names_;
  std::size_t expected_columns_ = 0;
  std::vector<std::string_view> cells_;
};

}  // namespace rio::io
