// SPDX-License-Identifier: BSD-3-Clause
#include "rio/checks/velocity_check.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <utility>

#include "support/random_state.hpp"
#include "support/seen_vehicle.hpp"

namespace rio {
namespace {

using std::chrono::milliseconds;

class VelocityCheckTest : public testing::Test {
 protected:
  VelocityCheckTest() {
    options_.radar.max_doppler = kLimit;
    options_.radar.T_BS.translation = Vector3d(0.1, 0.05, -0.1);
    restart();
  }

  void restart() {
    check_.emplace(options_);
    vehicle_.emplace(options_, v_, &random_);
    check_->reset(vehicle_->truth.time);
  }

  /// One scan later. The estimate is the truth, but for its velocity.
  std::optional<IndependentVelocity> step(const Vector3d& wrong_W, double sigma, int points,
                                          int others = 0, const Vector3d& u_W = Vector3d::Zero()) {
    return step_of(0, points, others, u_W, sigma, [&](Estimate& x) { x.nav.v_WB += wrong_W; });
  }
  /// The same of a radar; the estimate is the truth, changed by `wrong`.
  template <class Wrong>
  std::optional<IndependentVelocity> step_of(std::size_t radar, int points, int others,
                                             const Vector3d& u_W, double sigma, Wrong&& wrong) {
    const Time last = vehicle_->truth.time;
    vehicle_->advance();
    Estimate x = vehicle_->estimate();
    wrong(x);
    check_->carry(x, last, vehicle_->imu(), std::exchange(paused_, false));
    DetectionList scan = vehicle_->scan_of(radar, points, others, u_W);
    for (Detection& d : scan.items) {
      if (!blurred_) continue;
      d.direction_S +=
          random_.normal() * d.sigma_azimuth_S + random_.normal() * d.sigma_elevation_S;
      d.direction_S.normalize();
    }
    return check_->observe(scan, x, sigma, 0.002, at_rest_);
  }

  /// Scans until there is a verdict, at most `count`; the seconds that took, negative if none came.
  double seconds_to_verdict(const Vector3d& wrong_W, double sigma, int points, int count = 30) {
    for (int i = 1; i <= count; ++i) {
      const auto other = step(wrong_W, sigma, points);
      if (!other) continue;
      const Vector3d e = other->v_B - vehicle_->truth.q_WB.conjugate() * vehicle_->truth.v_WB;
      EXPECT_LT(e.norm(), v_.norm() > 8.0 ? 0.1 * v_.norm() : 0.4);  // by directions 0.1 rad off
      EXPECT_LT(e.dot(other->covariance.inverse() * e), 20.0);
      return i * 0.066;
    }
    return -1.0;
  }

  /// From an estimate that is wrong by so much.
  void find_in_a_second(double speed, double wrong, int points) {
    v_ = speed * random_.direction();
    restart();
    const double time = seconds_to_verdict(wrong * random_.direction(), 0.05, points);
    EXPECT_GT(time, 0.0);
    EXPECT_LT(time, 1.0);
  }

  /// So many scans without a verdict.
  void expect_none(int scans, const Vector3d& wrong_W, int points, int others = 0,
                   const Vector3d& u_W = Vector3d::Zero()) {
    for (int i = 0; i < scans; ++i) {
      EXPECT_FALSE(step(wrong_W, 0.05, points, others, u_W)) << points << " " << i;
    }
  }

  /// Mean share by chance over 60 scans of so many points of the world and others of random
  /// Doppler, once a second of them is there.
  double mean_chance(int points, int others) {
    restart();
    double sum = 0.0;
    for (int i = -15; i < 60; ++i) {
      step(kNone, 0.02, points, others, 1e3 * random_.direction());
      if (i >= 0) sum += check_->chance() / 60.0;
    }
    return sum;
  }

  static constexpr double kLimit = 2.6;  // [m/s]
  const Vector3d kNone = Vector3d::Zero();

  test::Random random_{11};
  Options options_;
  Vector3d v_{0.4, -0.3, 0.1};
  bool paused_ = false;   ///< the IMU, before the next scan
  bool at_rest_ = false;  ///< by the rest detector
  bool blurred_ = false;  ///< the directions of the points have errors, too
  std::optional<VelocityCheck> check_;
  std::optional<test::SeenVehicle> vehicle_;
};

TEST_F(VelocityCheckTest, FindsTheVelocityInASecondWithAFewPointsAScan) {
  for (const int points : {3, 4, 6, 20}) {
    for (const double wrong : {2.0, 10.0}) {
      for (const double sigma : {0.05, 3.0}) {
        restart();
        const Vector3d error = wrong * random_.direction();
        const double time = seconds_to_verdict(error, sigma, points);
        // an error that the covariance admits, in a fold of its own, is for the update
        if (DopplerFold(kLimit).is_unique(sigma * sigma) && wrong < 3.0 * sigma) continue;
        EXPECT_GT(time, 0.0) << points << " points, " << wrong << " m/s wrong, sigma " << sigma;
        EXPECT_LT(time, 1.0) << points << " points, " << wrong << " m/s wrong, sigma " << sigma;
      }
    }
  }
}

// At 6 m/s the errors of the directions leave 0.2 m/s in a Doppler: the velocities of triples
// are up to a metre a second apart, at 10 m/s more, and still one: none of them is a rival of the
// best.
TEST_F(VelocityCheckTest, FastTheTriplesScatterAndAreNoRivals) {
  blurred_ = true;
  for (const double limit : {kLimit, 5.0, 0.0}) {  // 0: no folds
    options_.radar.max_doppler = limit;
    for (int run = 0; run < 20; ++run) find_in_a_second(run % 2 == 0 ? 6.0 : 10.0, 3.0, 6);
  }
}

// At 28 m/s the errors of the directions explain any Doppler that folds. That is no support.
TEST_F(VelocityCheckTest, AVelocityThatExplainsAnythingIsContradicted) {
  for (const int points : {3, 20}) find_in_a_second(0.5, 28.0, points);
}

// At 7 m/s most Dopplers are folded once, to either side, and an estimate that is wrong by more
// than a fold does not tell to which.
TEST_F(VelocityCheckTest, FindsTheFoldsWithoutTheEstimate) {
  for (int run = 0; run < 30; ++run) find_in_a_second(7.0, 10.0, 3);
}

// Three points a scan, of a radar that does not fold and, three times as often, of one that does.
TEST_F(VelocityCheckTest, EachRadarHasItsOwnFold) {
  options_.other_radars.push_back({options_.radar.T_BS, 0.0, 0.0, options_.radar});
  options_.radar.max_doppler = 0.0;
  for (const double wrong : {0.0, 4.0}) {
    restart();
    vehicle_->truth.v_WB = vehicle_->truth.q_WB * Vector3d(4.0, 0.3, 0.0);  // beyond that limit
    const Vector3d error = wrong * random_.direction();
    std::optional<IndependentVelocity> other;
    for (std::size_t i = 0; i < 30 && !other; ++i) {
      other =
          step_of(i % 4 == 0 ? 0 : 1, 3, 0, kNone, 0.05, [&](Estimate& x) { x.nav.v_WB += error; });
    }
    ASSERT_EQ(other.has_value(), wrong > 0.0);
    if (wrong == 0.0) {
      EXPECT_GT(check_->record().agreed(), vehicle_->truth.time - milliseconds(200));
      continue;
    }
    const Vector3d v_B = vehicle_->truth.q_WB.conjugate() * vehicle_->truth.v_WB;
    EXPECT_LT((other->v_B - v_B).norm(), 0.4);
  }
}

TEST_F(VelocityCheckTest, ARightVelocityIsNeverContradicted) {
  for (const int points : {1, 3, 6, 20}) {
    restart();
    for (int i = 0; i < 300; ++i) {
      if (i % 30 == 0) {  // back and forth
        vehicle_->acceleration = random_.normal_vector(0.3) - 0.5 * vehicle_->truth.v_WB;
        vehicle_->rate = random_.normal_vector(0.3);
      }
      EXPECT_FALSE(step(random_.normal_vector(0.05), 0.1, points)) << points << " " << i;
    }
    if (points >= 3) {
      EXPECT_GT(check_->record().agreed(), vehicle_->truth.time - milliseconds(500)) << points;
    }
  }
}

// A person in front of a standing radar gives most of a few points. Their velocity is no other one
// of the radar's: it was proven right, and they do not stay.
TEST_F(VelocityCheckTest, APersonWhoFillsTheViewForSecondsIsNoVelocity) {
  v_.setZero();
  restart();
  vehicle_->rate.setZero();
  vehicle_->acceleration.setZero();
  expect_none(45, kNone, 6);
  expect_none(45, kNone, 1, 5, Vector3d(1.0, 0.5, 0.0));
  expect_none(45, kNone, 6);
}

// A vehicle stops while the estimate, that was right before, goes on.
TEST_F(VelocityCheckTest, AtRestAProvenVelocityIsContradictedInASecond) {
  v_.setZero();
  const Vector3d wrong(0.4, 0.0, 0.0);
  for (const bool at_rest : {false, true}) {
    at_rest_ = at_rest;
    restart();
    vehicle_->rate.setZero();
    vehicle_->acceleration.setZero();
    expect_none(45, kNone, 6);
    EXPECT_EQ(seconds_to_verdict(wrong, 0.05, 6, 20) > 0.0, at_rest);
  }
}

// A pause of the IMU ends the proof and leaves no Dopplers: a scan after it, however dense and for
// however long another velocity was seen before it, is no verdict, a quarter of a second of scans
// is.
TEST_F(VelocityCheckTest, OneScanAfterAPauseIsNoVerdict) {
  constexpr int kDense = 23;  // enough rows in one scan
  const Vector3d wrong = 2.0 * random_.direction();
  expect_none(45, kNone, kDense);
  expect_none(15, wrong, kDense);
  paused_ = true;
  expect_none(4, wrong, kDense);
  EXPECT_TRUE(step(wrong, 0.05, kDense));
}

// Until the patience ends it says by how much it contradicts.
TEST_F(VelocityCheckTest, AContradictionHasASize) {
  const Vector3d wrong = 0.8 * random_.direction();
  for (int i = 0; i < 45; ++i) {
    (void)step(kNone, 0.05, 20);
    EXPECT_EQ(check_->contradiction(), 0.0);
  }
  for (int i = 0; i < 45; ++i) {
    (void)step(wrong, 0.05, 20);
    if (i < 15) continue;
    EXPECT_NEAR(check_->contradiction(), 0.8, 0.1) << i;
  }
  for (int i = 0; i < 15; ++i) (void)step(kNone, 0.05, 20);
  EXPECT_EQ(check_->contradiction(), 0.0);
  restart();
  for (int i = 0; i < 75; ++i) (void)step(i < 45 ? kNone : wrong, 0.05, 20);
  EXPECT_NEAR(check_->contradiction(), 0.8, 0.1);
  check_->reset(vehicle_->truth.time);
  EXPECT_EQ(check_->contradiction(), 0.0);
}

// Of five points a scan three move, each in another direction.
TEST_F(VelocityCheckTest, OutliersAreNoVerdict) {
  for (int i = 0; i < 150; ++i) {
    expect_none(1, kNone, 2);
    for (int k = 0; k < 3; ++k) expect_none(1, kNone, 0, 1, random_.normal_vector(2.0));
  }
}

// Less than what agrees at once, more than any other velocity has: the one believed stays right,
// also where Dopplers do not fold.
TEST_F(VelocityCheckTest, AThirdOfOutliersLeavesTheVelocitySupported) {
  for (const double limit : {kLimit, 0.0}) {
    options_.radar.max_doppler = limit;
    restart();
    for (int i = 0; i < 60; ++i) {
      expect_none(1, kNone, 4);
      for (int k = 0; k < 2; ++k) expect_none(1, kNone, 0, 1, random_.normal_vector(2.0));
    }
    EXPECT_GT(check_->record().agreed(), vehicle_->truth.time - milliseconds(200)) << limit;
  }
}

// Bounds are 0.2 to 0.4 m/s, of +-2.6 m/s: a random Doppler is inside with 0.08 to 0.15.
TEST_F(VelocityCheckTest, TheShareByChanceIsThatOfRandomDopplers) {
  EXPECT_LT(mean_chance(6, 0), 0.01);
  const double half = mean_chance(5, 5);  // 0.08 of 1.08 to 0.15 of 1.15
  EXPECT_GT(half, 0.07);
  EXPECT_LT(half, 0.13);
  EXPECT_GT(mean_chance(1, 9), 0.4);
  EXPECT_GT(mean_chance(0, 10), 0.8);
  options_.radar.max_doppler = 0.8;  // beside the bounds are 0.5 m/s, not the pace of people
  EXPECT_GT(mean_chance(0, 10), 0.8);
  EXPECT_LT(mean_chance(6, 0), 0.01);
  check_->reset(vehicle_->truth.time);
  EXPECT_EQ(check_->chance(), 0.0);
}

// What the covariance of the velocity admits is no outlier.
TEST_F(VelocityCheckTest, AWrongVelocityWithAnHonestSigmaIsNoChance) {
  const Vector3d wrong = random_.direction();
  for (const double sigma : {0.02, 0.5}) {
    restart();
    for (int i = 0; i < 4; ++i) step(wrong, sigma, 6);
    if (sigma > 0.1) {
      EXPECT_EQ(check_->chance(), 0.0);
    } else {
      EXPECT_GT(check_->chance(), 0.3);
    }
  }
}

TEST_F(VelocityCheckTest, CanBeSwitchedOff) {
  options_.checks.velocity = false;
  restart();
  expect_none(30, Vector3d(2.0, 1.0, 0.0), 6);
}

// A Doppler scale that is not zero has divided the range rates, and where they fold.
TEST_F(VelocityCheckTest, FoldsWhereTheDividedRangeRatesDo) {
  constexpr double kScale = 0.1;
  Options corrected = options_;
  corrected.radar.max_doppler = kLimit / (1.0 + kScale);
  vehicle_.emplace(corrected, Vector3d(8.0, 0.5, 0.0), &random_);
  check_->reset(vehicle_->truth.time);
  for (int i = 0; i < 40; ++i) {
    EXPECT_FALSE(step_of(0, 20, 0, kNone, 0.05, [](Estimate& x) { x.doppler_scale = kScale; }))
        << i;
    EXPECT_EQ(check_->contradiction(), 0.0) << i;
  }
}

}  // namespace
}  // namespace rio
