// SPDX-License-Identifier: BSD-3-Clause
// Scenario files: a scenario that reads back the same, or a std::runtime_error that names the file.
#include <string>

#include "fuzz/fuzz.hpp"
#include "rio/io/simulation.hpp"
#include "support/temp_dir.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const rio::test::TempDir dir;
  const std::string text = rio::fuzz::text_of(data, size);
  const std::string file = dir.write("scenario.yaml", text);
  rio::sim::Scenario scenario;
  const auto load = [&] { scenario = rio::io::load_scenario(file); };
  if (!rio::fuzz::reads(file + ":", load)) return 0;
  scenario.path.file.clear();  // is taken from the folder of the file
  const std::string written = rio::io::scenario_as_yaml(scenario);
  const std::string again = dir.write("again.yaml", written);
  RIO_FUZZ_CHECK(rio::io::scenario_as_yaml(rio::io::load_scenario(again)) == written);
  return 0;
}
