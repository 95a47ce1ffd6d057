// SPDX-License-Identifier: BSD-3-Clause
// `rio ti-config` as a user runs it, and its options pasted into a file.
#include "e2e/tool.hpp"

namespace rio::test {
namespace {

class TiConfigTool : public Tool {
 protected:
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
  const std::string text = rio("ti-config " + good(), {"+-5.364 m/s", "20.00 Hz", "side info on",
                                                       "Nothing is wrong", "radar:"})
                               .output;
  std::ofstream(file("options.yaml")) << text.substr(text.find("radar:"));
  const Outcome replay = try_rio("replay --quiet " + flight_ + " --config " + file("options.yaml"));
  expect_none(replay.output, {"options.yaml:"});  // no error
  EXPECT_NE(replay.code, 1) << replay.output;
}

TEST_F(TiConfigTool, SaysWhatIsWrongAndExitsWithThree) {
  fails(3, "ti-config " + spoiled("clutterRemoval -1 1"),
        {"clutter removal: ", "-> clutterRemoval -1 0"});
  fails(3, "ti-config --speed 12 " + good(), {"the vehicle flies 12 m/s"});
}

TEST_F(TiConfigTool, JsonHoldsTheSame) {
  const Json json = fails(3, "ti-config --json " + spoiled("bmpCfg \xff"), {}).json();
  EXPECT_NEAR(json["figures"]["max_speed_mps"].get<double>(), 5.3635, 1e-3);
  EXPECT_EQ(json["findings"][0]["subject"], "unknown command");
}

TEST_F(TiConfigTool, NamesOtherFirmwareInsteadOfJudging) {
  const Outcome run = fails(3, "ti-config " + spoiled("ddmPhaseShiftAntOrder 0 2 3 1"),
                            {"AWR2944", "not of the out-of-box demo of SDK 3.x: not judged"});
  expect_none(run.output, {"wrong", "take the line out", "speed ", "radar:"});
  fails(1,
        "live --sensors " + flight_ + " --radar-cfg " + file("spoiled.cfg") + " --radar " +
            file("no") + " --imu " + file("no") + " --patience 0",
        {"the frame rate is that of --sensors"});
}

TEST_F(TiConfigTool, WrongCommandLines) {
  fails(1, "ti-config " + file("nothing.cfg"), {"nothing.cfg"});
  fails(1, "ti-config " + flight_, {flight_ + ": is a folder"});
  fails(2, "ti-config", {"FILE"});
  fails(2, "ti-config --speed 0 " + good(), {"--speed"});
}

}  // namespace
}  // namespace rio::test
