// SPDX-License-Identifier: BSD-3-Clause
#include "view/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>

#include "page_text.hpp"
#include "plot/svg.hpp"
#include "rio/io/text_file.hpp"

namespace rio::view {

namespace {

using Json = nlohmann::ordered_json;
using plot::escaped;

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();
constexpr std::size_t kMostRows = 3000;     // of a series: two a pixel of a page 1400 wide
constexpr std::size_t kMostMarks = 300000;  // of nine bytes

template <class T>
std::string base64(const std::vector<T>& values) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<unsigned char> bytes(values.size() * sizeof(T));
  if (!bytes.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  std::string text;
  text.reserve(4 * (bytes.size() / 3 + 1));
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = (group << 8) | (i + k < bytes.size() ? bytes[i + k] : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += i + k > bytes.size() ? '=' : kDigits[(group >> (18 - 6 * k)) & 63U];
    }
  }
  return text;
}

std::int16_t rounded(double value) {
  if (!std::isfinite(value)) return 0;
  return static_cast<std::int16_t>(std::clamp(std::round(value), -32767.0, 32767.0));
}

/// The two values that each bucket of a column is drawn with: the smallest, the largest, or both.
std::vector<float> folded(const std::vector<float>& v, std::size_t step, bool lows, bool highs) {
  std::vector<float> out;
  for (std::size_t from = 0; from < v.size(); from += step) {
    std::size_t low = from;
    std::size_t high = from;
    for (std::size_t i = from; i < std::min(from + step, v.size()); ++i) {
      if (std::isnan(v[low]) || v[i] < v[low]) low = i;
      if (std::isnan(v[high]) || v[i] > v[high]) high = i;
    }
    if (lows) high = low;
    if (highs) low = high;
    out.insert(out.end(), {v[std::min(low, high)], v[std::max(low, high)]});
  }
  return out;
}

/// A library of Debian as text; empty if it is not installed.
std::string library(const std::vector<std::string>& places) {
  for (const std::string& place : places) {
    std::ifstream file(place, std::ios::binary);
    if (!file) continue;
    return {std::istreambuf_iterator<char>(file), {}};
  }
  return {};
}

/// Text that does not end the element it stands in.
std::string inlined(std::string text, const std::string& element) {
  const std::string end = "</" + element;
  for (std::size_t at = 0; (at = text.find(end, at)) != std::string::npos; at += end.size() + 1) {
    text.insert(at + 1, "\\");
  }
  return text;
}

Json columns_json(const Page& page, std::size_t* every) {
  const Columns columns = page.columns.folded(kMostRows, every);
  Json json = {{"t", base64(columns.times())}};
  for (const auto& [name, column] : columns.all()) json[name] = base64(column);
  return json;
}

Json plots_json(const Page& page) {
  Json plots = Json::array();
  for (const Plot& plot : page.plots) {
    Json curves = Json::array();
    for (std::size_t i = 0; i < plot.curves.size(); ++i) {
      const Curve& c = plot.curves[i];
      if (!page.columns.has(c.value)) continue;
      curves.push_back({{"index", i}, {"label", c.label}, {"value", c.value}});  // i: its colour
    }
    if (curves.empty()) continue;
    plots.push_back({{"group", plot.group},
                     {"title", plot.title},
                     {"note", plot.note},
                     {"curves", curves},
                     {"lines", plot.lines},
                     {"range", plot.range},
                     {"zero", plot.bands_about_zero},
                     {"steps", plot.steps}});
  }
  return plots;
}

Json marks_json(const Marks& marks) {
  std::vector<float> times;
  std::vector<float> centres;
  std::vector<std::uint32_t> firsts;  // index of the first mark of a scan
  std::vector<std::int16_t> values;
  std::vector<std::uint8_t> labels;
  for (const Marks::Scan& scan : marks.scans) {
    times.push_back(static_cast<float>(scan.seconds));
    for (const double value : scan.centre) centres.push_back(static_cast<float>(value));
    firsts.push_back(static_cast<std::uint32_t>(labels.size()));
    values.insert(values.end(), scan.values.begin(), scan.values.end());
    labels.insert(labels.end(), scan.labels.begin(), scan.labels.end());
  }
  return {{"stride", marks.stride},  {"t", base64(times)},       {"centre", base64(centres)},
          {"first", base64(firsts)}, {"values", base64(values)}, {"labels", base64(labels)}};
}

Json page_json(const Page& page) {
  std::size_t every = 1;
  Json json = {{"columns", columns_json(page, &every)},
               {"every", every},
               {"plots", plots_json(page)},
               {"paths", Json::array()},
               {"histograms", Json::array()},
               {"events", Json::array()},
               {"labels", Json::array()},
               {"marks", marks_json(page.marks)}};
  for (const Path& path : page.paths) {
    json["paths"].push_back({{"name", path.name},
                             {"t", base64(path.times)},
                             {"p", base64(path.positions)},
                             {"q", base64(path.attitudes)}});
  }
  for (const Histogram& h : page.histograms) {
    json["histograms"].push_back({{"group", "Histograms"},
                                  {"title", h.title},
                                  {"note", h.note},
                                  {"unit", h.unit},
                                  {"first", h.first},
                                  {"width", h.width},
                                  {"counts", h.counts},
                                  {"lines", h.lines}});
  }
  for (const Event& event : page.events) {
    json["events"].push_back({{"t", to_seconds(event.time - page.begin)},
                              {"kind", kEventNames[static_cast<std::size_t>(event.kind)]},
                              {"serious", event.serious},
                              {"text", event.text}});
  }
  for (std::size_t i = 0; i < kPointLabelCount; ++i) {
    json["labels"].push_back(to_string(static_cast<PointLabel>(i)));
  }
  json["labels"].push_back("landmark");
  return json;
}

std::string card_html(const Page& page) {
  const std::string kind = page.verdict.substr(0, page.verdict.find(':'));
  std::string html = page.verdict.empty()
                         ? ""
                         : fmt::format("<p class='verdict {}'><strong>{}</strong>{}</p>\n", kind,
                                       escaped(kind), escaped(page.verdict.substr(kind.size())));
  html += "<dl class='card'>\n";
  for (const CardLine& line : page.card) {
    html += fmt::format("<div><dt>{}</dt><dd>{}{}</dd></div>\n", escaped(line.name),
                        escaped(line.value),
                        line.advice.empty() ? "" : "<em>" + escaped(line.advice) + "</em>");
  }
  html += "</dl>\n";
  for (const Table& table : page.tables) {
    html += "<h2>" + escaped(table.title) + "</h2><div class='scroll'><table>\n";
    for (std::size_t r = 0; r < table.rows.size(); ++r) {
      html += "<tr>";
      for (const std::string& cell : table.rows[r]) {
        html += fmt::format("<{0}>{1}</{0}>", r == 0 ? "th" : "td", escaped(cell));
      }
      html += "</tr>\n";
    }
    html += "</table></div>\n";
  }
  return html;
}

}  // namespace

void Columns::set(const std::string& name, double value) {
  std::vector<float>& column = columns_[name];
  column.resize(times_.size(), kMissing);
  column.back() = static_cast<float>(value);
}

Columns Columns::folded(std::size_t most, std::size_t* every) const {
  const std::size_t step = rows() <= most ? 1 : (2 * rows() + most - 1) / most;
  *every = step;
  Columns out = *this;
  for (auto& [name, column] : out.columns_) {
    column.resize(rows(), kMissing);
    const bool sigmas = name[0] == 's' && has(name.substr(1));
    if (step > 1) {
      column = view::folded(column, step, name.back() == '-', name.back() == '+' || sigmas);
    }
  }
  if (step > 1) out.times_.clear();
  for (std::size_t i = 0; step > 1 && i < rows(); i += step) {
    const float end = times_[std::min(i + step, rows() - 1)];
    out.times_.insert(out.times_.end(), {times_[i], 0.5F * (times_[i] + end)});
  }
  return out;
}

void Marks::start_scan(double seconds, const Vector3d& centre) {
  if (seen_ % stride == 0 && marks_ > kMostMarks) {
    std::size_t i = 0;
    std::erase_if(scans, [&i](const Scan& /*scan*/) { return i++ % 2 == 1; });
    stride *= 2;
    marks_ = 0;
    for (const Scan& scan : scans) marks_ += scan.labels.size();
  }
  kept_ = seen_++ % stride == 0;
  if (kept_) scans.push_back({seconds, centre});
}

void Marks::add(const Vector3d& point_W, double value, std::uint8_t label) {
  if (!kept_) return;
  Scan& scan = scans.back();
  for (const double d : Vector3d(point_W - scan.centre)) scan.values.push_back(rounded(100.0 * d));
  scan.values.push_back(rounded(1000.0 * value));
  scan.labels.push_back(label);
  ++marks_;
}

std::vector<std::string> write_page(const Page& page, const std::filesystem::path& path) {
  const std::string root = "/usr/share/javascript/";
  const std::string dygraphs =
      library({root + "dygraphs/dygraph.min.js", root + "dygraphs/dygraph-combined.js"});
  const std::string dygraphs_css = library({root + "dygraphs/dygraph.min.css"});
  std::string three = library({root + "three/three.min.js", root + "three/three.js"});
  if (!three.empty()) three += library({root + "three/examples/js/controls/OrbitControls.js"});
  std::vector<std::string> notes;
  if (dygraphs.empty()) {
    notes.emplace_back("without plots over time: the package libjs-dygraphs is not installed");
  }
  if (three.empty()) {
    notes.emplace_back("without paths and points in 3-D: the package libjs-three is not installed");
  }
  io::TextFile file(path);
  file.write("<!DOCTYPE html>\n<html lang='en'>\n<head>\n<meta charset='utf-8'>\n<title>" +
             escaped(page.title) +
             "</title>\n<meta name='viewport' content='width=device-width, initial-scale=1'>\n");
  file.write("<style>" + inlined(dygraphs_css, "style") + kPageStyle +
             "</style>\n</head>\n<body>\n<noscript>Paths and plots need JavaScript.</noscript>\n");
  file.write(fmt::format("<header><h1>{}</h1><p>{}</p></header>\n<main>\n", escaped(page.title),
                         escaped(page.subtitle)));
  for (const std::string& note : notes) {
    file.write("<p class='missing'>This page is " + escaped(note) + ".</p>\n");
  }
  file.write("<section id='summary'>" + card_html(page) + "</section>\n");
  file.write(kPageBody);
  file.write("<script>" + inlined(dygraphs, "script") + "</script>\n");
  file.write("<script>" + inlined(three, "script") + "</script>\n");
  file.write(
      "<script type='application/json' id='data'>" +
      inlined(page_json(page).dump(-1, ' ', false, Json::error_handler_t::replace), "script") +
      "</script>\n<script>" + inlined(kPageScript, "script") + "</script>\n</body>\n</html>\n");
  file.close();
  return notes;
}

}  // namespace rio::view
