// SPDX-License-Identifier: BSD-3-Clause
// The arrangement for two threads of rio.hpp: one lock around all calls, or an estimator each.
#include <atomic>
#include <mutex>
#include <thread>

#include "api/flying.hpp"

namespace rio::test {
namespace {

/// After a shorter standstill than usual.
sim::Flight shortest_flight(std::uint64_t seed) {
  return flight_of(seed, 10.0, 6.0, [](sim::Scenario& o) { o.path.stand_before = 2.0; });
}

/// Bytes of an estimate.
std::string bytes_of(const Odometry& odometry) {
  const auto text = [](const auto& value) {
    return std::string(reinterpret_cast<const char*>(&value), sizeof value);
  };
  return text(odometry.now()) + text(odometry.at_scan()) + text(odometry.covariance());
}

/// All estimates of a flight.
std::vector<std::string> estimates(const sim::Flight& flight, const Options& options) {
  const std::unique_ptr<Odometry> odometry = Odometry::create(options);
  std::vector<std::string> all;
  (void)experiment::replay(flight, *odometry, [&](const UpdateReport& /*report*/) {
    all.push_back(bytes_of(*odometry));
  });
  return all;
}

class TwoThreads : public BackEndTest {};

TEST_P(TwoThreads, FeedOneEstimatorUnderOneLock) {
  const sim::Flight flight = shortest_flight(1);
  const std::unique_ptr<Odometry> odometry = Odometry::create(options_for(flight));
  std::mutex mutex;
  std::atomic<std::size_t> samples{0};  // given; keeps the threads within 0.1 s of each other
  std::atomic<std::size_t> scans{0};
  std::atomic<bool> done{false};
  constexpr Time kApart{100'000'000};

  const auto give = [&](const auto& mine, auto* given, const auto& others, const auto& others_given,
                        const auto& add) {
    for (const auto& data : mine) {
      const auto is_far = [&] {
        const std::size_t next = others_given;
        return next < others.size() && data.time - others[next].time > kApart;
      };
      while (is_far()) std::this_thread::yield();
      const std::lock_guard lock(mutex);
      add(data);
      ++*given;
    }
  };
  std::atomic<int> reads{0};
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
  while (reads == 0) std::this_thread::yield();  // it reads while the others write
  std::thread imu([&] {
    give(flight.imu, &samples, flight.scans, scans,
         [&](const ImuSample& sample) { (void)odometry->add_imu(sample); });
  });
  std::thread radar([&] {
    give(flight.scans, &scans, flight.imu, samples,
         [&](const RadarScan& scan) { (void)odometry->add_scan(scan); });
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
  const sim::Flight flights[] = {shortest_flight(2), shortest_flight(3)};
  std::vector<std::string> alone[2];
  std::vector<std::string> together[2];
  const auto fly = [&](int i) { return estimates(flights[i], options_for(flights[i])); };
  for (int i = 0; i < 2; ++i) alone[i] = fly(i);
  std::thread other([&] { together[1] = fly(1); });
  together[0] = fly(0);
  other.join();
  for (int i = 0; i < 2; ++i) {
    EXPECT_GT(alone[i].size(), 50U);
    EXPECT_TRUE(alone[i] == together[i]) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(BackEnds, TwoThreads, kBothBackEnds, back_end_name);

}  // namespace
}  // namespace rio::test
