// SPDX-License-Identifier: BSD-3-Clause
// Several radars on one body, through the odometry API, with either back-end. Their scans have the
// same stamps, which is the hardest case; the drives of test/e2e/recordings_test.cpp have them
// interleaved.
#include <algorithm>
#include <cmath>

#include "api/flying.hpp"
#include "rio/models/aids.hpp"
#include "support/measured.hpp"
#include "support/scanwise_flight.hpp"

namespace rio::test {
namespace {

using std::chrono::milliseconds;

const Pose kFirst = sim::default_radar_mount(0.3);
const std::vector<Pose> kFrontAndDown = sim::radar_mounts(kFirst, 2);
const std::vector<Pose> kAround = sim::radar_mounts(kFirst, 4);

/// The same flight as each radar sees it.
/// @param change of the scenario of radar r
std::vector<sim::Flight> flights(
    std::uint64_t seed, const std::vector<Pose>& mounts,
    const std::function<void(sim::Scenario&, std::size_t r)>& change = {}) {
  std::vector<sim::Flight> out;
  for (std::size_t r = 0; r < mounts.size(); ++r) {
    out.push_back(flight_of(seed, 25.0, 25.0, [&](sim::Scenario& o) {
      o.radar.T_BS = mounts[r];
      o.radar.max_static = 12;
      if (change) change(o, r);
    }));
  }
  return out;
}

/// One radar folds at 1.5 m/s; the other sees 6 m/s, in a third of the view, with twice the noise
/// and in coarse cells. The first of the two is radar 0.
std::vector<sim::Flight> flights_of_two_kinds(std::uint64_t seed, bool coarse_first) {
  return flights(seed, kFrontAndDown, [coarse_first](sim::Scenario& o, std::size_t r) {
    o.path.max_speed = 2.0;
    if ((r == 0) != coarse_first) return;
    o.radar.max_doppler = 6.0;
    o.radar.doppler_resolution = 6.0 / 16.0;
    o.radar.range_resolution *= 4.0;
    o.radar.fov_azimuth *= 0.33;
    o.radar.sigma_azimuth *= 2.0;
    o.radar.sigma_elevation *= 2.0;
    o.radar.sigma_doppler *= 2.0;
  });
}

class RadarsTest : public BackEndTest {
 protected:
  /// @param alike those of further radars are taken to be of the kind of the first
  static Options options(const std::vector<sim::Flight>& all, bool alike = false) {
    Options o = options_for(all.front());
    for (std::size_t r = 1; r < all.size(); ++r) {
      RadarMount other{all[r].configured_T_BS, 0.0, 0.0, {}};
      if (!alike) other.kind = options_for(all[r]).radar;
      EXPECT_TRUE(o.other_radars.push_back(other));
    }
    return o;
  }
  /// @param delays of the arrivals, by radar
  /// @param until radar 0 sends nothing from there on [s]
  Errors fly(const std::vector<sim::Flight>& all, std::vector<Time> delays = {}, double until = 1e9,
             bool alike = false) {
    const sim::Flight& flight = all.front();
    delays.resize(all.size(), Time{0});
    odometry = Odometry::create(options(all, alike));
    told.clear();
    odometry->on_scan([this] {
      told.push_back(odometry->report().radar);
      told_P = odometry->covariance();
    });
    std::vector<std::size_t> next(all.size(), 0);
    Errors out;
    for (const ImuSample& sample : flight.imu) {
      const std::size_t before = told.size();
      EXPECT_EQ(odometry->add_imu(sample), Status::kOk);
      for (std::size_t r = 0; r < all.size(); ++r) {
        const auto& scans = all[r].scans;
        for (; next[r] < scans.size() && scans[next[r]].time + delays[r] <= sample.time;
             ++next[r]) {
          const double t = to_seconds(scans[next[r]].time - flight.imu.front().time);
          if (r == 0 && t > until) continue;
          (void)odometry->add_scan(scans[next[r]], r);
        }
      }
      if (told.size() > before) {
        EXPECT_EQ(told_P, odometry->covariance());  // of the last one
      }
      out.add(*odometry, flight);
    }
    return out;
  }

  std::unique_ptr<Odometry> odometry;
  std::vector<std::size_t> told;  ///< the radar of each processed scan
  BodyCovariance told_P;          ///< at the last one
};

TEST_P(RadarsTest, MoreRadarsAreBetterThanOne) {
  double one = 0.0;
  double two = 0.0;
  double four = 0.0;
  double nees = 0.0;
  constexpr int kSeeds = 2;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const auto both = flights(seed, kFrontAndDown);
    one += fly({both.front()}).rms() / kSeeds;
    const Errors result = fly(both);
    two += result.rms() / kSeeds;
    nees += result.pose_nees / result.steps / kSeeds;
    EXPECT_EQ(odometry->counters().scans_late, 0U);
    EXPECT_EQ(odometry->counters().scans_duplicate, 0U);
    EXPECT_EQ(odometry->counters().updates_failed, 0U);
    four += fly(flights(seed, kAround)).rms() / kSeeds;
  }
  measured(name() + ", one radar: RMSE [m]", one, "");
  expect_below(name() + ", front and down: RMSE over that of one", two / one, 1.0);
  expect_below(name() + ", four around: RMSE over that of one", four / one, 1.0);
  expect_below(name() + ", front and down: NEES of the pose a dimension", nees, 2.0);
}

TEST_P(RadarsTest, OneOfThemFailsInFlight) {
  for (const auto& mounts : {kFrontAndDown, kAround}) {
    const auto all = flights(3, mounts);
    const Errors result = fly(all, {}, 10.0);
    EXPECT_LT(result.last, 0.3);
    EXPECT_LT(result.pose_nees / result.steps, 3.0);
    EXPECT_EQ(odometry->health().state, HealthState::kOk);
    EXPECT_TRUE(odometry->health().because(HealthReason::kOneRadarSilent));
    (void)fly(all);
    EXPECT_FALSE(odometry->health().because(HealthReason::kOneRadarSilent));
  }
}

TEST_P(RadarsTest, EveryProcessedScanIsToldAndTheOrderOfArrivalDoesNotMatter) {
  const auto both = flights(2, kFrontAndDown);
  fly(both, {milliseconds(80), milliseconds(60)});
  EXPECT_EQ(told.size(), odometry->counters().scans);
  const auto of_first = std::ranges::count(told, std::size_t{0});
  EXPECT_EQ(2 * static_cast<std::size_t>(of_first), told.size());
  const NavState first = odometry->at_scan();
  const std::uint64_t late = odometry->counters().scans_late;  // of before the start
  fly(both, {milliseconds(60), milliseconds(80)});
  EXPECT_LE(late, 4U);
  EXPECT_EQ(odometry->counters().scans_late, late);
  EXPECT_TRUE(same(first, odometry->at_scan()));
}

TEST_P(RadarsTest, EachHasItsOwnMounting) {
  const auto both = flights(4, kFrontAndDown,
                            [](sim::Scenario& o, std::size_t) { o.errors.extrinsic_angle = 0.05; });
  fly(both);
  EXPECT_EQ(odometry->radars(), both.size());
  for (std::size_t r = 0; r < both.size(); ++r) {
    const Pose& truth = both[r].scenario.radar.T_BS;
    const auto off = [&truth](const Pose& T) {
      return quaternion_log(truth.rotation.conjugate() * T.rotation).norm();
    };
    EXPECT_NEAR(off(both[r].configured_T_BS), 0.05, 1e-9);
    EXPECT_LT(off(odometry->extrinsics(r)), 0.02) << r;
  }
}

TEST_P(RadarsTest, TheyMayBeOfDifferentKinds) {
  for (const bool coarse_first : {false, true}) {
    double own = 0.0;
    double shared = 0.0;
    double nees = 0.0;
    constexpr int kSeeds = 3;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      const auto both = flights_of_two_kinds(seed, coarse_first);
      const Errors result = fly(both);
      own += result.rms() / kSeeds;
      nees += result.pose_nees / result.steps / kSeeds;
      EXPECT_EQ(odometry->health().state, HealthState::kOk);
      shared += fly(both, {}, 1e9, true).rms() / kSeeds;
    }
    const std::string which = name() + (coarse_first ? ", coarse radar first" : ", coarse second");
    expect_below(which + ": RMSE over that with the noise of the first for both", own / shared,
                 1.0);
    expect_below(which + ": NEES of the pose a dimension", nees, 2.0);
  }
}

TEST_P(RadarsTest, WhatIsRefused) {
  const auto both = flights(1, kFrontAndDown);
  Options o = options(both);
  o.start.static_alignment = false;
  odometry = Odometry::create(o);
  EXPECT_EQ(odometry->add_scan(both[0].scans[0], 2), Status::kUndeclared);
  EXPECT_EQ(odometry->add_scan(both[1].scans[0], 1), Status::kNotInitialized);
  ASSERT_EQ(odometry->reset(both[0].truth.front(), 1e-4 * BodyCovariance::Identity()), Status::kOk);
  EXPECT_EQ(odometry->add_scan(both[0].scans[0], 0), Status::kWaiting);
  EXPECT_EQ(odometry->add_scan(both[1].scans[0], 1), Status::kWaiting);  // of the same stamp
  EXPECT_EQ(odometry->add_scan(both[1].scans[0], 1), Status::kDuplicate);
  EXPECT_EQ(odometry->add_scan(both[0].scans[0], 0), Status::kDuplicate);
}

TEST_P(RadarsTest, AllocateNothing) {
  if (!AllocationGuard::kWorks) GTEST_SKIP() << "allocations are not counted under a sanitizer";
  const auto all = flights(1, kAround);
  odometry = fly_without_heap(all, options(all), nullptr);
  EXPECT_GT(odometry->counters().scans, 400U);
}

/// Trails and landmarks that the scans of each radar have matched.
template <class Estimator>
std::vector<int> matches(const std::vector<sim::Flight>& all, const Options& o,
                         const std::vector<std::size_t>& every) {
  ScanwiseFlight<Estimator> flight(all[0]);
  flight.begin(o);
  std::vector<int> sum(all.size(), 0);
  for (std::size_t i = 1; i + 1 < all[0].scans.size(); ++i) {
    for (std::size_t r = 0; r < all.size(); ++r) {
      if (i % every[r] != 0) continue;
      EXPECT_EQ(flight.process(all[r].scans[i], r), Status::kOk);
      sum[r] += flight.report().trails_matched + flight.report().landmarks_matched;
    }
  }
  return sum;
}

/// What process() reports of a scan of radar 1 before which `count` velocities were measured.
template <class Estimator>
UpdateReport report_after(const std::vector<sim::Flight>& both, const Options& o, int count) {
  ScanwiseFlight<Estimator> flight(both[0]);
  flight.begin(o);
  const NavState& start = both[0].truth.front();
  const auto next = [&start](const RadarScan& s) {
    return s.time > start.time + milliseconds(200);
  };
  const RadarScan& seen = *std::find_if(both[1].scans.begin(), both[1].scans.end(), next);
  for (int i = 0; i < count; ++i) {
    const WorldVelocityModel::Measurement z{start.v_WB, Matrix3d::Identity()};
    EXPECT_TRUE(flight.pipeline().add({start.time + milliseconds(1 + i), WorldVelocityModel{}, z}));
  }
  EXPECT_EQ(flight.process(seen, 1), Status::kOk);
  EXPECT_EQ(flight.report().time, seen.time);
  return flight.report();
}

// More measurements of another sensor than one update takes are updates of their own.
TEST_P(RadarsTest, TheReportIsThatOfTheScan) {
  const auto both = flights(1, kFrontAndDown);
  const int count = static_cast<int>(kMaxAiding) + 8;
  const UpdateReport report = GetParam() == BackEnd::kEkf
                                  ? report_after<Ekf>(both, options(both), count)
                                  : report_after<Smoother>(both, options(both), count);
  EXPECT_EQ(report.radar, 1U);
  const ModelReport& aiding = report.models[static_cast<std::size_t>(Model::kAiding)];
  EXPECT_EQ(aiding.rows_used + aiding.rows_gated, 3 * 8);
}

TEST_P(RadarsTest, EachMatchesItsTrails) {
  const auto all = flights(1, kAround);
  const auto of_all = [&](const std::vector<std::size_t>& every) {
    const Options o = options(all);
    return GetParam() == BackEnd::kEkf ? matches<Ekf>(all, o, every)
                                       : matches<Smoother>(all, o, every);
  };
  const std::vector<int> together = of_all({1, 1, 1, 1});
  const std::vector<int> slow = of_all({1, 1, 1, 4});  // at 5 Hz
  for (std::size_t r = 0; r < all.size(); ++r) {
    measured(name() + ", radar " + std::to_string(r) + " of four: matches", together[r], "");
    EXPECT_GT(together[r], 1000) << r;
    EXPECT_GT(slow[r], r == 3 ? 50 : 1000) << r;
  }
}

INSTANTIATE_TEST_SUITE_P(BackEnds, RadarsTest, kBothBackEnds, back_end_name);

}  // namespace
}  // namespace rio::test
