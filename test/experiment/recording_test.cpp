// SPDX-License-Identifier: BSD-3-Clause
// Recordings are found, perturbed and judged, on simulated flights, whose truth is known; their
// tables; and the benchmark of a folder: every recording has its rows, also without truth, also if
// it is broken.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <sstream>
#include <stdexcept>

#include "experiment/experiment.hpp"
#include "experiment/recording.hpp"
#include "experiment/spread.hpp"
#include "rio/eval/alignment.hpp"
#include "rio/io/dataset.hpp"
#include "rio/io/simulation.hpp"
#include "rio/io/trajectory.hpp"
#include "rio/sim/flight.hpp"
#include "support/temp_dir.hpp"

namespace rio::experiment {
namespace {

TEST(Spread, MeanWorstAndSampleDeviation) {
  const Spread s = Spread::of(std::vector<double>{1.0, 4.0, 1.0});
  EXPECT_DOUBLE_EQ(s.mean, 2.0);
  EXPECT_DOUBLE_EQ(s.worst, 4.0);
  EXPECT_DOUBLE_EQ(s.std, std::sqrt(3.0));
  EXPECT_EQ(s.text(2), "2.00 (4.00) ± 1.73");
  EXPECT_EQ(Spread::of(std::vector<double>{0.5}).text(1), "0.5 (0.5) ± 0.0");
  EXPECT_EQ(Spread::of(std::vector<double>{}).text(1), "- (-) ± -");
  EXPECT_EQ(number(999.96, 1), "1000.0");
  EXPECT_EQ(number(-12345.6, 2), "-12346");  // large figures have no decimals
}

TEST(Spread, OneMissingFigureIsTheWorst) {
  for (const auto& values :
       {std::vector<double>{NAN, 1.0, 2.0}, {1.0, NAN, 2.0}, {1.0, 2.0, NAN}}) {
    EXPECT_TRUE(std::isnan(Spread::of(values).worst));
    EXPECT_TRUE(std::isnan(Spread::of(values).mean));
  }
}

TEST(MarkdownTable, HeadRuleAndRows) {
  MarkdownTable table({"a", "b"});
  table.add({"1", "2"});
  EXPECT_EQ(table.text(), "| a | b |\n| --- | --- |\n| 1 | 2 |\n");
  EXPECT_THROW(table.add({"1"}), std::logic_error);
}

/// A short flight with its truth as the reference.
Recording simulated(double length = 20.0) {
  const sim::Flight flight = sim::simulate_flight({.seed = 3, .path = {.length = length}});
  Recording r{"simulated", "", io::dataset_of(flight), {}};
  for (const NavState& x : r.data.ground_truth) r.reference.push_back({x.time, x.p_WB, x.q_WB});
  return r;
}

Options options_of(const Recording& recording) {
  Options options;
  io::apply_sensor_info(recording.data, &options);
  return options;
}

TEST(Recording, IsFoundByItsFoldersAndKnowsAFlatFloor) {
  const test::TempDir dir;
  EXPECT_THROW(find_recordings(dir.path() / "nothing"), std::runtime_error);
  EXPECT_THROW(find_recordings(dir.path()), std::runtime_error);
  Recording r = simulated();
  io::write_dataset(dir.path() / "b" / "flight", r.data);
  io::write_dataset(dir.path() / "a", r.data);
  EXPECT_FALSE(r.flat());
  for (eval::StampedPose& pose : r.reference) pose.p.z() = 0.0;
  EXPECT_TRUE(r.flat());
  io::write_tum(dir.path() / "a" / "reference.tum", r.reference);
  const std::vector<Recording> found = find_recordings(dir.path());
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].name, "a");
  EXPECT_EQ(found[1].name, "flight");
  EXPECT_TRUE(found[0].flat());
  EXPECT_TRUE(found[1].reference.empty());
  EXPECT_EQ(found[1].data.imu.size(), r.data.imu.size());
}

TEST(Recording, IsJudgedAgainstItsReference) {
  Recording r = simulated();
  const Replay run = replay(r.data, options_of(r));
  const RealScore score = judge(r, run);
  ASSERT_TRUE(score.started);
  EXPECT_NEAR(score.distance, 20.0, 2.0);
  EXPECT_LT(score.horizontal, 0.1);  // 0.5 % of the way
  // the same path turned and moved is as good: the reference may begin anywhere
  const Pose T{quaternion_exp({0.0, 0.0, 2.0}), {5.0, -3.0, 0.0}};
  for (eval::StampedPose& pose : r.reference) pose = eval::transformed(T, pose);
  EXPECT_NEAR(judge(r, run).horizontal, score.horizontal, 1e-9);
  // on a floor that is not flat, a flat one is wrong by the height flown
  for (eval::StampedPose& pose : r.reference) pose.p.z() = 0.0;
  const RealScore flat = judge(r, run);
  EXPECT_GT(flat.height, 0.2);
  EXPECT_LT(flat.honest, 0.5);
}

TEST(Recording, WithoutAStartHasNoScore) {
  Recording r = simulated();
  r.data.imu.resize(100);
  const RealScore score = judge(r, replay(r.data, options_of(r)));
  EXPECT_FALSE(score.started);
  EXPECT_TRUE(std::isnan(score.horizontal));
}

TEST(Recording, IsPerturbedAsSaid) {
  const Recording r = simulated();
  const std::size_t scans = r.data.scans.size();
  const auto points = [](const Recording& one) {
    std::size_t sum = 0;
    for (const RadarScan& scan : one.data.scans) sum += scan.detections.size();
    return static_cast<double>(sum);
  };
  int seen = 0;
  for (const Copy& copy : perturbed(r, 3, 1)) {
    ++seen;
    const io::Dataset& data = copy.recording.data;
    if (copy.kind == "every other scan") {
      EXPECT_NEAR(static_cast<double>(data.scans.size()), 0.5 * static_cast<double>(scans), 1.0);
    } else if (copy.kind == "30 % of the points dropped") {
      EXPECT_NEAR(points(copy.recording) / points(r), 0.7, 0.03);
    } else if (copy.kind == "mounting wrong by 3 deg") {
      EXPECT_NEAR(data.radar_info.T_BS->rotation.angularDistance(r.data.radar_info.T_BS->rotation),
                  3.0 * M_PI / 180.0, 1e-6);
    } else if (copy.kind == "stamps wrong by 20 ms") {
      EXPECT_NEAR(std::abs(to_seconds(data.scans[7].time - r.data.scans[7].time)), 0.02, 1e-12);
    } else {
      EXPECT_EQ(copy.kind, "2 s of rest before the start");
      EXPECT_LT(data.imu.size(), r.data.imu.size());
      EXPECT_EQ(data.imu.back().time, r.data.imu.back().time);
    }
  }
  EXPECT_EQ(seen, 11);
}

/// The cells of the row of a recording and back-end.
std::vector<std::string> row(const std::string& table, const std::string& begin) {
  const std::size_t at = table.find("| " + begin + " |");
  std::istringstream line(table.substr(at, table.find('\n', at) - at));
  std::vector<std::string> cells;
  for (std::string cell; std::getline(line, cell, '|');) {
    const std::size_t first = cell.find_first_not_of(' ');
    cells.push_back(
        first == cell.npos ? "" : cell.substr(first, cell.find_last_not_of(' ') - first + 1));
  }
  return cells;
}

TEST(Benchmark, HasARowForEveryRecordingAndBackEnd) {
  const test::TempDir dir;
  io::Dataset data = simulated(12.0).data;
  eval::Trajectory truth;  // turned and moved: alignment takes that out
  const Pose T{Quaternion(0.8, 0.0, 0.0, 0.6), {5.0, -2.0, 1.0}};
  for (const NavState& s : data.ground_truth) {
    truth.push_back(eval::transformed(T, {s.time, s.p_WB, s.q_WB}));
  }
  data.ground_truth.clear();
  io::write_dataset(dir.path() / "data/without", data);
  io::write_dataset(dir.path() / "data/deep/with", data);
  io::write_tum(dir.path() / "data/deep/with.tum", truth);
  dir.write("data/broken.bag", "#ROSBAG V2.0\nand no more");

  Settings settings;
  settings.data = (dir.path() / "data").string();
  const std::string table = benchmark(settings).markdown;
  for (const char* back_end : {"filter", "smoother"}) {
    SCOPED_TRACE(table);
    const auto with = row(table, std::string("deep/with | ") + back_end);
    ASSERT_EQ(with.size(), 11U);
    EXPECT_NEAR(std::stod(with[4]), 12.0, 2.0);
    EXPECT_LT(std::stod(with[5]), 0.2);
    EXPECT_LT(std::stod(with[6]), 3.0);
    EXPECT_LT(std::stod(with[7]), 0.5);
    EXPECT_GT(std::stod(with[5]), 1e-3);
    EXPECT_GT(std::stod(with[8]), 0.01);
    EXPECT_LT(std::stod(with[8]), 10.0);
    EXPECT_GT(std::stod(with[9]), 0.0);
    EXPECT_EQ(with[10], "healthy");
    const auto without = row(table, std::string("without | ") + back_end);
    ASSERT_EQ(without.size(), 11U);
    EXPECT_EQ(without[5], "-");
    EXPECT_EQ(without[3], with[3]);
    EXPECT_EQ(without[10], "healthy");
    const auto broken = row(table, std::string("broken.bag | ") + back_end);
    ASSERT_EQ(broken.size(), 11U);
    EXPECT_EQ(broken[10].substr(0, 8), "failed: ");
  }
  settings.dataset = "brioo";
  EXPECT_ERROR(benchmark(settings), "did you mean \"brio\"?");
  settings.data = (dir.path() / "nothing").string();
  settings.dataset.clear();
  EXPECT_ERROR(benchmark(settings), "is not a folder");
}

}  // namespace
}  // namespace rio::experiment
