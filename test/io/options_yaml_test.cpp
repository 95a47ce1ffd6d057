// SPDX-License-Identifier: BSD-3-Clause
// Option files, and with them the option table, its ranges and the presets.
#include "rio/io/options_yaml.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "io/field_values.hpp"
#include "rio/io/flown_options.hpp"
#include "rio/option_fields.hpp"
#include "support/temp_dir.hpp"

namespace rio::io {
namespace {

using test::TempDir;

Options parsed(const std::string& yaml) {
  Options options;
  parse_options(yaml, "o.yaml", &options);
  return options;
}

// What a user has to know stays short; the rest belongs to the presets.
TEST(OptionsYaml, TheUsersLayerIsShort) {
  int user = 0;
  int all = 0;
  const Options options;
  visit_fields(options, [&](const FieldInfo& info, const auto&) {
    user += info.layer == Layer::kUser ? 1 : 0;
    ++all;
  });
  EXPECT_LE(user, 40);
  EXPECT_LE(all, 60);
}

TEST(OptionsYaml, WhatThePresetsOwnIsNoFileOption) {
  EXPECT_ERROR(parsed("preset: default\nfrontend: {matching: euclidean}\n"),
               "o.yaml:2: frontend.matching belongs to the preset, it is no option of a file");
  Options options;
  EXPECT_ERROR(apply_settings({"update.gate_probability=1"}, &options),
               "update.gate_probability belongs to the preset");
}

TEST(OptionsYaml, KeysOfEarlierVersionsNameWhatReplacesThem) {
  EXPECT_ERROR(parsed("update:\n  direction_noise: true\n"),
               "o.yaml:2: update.direction_noise is part of update.doppler_directions");
  EXPECT_ERROR(parsed("calibration: {elevation_bias_sigma: 0.1}\n"),
               "o.yaml:1: calibration.elevation_bias_sigma is gone: calibration.rotation_sigma");
  Options options;
  EXPECT_ERROR(apply_settings({"frontend.velocity_recovery=false"}, &options),
               "frontend.velocity_recovery is Options::checks of the library");
}

TEST(OptionsYaml, EveryFieldRoundTripsAlone) {
  expect_each_field_round_trips<Options>(50, [](const Options& options) {
    std::string why;
    EXPECT_TRUE(options.validate(&why)) << why;
    return parsed(options_as_yaml(options));
  });
}

TEST(OptionsYaml, PresetsAreValidAndRoundTrip) {
  for (const char* name : kPresets) {
    Options expected;
    ASSERT_TRUE(preset(name, &expected)) << name;
    EXPECT_TRUE(expected.validate()) << name;
    const std::string all = options_as_yaml(expected);
    EXPECT_EQ(values(parsed(all)), values(expected)) << name;
    EXPECT_EQ(preset_in_texts({all}, "o.yaml").value_or("default"), name);  // with what it hides
    const std::string text = option_file(name);
    EXPECT_EQ(values(parsed(text)), values(expected)) << name;
    Options other = expected;  // what a recording says of its sensors
    other.radar.sigma_range = 0.123;
    other.radar.T_BS.translation = {1, 2, 3};
    parse_option_values({text}, "my.yaml", &other);
    EXPECT_EQ(other.radar.sigma_range, 0.123) << name;
    EXPECT_EQ(other.radar.T_BS.translation, Vector3d(1, 2, 3)) << name;
  }
}

TEST(OptionsYaml, AFileToStartFromLeavesSensorsAndAlgorithm) {
  const std::string text = option_file("default");
  for (const char* part :
       {"\npreset: default\n", "\n  # gyro_noise_density: 0.0004  # [rad/s/sqrt(Hz)] White",
        "\n    # translation: [0, 0, 0]  # [m] ", "\n  min_range: 0.2  # [m] Nearer",
        "\n  # ransac_threshold: 0.15  # [m/s] The Doppler",
        "\n  # max_landmarks: 40  # Persistent", "\n# backend: ekf"}) {
    EXPECT_PRED2(test::contains, text, part);
  }
  for (const char* name : kPresets) {  // nothing that presets differ in
    Options options;
    ASSERT_TRUE(preset(name, &options));
    const auto before = values(options);
    parse_option_values({text}, "my.yaml", &options);
    EXPECT_EQ(values(options), before) << name;
  }
}

TEST(OptionsYaml, PrintsUnitAndMeaning) {
  const std::string text = options_as_yaml(Options{});
  for (const char* part :
       {"\nimu:\n  gyro_noise_density: 0.0004  # [rad/s/sqrt(Hz)] White noise of the gyroscope.\n",
        "\nradar:\n  T_BS:\n    translation: [0, 0, 0]  # [m] ",
        "\n  min_range: 0.2  # [m] Nearer detections",
        "\n  use_trails: false  # Use distances to trails.\n"}) {
    EXPECT_PRED2(test::contains, text, part);
  }
}

TEST(OptionsYaml, ReadsValuesWithUnits) {
  const Options o = parsed(
      "imu: {gyro_noise_density: 4e-3, max_gap: 30 ms}\n"
      "radar:\n"
      "  sigma_azimuth: 2 deg\n"
      "  sigma_range: \"5 cm\"\n"
      "  T_BS:\n"
      "    translation: [10 cm, 0, -0.02]\n"
      "    quaternion_wxyz: [0, 0, 0.6, 0.8]\n"
      "frontend:\n"  // a section whose values are all commented out
      "update: {use_trails: false, max_clones: 3}\n"
      "start: {max_rate: 10 deg/s}\n");
  EXPECT_EQ(o.imu.gyro_noise_density, 4e-3);
  EXPECT_EQ(o.imu.max_gap, 0.03);
  EXPECT_NEAR(o.radar.sigma_azimuth, 0.034906585039886591, 1e-16);
  EXPECT_EQ(o.radar.sigma_range, 0.05);
  EXPECT_EQ(o.radar.T_BS.translation, Vector3d(0.1, 0.0, -0.02));
  EXPECT_EQ(o.radar.T_BS.rotation.z(), 0.8);
  EXPECT_FALSE(o.update.use_trails);
  EXPECT_EQ(o.update.max_clones, 3);
  EXPECT_NEAR(o.start.max_rate, 0.17453292519943295, 1e-16);
  EXPECT_EQ(o.imu.gravity, Options{}.imu.gravity);
}

TEST(OptionsYaml, UnknownKeysAreRejectedWithSuggestion) {
  EXPECT_ERROR(parsed("radar:\n  sigma_dopler: 1\n"),
               "o.yaml:2: unknown key \"radar.sigma_dopler\", did you mean "
               "\"radar.sigma_doppler\"?");
  EXPECT_ERROR(parsed("imu: {sigma_doppler: 1}\n"), "did you mean \"radar.sigma_doppler\"?");
  EXPECT_ERROR(parsed("radr: {sigma_doppler: 1}\n"),
               "unknown key \"radr\", did you mean \"radar\"?");
  EXPECT_ERROR(parsed("max_clones: 3\n"), "did you mean \"update.max_clones\"?");
  EXPECT_ERROR(parsed("presett: default\n"), "did you mean \"preset\"?");
  EXPECT_ERROR(parsed("preset: default\nimu: &x [*x]\n"), "o.yaml:2: an anchor that contains");
  EXPECT_ERROR(parsed("a: &x\n  b: {c: *x}\n"), "o.yaml:2: an anchor that contains");
  EXPECT_ERROR(parsed("timing: {clock: 1}\n"), "o.yaml:1: unknown key \"timing.clock\"");
  const std::string far = test::error_of([] { parsed("colour: red\n"); });
  EXPECT_EQ(far, "o.yaml:1: unknown key \"colour\"");
}

TEST(OptionsYaml, WrongValuesNameFileAndLine) {
  EXPECT_ERROR(parsed("imu:\n  max_gap: 2 deg\n"),
               "o.yaml:2: imu.max_gap: \"2 deg\" does not fit the unit [s]");
  EXPECT_ERROR(parsed("imu: {max_gap: fast}\n"), "o.yaml:1: imu.max_gap: not a number");
  EXPECT_ERROR(parsed("imu: {max_gap: [1, 2]}\n"), "imu.max_gap: a single number is expected");
  EXPECT_ERROR(parsed("imu: {max_gap: }\n"), "imu.max_gap: a single number is expected");
  EXPECT_ERROR(parsed("imu: {max_gap: 11}\n"), "imu.max_gap = 11 is outside [0.001, 10] s");
  EXPECT_ERROR(parsed("imu: {max_gap: nan}\n"), "imu.max_gap = nan is outside");
  EXPECT_ERROR(parsed("imu: 3\n"), "o.yaml:1: imu: a map is expected");
  EXPECT_ERROR(parsed("update: {max_clones: 3.5}\n"), "max_clones: a whole number is expected");
  EXPECT_ERROR(parsed("update: {max_clones: [3]}\n"), "max_clones: a whole number is expected");
  EXPECT_ERROR(parsed("update: {max_clones: 21}\n"), "update.max_clones = 21 is outside [0, 20]");
  EXPECT_ERROR(parsed("update: {use_trails: 1}\n"), "use_trails: true or false is expected");
  EXPECT_ERROR(parsed("smoother: {kernel: white}\n"), "none or huber or cauchy or dcs is expected");
  EXPECT_ERROR(parsed("radar: {T_BS: {translation: [1, 2]}}\n"), "a list of 3 numbers");
  EXPECT_ERROR(parsed("radar: {T_BS: {translation: [1, 2, 3 s]}}\n"), "does not fit the unit [m]");
  EXPECT_ERROR(parsed("radar: {T_BS: {quaternion_wxyz: [1, 1, 0, 0]}}\n"), "not a unit quaternion");
  EXPECT_ERROR(parsed("imu:\n  max_gap: 1\n  max_gap: 2\n"), "o.yaml:3: duplicate key \"max_gap\"");
  EXPECT_ERROR(parsed("imu:\n  max_gap: [1\n"), "o.yaml:");
  EXPECT_ERROR(parsed("- 1\n"), "o.yaml:1: not a map of keys");
  EXPECT_ERROR(parsed("imu: {}\n---\nimu: {}\n"), "more than one document");
  EXPECT_ERROR(parsed(",\n"), "more than one document, or a comma");  // the parser stays there
}

TEST(OptionsYaml, ErrorsChangeNothing) {
  Options options;
  options.imu.gravity = 9.8;
  const Values before = values(options);
  EXPECT_ERROR(parse_options("preset: published-ekf\nimu: {max_gap: 0.2, gravity: -1}\n", "o.yaml",
                             &options),
               "imu.gravity");
  EXPECT_EQ(values(options), before);
  EXPECT_ERROR(parse_options("radar: {min_range: 60}\n", "o.yaml", &options),
               "o.yaml: radar.min_range is not below radar.max_range");
  EXPECT_EQ(values(options), before);
}

TEST(OptionsYaml, PresetComesFirstWhereverItStands) {
  Options options;
  options.imu.gravity = 9.8;
  parse_options("update: {use_trails: false}\npreset: published-ekf\n", "o.yaml", &options);
  EXPECT_FALSE(options.update.use_trails);
  EXPECT_FALSE(options.update.consistent_covariance);
  EXPECT_EQ(options.imu.gravity, Options{}.imu.gravity);
  EXPECT_ERROR(parsed("imu: {}\npreset: none\n"), "o.yaml:2: preset: no such preset: \"none\"");
}

TEST(OptionsYaml, FilesWithAndWithoutPreset) {
  const std::string with = "preset: published-ekf\nimu: {max_gap: 0.2}\n";
  const std::string comments = "# nothing yet\n";
  EXPECT_EQ(preset_in_texts({with}, "o.yaml"), "published-ekf");
  EXPECT_EQ(preset_in_texts({comments}, "o.yaml"), std::nullopt);
  Options options;
  parse_option_values({with}, "o.yaml", &options);
  EXPECT_EQ(options.update.doppler_directions, DopplerDirections::kCorrected);
  EXPECT_EQ(options.imu.max_gap, 0.2);
  parse_options(with, "o.yaml", &options);
  EXPECT_EQ(options.update.doppler_directions, DopplerDirections::kExact);
  const Values before = values(options);
  parse_options(comments, "o.yaml", &options);
  EXPECT_EQ(values(options), before);
  // in a setting it wins over files and arguments
  EstimatorArguments arguments;
  arguments.preset = "doppler-only";
  arguments.texts = {with};
  arguments.set = {"preset=published-ekf", "imu.max_gap=0.3"};
  std::vector<std::string> notes;
  EXPECT_EQ(preset_of(flown_options(arguments, {}, {}, &notes)), "published-ekf");
  arguments.set = {"preset=nix"};
  EXPECT_ERROR(flown_options(arguments, {}, {}, &notes), "no such preset: \"nix\"");
  const TempDir dir;
  const auto flown = [&notes](const std::string& file) {
    (void)flown_options({{file}}, {}, {}, &notes);
  };
  EXPECT_ERROR(flown(dir.path() / "none.yaml"), "none.yaml: no such file");
  EXPECT_ERROR(flown(dir.write("empty.yaml", "")), "empty.yaml: is empty");
}

/// The nearest values that are not allowed.
std::vector<double> outside(const FieldInfo& info, double) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  return {std::nextafter(info.min, -kInfinity), std::nextafter(info.max, kInfinity), std::nan("")};
}
std::vector<int> outside(const FieldInfo& info, int) {
  const int below = static_cast<int>(info.min) - 1;
  if (info.max > 2147483646.0) return {below};  // an int cannot exceed it
  return {below, static_cast<int>(info.max) + 1};
}

TEST(Options, ValidateHoldsEveryNumberAgainstItsRange) {
  Options options;
  int checked = 0;
  const auto check = [&](const FieldInfo& info, auto& value) {
    using Field = std::decay_t<decltype(value)>;
    if constexpr (std::is_same_v<Field, double> || std::is_same_v<Field, int>) {
      ++checked;
      EXPECT_EQ(field_error(info, static_cast<Field>(info.min)), "");
      EXPECT_EQ(field_error(info, static_cast<Field>(info.max)), "");
      const Field kept = value;
      for (const Field wrong : outside(info, kept)) {
        value = wrong;
        std::string why;
        EXPECT_FALSE(options.validate(&why));
        EXPECT_TRUE(why.starts_with(std::string(info.key) + " = ")) << info.key << ": " << why;
      }
      value = kept;
    }
  };
  visit_fields(options, check);
  visit_library_fields(options, check);
  EXPECT_GT(checked, 40);
}

TEST(Options, ValidateChecksOtherTypesAndCoherence) {
  const struct {
    void (*change)(Options& o);
    const char* said;
  } cases[] = {
      {[](Options& o) { o.radar.T_BS.translation.z() = 101.0; },
       "radar.T_BS.translation = 101 is outside [-100, 100] m"},
      {[](Options& o) { o.radar.T_BS.rotation.x() = 0.01; },
       "radar.T_BS.quaternion_wxyz is not a unit quaternion"},
      {[](Options& o) { o.radar.T_BS.rotation.w() = std::nan(""); },
       "radar.T_BS.quaternion_wxyz is not a unit quaternion"},
      {[](Options& o) { o.update.doppler_directions = static_cast<DopplerDirections>(4); },
       "update.doppler_directions = 4 is outside [0, 2]"},
      {[](Options& o) { o.radar.min_range = o.radar.max_range; },
       "radar.min_range is not below radar.max_range"},
      {[](Options& o) { o.frontend.max_detections = 4; },
       "frontend.max_detections = 4 is outside [5, 1024]"},
      {[](Options& o) { o.update.max_clones = 0; }, "update.max_clones = 0"},
      {[](Options& o) { o.update.max_landmarks = 0; }, "update.max_landmarks = 0"},
  };
  for (const auto& [change, said] : cases) {
    Options o;
    change(o);
    std::string why;
    EXPECT_FALSE(o.validate(&why));
    EXPECT_TRUE(why.starts_with(said)) << why;
  }
  Options o;
  o.update.max_clones = o.update.max_landmarks = 0;
  o.update.use_trails = o.update.use_landmarks = false;
  EXPECT_TRUE(o.validate());
}

TEST(Options, UnknownPresetChangesNothing) {
  Options o;
  o.imu.gravity = 9.8;
  EXPECT_FALSE(preset("none", &o));
  EXPECT_EQ(o.imu.gravity, 9.8);
}

}  // namespace
}  // namespace rio::io
