// SPDX-License-Identifier: BSD-3-Clause
// `rio ti-config`: figures of a TI radar with its configuration, and errors of that.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "commands.hpp"
#include "json_line.hpp"
#include "live_ports.hpp"
#include "rio/ti/config.hpp"

namespace rio::tools {

namespace {

using ti::ConfigFigures;
using ti::LintFinding;

double milliseconds(Time t) {
  return 1e3 * to_seconds(t);
}

void print(const ConfigFigures& f, std::size_t points) {
  fmt::print("speed      +-{:.3f} m/s unambiguous, grid {:.4f} m/s ({} loops of {} chirps)\n",
             f.max_speed, f.speed_grid, f.loops, f.chirps);
  fmt::print("range      to {:.1f} m, resolution {:.4f} m, grid {:.4f} m\n", f.max_range,
             f.range_resolution, f.range_grid);
  fmt::print("frames     {:.2f} Hz, chirps {:.2f} ms of {:.2f}\n", f.frame_rate(),
             milliseconds(f.chirp_block), milliseconds(f.period));
  fmt::print("antennas   {} transmitters, {} receivers; radar cube {} kB\n", f.transmitters,
             f.receivers, f.cube_bytes / 1024);
  fmt::print("packet     {} bytes with {} points, {:.1f} ms at {:.0f} baud; side info {}\n\n",
             f.packet_bytes(points), points, milliseconds(f.packet_time(points)), f.baud,
             f.side_info ? "on" : "off");
}

const char* verdict_of(const LintFinding& f) {
  if (f.kind == ti::LintKind::kOtherFirmware) return "not judged";
  return f.wrong ? "wrong" : "doubtful";
}

void print(const LintFinding& f) {
  if (f.kind == ti::LintKind::kOtherFirmware) return fmt::print("{}.\n", f.text);
  const std::string where = f.line > 0 ? fmt::format("line {}, ", f.line) : "";
  fmt::print("{:<9} {}{}: {}.\n", verdict_of(f), where, to_string(f.kind), f.text);
  if (!f.change.empty()) fmt::print("          -> {}\n", f.change);
}

void print_json(bool known, const ConfigFigures& f, std::size_t points,
                const std::vector<LintFinding>& findings) {
  nlohmann::json all;
  if (known) {
    all["figures"] = {{"max_speed_mps", f.max_speed},
                      {"speed_grid_mps", f.speed_grid},
                      {"range_resolution_m", f.range_resolution},
                      {"range_grid_m", f.range_grid},
                      {"max_range_m", f.max_range},
                      {"frame_rate_hz", f.frame_rate()},
                      {"chirp_block_s", to_seconds(f.chirp_block)},
                      {"transmitters", f.transmitters},
                      {"receivers", f.receivers},
                      {"cube_bytes", f.cube_bytes},
                      {"side_info", f.side_info},
                      {"baud", f.baud},
                      {"packet_bytes", f.packet_bytes(points)},
                      {"packet_s", to_seconds(f.packet_time(points))}};
  }
  all["findings"] = nlohmann::json::array();
  for (const LintFinding& finding : findings) {
    all["findings"].push_back({{"verdict", verdict_of(finding)},
                               {"subject", to_string(finding.kind)},
                               {"line", finding.line},
                               {"text", finding.text},
                               {"change", finding.change}});
  }
  // replaces invalid UTF-8 of the file
  fmt::print("{}\n", json_line(all));
}

}  // namespace

void ti_config(const TiConfigArguments& arguments) {
  const ti::Config config = read_config(arguments.file);
  ti::RadarUse use;
  use.speed = arguments.speed;
  use.points = arguments.points;
  ConfigFigures figures;
  const bool known = ti::derive(config, &figures);
  const std::vector<LintFinding> findings = ti::lint(config, use);
  if (arguments.json) {
    print_json(known, figures, use.points, findings);
  } else {
    if (known) print(figures, use.points);
    for (const LintFinding& finding : findings) print(finding);
    if (findings.empty()) fmt::print("Nothing is wrong with it for {:g} m/s.\n", use.speed);
    if (known) fmt::print("\nThe options that follow (--config):\n\n{}", ti::as_options(figures));
  }
  if (ti::other_firmware(config) != nullptr) {
    throw WrongResult(arguments.file + ": not judged");
  }
  const auto wrong =
      std::count_if(findings.begin(), findings.end(), [](const LintFinding& f) { return f.wrong; });
  if (wrong > 0) throw WrongResult(fmt::format("{}: {} wrong", arguments.file, wrong));
}

}  // namespace rio::tools
