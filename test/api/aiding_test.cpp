// SPDX-License-Identifier: BSD-3-Clause
// Other sensors beside the radar, through the odometry API, with either back-end.
#include <algorithm>
#include <cmath>

#include "api/aided.hpp"
#include "rio/models/aids.hpp"
#include "support/temp_dir.hpp"

namespace rio::test {
namespace {

/// A barometer whose offset is 0.7 m and drifts.
struct Barometer {
  double offset = 0.7;
  double walk = 0.02;  // [m/sqrt(s)]
  double sigma = 0.15;
  void operator()(Odometry& o, const NavState& x, sim::Random& random) {
    offset += walk * std::sqrt(0.04) * random.normal();
    const double height = x.p_WB.z() + offset + sigma * random.normal();
    EXPECT_EQ(o.add_measurement({x.time, HeightModel{}, {height, sigma}}), Status::kWaiting);
  }
};

class AidingTest : public AidedTest {
 protected:
  static Options options_with_offset(double sigma = HeightOffset::kSigma,
                                     double walk = HeightOffset::kWalk) {
    Options o = options();
    EXPECT_TRUE(o.auxiliary.declare<HeightOffset>(sigma, walk));
    return o;
  }
  /// The offset is known, and as well as its sigma says.
  void expect_found(const Barometer& barometer) const {
    const auto offset = auxiliary<HeightOffset>(*odometry).value();
    const double sigma = std::sqrt(offset.covariance(0, 0));
    EXPECT_LT(sigma, 0.3 * HeightOffset::kSigma);
    EXPECT_LT(std::abs(offset.value[0] - barometer.offset), 3.0 * sigma);
  }
};

TEST_P(AidingTest, ABarometerWithItsOffset) {
  const Errors alone = fly(options(), kNone);
  Barometer barometer;
  const Errors aided = fly(options_with_offset(), std::ref(barometer));
  expect_found(barometer);
  EXPECT_GT(rows, 500.0);
  expect_consistent();
  EXPECT_LT(gated, 0.02 * rows);
  expect_below("barometer, " + name() + ": height RMS over that without",
               aided.rms_height() / alone.rms_height(), 1.05);
}

// What left the window long ago is still known.
TEST_P(AidingTest, ABarometerThatFellSilentIsRemembered) {
  Barometer barometer;
  fly(options_with_offset(), [&](Odometry& odo, const NavState& x, sim::Random& random) {
    if (x.time < start() + 15s) barometer(odo, x, random);
  });
  expect_found(barometer);
}

// Its variance grows by its random walk, through the window and out of it; nothing else changes.
TEST_P(AidingTest, AStateThatNothingMeasuresOnlyWalks) {
  constexpr double kSigma = 0.5;
  constexpr double kWalk = 0.2;  // [m/sqrt(s)]
  const Errors without = fly(options(), kNone);
  const Vector3d end = odometry->at_scan().p_WB;
  const Errors with = fly(options_with_offset(kSigma, kWalk), kNone);
  EXPECT_EQ(with.steps, without.steps);
  EXPECT_LT((odometry->at_scan().p_WB - end).norm(), 1e-6);
  const auto offset = auxiliary<HeightOffset>(*odometry).value();
  EXPECT_EQ(offset.value[0], 0.0);
  const double expected =
      kSigma * kSigma + kWalk * kWalk * to_seconds(flight().imu.back().time - start());
  EXPECT_NEAR(offset.covariance(0, 0) / expected, 1.0, 0.1);
}

int absurd = 0;  // of the positions below

/// Positions of motion capture or GNSS, some of them absurd.
const Aids kPosition = [](Odometry& o, const NavState& x, sim::Random& random) {
  constexpr double kSigma = 0.1;
  PositionModel::Measurement z;
  z.lever_B = {0.1, 0.0, 0.2};
  z.covariance_W = kSigma * kSigma * Matrix3d::Identity();
  z.p_W = x.p_WB + x.q_WB * z.lever_B + kSigma * random.normal3();
  if (random.uniform(0.0, 1.0) < 0.05) {
    z.p_W.x() += 20.0;
    ++absurd;
  }
  EXPECT_EQ(o.add_measurement({x.time, PositionModel{}, z}), Status::kWaiting);
};

TEST_P(AidingTest, PositionBoundsTheErrorAndAbsurdOnesAreGated) {
  absurd = 0;
  const Errors aided = fly(options(), kPosition, 200ms);
  EXPECT_LT(aided.rms(), 0.08);
  expect_consistent();
  EXPECT_GT(absurd, 5);
  EXPECT_GE(gated, absurd - 1);  // the last one may wait
  EXPECT_LE(gated, absurd + 0.03 * rows / 3.0);
  EXPECT_LT(aided.position_nees / aided.steps, 2.5);
}

TEST_P(AidingTest, AnAidIsLostAndComesBack) {
  const Aids with_a_loss = [&](Odometry& o, const NavState& x, sim::Random& random) {
    if (x.time < start() + 15s || x.time > start() + 35s) kPosition(o, x, random);
  };
  const Errors aided = fly(options(), with_a_loss, 200ms);
  EXPECT_LT(aided.last, 0.2);
  EXPECT_LT(aided.rms(), 0.2);
}

TEST_P(AidingTest, HeadingAndVelocity) {
  const Aids aids = [](Odometry& o, const NavState& x, sim::Random& random) {
    const Matrix3d R = x.q_WB.toRotationMatrix();
    const double heading = std::atan2(R(1, 0), R(0, 0)) + 0.005 * random.normal();
    EXPECT_EQ(o.add_measurement({x.time, HeadingModel{}, {heading, 0.005}}), Status::kWaiting);
    const Matrix3d covariance = 4e-4 * Matrix3d::Identity();
    const BodyVelocityModel::Measurement v{
        .v_B = x.q_WB.conjugate() * x.v_WB + 0.02 * random.normal3(), .covariance_B = covariance};
    EXPECT_EQ(o.add_measurement({x.time, BodyVelocityModel{}, v}), Status::kWaiting);
    const WorldVelocityModel::Measurement w{x.v_WB + 0.02 * random.normal3(), covariance};
    EXPECT_EQ(o.add_measurement({x.time, WorldVelocityModel{}, w}), Status::kWaiting);
  };
  const Errors alone = fly(options(), kNone);
  const Errors aided = fly(options(), aids, 100ms);
  EXPECT_LT(aided.rms(), alone.rms());
  expect_consistent();
  const NavState& x = odometry->at_scan();
  EXPECT_LT(flight().truth_at(x.time).q_WB.angularDistance(x.q_WB), 0.01);
}

TEST_P(AidingTest, WhileTheRadarIsSilentTheyCountAlone) {
  double worst = 0.0;  // in the silence
  const auto watched = [&worst](const Aids& aids) -> Aids {
    worst = 0.0;
    return [&worst, aids](Odometry& o, const NavState& x, sim::Random& random) {
      aids(o, x, random);
      if (x.time < start() + 21s || x.time > start() + 40s) return;
      const NavState& at = o.at_scan();
      worst = std::max(worst, (at.p_WB - flight().truth_at(at.time).p_WB).norm());
    };
  };
  const Errors blind = fly(options(), watched(kNone), 200ms, 0s, {20.0, 40.0});
  const double alone = worst;
  const Errors aided = fly(options(), watched(kPosition), 200ms, 0s, {20.0, 40.0});
  EXPECT_LT(worst, 0.2);
  EXPECT_GT(alone, 5.0 * worst);
  EXPECT_LT(aided.rms(), 0.1);
  EXPECT_GT(blind.rms(), aided.rms());
  EXPECT_EQ(odometry->counters().updates_failed, 0U);
}

TEST_P(AidingTest, LateOnesGoWhereTheyBelong) {
  Options o = options();
  const Errors in_time = fly(o, kPosition, 200ms);
  const Aids late_ones = [](Odometry& odo, const NavState& x, sim::Random&) {
    const Status status = odo.add_measurement({x.time, PositionModel{}, {.p_W = x.p_WB}});
    EXPECT_EQ(status, x.time < odo.at_scan().time ? Status::kLate : Status::kWaiting);
  };
  fly(o, late_ones, 200ms, 300ms);
  EXPECT_GT(odometry->counters().aiding_late, 100U);
  o.timing.aiding_delay = 0.5;
  EXPECT_LT(fly(o, kPosition, 200ms, 300ms).rms(), 1.3 * in_time.rms());
  EXPECT_EQ(odometry->counters().aiding_late, 0U);
  expect_consistent();
}

TEST_P(AidingTest, WhatIsRefusedSaysWhy) {
  Options o = options();
  o.auxiliary.declare<HeightOffset>();
  odometry = Odometry::create(o);
  EXPECT_EQ(odometry->add_measurement({Time{0}, HeightModel{}, {1.0, 1.0}}),
            Status::kNotInitialized);
  EXPECT_FALSE(auxiliary<HeightOffset>(*odometry));
  o = options();
  o.start.static_alignment = false;
  odometry = Odometry::create(o);
  ASSERT_EQ(odometry->reset(flight().truth.front(), 1e-4 * BodyCovariance::Identity()),
            Status::kOk);
  const Time now = odometry->at_scan().time;
  EXPECT_EQ(odometry->add_measurement({now, HeightModel{}, {1.0, 1.0}}), Status::kUndeclared);
  EXPECT_FALSE(auxiliary<HeightOffset>(*odometry));
  AuxiliaryState of_another = auxiliary_state<HeightOffset>();
  of_another.size = 3;  // the same name
  ASSERT_TRUE(o.auxiliary.declare(of_another));
  EXPECT_FALSE(AidingMeasurement(now, HeightModel{}, {1.0, 1.0}).is_declared(o.auxiliary));
  const auto with_three = Odometry::create(o);
  ASSERT_EQ(with_three->reset(flight().truth.front(), 1e-4 * BodyCovariance::Identity()),
            Status::kOk);
  EXPECT_FALSE(auxiliary<HeightOffset>(*with_three));  // nor is anything written
  const AidingMeasurement no_such_radar(now, PositionModel{}, {}, o.radars());
  EXPECT_EQ(odometry->add_measurement(no_such_radar), Status::kUndeclared);
  const auto position_at = [this](Time time) {
    return odometry->add_measurement({time, PositionModel{}, {}});
  };
  EXPECT_EQ(position_at(now - 1ms), Status::kLate);
  EXPECT_EQ(position_at(now + 1h), Status::kAhead);
  EXPECT_EQ(position_at(Time::max()), Status::kAhead);
  EXPECT_EQ(position_at(Time::min()), Status::kLate);
  for (int i = 0; i < 256; ++i) EXPECT_EQ(position_at(now + 1ms), Status::kWaiting);
  EXPECT_EQ(position_at(now + 1ms), Status::kQueueFull);
  EXPECT_EQ(odometry->counters().aiding, 256U);
  EXPECT_EQ(odometry->counters().aiding_late, 2U);
  EXPECT_EQ(odometry->counters().aiding_ahead, 2U);
  EXPECT_EQ(odometry->counters().aiding_overflow, 1U);
}

// As users of Eigen write it: symmetric, positive definite, sigmas positive.
TEST_P(AidingTest, ANoiseThatIsNoneIsRefused) {
  Options o = options();
  o.start.static_alignment = false;
  ASSERT_TRUE(o.auxiliary.declare<HeightOffset>());
  ASSERT_TRUE(o.auxiliary.declare<GroundHeight>());
  odometry = Odometry::create(o);
  ASSERT_EQ(odometry->reset(flight().truth.front(), 1e-4 * BodyCovariance::Identity()),
            Status::kOk);
  const Time now = odometry->at_scan().time + 1ms;
  const auto with = [&](const Matrix3d& R) {
    const Status status = odometry->add_measurement({now, PositionModel{}, {.covariance_W = R}});
    EXPECT_EQ(odometry->add_measurement({now, BodyVelocityModel{}, {.covariance_B = R}}), status);
    EXPECT_EQ(odometry->add_measurement({now, WorldVelocityModel{}, {.covariance_W = R}}), status);
    return status;
  };
  const auto with_sigma = [&](double sigma) {
    const Status status = odometry->add_measurement({now, HeightModel{}, {0.0, sigma}});
    EXPECT_EQ(odometry->add_measurement({now, HeadingModel{}, {0.0, sigma}}), status);
    EXPECT_EQ(odometry->add_measurement({now, GroundRangeModel{}, {1.0, sigma}}), status);
    return status;
  };
  Matrix3d R;
  R << 4e-4, 1e-4, 0.0, 1e-4, 9e-4, 0.0, 0.0, 0.0, 1e-2;
  EXPECT_EQ(with(R), Status::kWaiting);
  R(0, 1) *= 1.0 + 1e-12;  // rounding
  EXPECT_EQ(with(R), Status::kWaiting);
  EXPECT_EQ(with_sigma(0.1), Status::kWaiting);
  EXPECT_EQ(odometry->counters().aiding, 9U);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const double upper : {0.0, -1e-4, 1.1e-4, kNan}) {
    EXPECT_EQ(with((R(0, 1) = upper, R)), Status::kNumerical) << upper;
  }
  for (const double variance : {-1e-2, 0.0, kNan}) {
    EXPECT_EQ(with(Vector3d(1e-2, 1e-2, variance).asDiagonal()), Status::kNumerical) << variance;
    EXPECT_EQ(with_sigma(variance), Status::kNumerical) << variance;
  }
  EXPECT_EQ(odometry->counters().aiding, 9U);
}

TEST_P(AidingTest, AStateBeginsAtItsInitialValue) {
  Barometer barometer{.offset = 40.0};  // twenty sigmas from zero
  Options o = options();
  ASSERT_TRUE(o.auxiliary.declare_at<HeightOffset>(HeightOffset::Value(41.0), 2.0));
  fly(o, std::ref(barometer));
  EXPECT_NEAR(auxiliary<HeightOffset>(*odometry)->value[0], barometer.offset, 0.5);
  EXPECT_LT(gated, 0.02 * rows);
  EXPECT_FALSE(odometry->health().because(HealthReason::kAiding));
}

// A barometer that jumps by 50 m is rejected, and the health says so until ten seconds after.
TEST_P(AidingTest, RejectedMeasurementsAreAReasonOfTheHealth) {
  Barometer barometer;
  const Time from = start() + 10s;
  bool before = false, during = false;
  fly(options_with_offset(), [&](Odometry& odo, const NavState& x, sim::Random& random) {
    if (x.time > from + 5s) return;
    if (x.time >= from) barometer.offset = 50.0;
    const bool now = odo.health().because(HealthReason::kAiding);
    (x.time < from ? before : during) |= now;
    EXPECT_TRUE(!now || odo.health().position >= HealthState::kDegraded);
    barometer(odo, x, random);
  });
  EXPECT_FALSE(before);
  EXPECT_TRUE(during);
  EXPECT_FALSE(odometry->health().because(HealthReason::kAiding));
}

TEST_P(AidingTest, OptionsOfAStateAreChecked) {
  const auto refused = [](const std::string& part, void (*change)(AuxiliaryState&)) {
    AuxiliaryState state = auxiliary_state<HeightOffset>();
    change(state);
    Options o = options();
    ASSERT_TRUE(o.auxiliary.declare(state));
    EXPECT_ERROR(experiment::create_odometry(o), part);
  };
  refused("initial value not finite", [](AuxiliaryState& s) { s.initial[0] = NAN; });
  refused("height_offset", [](AuxiliaryState& s) { s.sigma = -1.0; });
  refused("sigma or walk out of range", [](AuxiliaryState& s) { s.sigma = 2e6; });
  refused("sigma or walk out of range", [](AuxiliaryState& s) { s.walk = 1e200; });
  refused("delayed, and with a random walk", [](AuxiliaryState& s) { s.delayed = true; });
  refused("size out of range", [](AuxiliaryState& s) { s.size = 0; });
}

TEST_P(AidingTest, AllocatesNothing) {
  if (!AllocationGuard::kWorks) GTEST_SKIP() << "allocations are not counted under a sanitizer";
  Options o = options_with_offset();
  o.timing.aiding_delay = 0.2;
  odometry = fly_without_heap({flight()}, o, nullptr, [](Odometry& odo, Time time) {
    for (int i = 20; i < 30; ++i) {
      (void)odo.add_measurement({time - 5ms * i, HeightModel{}, {1.0, 1.0}});
    }
  });
  EXPECT_GT(odometry->counters().aiding, 1000U);
}

INSTANTIATE_TEST_SUITE_P(BackEnds, AidingTest, kBothBackEnds, back_end_name);

}  // namespace
}  // namespace rio::test
