// SPDX-License-Identifier: BSD-3-Clause
// After create() the estimator does not touch the heap, with every option that changes the hot
// path.
#include "rio/testing/allocation_guard.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "experiment/trial.hpp"

namespace rio::test {
namespace {

using experiment::options_for;

class Allocation : public testing::TestWithParam<std::function<void(Options*)>> {};

TEST(AllocationGuard, SeesVectorsAndEigen) {
  if (!AllocationGuard::kWorks) GTEST_SKIP() << "allocations are not counted under a sanitizer";
  const AllocationGuard guard;
  const std::vector<int> v(10);
  const int* const volatile used = v.data();  // else the compiler may leave the vector out
  ASSERT_NE(used, nullptr);
  const Eigen::MatrixXd m = Eigen::MatrixXd::Zero(5, static_cast<int>(v.size()));
  EXPECT_EQ(guard.count(), 2 + (m.size() == 50 ? 0 : 1));
}

TEST_P(Allocation, NoneAfterCreate) {
  if (!AllocationGuard::kWorks) GTEST_SKIP() << "allocations are not counted under a sanitizer";
  sim::Scenario flight_options;
  flight_options.seed = 6;
  flight_options.path.length = 25.0;
  const sim::Flight flight = sim::simulate_flight(flight_options);
  Options options = options_for(flight, "default");
  GetParam()(&options);
  auto odometry = Odometry::create(options);
  ASSERT_NE(odometry, nullptr);
  std::size_t next = 0;
  int rows = 0;
  std::size_t points = 0;
  std::size_t landmarks = 0;
  const AllocationGuard guard;
  for (const ImuSample& sample : flight.imu) {
    if (next % 50 == 49) {  // ahead of the IMU now and then
      (void)odometry->add_scan(flight.scans[std::min(next, flight.scans.size() - 1)]);
    }
    (void)odometry->add_imu(sample);
    (void)odometry->covariance_now();
    while (next < flight.scans.size() && flight.scans[next].time <= sample.time) {
      (void)odometry->add_scan(flight.scans[next++]);
      for (const ModelReport& model : odometry->report().models) rows += model.rows_used;
      points += odometry->points().size();
      landmarks += odometry->landmarks().size();
    }
  }
  const BodyCovariance P = odometry->covariance();
  (void)odometry->reset(odometry->now(), P);
  odometry->reset();
  EXPECT_EQ(guard.count(), 0);
  EXPECT_GT(rows, 1000);
  EXPECT_GT(points, 1000U);
  if (options.update.use_landmarks) {
    EXPECT_GT(landmarks, 0U);
  }
}

class Reopening : public testing::TestWithParam<BackEnd> {};

TEST_P(Reopening, AllocatesNothing) {
  if (!AllocationGuard::kWorks) GTEST_SKIP() << "allocations are not counted under a sanitizer";
  sim::Scenario scenario;
  scenario.seed = 7;
  scenario.path.length = 10.0;
  const sim::Flight flight = sim::simulate_flight(scenario);
  Options options = options_for(flight, "default");
  options.backend = GetParam();
  auto odometry = Odometry::create(options);
  ASSERT_NE(odometry, nullptr);
  NavState wrong = flight.truth.front();
  wrong.v_WB += Vector3d(2.0, 2.0, 0.0);
  const BodyCovariance P0 = 1e-4 * BodyCovariance::Identity();
  const AllocationGuard guard;
  ASSERT_EQ(odometry->reset(wrong, P0), Status::kOk);
  std::size_t next = 0;
  for (const ImuSample& sample : flight.imu) {
    (void)odometry->add_imu(sample);
    while (next < flight.scans.size() && flight.scans[next].time <= sample.time) {
      (void)odometry->add_scan(flight.scans[next++]);
    }
  }
  EXPECT_EQ(guard.count(), 0);
  EXPECT_EQ(odometry->counters().velocity_resets, 1U);
}

/// An imaging radar: a thousand detections a scan, all of them used.
class Imaging : public testing::TestWithParam<BackEnd> {};

TEST_P(Imaging, AllocatesNothing) {
  if (!AllocationGuard::kWorks) GTEST_SKIP() << "allocations are not counted under a sanitizer";
  sim::Scenario scenario;
  scenario.seed = 3;
  scenario.max_duration = 5.0;
  for (double* density : {&scenario.room.floor_density, &scenario.room.wall_density,
                          &scenario.room.ceiling_density, &scenario.room.clutter_density}) {
    *density *= 50.0;
  }
  scenario.radar.max_static = 1000;
  scenario.radar.range_resolution /= 7.0;
  scenario.radar.doppler_resolution /= 7.0;
  scenario.radar.snr_1m_db = 78.0;
  const sim::Flight flight = sim::simulate_flight(scenario);
  Options options = options_for(flight, "default");
  options.backend = GetParam();
  options.frontend.max_detections = 1000;
  auto odometry = Odometry::create(options);
  ASSERT_NE(odometry, nullptr);
  ASSERT_EQ(odometry->reset(flight.truth.front(), 1e-4 * BodyCovariance::Identity()), Status::kOk);
  std::size_t next = 0;
  int most = 0;
  const AllocationGuard guard;
  for (const ImuSample& sample : flight.imu) {
    (void)odometry->add_imu(sample);
    while (next < flight.scans.size() && flight.scans[next].time <= sample.time) {
      (void)odometry->add_scan(flight.scans[next++]);
      most = std::max(most, odometry->report().static_detections);
    }
  }
  EXPECT_EQ(guard.count(), 0);
  EXPECT_GT(most, 400);
  const NavState& x = odometry->at_scan();
  EXPECT_LT((x.p_WB - flight.truth_at(x.time).p_WB).norm(), 0.1);
}

INSTANTIATE_TEST_SUITE_P(BackEnds, Imaging, testing::Values(BackEnd::kEkf, BackEnd::kSmoother));

INSTANTIATE_TEST_SUITE_P(BackEnds, Reopening, testing::Values(BackEnd::kEkf, BackEnd::kSmoother));

INSTANTIATE_TEST_SUITE_P(
    Options, Allocation,
    testing::Values([](Options*) {},
                    [](Options* o) {  // the largest state: 21 + 120 + 192 = 333
                      o->update.max_clones = 20;
                      o->update.max_landmarks = 64;
                      o->frontend.landmark_timeout = 1000.0;
                      o->frontend.promote_after = 1;
                    },
                    [](Options* o) { EXPECT_TRUE(preset("published-ekf", o)); },
                    [](Options* o) { o->calibration.rotation_sigma = 3.0; },
                    [](Options* o) { o->backend = BackEnd::kSmoother; },
                    [](Options* o) {  // many landmarks, a long window, few iterations
                      o->backend = BackEnd::kSmoother;
                      o->smoother.window = 19;
                      o->smoother.max_iterations = 2;
                      o->update.max_landmarks = 64;
                      o->frontend.landmark_timeout = 1000.0;
                      o->frontend.promote_after = 1;
                    },
                    [](Options* o) { EXPECT_TRUE(preset("published-smoother", o)); },
                    [](Options* o) { EXPECT_TRUE(preset("published-uncertainty", o)); },
                    [](Options* o) { EXPECT_TRUE(preset("doppler-only", o)); }));

}  // namespace
}  // namespace rio::test
