// SPDX-License-Identifier: BSD-3-Clause
// A self-contained HTML page about runs: a summary, paths and points in 3-D, series over time with
// bands, events. Generic: what is shown is data; page.js draws it with dygraphs and three of
// Debian, which are inlined when they are installed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "view/record.hpp"

namespace rio::view {

/// How the rows of a column are drawn where there are more of them than pixels: never thinned.
enum class Fold : std::uint8_t {
  kBoth,  ///< the smallest and the largest, in their order
  kLow,   ///< the smallest: lower edge of a band
  kHigh,  ///< the largest: upper edge of a band, sigmas
};

/// Numbers over one time axis; missing ones are NaN.
class Columns {
 public:
  void start_row(double seconds) { times_.push_back(static_cast<float>(seconds)); }
  /// Of the newest row.
  void set(const std::string& name, double value, Fold fold = Fold::kBoth);
  bool has(const std::string& name) const { return columns_.count(name) > 0; }
  std::size_t rows() const { return times_.size(); }

  struct Column {
    Fold fold = Fold::kBoth;
    std::vector<float> values;
  };
  /// At most about `most` rows; `every` rows of the original became two.
  Columns folded(std::size_t most, std::size_t* every) const;
  const std::vector<float>& times() const { return times_; }
  const std::map<std::string, Column>& all() const { return columns_; }

 private:
  std::vector<float> times_;
  std::map<std::string, Column> columns_;
};

/// A curve of a plot: names of columns.
struct Curve {
  std::string label;
  std::string value;
  std::string sigma{};        ///< a band of three of them about the value ...
  std::string low{}, high{};  ///< ... or between two columns
  bool about_zero = false;    ///< the band of sigma is about zero, not about the value
};

struct Plot {
  std::string title;  ///< with the unit
  std::string note;   ///< what is to be expected
  std::vector<Curve> curves;
  std::vector<double> lines{};  ///< horizontal ones
  bool steps = false;
  std::string group{};  ///< heading above
};

/// A histogram: counts over equal bins, with vertical lines at special values.
struct Histogram {
  std::string title, note;
  double first = 0.0, width = 1.0;
  std::vector<std::uint64_t> counts;
  std::vector<double> lines{};
};

struct Path {
  std::string name;
  std::vector<float> times{};      ///< [s]
  std::vector<float> positions{};  ///< x y z of each [m]
  std::vector<float> attitudes{};  ///< q x y z w of each; may be empty

  void add(double seconds, const Vector3d& p) {
    times.push_back(static_cast<float>(seconds));
    for (const double value : p) positions.push_back(static_cast<float>(value));
  }
  void add(double seconds, const Vector3d& p, const Quaternion& q) {
    add(seconds, p);
    for (const double value : q.coeffs()) attitudes.push_back(static_cast<float>(value));
  }
};

/// Points and landmarks of scans, quantised around the position of the scan.
class Marks {
 public:
  static constexpr std::uint8_t kLandmark = kPointLabelCount;

  void start_scan(double seconds, const Vector3d& centre);
  /// @param value residual of a point [m/s], sigma of a landmark [m]
  void add(const Vector3d& point_W, double value, std::uint8_t label);

  std::size_t stride = 1;  ///< one of so many scans is kept
  std::vector<float> times;
  std::vector<float> centres;         ///< x y z of each scan [m]
  std::vector<std::uint32_t> firsts;  ///< index of its first mark
  std::vector<std::int16_t> values;   ///< x y z [cm] from the centre, value [mm or mm/s]
  std::vector<std::uint8_t> labels;

 private:
  void drop_every_second();

  std::size_t scan_ = 0;
  bool kept_ = false;
};

struct CardLine {
  std::string name, value, advice{};
};

/// Rows of cells; the first row is the head.
struct Table {
  std::string title;
  std::vector<std::vector<std::string>> rows;
};

struct Page {
  std::string title, subtitle;
  std::string verdict;  ///< "healthy", "doubtful: ...", "lost: ..."
  std::vector<CardLine> card;
  std::vector<Table> tables;
  std::vector<Path> paths;
  Marks marks;
  Columns columns;
  std::vector<Plot> plots;
  std::vector<Histogram> histograms;
  Time begin{0};  ///< zero of all times above
  std::vector<Event> events;
};

/// Writes the page. Without the libraries it has no plots or no 3-D, and says so.
/// @return notes for the user: what is missing and how to get it
std::vector<std::string> write_page(const Page& page, const std::filesystem::path& path);

}  // namespace rio::view
