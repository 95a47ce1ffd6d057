// SPDX-License-Identifier: BSD-3-Clause
#include "rio/io/csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <iterator>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "decimal.hpp"

namespace rio::io {

namespace {

/// In small letters, without its unit; components of usual vectors by one letter, as "qw" or "ax".
std::string name_of_column(std::string_view cell) {
  cell.remove_prefix(std::min(cell.find_first_not_of(" \t#"), cell.size()));
  std::string name(cell.substr(0, cell.find_first_of(" \t[(")));
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (name.size() < 2 || std::string_view("wxyz").find(name.back()) == name.npos) return name;
  const bool one_letter = name.size() == 2 || name[1] == '_';
  constexpr std::pair<const char*, char> kVectors[] = {
      {"quat", 'q'}, {"orient", 'q'}, {"gyr", 'w'}, {"ang", 'w'}, {"omega", 'w'}, {"acc", 'a'},
      {"mag", 'm'},  {"q", 'q'},      {"w", 'w'},   {"g", 'w'},   {"a", 'a'},     {"m", 'm'}};
  for (const auto& [begin, letter] : kVectors) {
    const bool is_letter = begin[1] == '\0';
    if (is_letter ? one_letter && name[0] == begin[0] : name.find(begin) != name.npos) {
      return {letter, name.back()};
    }
  }
  return name;
}

[[noreturn]] void fail_on(const std::filesystem::path& path, const char* what) {
  throw std::runtime_error(path.string() + ": " + what);
}

/// Explains why a path is not a file.
std::ifstream open_text(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) fail_on(path, "no such file");
  if (std::filesystem::is_directory(path, ignored)) fail_on(path, "is a folder, not a file");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) fail_on(path, "cannot be opened");
  return stream;
}

}  // namespace

std::string read_text(const std::filesystem::path& path) {
  std::ifstream stream = open_text(path);
  std::string text((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  if (stream.bad()) fail_on(path, "cannot be read");
  if (text.empty()) fail_on(path, "is empty");
  return text;
}

CsvReader::CsvReader(const std::filesystem::path& path, char separator, bool may_be_cut)
    : name_(path.string()),
      stream_(open_text(path)),
      separator_(separator),
      may_be_cut_(may_be_cut) {
  read_on();
  if (text_.empty()) fail_on(path, "is empty");
  if (const std::string what(foreign_file(text_)); !what.empty()) fail_on(path, what.c_str());
  if (text_.starts_with("\xFF\xFE") || text_.starts_with("\xFE\xFF")) {
    fail_on(path, "is UTF-16: save it as UTF-8");
  }
  if (text_.starts_with("\xEF\xBB\xBF")) position_ = 3;  // byte order mark of spreadsheet programs
}

void CsvReader::read_on() {
  constexpr std::size_t kPiece = 64 * 1024;
  text_.erase(0, position_);
  position_ = 0;
  const std::size_t kept = text_.size();
  text_.resize(kept + kPiece);
  stream_.read(text_.data() + kept, kPiece);
  if (stream_.bad()) fail_on(name_, "cannot be read");
  text_.resize(kept + static_cast<std::size_t>(stream_.gcount()));
  for (auto at = text_.find('\r', kept); at != text_.npos; at = text_.find('\r', at + 1)) {
    const bool last = at + 1 == text_.size();  // of the old ends of lines, CR without LF
    if ((last ? stream_.peek() : text_[at + 1]) != '\n') text_[at] = '\n';
  }
}

bool CsvReader::next_line(std::string_view* line) {
  std::size_t end = text_.find('\n', position_);
  while (end == std::string::npos && stream_) {
    const std::size_t searched = text_.size() - position_;
    read_on();
    end = text_.find('\n', searched);
  }
  if (end == std::string::npos) end = text_.size();
  if (position_ >= text_.size()) return false;
  *line = std::string_view(text_).substr(position_, end - position_);
  position_ = std::min(end + 1, text_.size());
  ++line_;
  if (line->ends_with('\r')) line->remove_suffix(1);
  return true;
}

bool CsvReader::next() {
  std::string_view line;
  while (next_line(&line)) {
    line = trimmed(line);
    if (line.empty()) continue;
    split(line);
    if (cells_.front().starts_with('#') || is_heading() || repeats_heading()) {
      if (expected_columns_ == 0) heading_.assign(cells_.begin(), cells_.end());
      continue;
    }
    const bool zeros = line.find('\0') != line.npos;
    if (zeros && (!may_be_cut_ || expected_columns_ == 0)) {
      fail("holds bytes of zero: damaged, or UTF-16, which must be saved as UTF-8");
    }
    if (zeros || is_cut()) {
      cut_ = place() + (zeros ? ": the file holds bytes of zero here, as after a power failure"
                              : ": the file ends inside of this line");
      return false;
    }
    expect_columns();
    return true;
  }
  return false;
}

/// The heading again, where files were joined.
bool CsvReader::repeats_heading() const {
  return expected_columns_ > 0 && !heading_.empty() && cells_.front() == heading_.front() &&
         std::equal(cells_.begin(), cells_.end(), heading_.begin(), heading_.end());
}

/// Names before the first row.
bool CsvReader::is_heading() const {
  const auto is_name = [](std::string_view cell) {
    return !cell.empty() && std::isalpha(static_cast<unsigned char>(cell[0])) != 0 &&
           !number_of<double>(cell);
  };
  if (expected_columns_ > 0) return false;
  if (cells_.front().empty() && cells_.size() > 1 &&
      (is_name(cells_[1]) || cells_[1].starts_with('#'))) {
    fail("the first column counts the rows and has no name: leave it out (pandas: index=False)");
  }
  return is_name(cells_.front());
}

/// The last line of the file, if it is no row like those before.
bool CsvReader::is_cut() {
  const bool any_before = expected_columns_ > 0;
  const bool ended_empty = std::exchange(last_is_empty_, cells_.back().empty());
  if (!may_be_cut_ || !any_before) return false;
  if (text_.find_first_not_of(" \t\r\n", position_) != std::string::npos) return false;
  if (stream_ && stream_.peek() != std::ifstream::traits_type::eof()) return false;
  if (cells_.size() != expected_columns_) return cells_.size() < expected_columns_;
  const std::string longer(cells_.back());  // "-" and "1e" may be the beginning of a number
  if (!last_is_empty_) return !number_of<double>(longer) && number_of<double>(longer + '0');
  const bool only_stamp = std::all_of(cells_.begin() + 1, cells_.end(),
                                      [](std::string_view cell) { return cell.empty(); });
  return !ended_empty && !only_stamp;
}

void CsvReader::expect_columns() {
  const std::size_t columns = cells_.size();
  const bool first = expected_columns_ == 0;
  if (first) expected_columns_ = columns;
  if (first && columns == heading_.size()) compare_names();
  const auto is_whole = [](std::string_view cell) { return cell.find('.') == cell.npos; };
  const bool halves = separator_ == ',' && columns + 1 == 2 * heading_.size() && columns > 1 &&
                      std::all_of(cells_.begin(), cells_.end(), is_whole);  // all but the stamp
  if (columns == expected_columns_ && !(first && halves)) return;
  if (halves) {
    fail(fmt::format("has {} columns, the header has {}: numbers need a decimal point, not a comma",
                     columns, heading_.size()));
  }
  fail(fmt::format("has {} columns, the rows before have {}", columns, expected_columns_));
}

void CsvReader::compare_names() const {
  constexpr std::string_view kOthers[] = {"range", "azimuth", "elevation", "az", "el",
                                          "qw",    "qx",      "qy",        "qz", "mx",
                                          "roll",  "pitch",   "yaw"};
  for (std::size_t i = 0; i < std::min(heading_.size(), expected_names_.size()); ++i) {
    const std::string name = name_of_column(heading_[i]);
    if (name.empty() || name == expected_names_[i]) continue;
    const auto is_in = [&name](const auto& names) {
      return std::find(std::begin(names), std::end(names), name) != std::end(names);
    };
    if (!is_in(expected_names_) && !is_in(kOthers)) continue;  // some other name for the same
    fail(fmt::format("by the heading column {} is \"{}\"; the columns are read as {}", i + 1,
                     heading_[i], fmt::join(expected_names_, ", ")));
  }
}

std::string CsvReader::other_separator(std::size_t i) const {
  if (i == 0 && cell(i).find(':') != std::string_view::npos) {
    return "; a date: a stamp is a number of nanoseconds";
  }
  const bool whole = cells_.size() == 1;  // line; else a blank is no separator
  const auto at = cell(i).find_first_of(separator_ == ' ' ? ";," : whole ? ";\t " : ";\t");
  if (at == std::string_view::npos) return "";
  const char found = cell(i)[at];
  const std::string name = found == '\t' ? "tabs" : found == ' ' ? "blanks" : std::string(1, found);
  return fmt::format("; columns are separated by {}, not by {}",
                     separator_ == ',' ? "commas" : "blanks", name);
}

void CsvReader::split(std::string_view line) {
  cells_.clear();
  while (true) {
    const std::size_t end = separator_ == ' ' ? line.find_first_of(" \t") : line.find(separator_);
    cells_.push_back(trimmed(line.substr(0, end), " \t\"'"));
    if (end == std::string_view::npos) return;
    line.remove_prefix(end + 1);
    if (separator_ == ' ') line = trimmed(line);
  }
}

std::string_view CsvReader::cell(std::size_t i) const {
  if (i >= cells_.size()) {
    fail(fmt::format("has {} columns, column {} is needed", cells_.size(), i + 1));
  }
  return cells_[i];
}

double CsvReader::number(std::size_t i) const {
  const auto value = number_of<double>(cell(i));
  if (!value) fail_on_cell(i, "not a number");
  return *value;
}

std::int64_t CsvReader::integer(std::size_t i) const {
  const auto value = number_of<std::int64_t>(cell(i));
  if (value) return *value;
  const bool decimal = number_of<double>(cell(i)).has_value();
  fail_on_cell(i, decimal ? "not an integer, as a stamp in ns is" : "not an integer");
}

std::int64_t CsvReader::seconds_to_ns(std::size_t i) const {
  const auto value = scaled_by_1e9(cell(i));
  if (!value) fail(fmt::format("column {}: not a time in seconds: \"{}\"", i + 1, cell(i)));
  return *value;
}

std::string CsvReader::place() const {
  return name_ + ":" + std::to_string(line_);
}

void CsvReader::fail_on_cell(std::size_t i, const char* what) const {
  fail(fmt::format("column {}: {}: \"{}\"{}", i + 1, what, cell(i), other_separator(i)));
}

void CsvReader::fail(const std::string& what) const {
  throw std::runtime_error(place() + ": " + what);
}

}  // namespace rio::io
