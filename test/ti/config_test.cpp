// SPDX-License-Identifier: BSD-3-Clause
// Mistakes planted one by one into the configuration of the project, which has none.
#include <gtest/gtest.h>

#include <algorithm>

#include "rio/ti/config.hpp"
#include "support/measured.hpp"
#include "support/temp_dir.hpp"
#include "ti/config_text.hpp"

namespace rio::ti::test {
namespace {

using rio::test::contains;

std::string all(const std::vector<LintFinding>& findings) {
  std::string text;
  for (const LintFinding& f : findings) {
    text += std::string(to_string(f.kind)) + ", line " + std::to_string(f.line) + ": " + f.text +
            " -> " + f.change + "\n";
  }
  return text;
}

std::vector<LintFinding> lint_text(const std::string& text, const RadarUse& use = {}) {
  return lint(parse_config(text), use);
}

/// The one finding there must be.
LintFinding only_finding(const std::string& text, const RadarUse& use = {}) {
  const std::vector<LintFinding> findings = lint_text(text, use);
  EXPECT_EQ(findings.size(), 1U) << all(findings);
  return findings.empty() ? LintFinding{} : findings.front();
}

void expect_no_finding(const std::string& text, const RadarUse& use = {}) {
  EXPECT_EQ(all(lint_text(text, use)), "");
}

TEST(TiConfig, TheCommittedOneHasNoMistake) {
  for (const std::size_t points : {60U, 100U}) expect_no_finding(committed(), {.points = points});
}

TEST(TiConfig, EveryPlantedMistakeIsFound) {
  const struct {
    const char* what;
    const char* by;
    LintKind kind;
    const char* advice;  ///< a part of the text or the change
  } mistakes[] = {
      {"clutterRemoval -1 0", "clutterRemoval -1 1", LintKind::kClutterRemoval,
       "clutterRemoval -1 0"},
      {"guiMonitor -1 1 0", "guiMonitor -1 2 0", LintKind::kNoSideInfo,
       "guiMonitor -1 1 0 0 0 0 0"},
      {"guiMonitor -1 1 0", "guiMonitor -1 0 0", LintKind::kNoPoints, "guiMonitor -1 1 0 0 0 0 0"},
      {"guiMonitor -1 1 0 0 0 0 0", "", LintKind::kMissingCommand, "guiMonitor is missing"},
      {"profileCfg 0 77 10", "profileCfg 0 77 100", LintKind::kTooSlow, "193 us instead of 450"},
      {"cfarCfg -1 0 2 8 4 3 0 10 1", "cfarCfg -1 0 2 8 4 3 0 20 1", LintKind::kCfarTooHigh,
       "cfarCfg -1 0 2 8 4 3 0 10 1"},
      {"cfarCfg -1 1 0 8 4 4 1 10 1", "", LintKind::kMissingCommand, "no cfarCfg for Doppler"},
      {"guiMonitor -1 1 0 0 0 0 0", "guiMonitor -1 1 0 0 0 1 0", LintKind::kUartTooSlow,
       "at 921600 baud"},
      {"frameCfg 0 2 128 0 50 1 0", "frameCfg 0 2 128 0 20 1 0", LintKind::kFrameTooShort,
       "take 23.04 ms of a period of 20 ms"},
      {"frameCfg 0 2 128 0 50 1 0", "frameCfg 0 2 128 0 200 1 0", LintKind::kFewScans,
       "frameCfg 0 2 128 0 100 1 0"},
      {"frameCfg 0 2 128", "frameCfg 0 3 128", LintKind::kInconsistent, "chirp 3"},
      {"chirpCfg 1 1 0", "chirpCfg 1 1 1", LintKind::kInconsistent, "chirpCfg 1 1 0 0 0 0 0 4"},
      {"channelCfg 15 7 0", "channelCfg 15 3 0", LintKind::kInconsistent, "switches on 3"},
      {"chirpCfg 0 0 0 0 0 0 0 1", "chirpCfg 0 0 0 0 0 0 0 7", LintKind::kInconsistent,
       "3 transmitters at once: without bpmCfg they must take turns"},
      {"bpmCfg -1 0 0 1", "bpmCfg -1 1 0 1", LintKind::kInconsistent, "bpmCfg -1 0 0 1"},
      {"dfeDataOutputMode 1", "dfeDataOutputMode 3", LintKind::kInconsistent,
       "dfeDataOutputMode 1"},
      {"profileCfg 0 77 10 7 50", "profileCfg 0 77 10 7 40", LintKind::kSamplesOutsideRamp,
       "profileCfg 0 77 10 7 48"},
      {"profileCfg 0 77 10 7 50 0 0 23.4", "profileCfg 0 77 10 7 50 0 0 90",
       LintKind::kBandExceeded, "0 0 80 1"},
      {"frameCfg 0 2 128", "frameCfg 0 2 255", LintKind::kTooMuchMemory, "the memory 1024 kB"},
      {"profileCfg 0 77", "profileCfg 0 60", LintKind::kTooMuchMemory, "the memory 768 kB"},
      {"lvdsStreamCfg -1 0 0 0", "lvdsStreamCfg -1 0 1 0", LintKind::kLvdsOn,
       "lvdsStreamCfg -1 0 0 0"},
      {"sensorStart", "sensorStart\nanalogMonitor 0 0", LintKind::kWrongOrder, "sensorStart"},
      {"flushCfg", "frameCfg 0 2 128 0 50 1 0\nflushCfg", LintKind::kWrongOrder,
       "flushCfg stands behind frameCfg"},
      {"bpmCfg", "bmpCfg", LintKind::kUnknownCommand, "take the line out"},
      {"bpmCfg", "bpmCfgs", LintKind::kUnknownCommand, "did you mean bpmCfg?"},
      {"bpmCfg", "//bpmCfg", LintKind::kUnknownCommand, "a comment begins with %"},
      {"lowPower 0 0", "lowPower 0", LintKind::kWrongArguments, "has 1 arguments and needs 2"},
      {"lowPower 0 0", "lowPower 0 O", LintKind::kWrongArguments, "is no number: O"},
      {"extendedMaxVelocity -1 0", "extendedMaxVelocity -1 1", LintKind::kExtendedVelocity,
       "extendedMaxVelocity -1 0"},
      {"aoaFovCfg -1 -70 70", "aoaFovCfg -1 -20 20", LintKind::kNarrowView, "40 x 90 deg"},
      {"cfarFovCfg -1 1 -5.36 5.36", "cfarFovCfg -1 1 -1 1", LintKind::kSpeedCut,
       "cfarFovCfg -1 1 -5.36 5.36"},
      {"cfarFovCfg -1 0 0.25 15", "cfarFovCfg -1 0 15 0.25", LintKind::kInconsistent,
       "cfarFovCfg -1 0 0.25 15"},
      {"aoaFovCfg -1 -70 70", "aoaFovCfg -1 70 -70", LintKind::kNarrowView, "only 0 x 90 deg"},
      {"adcCfg 2 1", "adcCfg 0 1", LintKind::kInconsistent, "takes samples of 16 bits"},
      {"adcCfg 2 1", "adcCfg 2 0", LintKind::kInconsistent, "takes complex samples"},
      {"adcbufCfg -1 0 1 1 1", "adcbufCfg -1 1 1 1 1", LintKind::kInconsistent,
       "adcbufCfg -1 0 1 1 1"},
      {"adcbufCfg -1 0 1 1 1", "adcbufCfg -1 0 1 0 1", LintKind::kInconsistent,
       "adcbufCfg -1 0 1 1 1"},
      {"frameCfg 0 2 128 0 50 1 0", "frameCfg 0 2 128 0 50 2 0", LintKind::kHardwareTrigger,
       "frameCfg 0 2 128 0 50 1 0"},
      {"frameCfg 0 2 128 0", "frameCfg 0 2 128 100", LintKind::kInconsistent,
       "stops after 100 frames"},
      {"frameCfg 0 2 128", "frameCfg 0 1 128", LintKind::kFlatElevation, "2 transmitters"},
      {"frameCfg 0 2 128", "frameCfg 0 2 16", LintKind::kCoarseSpeed, "more than 16 loops"},
      {"guiMonitor -1 1 0", "guiMonitor -1 1 0 0 0 0 0\nguiMonitor -1 0 0", LintKind::kNoPoints,
       "guiMonitor is given twice, the last counts"},
      {"sensorStart", "sensorStart 0", LintKind::kInconsistent, "refuses it behind a new one"},
      {"cfarFovCfg -1 1 -5.36 5.36", "", LintKind::kMissingCommand, "no cfarFovCfg for Doppler"},
      {"frameCfg 0 2 128 0 50 1 0", "frameCfg 0 2 128 0 50 1 0 % 20 Hz", LintKind::kWrongArguments,
       "a comment needs a line of its own"},
      {"profileCfg", "profileCfg 5 77 10 7 50 0 0 23.4 1 64 3200 0 0 30\nprofileCfg",
       LintKind::kInconsistent, "another profile than 0"},
      {"frameCfg 0 2 128 0 50 1 0", "frameCfg 0 2 abc 0 50 1 0", LintKind::kInconsistent,
       "argument 3 must be 1 to 255"},
      {"profileCfg 0", "profileCfg O", LintKind::kInconsistent, "profileCfg: argument 1 must be 0"},
  };
  int found = 0;
  for (const auto& [what, by, kind, advice] : mistakes) {
    const auto findings = lint_text(replaced(committed(), what, by));
    const auto is_it = [k = kind](const LintFinding& f) { return f.kind == k; };
    const bool is_found = std::any_of(findings.begin(), findings.end(), is_it);
    EXPECT_TRUE(is_found) << by << "\n" << all(findings);
    EXPECT_PRED2(contains, all(findings), advice);
    found += is_found ? 1 : 0;
  }
  rio::test::measured("planted mistakes found", found, "all of 48");
  EXPECT_EQ(found, 48);
}

/// Of the committed one with other lines: one finding, no figures; and the clutter removal.
TEST(TiConfig, OtherFirmwareIsNamedAndNotJudged) {
  const std::string base = committed();
  const std::string low_power =
      "sensorStop 0\nchannelCfg 7 3 0\nchirpComnCfg 20 0 0 128 4 30 0\nchirpTimingCfg 6 32 0 75 "
      "60\n"
      "frameCfg 2 0 1358 64 100 0\nguiMonitor 2 0 0 0 0 1 0 0 0 0 0\nclutterRemoval 0\n"
      "trackingCfg 1 2 100 3 61.4 191.8 100\nbaudRate 1250000\nsensorStart 0 0 0 0\n";
  const std::string old = "sensorStop\nflushCfg\nchannelCfg 15 7 0\nclutterRemoval 0\n";
  const std::pair<std::string, const char*> others[] = {
      {low_power, "xWRL6432"},
      {base + "ddmPhaseShiftAntOrder 0 2 3 1\n", "AWR2944"},
      {base + "compressionCfg -1 1 0 0.5 8\nlocalMaxCfg -1 3 40\n", "AWR2944"},
      {replaced(base, "channelCfg 15 7 0", "channelCfg 15 15 0"), "AWR2944"},
      {replaced(base, "frameCfg 0 2 128 0 50 1 0", "frameCfg 0 2 128 0 128 50 1 0"), "AWR2944"},
      {base + "trackingCfg 1 2 500 20 50 80 60\n", "people counting or tracking"},
      {base + "boundaryBox -3 3 0 7 0 2.5\nfovCfg -1 70 40\n", "people counting or tracking"},
      {old + "peakGrouping 1 0 1 1 225\n", "SDK 1 or 2"},
      {old + "cfarCfg 0 2 8 4 3 0 1200\n", "SDK 1 or 2"},
      {old + "cfarCfg -1 0 0 8 4 4 0 1500\nnearFieldCfg -1 0 0 0\n", "SDK 1 or 2"},
      {old + "adcbufCfg 0 0 1 1\n", "SDK 1 or 2"},
      {base + "antGeometryCfg 1 0 1 1 1 2\n", "AWR2944"},
      {low_power + "antGeometryCfg 1 0 1 1 1 2\n", "xWRL6432"},
      {old + "antGeometryCfg 1 0 1 1 1 2\noneCfg\ntwoCfg\n", "unknown demo"},
      {base + "chirpCfg 3 3 0 0 0 0 0 15\n", "AWR2944"},
      {base + "oneCfg 1\ntwoCfg 1\nthreeCfg 1\n", "unknown demo"},
  };
  for (const auto& [text, name] : others) {
    const LintFinding finding = only_finding(text);
    EXPECT_EQ(finding.kind, LintKind::kOtherFirmware);
    EXPECT_PRED2(contains, finding.text, name);
    EXPECT_PRED2(contains, finding.text, "not judged");
    EXPECT_EQ(finding.change, "");
    ConfigFigures figures;
    EXPECT_FALSE(derive(parse_config(text), &figures)) << name;
  }
  const std::vector<LintFinding> moving =
      lint_text(replaced(low_power, "clutterRemoval 0", "clutterRemoval 1"));
  ASSERT_EQ(moving.size(), 2U) << all(moving);
  EXPECT_EQ(moving[1].kind, LintKind::kClutterRemoval);
  EXPECT_EQ(moving[1].change, "clutterRemoval 0");
  for (const char* line : {"peakGrouping -1 1 1 1 1 200", "oneCfg 1\noneCfg 2\ntwoCfg 1",
                           "chanelCfg 1\nframCfg 1\nlowPowr 0", "//one\n//two\n;three\n; four"}) {
    EXPECT_EQ(other_firmware(parse_config(base + line)), nullptr) << line;
  }
}

TEST(TiConfig, ALineWithAWrongNumberOfArgumentsIsNotJudgedFurther) {
  const std::pair<const char*, const char*> lines[] = {
      {"clutterRemoval -1 0", "clutterRemoval 1"},
      {"guiMonitor -1 1 0 0 0 0 0", "guiMonitor 0 0 0 0 0 0"},
      {"aoaFovCfg -1 -70 70 -45 45", "aoaFovCfg -1 -1 1"},
      {"cfarCfg -1 0 2 8 4 3 0 10 1", "cfarCfg -1 0 2 8 4 3 0 99 1 1"},
      {"frameCfg 0 2 128 0 50 1 0", "frameCfg 0 2 255 5 20 2 0 0"},
      {"chirpCfg 1 1 0 0 0 0 0 4", "chirpCfg 1 1 0 0 0 0 0"},
      {"channelCfg 15 7 0", "channelCfg 15 7 0 0"},
      {"profileCfg 0 77 10 7 50", "profileCfg 0 77 10 7 40 1"},
  };
  for (const auto& [what, by] : lines) {
    EXPECT_EQ(only_finding(replaced(committed(), what, by)).kind, LintKind::kWrongArguments);
  }
}

TEST(TiConfig, ManyMissingCommandsAreOneFinding) {
  const std::string text = committed();
  EXPECT_PRED2(contains, only_finding(text.substr(0, text.find("lowPower"))).text,
               "commands without which the demo of SDK 3.x does not start are missing");
}

TEST(TiConfig, OfACommandGivenTwiceTheLastCounts) {
  const std::string text = replaced(committed(), "frameCfg", "frameCfg 0 2 64 0 100 1 0\nframeCfg");
  EXPECT_DOUBLE_EQ(figures_of(text).frame_rate(), 20.0);
  EXPECT_EQ(only_finding(text).text, "frameCfg is given twice, the last counts");
  expect_no_finding("sensorStop\n" + committed());
}

TEST(TiConfig, WhatIsNotUnderstoodIsOneFinding) {
  const std::string text = committed();
  std::string wide, old_mac = text;
  for (const char c : text) wide += {c, '\0'};
  std::replace(old_mac.begin(), old_mac.end(), '\n', '\r');
  const std::pair<std::string, const char*> inputs[] = {
      {"", "no configuration of a TI radar"},
      {"{\n \"a\": 1,\n \"b\": 2,\n \"c\": 3\n}\n", "no configuration of a TI radar"},
      {"\xFF\xFE" + wide, "UTF-16 or binary: save it as plain text"},
      {text + std::string("version 3.6\0", 12), "UTF-16 or binary: save it as plain text"},
      {text + std::string("guiMonitor\0", 11), "UTF-16 or binary: save it as plain text"},
      {replaced(text, "frameCfg 0 2 128 0 50 1 0",
                "guiMonitor 0 1 0 0 0 0 0\nadvFrameCfg 2 0 0 1 0"),
       "advanced frames (subframes) and continuous chirps are not understood"},
      {replaced(text, "dfeDataOutputMode 1", "dfeDataOutputMode 2"), "advanced frames"},
  };
  for (const auto& [input, said] : inputs) {
    std::string why;
    ConfigFigures figures;
    EXPECT_FALSE(derive(parse_config(input), &figures, &why));
    EXPECT_TRUE(why.starts_with(said)) << why;
    EXPECT_EQ(why, only_finding(input).text);
    EXPECT_EQ(other_firmware(parse_config(input)), nullptr);
  }
  expect_no_finding("\xEF\xBB\xBF" + text.substr(text.find("sensorStop")));
  expect_no_finding(old_mac);
}

TEST(TiConfig, TheAdviceHelps) {
  for (const auto& [what, by] : {std::pair{"profileCfg 0 77 10 7 50", "profileCfg 0 77 10 7 40"},
                                 std::pair{"frameCfg 0 2 128 0 50", "frameCfg 0 2 128 0 20"},
                                 std::pair{"clutterRemoval -1 0", "clutterRemoval -1 1"},
                                 std::pair{"cfarFovCfg -1 1 -5.36 5.36", "cfarFovCfg -1 1 -1 1"}}) {
    std::string text = replaced(committed(), what, by);
    const std::string change = only_finding(text).change;
    const std::size_t begin = text.find(std::string("\n") + by) + 1;
    text.replace(begin, text.find('\n', begin) - begin, change);
    expect_no_finding(text);
  }
}

TEST(TiConfig, TheVehicleDecides) {
  expect_no_finding(committed(), {.speed = 2.0});
  EXPECT_EQ(only_finding(committed(), {.speed = 8.0}).kind, LintKind::kTooSlow);
  const RadarUse crowded{.points = 200};
  EXPECT_EQ(only_finding(committed(), crowded).kind, LintKind::kUartTooSlow);
  EXPECT_FALSE(only_finding(committed(), crowded).wrong);
  expect_no_finding(replaced(committed(), "flushCfg", "flushCfg\nconfigDataPort 3125000 1"),
                    crowded);
}

TEST(TiConfig, LinesAsPeopleWriteThem) {
  const Config config = parse_config("\r\n% a comment\r\n\tframeCfg  0 2   16\t0 50 1 0\r\n# more");
  ASSERT_EQ(config.commands.size(), 1U);
  EXPECT_EQ(config.commands[0].line, 3);
  EXPECT_EQ(config.commands[0].number(4), 50.0);
  EXPECT_TRUE(std::isnan(config.commands[0].number(7)));
}

}  // namespace
}  // namespace rio::ti::test
