// SPDX-License-Identifier: BSD-3-Clause
// The input contract of the odometry API, with either back-end: data that break it are counted,
// what is promised of faults is kept, and which starts are taken.
#include <gtest/gtest.h>

#include <array>
#include <cfenv>
#include <cmath>
#include <functional>

#include "api/flying.hpp"
#include "experiment/survival.hpp"
#include "support/measured.hpp"

namespace rio::test {
namespace {

using experiment::Event;
using experiment::Fault;
using experiment::fault_named;
using experiment::Stream;
using experiment::Survival;
using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr double kBegin = 8.0;   // of a fault, in flight [s]
constexpr double kAfter = 16.0;  // it is judged [s]

/// A fault of the catalogue, and which counters tell of it.
struct Told {
  const char* fault;
  std::vector<std::uint64_t Counters::*> counters{};
  std::uint64_t times = 0;  ///< at least, each of them
  bool kept = true;         ///< the promise of the catalogue
};

using C = Counters;
const Told kTold[] = {
    {"none", {&C::scans}, 100},
    {"one IMU stamp +1 h", {&C::imu_ahead}, 1},
    {"one IMU stamp +10 s", {&C::imu_ahead}, 1},
    {"one IMU stamp -1 h", {&C::imu_stale}, 1},
    {"IMU stamps at both ends of time", {&C::imu_ahead, &C::imu_stale}, 1},
    {"ten IMU stamps +1 h in a row", {&C::imu_ahead}, 10},
    {"scan stamps at both ends of time", {&C::scans_late, &C::scans_ahead}, 1},
    {"nine scan stamps +1 h", {&C::radar_clock_steps}, 2},
    {"the radar's clock late by 0.3 s", {&C::radar_clock_steps}, 1},
    {"the radar's clock early by 0.3 s", {&C::radar_clock_steps}, 1},
    {"the radar's clock starts again at 0", {&C::radar_clock_steps}, 1},
    {"the IMU's clock jumps by 2 s", {&C::imu_gaps, &C::radar_clock_steps}, 1},
    {"the IMU's clock goes back by 2 s", {&C::clock_restarts, &C::radar_clock_steps}, 1},
    {"the IMU's clock starts again at 0", {&C::clock_restarts, &C::radar_clock_steps}, 1},
    {"nine scan stamps +0.9 s", {&C::scans}, 100},
    {"all clocks start again at 0", {&C::clock_restarts}, 1},
    {"all clocks jump by 1 h", {&C::clock_restarts}, 1},
    {"all clocks go back by 0.3 s", {&C::clock_restarts}, 1},
    // half a second after its restart the window claims 0.8 deg of tilt, 6 deg off, for 0.7 s
    {"all clocks jump by 2 s", {&C::imu_gaps}, 1, false},
    {"one sample of 1e299 rad/s", {&C::imu_out_of_range}, 1},
    {"accel NaN for 0.2 s", {&C::imu_non_finite}, 35},
    {"points NaN for 1 s", {&C::detections_non_finite}, 10},
    {"range rate NaN, infinite, 1e200 for 1 s", {&C::detections_non_finite}, 10},
    {"sigma of the Doppler NaN, infinite, 1e200 for 1 s", {&C::detections_non_finite}, 10},
    {"IMU samples swapped for 10 s"},
    {"scans again after 0.3 s"},
    {"IMU silent for 0.3 s"},
    {"radar silent for 5 s"},
    {"scans in blocks of 2 s for 10 s"},
    {"accel frozen for 5 s"},
    {"IMU frozen for 0.1 s"},
    {"one sample of 100 m/s^2"},
    {"vibration of 3 g and 1 rad/s for 10 s"},
    {"accel bias x +0.5 m/s^2"},
    {"empty scans for 5 s"},
    {"80 % random outliers for 3 s"},
    {"100 % random outliers for 10 s"},
    {"90 % movers for 10 s"},
    {"60 % coherent outliers for 10 s"},
    {"the same scan again for 10 s"},
    {"start in flight, 20 deg of roll off, sigma lying"},
    {"start in flight, 1 m/s off, sigma lying"},
    {"start in flight, quaternion zero"},
};

class ContractTest : public IndoorTest<36> {
 protected:
  static Stream events() { return experiment::disturbed(flight(), fault_named("none"), Time{0}); }
};

TEST_P(ContractTest, FaultsAreNoticedAndPromisesKept) {
  for (const Told& told : kTold) {
    const std::string name = told.fault;
    SCOPED_TRACE(name);
    const Fault& fault = fault_named(name);
    const Survival end = experiment::survive(flight(), options(), fault, kBegin, kAfter);
    measured(name + ": wrong until [s]", end.wrong_until, experiment::promise_text(fault));
    EXPECT_TRUE(end.kept || !told.kept)
        << "wrong until " << end.wrong_until << ", in the end " << end.last.why();
    EXPECT_TRUE(end.always_finite);
    EXPECT_TRUE(end.always_covariance);
    for (const auto counter : told.counters) {
      EXPECT_GE(end.counters.*counter, told.times);
    }
    if (told.counters.empty()) continue;
    EXPECT_FALSE(end.last.wrong()) << end.last.why();
    EXPECT_LT(end.wrong_until, 9.0);
    EXPECT_LT(end.last.age, 0.006);  // of the newest sample
  }
}

// Nobody knows where it flew meanwhile; the sigma has to say so.
TEST_P(ContractTest, PromiseOfASilenceOfBothSensorsIsKept) {
  const sim::Flight longer = short_flight("indoor-1", 56.0);
  const Fault& fault = fault_named("IMU and radar silent for 30 s");
  const Survival end = experiment::survive(longer, options_for(longer), fault, kBegin, kAfter);
  expect_below(fault.name + ": position, sigmas", end.last.position_sigmas, 3.0);
  EXPECT_TRUE(end.kept) << "wrong until " << end.wrong_until << ", in the end " << end.last.why();
  EXPECT_LT(end.last.position, 60.0);  // 30 s at 2 m/s; extrapolated it is a kilometre
  EXPECT_LT(end.outside_unreported, 1.0);
  EXPECT_EQ(end.counters.clock_restarts, 0U);
  EXPECT_GE(end.counters.restarts, 1U);
}

// A spike opens the velocity, outliers then give a wrong one, and landmarks matched among them
// would settle the position 0.5 m off with a sigma of 0.04 m.
TEST(Contract, PositionAfterOutliersThatFollowASpike) {
  const sim::Flight hover = short_flight("hover", 54.0, 2);
  const Fault both =
      experiment::together(fault_named("80 % random outliers for 3 s"),
                           fault_named("one sample of 100 m/s^2"), experiment::recovered(5.0));
  const Survival end = experiment::survive(hover, experiment::options_for(hover, "default"), both);
  expect_below("outliers after a spike: position, sigmas", end.last.position_sigmas, 5.0);
  EXPECT_GT(end.counters.position_reopened, 0U);
  EXPECT_TRUE(end.kept) << end.last.why();
}

/// The first `duration` of the flight.
void feed(Odometry& odometry, const Stream& events, Time duration) {
  for (const Event& e : events) {
    if (e.arrival > events.front().arrival + duration) return;
    e.is_imu() ? (void)odometry.add_imu(e.sample) : (void)odometry.add_scan(e.scan);
  }
}

TEST_P(ContractTest, WhoIsToldOfAScanMayReplaceItself) {
  auto odometry = Odometry::create(options());
  int first = 0;
  int second = 0;
  const std::array<double, 32> captured{7.0};
  double kept = 0.0;
  odometry->on_scan([&, captured] {
    ++first;
    odometry->on_scan([&] {
      if (++second == 3) odometry->on_scan({});
    });
    kept = captured[0];  // of the call that is replaced
  });
  feed(*odometry, events(), seconds(5));
  EXPECT_GT(odometry->counters().scans, 10U);
  EXPECT_EQ(first, 1);
  EXPECT_EQ(second, 3);
  EXPECT_EQ(kept, 7.0);
}

TEST_P(ContractTest, AStartIsHeldAgainstWhatIsBuffered) {
  auto odometry = Odometry::create(options());
  feed(*odometry, events(), seconds(5));
  ASSERT_TRUE(odometry->initialized());
  const NavState now = odometry->now();
  const BodyCovariance P = odometry->covariance();
  const auto status = [&](Time time) {
    NavState prior = now;
    prior.time = time;
    const Status given = odometry->reset(prior, P);
    if (given == Status::kOk) return given;
    EXPECT_TRUE(same(odometry->now(), now));
    return given;
  };
  EXPECT_EQ(status(Time{0}), Status::kLate);
  EXPECT_EQ(status(Time::min()), Status::kLate);
  EXPECT_EQ(status(Time::max()), Status::kAhead);
  EXPECT_EQ(status(now.time + hours(1)), Status::kAhead);
  EXPECT_EQ(status(now.time - milliseconds(500)), Status::kOk);
  EXPECT_EQ(status(now.time + milliseconds(500)), Status::kOk);
}

/// A start that no vehicle has, or one at the edge of what it may have.
struct Start {
  const char* name;
  std::function<void(NavState&, BodyCovariance&)> change;
  Status expected;
};

auto scaled(double norm) {
  return [norm](NavState& x, BodyCovariance&) { x.q_WB.coeffs() *= norm; };
}

void mix_magnitudes(BodyCovariance& P) {
  P.block<3, 3>(body::kPosition, body::kPosition) *= 1e10;
}

const Start kStarts[] = {
    {"velocity NaN", [](auto& x, auto&) { x.v_WB.x() = std::nan(""); }, Status::kNonFinite},
    {"position", [](auto& x, auto&) { x.p_WB.x() = 1e300; }, Status::kImplausible},
    {"velocity", [](auto& x, auto&) { x.v_WB.z() = -2e4; }, Status::kImplausible},
    {"gyroscope bias", [](auto& x, auto&) { x.gyro_bias.y() = 1e155; }, Status::kImplausible},
    {"accelerometer bias", [](auto& x, auto&) { x.accel_bias.y() = 2e4; }, Status::kImplausible},
    {"variance", [](auto&, auto& P) { P(4, 4) = 1e300; }, Status::kImplausible},
    {"quaternion 0", scaled(0.0), Status::kNumerical},
    {"quaternion 1e-300", scaled(1e-300), Status::kNumerical},
    {"quaternion 0.49", scaled(0.49), Status::kNumerical},
    {"quaternion 2.01", scaled(2.01), Status::kNumerical},
    {"quaternion 1e200", [](auto& x, auto&) { x.q_WB.w() = 1e200; }, Status::kNumerical},
    {"negative variance", [](auto&, auto& P) { P(0, 0) = -1.0; }, Status::kNumerical},
    {"not symmetric", [](auto&, auto& P) { P(0, 1) = 1e-5; }, Status::kNumerical},
    {"covariance without variance",
     [](auto&, auto& P) {
       P(4, 4) = 0.0;
       P(4, 5) = P(5, 4) = 100.0;
     },
     Status::kNumerical},
    {"indefinite where the numbers are small",
     [](auto&, auto& P) {
       mix_magnitudes(P);
       P(body::kGyroBias, body::kGyroBias) = -1e-8;
     },
     Status::kNumerical},
    {"correlation 1.1 where the numbers are small",
     [](auto&, auto& P) {
       mix_magnitudes(P);
       P(body::kGyroBias, body::kGyroBias) = 1e-8;
       P(body::kGyroBias, body::kAccelBias) = P(body::kAccelBias, body::kGyroBias) = 1.1e-6;
     },
     Status::kNumerical},
    {"quaternion 0.51", scaled(0.51), Status::kOk},
    {"quaternion 1.99", scaled(1.99), Status::kOk},
    {"mixed magnitudes", [](auto&, auto& P) { mix_magnitudes(P); }, Status::kOk},
    {"zero covariance", [](auto&, auto& P) { P.setZero(); }, Status::kOk},
};

// Flight stacks that trap floating point exceptions must not end here.
TEST_P(ContractTest, AStartIsRefusedWithoutOverflowAndChangesNothing) {
  auto odometry = Odometry::create(options());
  std::feclearexcept(FE_ALL_EXCEPT);
  for (const Start& start : kStarts) {
    SCOPED_TRACE(start.name);
    NavState prior = flight().truth.front();
    BodyCovariance P = 1e-4 * BodyCovariance::Identity();
    ASSERT_EQ(odometry->reset(prior, P), Status::kOk);
    const NavState before = odometry->now();
    const BodyCovariance P_before = odometry->covariance();
    start.change(prior, P);
    EXPECT_EQ(odometry->reset(prior, P), start.expected);
    EXPECT_TRUE(odometry->initialized());
    EXPECT_NEAR(odometry->now().q_WB.norm(), 1.0, 1e-15);
    if (start.expected != Status::kOk) {
      EXPECT_TRUE(same(odometry->now(), before));
      EXPECT_EQ(odometry->covariance(), P_before);
    }
    EXPECT_EQ(std::fetestexcept(FE_INVALID | FE_OVERFLOW | FE_DIVBYZERO), 0);
  }
}

// A time left at zero, and the first sample fifty years later.
TEST_P(ContractTest, AStartBeforeTheFirstSampleHoldsThere) {
  Options o = options();
  o.start.static_alignment = false;
  auto odometry = Odometry::create(o);
  NavState prior = flight().truth.front();
  prior.time = Time{0};
  ASSERT_EQ(odometry->reset(prior, 1e-4 * BodyCovariance::Identity()), Status::kOk);
  const Stream all = events();
  EXPECT_EQ(odometry->add_scan({start() + seconds(1), {}}), Status::kAhead);
  ASSERT_EQ(odometry->add_imu(all.front().sample), Status::kOk);
  EXPECT_EQ(odometry->now().time, all.front().sample.time);
  EXPECT_LT((odometry->now().p_WB - prior.p_WB).norm(), 0.01);
  feed(*odometry, {all.begin() + 1, all.end()}, seconds(15));
  const NavState truth = flight().truth_at(all.front().arrival + seconds(15));
  EXPECT_LT((odometry->now().p_WB - truth.p_WB).norm(), 0.5);
}

// The clock starts again while the estimator waits for a standstill.
TEST_P(ContractTest, AlignmentSurvivesAJump) {
  for (const char* jump : {"all clocks start again at 0", "all clocks jump by 1 h"}) {
    auto odometry = Odometry::create(options());
    const Stream all = experiment::disturbed(flight(), fault_named(jump), milliseconds(300));
    feed(*odometry, all, seconds(3));
    EXPECT_TRUE(odometry->initialized());
    EXPECT_EQ(odometry->counters().clock_restarts, 1U);
  }
}

INSTANTIATE_TEST_SUITE_P(BackEnds, ContractTest, kBothBackEnds, back_end_name);

}  // namespace
}  // namespace rio::test
