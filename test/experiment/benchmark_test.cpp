// SPDX-License-Identifier: BSD-3-Clause
// The benchmark of a folder: every recording has its rows, also without truth, also if it is
// broken.
#include <gtest/gtest.h>

#include <sstream>

#include "experiment/experiment.hpp"
#include "rio/eval/alignment.hpp"
#include "rio/io/dataset.hpp"
#include "rio/io/flight_dataset.hpp"
#include "rio/io/trajectory.hpp"
#include "rio/sim/flight.hpp"
#include "support/temp_dir.hpp"

namespace rio::experiment {
namespace {

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
  sim::Scenario scenario;
  scenario.seed = 3;
  scenario.path.length = 12.0;
  io::Dataset data = io::dataset_of(sim::simulate_flight(scenario));
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
