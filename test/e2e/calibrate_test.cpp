// SPDX-License-Identifier: BSD-3-Clause
// `rio calibrate` and `rio fit-noise` as a user runs them: files to fly with from a flight told
// wrongly, an option file with the noise of another; bad input.
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "e2e/tool.hpp"
#include "rio/io/dataset.hpp"
#include "support/matches.hpp"

namespace rio::test {
namespace {

/// A flight told 5 deg, 5 cm and 10 ms wrong.
class Calibrate : public Tool {
 protected:
  static void SetUpTestSuite() {
    dir_ = new TempDir;
    flight_ = (dir_->path() / "flight").string();
    dir_->write("wrong.yaml",
                "seed: 2\npath: {length: 30}\nradar: {stamp_offset: 10 ms}\n"
                "told: {extrinsic_angle: 5 deg, extrinsic_distance: 5 cm}\n");
    rio("simulate " + flight_ + " --scenario " + file("wrong.yaml"));
  }
  static Pose mounting_in(const std::string& dataset) {
    return *io::read_sensor_info(dataset).radar_info.T_BS;
  }
  /// Largest difference of the rotation matrices.
  static double turn(const Pose& a, const Pose& b) {
    return (a.rotation.toRotationMatrix() - b.rotation.toRotationMatrix()).cwiseAbs().maxCoeff();
  }
};

TEST_F(Calibrate, WritesFilesThatReplayFliesBetterWith) {
  const std::string sensor = flight_ + "/radar0/sensor.yaml";
  const std::string before = text_of(sensor);
  const Json json = rio("calibrate " + flight_ + " --json --out " + file("found")).json();
  EXPECT_EQ(text_of(sensor), before) << "the recording was touched";
  EXPECT_EQ(json["parameters"]["time_offset"]["verdict"], "determined");
  EXPECT_NEAR(json["time_offset_s"].get<double>(), 0.01,
              3.0 * json["parameters"]["time_offset"]["sigma"].get<double>());
  EXPECT_EQ(json["recordings"].size(), 1U);
  ASSERT_TRUE(fs::exists(file("found") + "/radar0/sensor.yaml"));
  EXPECT_EQ(json["written"].size(), fs::exists(file("found") + "/imu0/sensor.yaml") ? 2U : 1U);

  // a copy with these files: an estimator that calibrates nothing gets what was found
  const auto drift = [](const std::string& dataset) {
    rio("replay " + dataset + " --json --preset published-ekf --out " + file("path.tum"));
    const Outcome score = rio("evaluate " + flight_ + " " + file("path.tum") + " --json");
    return score.json()["final_drift_percent"].get<double>();
  };
  const double wrong = drift(flight_);
  fs::copy(file("found"), copy("right"),
           fs::copy_options::recursive | fs::copy_options::overwrite_existing);
  const double right = drift(file("right"));
  EXPECT_LT(right, wrong);

  // the same flight, told right
  rio("simulate " + file("told") + " --seed 2 --length 30");
  const Pose truth = mounting_in(file("told"));
  const Pose found = mounting_in(file("found"));
  EXPECT_GT(turn(mounting_in(flight_), truth), 0.04);  // 5 deg, shared by the axes
  EXPECT_LT(turn(found, truth), 0.02);
  EXPECT_LT((found.translation - truth.translation).cwiseAbs().maxCoeff(), 0.02);
}

TEST_F(Calibrate, OverwritesOnlyWhatItIsToldToAndPrintsATable) {
  const std::string own = copy("own").string();
  const std::string before = dir_->read("own/radar0/sensor.yaml");
  fails(1, "calibrate " + own + " --out " + own, {"--overwrite"});
  EXPECT_EQ(dir_->read("own/radar0/sensor.yaml"), before);
  rio("calibrate " + own + " --overwrite --out " + own,
      {"radar_rotation_y", "radar_position_z", "doppler_scale", "time_offset", "sigma_azimuth",
       "gyroscope_noise", "determined", "halves", "deg"});
  expect_parts(dir_->read("own/radar0/sensor.yaml"), {"time_offset_s"});
}

TEST_F(Calibrate, SaysWhatIsWrong) {
  fails(2, "calibrate", {"RECORDING"});
  const fs::path damaged = copy("damaged");
  fs::remove(damaged / "radar0/data.csv");
  for (const auto& [arguments, part] : std::vector<std::pair<std::string, std::string>>{
           {file("nothing"), "nothing"},
           {flight_ + " " + file("nothing"), "nothing"},
           {flight_ + " --overwrite", "needs --out"},
           {flight_ + " --out " + file("wrong.yaml"), "is not a folder"},
           {flight_ + " --config " + file("nothing.yaml"), "nothing.yaml"},
           {damaged.string(), "radar0/data.csv"}}) {
    fails(1, "calibrate " + arguments, {part});
  }
  const std::string negated = changed("negated", "radar0/data.csv", "$5 = -$5");
  for (const char* command : {"calibrate ", "fit-noise "}) {
    expect_parts(try_rio(command + negated).output,
                 {"data wrong: axes and Doppler sign: ", "-> negate the column doppler"});
  }
}

TEST(FitNoise, PrintsAnOptionFileThatReplayTakes) {
  const TempDir dir;
  const std::string flight = (dir.path() / "flight").string();
  const std::string fitted = (dir.path() / "noise.yaml").string();
  rio("simulate " + flight + " --scenario monte-carlo --seed 9");
  rio("fit-noise " + flight + " 2>/dev/null >" + fitted);
  const std::string fit = text_of(fitted);
  const auto value_of = [&fit](const std::string& key) {
    return std::stod(matches(fit, key + ": \"?([0-9.]+)").at(0));
  };
  // of the scenario; 15 % as test/calibrate/noise_calibration_test.cpp
  EXPECT_NEAR(value_of("sigma_range"), 0.03, 0.15 * 0.03);
  EXPECT_NEAR(value_of("sigma_azimuth"), 2.0, 0.15 * 2.0);
  EXPECT_NEAR(value_of("sigma_elevation"), 4.0, 0.15 * 4.0);
  EXPECT_NEAR(value_of("sigma_doppler"), 0.02, 0.15 * 0.02);
  rio("replay " + flight + " --quiet --config " + fitted);
  fails(3, "fit-noise " + flight + " --set radar.sigma_azimuth=20deg --set radar.sigma_doppler=0.3",
        {"# Not converged: the sigmas still change after 6 runs", "rio: the sigmas still change"});

  // two seconds of scans, most of them at rest
  std::vector<std::string> lines = lines_of(flight + "/radar0/data.csv");
  ASSERT_GT(lines.size(), 600U);
  lines.resize(600);
  std::ofstream out(flight + "/radar0/data.csv");
  for (const std::string& line : lines) out << line << "\n";
  out.close();
  fails(1, "fit-noise " + flight, {"fly longer, or see `rio check`"});
  fails(1, "fit-noise " + flight + "/nothing", {"nothing"});
}

}  // namespace
}  // namespace rio::test
