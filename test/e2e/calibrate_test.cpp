// SPDX-License-Identifier: BSD-3-Clause
// `rio calibrate` as a user runs it: files to fly with from a flight told wrongly; bad input.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "e2e/tool.hpp"

namespace rio::test {
namespace {

using Json = nlohmann::json;

/// A flight told 5 deg, 5 cm and 10 ms wrong.
class Calibrate : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    dir_ = new TempDir;
    flight_ = (dir_->path() / "flight").string();
    dir_->write("wrong.yaml",
                "seed: 2\npath: {length: 30}\nradar: {stamp_offset: 10 ms}\n"
                "told: {extrinsic_angle: 5 deg, extrinsic_distance: 5 cm}\n");
    const Outcome run = rio("simulate " + flight_ + " --scenario " + file("wrong.yaml"));
    ASSERT_EQ(run.status, 0) << run.output;
  }
  static void TearDownTestSuite() { delete dir_; }
  static std::string file(const std::string& name) { return (dir_->path() / name).string(); }
  static std::string text_of(const fs::path& path) {
    std::ifstream in(path);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  }
  /// The 16 numbers of T_BS.
  static std::vector<double> pose_in(const fs::path& sensor) {
    const std::string text = text_of(sensor);
    std::vector<double> numbers;
    const char* at = text.c_str() + text.find("data: [") + 7;
    for (char* end = nullptr; numbers.size() < 16; at = end + 1) {
      numbers.push_back(std::strtod(at, &end));
    }
    return numbers;
  }
  /// Largest difference of the rotation matrices, or of the lever arms.
  static double difference(const std::vector<double>& a, const std::vector<double>& b, bool arm) {
    double largest = 0.0;
    for (std::size_t i = 0; i < 12; ++i) {
      if ((i % 4 == 3) == arm) largest = std::max(largest, std::abs(a[i] - b[i]));
    }
    return largest;
  }
  static void expect_failure(const std::string& arguments, const std::string& message) {
    const Outcome run = rio("calibrate " + arguments);
    EXPECT_NE(run.status, 0) << arguments;
    EXPECT_NE(run.output.find(message), std::string::npos) << run.output;
  }

  inline static TempDir* dir_ = nullptr;
  inline static std::string flight_;
};

TEST_F(Calibrate, WritesFilesThatReplayFliesBetterWith) {
  const std::string sensor = flight_ + "/radar0/sensor.yaml";
  const std::string before = text_of(sensor);
  const Outcome run = rio("calibrate " + flight_ + " --json --out " + file("found"));
  ASSERT_EQ(run.status, 0) << run.output;
  EXPECT_EQ(text_of(sensor), before) << "the recording was touched";
  const Json json = Json::parse(run.last_line());
  EXPECT_EQ(json["parameters"]["time_offset"]["verdict"], "determined");
  EXPECT_NEAR(json["time_offset_s"].get<double>(), 0.01,
              3.0 * json["parameters"]["time_offset"]["sigma"].get<double>());
  EXPECT_EQ(json["recordings"].size(), 1U);
  ASSERT_TRUE(fs::exists(file("found") + "/radar0/sensor.yaml"));
  EXPECT_EQ(json["written"].size(), fs::exists(file("found") + "/imu0/sensor.yaml") ? 2U : 1U);

  // a copy with these files: an estimator that calibrates nothing gets what was found
  const auto drift = [](const std::string& dataset) {
    const Outcome replay =
        rio("replay " + dataset + " --json --preset published-ekf --out " + file("path.tum"));
    EXPECT_EQ(replay.status, 0) << replay.output;
    const Outcome score = rio("evaluate " + flight_ + " " + file("path.tum") + " --json");
    EXPECT_EQ(score.status, 0) << score.output;
    return Json::parse(score.last_line())["final_drift_percent"].get<double>();
  };
  const double wrong = drift(flight_);
  fs::copy(flight_, file("right"), fs::copy_options::recursive);
  fs::copy(file("found"), file("right"),
           fs::copy_options::recursive | fs::copy_options::overwrite_existing);
  const double right = drift(file("right"));
  EXPECT_LT(right, wrong);

  // the same flight, told right
  const Outcome told = rio("simulate " + file("told") + " --seed 2 --length 30");
  ASSERT_EQ(told.status, 0) << told.output;
  const std::vector<double> truth = pose_in(file("told") + "/radar0/sensor.yaml");
  const std::vector<double> found = pose_in(file("found") + "/radar0/sensor.yaml");
  EXPECT_GT(difference(pose_in(sensor), truth, false), 0.04);  // 5 deg, shared by the axes
  EXPECT_LT(difference(found, truth, false), 0.02);
  EXPECT_LT(difference(found, truth, true), 0.02);
}

TEST_F(Calibrate, OverwritesOnlyWhatItIsToldToAndPrintsATable) {
  const fs::path copy = file("copy");
  fs::copy(flight_, copy, fs::copy_options::recursive);
  const std::string before = text_of(copy / "radar0/sensor.yaml");
  expect_failure(copy.string() + " --out " + copy.string(), "--overwrite");
  EXPECT_EQ(text_of(copy / "radar0/sensor.yaml"), before);
  const Outcome run = rio("calibrate " + copy.string() + " --overwrite --out " + copy.string());
  ASSERT_EQ(run.status, 0) << run.output;
  EXPECT_NE(text_of(copy / "radar0/sensor.yaml").find("time_offset_s"), std::string::npos);
  for (const char* word : {"radar_rotation_y", "radar_position_z", "doppler_scale", "time_offset",
                           "sigma_azimuth", "gyroscope_noise", "determined", "halves", "deg"}) {
    EXPECT_NE(run.output.find(word), std::string::npos) << word << "\n" << run.output;
  }
}

TEST_F(Calibrate, SaysWhatIsWrong) {
  expect_failure("", "DATASET");
  expect_failure(file("nothing"), "nothing");
  expect_failure(flight_ + " " + file("nothing"), "nothing");
  expect_failure(flight_ + " --overwrite", "needs --out");
  expect_failure(flight_ + " --out " + file("wrong.yaml"), "is not a folder");
  expect_failure(flight_ + " --config " + file("nothing.yaml"), "nothing.yaml");
  const fs::path damaged = file("damaged");
  fs::copy(flight_, damaged, fs::copy_options::recursive);
  fs::remove(damaged / "radar0/data.csv");
  expect_failure(damaged.string(), "radar0/data.csv");
}

}  // namespace
}  // namespace rio::test
