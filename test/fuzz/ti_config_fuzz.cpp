// SPDX-License-Identifier: BSD-3-Clause
// Configurations of TI's radars: figures that make sense, or why there are none; findings in the
// order of the file; options that can be read.
#include <cmath>
#include <string>

#include "fuzz/fuzz.hpp"
#include "rio/io/options_yaml.hpp"
#include "rio/ti/config.hpp"

namespace {

void check_figures(const rio::ti::Config& config) {
  rio::ti::ConfigFigures figures;
  std::string why;
  if (!rio::ti::derive(config, &figures, &why)) {
    RIO_FUZZ_CHECK(!why.empty());
    return;
  }
  for (const double value : {figures.max_speed, figures.speed_grid, figures.range_resolution,
                             figures.range_grid, figures.max_range, figures.baud}) {
    RIO_FUZZ_CHECK(std::isfinite(value) && value > 0.0);
  }
  RIO_FUZZ_CHECK(figures.period > rio::Time{0} && figures.chirp_block > rio::Time{0});
  RIO_FUZZ_CHECK(figures.packet_bytes(40) >= figures.packet_bytes(0));
  rio::Options options;
  rio::fuzz::reads("FILE:", [&] {  // or a radar that no option describes
    rio::io::parse_options(rio::ti::as_options(figures), "FILE", &options);
  });
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text = rio::fuzz::text_of(data, size);
  const rio::ti::Config config = rio::ti::parse_config(text);
  check_figures(config);
  int line = 0;
  for (const rio::ti::LintFinding& finding : rio::ti::lint(config)) {
    RIO_FUZZ_CHECK(!finding.text.empty());
    RIO_FUZZ_CHECK(finding.line == 0 || finding.line >= line);
    line = finding.line == 0 ? line : finding.line;
  }
  return 0;
}
