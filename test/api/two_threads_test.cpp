// SPDX-License-Identifier: BSD-3-Clause
// The arrangement for two threads of rio.hpp: one lock around all calls, or an estimator each.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "experiment/trial.hpp"
#include "rio/sim/flight.hpp"

namespace rio {
namespace {

sim::Flight short_flight(std::uint64_t seed) {
  sim::Scenario scenario;
  scenario.seed = seed;
  scenario.path.length = 10.0;
  scenario.path.stand_before = 2.0;
  scenario.max_duration = 6.0;
  return sim::simulate_flight(scenario);
}

std::unique_ptr<Odometry> make(const sim::Flight& flight, BackEnd backend) {
  Options options = experiment::options_for(flight, "default");
  options.backend = backend;
  return Odometry::create(options);
}

/// Bytes of an estimate.
std::string bytes_of(const Odometry& odometry) {
  const auto text = [](const auto& value) {
    return std::string(reinterpret_cast<const char*>(&value), sizeof value);
  };
  return text(odometry.now()) + text(odometry.at_scan()) + text(odometry.covariance());
}

/// Feeds a flight by stamps and returns all estimates.
std::vector<std::string> estimates(const sim::Flight& flight, BackEnd backend) {
  const std::unique_ptr<Odometry> odometry = make(flight, backend);
  std::vector<std::string> all;
  std::size_t next = 0;
  for (const ImuSample& sample : flight.imu) {
    (void)odometry->add_imu(sample);
    for (; next < flight.scans.size() && flight.scans[next].time < sample.time; ++next) {
      (void)odometry->add_scan(flight.scans[next]);
      all.push_back(bytes_of(*odometry));
    }
  }
  return all;
}

class TwoThreads : public testing::TestWithParam<BackEnd> {};

TEST_P(TwoThreads, FeedOneEstimatorUnderOneLock) {
  const sim::Flight flight = short_flight(1);
  const std::unique_ptr<Odometry> odometry = make(flight, GetParam());
  std::mutex mutex;
  std::atomic<std::size_t> samples{0};  // given; keeps the threads within 0.1 s of each other
  std::atomic<std::size_t> scans{0};
  std::atomic<bool> done{false};
  constexpr Time kApart{100'000'000};

  std::thread imu([&] {
    for (const ImuSample& sample : flight.imu) {
      const auto is_far = [&] {
        const std::size_t next = scans;
        return next < flight.scans.size() && sample.time - flight.scans[next].time > kApart;
      };
      while (is_far()) std::this_thread::yield();
      const std::lock_guard lock(mutex);
      (void)odometry->add_imu(sample);
      ++samples;
    }
  });
  std::thread radar([&] {
    for (const RadarScan& scan : flight.scans) {
      const auto is_far = [&] {
        const std::size_t next = samples;
        return next < flight.imu.size() && scan.time - flight.imu[next].time > kApart;
      };
      while (is_far()) std::this_thread::yield();
      const std::lock_guard lock(mutex);
      (void)odometry->add_scan(scan);
      ++scans;
    }
  });
  int reads = 0;
  std::thread reader([&] {
    Time last{0};
    while (!done) {
      NavState now;
      BodyCovariance covariance;
      bool initialized = false;
      {
        const std::lock_guard lock(mutex);
        now = odometry->now();
        covariance = odometry->covariance();
        initialized = odometry->initialized();
      }
      // the copies are whole, whatever the others do by now
      EXPECT_NEAR(now.q_WB.norm(), 1.0, 1e-12);
      EXPECT_EQ(covariance, covariance.transpose());
      EXPECT_GE(now.time, last);
      if (initialized) last = now.time;
      ++reads;
      std::this_thread::yield();
    }
  });
  imu.join();
  radar.join();
  done = true;
  reader.join();

  EXPECT_GT(reads, 0);
  EXPECT_EQ(odometry->now().time, flight.imu.back().time);
  const Counters& c = odometry->counters();
  EXPECT_EQ(c.imu_samples, flight.imu.size());
  EXPECT_EQ(c.scans + c.scans_uninitialized + c.scans_late, flight.scans.size());
  EXPECT_GT(c.scans, flight.scans.size() / 2);
  const NavState truth = flight.truth_at(odometry->at_scan().time);
  EXPECT_LT((odometry->at_scan().p_WB - truth.p_WB).norm(), 0.2);
}

TEST_P(TwoThreads, EstimatorsShareNothing) {
  const sim::Flight flights[] = {short_flight(2), short_flight(3)};
  std::vector<std::string> alone[2];
  std::vector<std::string> together[2];
  for (int i = 0; i < 2; ++i) alone[i] = estimates(flights[i], GetParam());
  std::thread other([&] { together[1] = estimates(flights[1], GetParam()); });
  together[0] = estimates(flights[0], GetParam());
  other.join();
  for (int i = 0; i < 2; ++i) {
    EXPECT_GT(alone[i].size(), 50U);
    EXPECT_TRUE(alone[i] == together[i]) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(BackEnds, TwoThreads, testing::Values(BackEnd::kEkf, BackEnd::kSmoother),
                         [](const auto& of) {
                           return of.param == BackEnd::kEkf ? "Filter" : "Smoother";
                         });

}  // namespace
}  // namespace rio
