// SPDX-License-Identifier: BSD-3-Clause
// `rio ti-config` as a user runs it, and its options pasted into a file.
#include <sys/wait.h>

#include <nlohmann/json.hpp>

#include "e2e/tool.hpp"

namespace rio::test {
namespace {

using Json = nlohmann::json;

class TiConfigTool : public Tool {
 protected:
  static int exit_code(const Outcome& run) { return WEXITSTATUS(run.status); }
  static std::string good() { return RIO_SOURCE_DIR "/data/awr1843boost_odometry.cfg"; }

  /// The good one with a line more.
  static std::string spoiled(const std::string& line) {
    std::string path = file("spoiled.cfg");
    fs::copy_file(good(), path, fs::copy_options::overwrite_existing);
    std::ofstream(path, std::ios::app) << line << "\n";
    return path;
  }
};

TEST_F(TiConfigTool, FiguresOfAGoodOneAndItsOptions) {
  const Outcome run = rio("ti-config " + good());
  EXPECT_EQ(exit_code(run), 0) << run.output;
  for (const char* part : {"+-5.364 m/s", "20.00 Hz", "side info on", "Nothing is wrong"}) {
    EXPECT_NE(run.output.find(part), std::string::npos) << part << "\n" << run.output;
  }
  const std::size_t begin = run.output.find("radar:");
  ASSERT_NE(begin, std::string::npos) << run.output;
  std::ofstream(file("options.yaml")) << run.output.substr(begin);
  const Outcome replay = rio("replay --quiet " + flight_ + " --config " + file("options.yaml"));
  EXPECT_EQ(replay.output.find("options.yaml:"), std::string::npos) << replay.output;  // no error
  EXPECT_NE(exit_code(replay), 1) << replay.output;
}

TEST_F(TiConfigTool, SaysWhatIsWrongAndExitsWithThree) {
  const Outcome run = rio("ti-config " + spoiled("clutterRemoval -1 1"));
  EXPECT_EQ(exit_code(run), 3) << run.output;
  EXPECT_NE(run.output.find("clutter removal: "), std::string::npos) << run.output;
  EXPECT_NE(run.output.find("-> clutterRemoval -1 0"), std::string::npos) << run.output;
  const Outcome fast = rio("ti-config --speed 12 " + good());
  EXPECT_EQ(exit_code(fast), 3) << fast.output;
  EXPECT_NE(fast.output.find("the vehicle flies 12 m/s"), std::string::npos) << fast.output;
}

TEST_F(TiConfigTool, JsonHoldsTheSame) {
  const Outcome run = rio("ti-config --json " + spoiled("bmpCfg \xff"));
  EXPECT_EQ(exit_code(run), 3) << run.output;
  const std::size_t at = run.output.find('{');  // the complaint may come before or after it
  ASSERT_NE(at, std::string::npos) << run.output;
  const std::string line = run.output.substr(at, run.output.find('\n', at) - at);
  const Json json = Json::parse(line, nullptr, false);
  ASSERT_FALSE(json.is_discarded()) << run.output;
  EXPECT_NEAR(json["figures"]["max_speed_mps"].get<double>(), 5.3635, 1e-3);
  EXPECT_EQ(json["findings"][0]["subject"], "unknown command");
}

TEST_F(TiConfigTool, NamesOtherFirmwareInsteadOfJudging) {
  const Outcome run = rio("ti-config " + spoiled("ddmPhaseShiftAntOrder 0 2 3 1"));
  EXPECT_EQ(exit_code(run), 3) << run.output;
  for (const char* part : {"AWR2944", "not of the out-of-box demo of SDK 3.x: not judged"}) {
    EXPECT_NE(run.output.find(part), std::string::npos) << run.output;
  }
  for (const char* part : {"wrong", "take the line out", "speed ", "radar:"}) {
    EXPECT_EQ(run.output.find(part), std::string::npos) << part << "\n" << run.output;
  }
  const Outcome live = rio("live --sensors " + flight_ + " --radar-cfg " + file("spoiled.cfg") +
                           " --radar " + file("no") + " --imu " + file("no") + " --patience 0");
  EXPECT_NE(live.output.find("the frame rate is that of --sensors"), std::string::npos)
      << live.output;
}

TEST_F(TiConfigTool, WrongCommandLines) {
  EXPECT_EQ(exit_code(rio("ti-config " + file("nothing.cfg"))), 1);
  EXPECT_EQ(exit_code(rio("ti-config")), 2);
  EXPECT_EQ(exit_code(rio("ti-config --speed 0 " + good())), 2);
}

}  // namespace
}  // namespace rio::test
