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

#include "view/run.hpp"

namespace rio::view {

/// Numbers over one time axis; missing ones are NaN. Column "s" + name has sigmas of column name;
/// columns name + "-" and name + "+" are the edges of a band about it.
class Columns {
 public:
  void start_row(double seconds) { times_.push_back(static_cast<float>(seconds)); }
  /// Of the newest row.
  void set(const std::string& name, double value);
  bool has(const std::string& name) const { return columns_.count(name) > 0; }
  std::size_t rows() const { return times_.size(); }
  /// At most about `most` rows, `every` of the original as two: the smallest and the largest in
  /// their order; of edges and sigmas the outer one. Nothing is thinned.
  Columns folded(std::size_t most, std::size_t* every) const;
  const std::vector<float>& times() const { return times_; }
  const std::map<std::string, std::vector<float>>& all() const { return columns_; }

 private:
  std::vector<float> times_;
  std::map<std::string, std::vector<float>> columns_;
};

/// A curve of a plot with the name of its column. Its band is of three sigmas or between edges.
struct Curve {
  std::string label, value;
};

struct Plot {
  std::string group;  ///< heading above
  std::string title;  ///< with the unit
  std::string note;   ///< what is to be expected
  std::vector<Curve> curves;
  std::vector<double> lines{};  ///< horizontal ones
  bool steps = false;
  std::vector<double> range{};    ///< of the y axis; empty: that of the values
  bool bands_about_zero = false;  ///< those of sigmas: not about the curve
};

/// A histogram: counts over equal bins, with vertical lines at special values.
struct Histogram {
  std::string title, note, unit;
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

  struct Scan {
    double seconds = 0.0;
    Vector3d centre;
    std::vector<std::int16_t> values{};  ///< x y z [cm] from the centre, value [mm or mm/s]
    std::vector<std::uint8_t> labels{};
  };
  std::size_t stride = 1;  ///< one of so many scans is kept
  std::vector<Scan> scans;

 private:
  std::size_t seen_ = 0;   ///< scans
  std::size_t marks_ = 0;  ///< kept
  bool kept_ = false;      ///< the newest scan
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
