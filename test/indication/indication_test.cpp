// SPDX-License-Identifier: BSD-3-Clause
// The alarm for unintended changes: what the estimator makes of the sample flight, compared with
// what it made of it when the files beside this one were committed.
//
// The first 25 s of data/sample_flight go through rio::Odometry for each preset; twice a second a
// row is noted: time, pose and velocity with their 1-sigma, and what became of the measurements
// since the row before. It is held against PRESET.csv. A number may differ by one unit of its last
// digit, which is what compilers make of rounding; counts must be equal. The digits written are
// those in which a change of 1 % in a sigma shows: it moves the estimate by 0.02 mm or the 1-sigma
// by 2e-4 of itself, while compilers, with and without fused multiply-add, agree to 1e-11 mm.
// Options that the sensor.yaml files of the recording replace are not seen by their defaults.
// Red does not mean worse, only different: whether it is better is for the tests of accuracy and
// consistency (test/mc).
//
// To accept a change that was made on purpose:
//     RIO_ACCEPT_CHANGE=1 ./test/run.sh -R indication
// rewrites the files; commit them with the change and say why in the commit message.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "indication/table.hpp"
#include "rio/io/dataset.hpp"
#include "rio/rio.hpp"
#include "support/temp_dir.hpp"

namespace rio {
namespace {

using test::Row;

constexpr Time kSpan = std::chrono::seconds(25);
constexpr Time kInterval = std::chrono::milliseconds(500);

/// Without the sign of a negative zero.
std::string formatted(const char* format, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, format, value);
  std::string text = buffer;
  if (text[0] == '-' && text.find_first_of("123456789") == std::string::npos) text.erase(0, 1);
  return text;
}

/// Three cells named NAME_x, NAME_y, NAME_z.
void add_vector(Row* row, const std::string& name, const std::string& unit, const char* format,
                const Vector3d& value) {
  const char* const kAxes[] = {"_x", "_y", "_z"};
  for (int i = 0; i < 3; ++i) {
    row->push_back({name + kAxes[i] + unit, formatted(format, value[i])});
  }
}

/// Sums over scans of the rows of each model.
using Sums = std::array<ModelReport, kModelCount>;

Row row_of(const Odometry& odometry, Time since_start, const Sums& sums) {
  const NavState& state = odometry.at_scan();
  const Eigen::Matrix<double, body::kSize, 1> sigma = odometry.covariance().diagonal().cwiseSqrt();
  Row row = {{"t [s]", formatted("%.3f", to_seconds(since_start)), true}};
  add_vector(&row, "p", " [mm]", "%.2f", 1e3 * state.p_WB);
  row.push_back({"q_w", formatted("%.6f", state.q_WB.w())});
  add_vector(&row, "q", "", "%.6f", state.q_WB.vec());
  add_vector(&row, "v", " [mm/s]", "%.2f", 1e3 * state.v_WB);
  add_vector(&row, "sigma_p", " [m]", "%.4e", sigma.segment<3>(body::kPosition));
  add_vector(&row, "sigma_phi", " [rad]", "%.4e", sigma.segment<3>(body::kAttitude));
  add_vector(&row, "sigma_v", " [m/s]", "%.4e", sigma.segment<3>(body::kVelocity));
  for (std::size_t i = 0; i < kModelCount; ++i) {
    const auto model = static_cast<Model>(i);
    if (model == Model::kAiding) continue;  // no other sensor here
    const std::string name = to_string(model);
    row.push_back({name + " used", std::to_string(sums[i].rows_used), true});
    row.push_back({name + " gated", std::to_string(sums[i].rows_gated), true});
  }
  row.push_back({"landmarks", std::to_string(odometry.report().landmarks), true});
  return row;
}

/// Feeds each scan when the IMU has reached it, so that its report is read before the next one.
std::vector<Row> replay(const io::Dataset& dataset, const std::string& preset_name) {
  Options options;
  if (!preset(preset_name, &options)) throw std::runtime_error("no preset " + preset_name);
  io::apply_sensor_info(dataset, &options);
  std::string why;
  const auto odometry = Odometry::create(options, &why);
  if (odometry == nullptr) throw std::runtime_error(why);

  const Time begin = dataset.imu.front().time;
  std::vector<Row> rows;
  Sums sums{};
  Time next_row = begin;
  auto sample = dataset.imu.begin();
  for (const RadarScan& scan : dataset.scans) {
    if (scan.time > begin + kSpan) break;
    for (bool reached = false; !reached && sample != dataset.imu.end(); ++sample) {
      reached = sample->time >= scan.time;
      if (odometry->add_imu(*sample) != Status::kOk) throw std::runtime_error("IMU not taken");
    }
    const Status status = odometry->add_scan(scan);
    if (status == Status::kNotInitialized) continue;
    if (status != Status::kOk && status != Status::kWaiting) {
      throw std::runtime_error(to_string(status));
    }
    // measured later than stamped, by the time offset as estimated: it waits for the IMU
    for (; odometry->report().time != scan.time && sample != dataset.imu.end(); ++sample) {
      if (odometry->add_imu(*sample) != Status::kOk) throw std::runtime_error("IMU not taken");
    }
    for (std::size_t i = 0; i < kModelCount; ++i) {
      sums[i].rows_used += odometry->report().models[i].rows_used;
      sums[i].rows_gated += odometry->report().models[i].rows_gated;
    }
    if (scan.time < next_row) continue;
    rows.push_back(row_of(*odometry, scan.time - begin, sums));
    sums = {};
    while (next_row <= scan.time) next_row += kInterval;
  }
  return rows;
}

bool change_accepted() {
  const char* value = std::getenv("RIO_ACCEPT_CHANGE");
  return value != nullptr && std::string(value) == "1";
}

void expect_as_committed(const std::string& preset_name) {
  const std::filesystem::path source = RIO_SOURCE_DIR;
  const std::string name = "test/indication/" + preset_name + ".csv";
  static const io::Dataset dataset = io::read_dataset(source / "data/sample_flight");
  const std::vector<Row> now = replay(dataset, preset_name);
  ASSERT_GT(now.size(), 40U) << "the estimator started late";  // of 47 after 1.5 s of standstill
  if (change_accepted()) {
    test::write_table(source / name, now);
    std::printf("%s written; commit it and say why\n", name.c_str());
    return;
  }
  const auto difference = test::first_difference(test::read_table(source / name), now);
  EXPECT_FALSE(difference) << "The estimate of the sample flight is not as committed.\n"
                           << name << ": " << *difference << "\n"
                           << "If the change is wanted, RIO_ACCEPT_CHANGE=1 ./test/run.sh -R "
                              "indication\nrewrites the file; commit it and say why.";
}

TEST(Indication, DefaultIsAsCommitted) {
  expect_as_committed("default");
}

TEST(Indication, PublishedEkfIsAsCommitted) {
  expect_as_committed("published-ekf");
}

TEST(Table, ForgivesOneUnitOfTheLastDigitButNotOfACount) {
  const std::pair<const char*, const char*> one_unit[] = {
      {"12", "13"},
      {"0.0300", "0.0299"},
      {"-0.0000", "0.0001"},
      {"9.99e-03", "1.00e-02"},
      {"1.00e-02", "9.95e-03"},  // unit of the larger number
      {"-1", "-2"}};
  for (const auto& [was, is] : one_unit) {
    EXPECT_TRUE(test::agree(was, is, false)) << was << " " << is;
    EXPECT_FALSE(test::agree(was, is, true)) << was << " " << is;
  }
  const std::pair<const char*, const char*> more[] = {{"12", "14"},
                                                      {"0.0301", "0.0299"},
                                                      {"1.23e-02", "1.25e-02"},
                                                      {"1.23e-02", "1.23e-01"},
                                                      {"1", "-1"},
                                                      {"nan", "1"},
                                                      {"1", "nan"}};
  for (const auto& [was, is] : more) EXPECT_FALSE(test::agree(was, is, false)) << was << " " << is;
  EXPECT_TRUE(test::agree("12", "12", true));
}

TEST(Table, NamesTheFirstDifference) {
  const std::vector<Row> was = {{{"t [s]", "0.5", true}, {"p [mm]", "10"}, {"rows", "7", true}},
                                {{"t [s]", "1.0", true}, {"p [mm]", "20"}, {"rows", "8", true}}};
  const test::Texts committed = test::texts_of(was);
  EXPECT_FALSE(test::first_difference(committed, was));
  std::vector<Row> is = was;
  is[0][1].text = "11";
  EXPECT_FALSE(test::first_difference(committed, is));
  is[1][1].text = "23";
  is[1][2].text = "9";
  EXPECT_EQ(test::first_difference(committed, is),
            "row 2 (t [s] = 1.0), column p [mm]: was 20, is 23");
  is[1][1].text = "20";
  EXPECT_EQ(test::first_difference(committed, is), "row 2 (t [s] = 1.0), column rows: was 8, is 9");
  is.pop_back();
  EXPECT_EQ(test::first_difference(committed, is), "number of rows: was 2, is 1");
  is = was;
  is.push_back(was[1]);
  EXPECT_EQ(test::first_difference(committed, is), "number of rows: was 2, is 3");
  is = was;
  test::Texts cut = committed;
  cut[1].pop_back();
  EXPECT_EQ(test::first_difference(cut, was), "row 1 is not whole");
  is[0][1].column = "p [m]";
  EXPECT_EQ(test::first_difference(committed, is), "the columns are not the same");
  EXPECT_EQ(test::first_difference({}, was), "the columns are not the same");
}

TEST(Table, FileKeepsTheTexts) {
  const test::TempDir dir;
  const std::vector<Row> rows = {{{"t [s]", "0.500", true}, {"sigma", "1.20e-03"}},
                                 {{"t [s]", "1.000", true}, {"sigma", "-0"}}};
  test::write_table(dir.path() / "a.csv", rows);
  EXPECT_EQ(dir.read("a.csv"), "t [s],sigma\n0.500,1.20e-03\n1.000,-0\n");
  EXPECT_EQ(test::read_table(dir.path() / "a.csv"), test::texts_of(rows));
  EXPECT_ERROR(test::read_table(dir.path() / "none.csv"), "none.csv: no such file");
}

}  // namespace
}  // namespace rio
