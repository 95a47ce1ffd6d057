// SPDX-License-Identifier: BSD-3-Clause
// Recordings are found, perturbed and judged: on simulated flights, whose truth is known.
#include "experiment/recording.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "rio/io/flight_dataset.hpp"
#include "rio/io/trajectory.hpp"
#include "support/temp_dir.hpp"

namespace rio::experiment {
namespace {

/// A short flight with its truth as the reference.
Recording simulated() {
  sim::Scenario scenario;
  scenario.seed = 3;
  scenario.path.length = 20.0;
  Recording r{"simulated", "", io::dataset_of(sim::simulate_flight(scenario)), {}};
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
  const Quaternion turn = quaternion_exp(Vector3d(0.0, 0.0, 2.0));
  for (eval::StampedPose& pose : r.reference) {
    pose.p = turn * pose.p + Vector3d(5.0, -3.0, 0.0);
    pose.q = turn * pose.q;
  }
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

}  // namespace
}  // namespace rio::experiment
