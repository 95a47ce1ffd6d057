// SPDX-License-Identifier: BSD-3-Clause
// Scenario files, and with them the table of the fields of a scenario and the catalogue.
#include "rio/io/simulation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "io/field_values.hpp"
#include "rio/sim/catalogue.hpp"
#include "rio/sim/scenario_fields.hpp"
#include "support/temp_dir.hpp"

namespace rio::io {
namespace {

using test::TempDir;

/// Through a file.
sim::Scenario parsed(const std::string& yaml) {
  const TempDir dir;
  return load_scenario(dir.write("s.yaml", yaml));
}

TEST(ScenarioYaml, EveryScenarioOfTheCatalogueIsValidAndRoundTrips) {
  for (const sim::CatalogueEntry& entry : sim::catalogue()) {
    const sim::Scenario scenario = load_scenario(entry.name);
    EXPECT_EQ(values(parsed(scenario_as_yaml(scenario))), values(scenario)) << entry.name;
    EXPECT_EQ(values(parsed(std::string("scenario: ") + entry.name + "\n")), values(scenario));
  }
}

TEST(ScenarioYaml, EveryFieldRoundTripsAlone) {
  expect_each_field_round_trips<sim::Scenario>(
      80, [](const sim::Scenario& scenario) { return parsed(scenario_as_yaml(scenario)); });
}

/// Bytes of the struct that belong to no row of the table are padding, which never fills eight in a
/// row; only `start` is left out.
TEST(ScenarioFields, NoneIsMissing) {
  const sim::Scenario scenario;
  const auto* base = reinterpret_cast<const char*>(&scenario);
  std::vector<bool> covered(sizeof scenario, false);
  const auto cover = [&](const auto& value) {
    const auto at = reinterpret_cast<const char*>(&value) - base;
    ASSERT_GE(at, 0);
    ASSERT_LE(static_cast<std::size_t>(at) + sizeof value, covered.size());
    std::fill_n(covered.begin() + at, sizeof value, true);
  };
  sim::visit_fields(scenario, [&](const FieldInfo&, const auto& value) { cover(value); });
  cover(scenario.start);
  std::size_t missing = 0;
  for (std::size_t i = 0; i < covered.size(); ++i) {
    missing = covered[i] ? 0 : missing + 1;
    EXPECT_LT(missing, 8U) << "bytes without a field end at " << i;
  }
}

TEST(ScenarioFields, DefaultsAndBoundsAreInRange) {
  const sim::Scenario defaults;
  sim::visit_fields(defaults, [](const FieldInfo& info, const auto& value) {
    using Field = std::decay_t<decltype(value)>;
    EXPECT_EQ(field_error(info, value), "") << info.key;
    EXPECT_GT(std::string(info.doc).size(), 5U) << info.key;
    if constexpr (std::is_same_v<Field, double> || std::is_same_v<Field, int>) {
      EXPECT_NE(field_error(info, info.min - 1e-9), "") << info.key;
      EXPECT_NE(field_error(info, std::nan("")), "") << info.key;
    }
  });
}

TEST(ScenarioYaml, PrintsUnitAndMeaning) {
  const std::string text = scenario_as_yaml(sim::Scenario{});
  for (const char* part :
       {"\nseed: 1  # Varies", "\nmax_duration: inf  # [s] ", "\npath:\n  file: \"\"  # Recorded",
        "\n  length: 150  # [m] Length", "\nradar:\n  T_BS:\n    translation: [0.1, 0, -0.05]",
        "\ndisturbances:\n  bursts:\n    count: 0  # Spells", "\n  outages:\n    count: 0",
        "\n  start_velocity: [0, 0, 0]  # [m/s] "}) {
    EXPECT_PRED2(test::contains, text, part);
  }
}

TEST(ScenarioYaml, ReadsValuesWithUnitsOnTopOfTheBase) {
  const sim::Scenario s = parsed(
      "disturbances: {bursts: {duration: 500 ms}}\n"
      "seed: 18446744073709551615\n"
      "max_duration: 1 min\n"
      "path: {max_yaw: 90 deg, low: [-1, -50 cm, 0.5]}\n"
      "radar: {people: 3, specular: false, outlier_share: 25 %}\n"
      "room:\n"  // a section whose values are all commented out
      "scenario: storm\n");
  EXPECT_EQ(s.disturbances.bursts.count, 3);
  EXPECT_EQ(s.disturbances.bursts.duration, 0.5);
  EXPECT_EQ(s.seed, std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(s.max_duration, 60.0);
  EXPECT_NEAR(s.path.max_yaw, 1.5707963267948966, 1e-15);
  EXPECT_EQ(s.path.low, Vector3d(-1.0, -0.5, 0.5));
  EXPECT_EQ(s.radar.people, 3);
  EXPECT_FALSE(s.radar.specular);
  EXPECT_EQ(s.radar.outlier_share, 0.25);
  EXPECT_EQ(s.path.length, sim::Scenario{}.path.length);
  EXPECT_EQ(parsed("scenario: storm\nmax_duration: inf\n").max_duration,
            std::numeric_limits<double>::infinity());
}

TEST(ScenarioYaml, ExampleInDataIsValid) {
  const std::filesystem::path root = RIO_SOURCE_DIR;
  const sim::Scenario s = load_scenario(root / "data/config/scenario_corridor.yaml");
  EXPECT_EQ(s.room.high_W, Vector3d(34.0, 1.2, 2.4));
  EXPECT_EQ(s.path.max_leg, 20.0);
}

TEST(ScenarioYaml, UnknownNamesAndKeysAreRejectedWithSuggestion) {
  EXPECT_ERROR(load_scenario("indor-3"), "no such file: \"indor-3\", did you mean \"indoor-3\"?");
  EXPECT_ERROR(load_scenario("nowhere.yaml"), "scenarios: indoor-1, indoor-2");
  EXPECT_ERROR(parsed("seed: 2\nscenario: strom\n"),
               "s.yaml:2: scenario: no such scenario: \"strom\", did you mean \"storm\"?");
  EXPECT_ERROR(parsed("scenario: [storm]\n"), "s.yaml:1: scenario: no such scenario");
  EXPECT_ERROR(parsed("radar:\n  poeple: 2\n"),
               "s.yaml:2: unknown key \"radar.poeple\", did you mean \"radar.people\"?");
  EXPECT_ERROR(parsed("senario: storm\n"), "did you mean \"scenario\"?");
  EXPECT_ERROR(parsed("preset: default\n"), "s.yaml:1: unknown key \"preset\"");
  EXPECT_ERROR(parsed("start: 0\n"), "s.yaml:1: unknown key \"start\"");
}

/// What options have as well is in options_yaml_test.cpp.
TEST(ScenarioYaml, WrongValuesNameFileAndLine) {
  EXPECT_ERROR(parsed("path: {file: [a]}\n"), "s.yaml:1: path.file: a text is expected");
  EXPECT_ERROR(parsed("path: {reach: [1, 1, 0]}\n"), "path.reach = 0 is outside");
  EXPECT_ERROR(parsed("seed: -1\n"), "s.yaml:1: seed: a whole number is expected");
  EXPECT_ERROR(parsed("seed: 18446744073709551616\n"), "seed: a whole number is expected");
  EXPECT_ERROR(parsed("max_duration: 0\n"), "max_duration = 0 is outside [1, inf] s");
  EXPECT_ERROR(parsed("disturbances: {bursts: 3}\n"), "disturbances.bursts: a map is expected");
}

TEST(ScenarioYaml, IncoherentValuesNameTheFile) {
  EXPECT_ERROR(parsed("path: {min_speed: 2}\n"), "s.yaml: path.min_speed exceeds path.max_speed");
  EXPECT_ERROR(parsed("path: {max_leg: 1}\n"), "s.yaml: path.min_leg exceeds path.max_leg");
  EXPECT_ERROR(parsed("path: {low: [4, 0, 0]}\n"), "s.yaml: path.low is above path.high");
  EXPECT_ERROR(parsed("path: {low: [0, 0, 1], high: [0.05, 0, 1]}\n"), "is below 0.1 m");
  EXPECT_ERROR(parsed("radar: {min_range: 20}\n"), "s.yaml: radar.min_range is not below");
}

TEST(ScenarioYaml, RelativePathsAreTakenFromTheFolderOfTheFile) {
  const TempDir dir;
  const auto load = [&dir](const std::string& file) {
    return load_scenario(dir.write("sub/s.yaml", "path: {file: " + file + "}\n")).path.file;
  };
  EXPECT_EQ(load("walk.tum"), (dir.path() / "sub/walk.tum").string());
  EXPECT_EQ(load("../walk.tum"), (dir.path() / "walk.tum").string());
  EXPECT_EQ(load("/walk.tum"), "/walk.tum");
  EXPECT_EQ(load("\"\""), "");
}

TEST(FlyScenario, SaysWhatCannotBeFlown) {
  sim::Scenario scenario;
  scenario.path.file = "/nowhere/walk.tum";
  EXPECT_ERROR(fly_scenario(scenario), "/nowhere/walk.tum");
  const TempDir dir;
  scenario.path.file = dir.write("short.tum",
                                 "0.0 0 0 1 0 0 0 1\n0.1 0 0 1 0 0 0 1\n0.2 0 0 1 0 0 0 1\n"
                                 "0.3 0 0 1 0 0 0 1\n0.4 0 0 1 0 0 0 1\n")
                           .string();
  EXPECT_ERROR(fly_scenario(scenario), "short.tum: recorded path: 5 poses");
  scenario = sim::Scenario{};
  scenario.path.length = 25.0;
  scenario.disturbances.outages = {1, 600.0};
  EXPECT_ERROR(fly_scenario(scenario), "silence a sensor for the whole flight");
}

}  // namespace
}  // namespace rio::io
