// SPDX-License-Identifier: BSD-3-Clause
// The input contract of door 1: data that break it are refused and counted, and ten seconds later
// the estimate is as good as ever. With either back-end.
#include <gtest/gtest.h>

#include <algorithm>
#include <cfenv>
#include <cmath>
#include <functional>
#include <limits>

#include "experiment/campaign.hpp"
#include "experiment/trial.hpp"
#include "support/measured.hpp"

namespace rio::test {
namespace {

using experiment::options_for;
using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Time kFault = seconds(10);  // after the first sample
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// What reaches the estimator, in this order.
struct Event {
  Time arrival{0};  ///< in true time
  bool is_imu = true;
  ImuSample sample;
  RadarScan scan;
};

struct Fault {
  const char* name;
  /// Changes one event; `t` is its arrival since the fault begins [s], `n` counts the events of its
  /// kind since then.
  std::function<void(Event&, double t, int n)> apply;
  std::function<std::uint64_t(const Counters&)> noticed;
  std::uint64_t times;  ///< it has to be noticed at least
};

void shift(Event& e, Time by) {
  (e.is_imu ? e.sample.time : e.scan.time) += by;
}

const Time kStart = seconds(1'700'000'000);  // of the flight, so that a restart at 0 is far away

const Fault kFaults[] = {
    {"none", [](Event&, double, int) {}, [](const Counters& c) { return c.scans; }, 100},
    {"one IMU stamp +1 h",
     [](Event& e, double, int n) {
       if (e.is_imu && n == 0) shift(e, hours(1));
     },
     [](const Counters& c) { return c.imu_ahead; }, 1},
    {"one IMU stamp +10 s",
     [](Event& e, double, int n) {
       if (e.is_imu && n == 0) shift(e, seconds(10));
     },
     [](const Counters& c) { return c.imu_ahead; }, 1},
    {"one IMU stamp -1 h",
     [](Event& e, double, int n) {
       if (e.is_imu && n == 0) shift(e, -hours(1));
     },
     [](const Counters& c) { return c.imu_stale; }, 1},
    {"IMU stamps at both ends of time",
     [](Event& e, double, int n) {
       if (e.is_imu && n == 0) e.sample.time = Time::max();
       if (e.is_imu && n == 10) e.sample.time = Time::min();
     },
     [](const Counters& c) { return std::min(c.imu_ahead, c.imu_stale); }, 1},
    {"ten IMU stamps +1 h in a row",
     [](Event& e, double, int n) {
       if (e.is_imu && n < 10) shift(e, hours(1));
     },
     [](const Counters& c) { return c.imu_ahead; }, 10},
    {"scan stamps at both ends of time",
     [](Event& e, double, int n) {
       if (!e.is_imu && n == 0) e.scan.time = Time::min();
       if (!e.is_imu && n == 1) e.scan.time = Time::max();
     },
     [](const Counters& c) { return std::min(c.scans_late, c.scans_ahead); }, 1},
    {"nine scan stamps +1 h",
     [](Event& e, double, int n) {
       if (!e.is_imu && n < 9) shift(e, hours(1));
     },
     [](const Counters& c) { return c.scans_ahead; }, 9},
    {"nine scan stamps +0.9 s",
     [](Event& e, double, int n) {
       if (!e.is_imu && n < 9) shift(e, milliseconds(900));
     },
     [](const Counters& c) { return c.scans; }, 100},
    {"all clocks start again at 0", [](Event& e, double, int) { shift(e, -kStart - kFault); },
     [](const Counters& c) { return c.clock_restarts; }, 1},
    {"all clocks jump by 1 h", [](Event& e, double, int) { shift(e, hours(1)); },
     [](const Counters& c) { return c.clock_restarts; }, 1},
    {"all clocks go back by 0.3 s", [](Event& e, double, int) { shift(e, -milliseconds(300)); },
     [](const Counters& c) { return c.clock_restarts; }, 1},
    {"all clocks jump by 2 s", [](Event& e, double, int) { shift(e, seconds(2)); },
     [](const Counters& c) { return c.imu_gaps; }, 1},
    {"a gyroscope of 1e299 rad/s",
     [](Event& e, double, int n) {
       if (e.is_imu && n == 0) e.sample.gyro_B.setConstant(1e299);
     },
     [](const Counters& c) { return c.imu_out_of_range; }, 1},
    {"an IMU of NaN for 0.2 s",
     [](Event& e, double t, int) {
       if (e.is_imu && t < 0.2) e.sample.accel_B.z() = kNaN;
     },
     [](const Counters& c) { return c.imu_non_finite; }, 35},
    {"absurd detections for a second",
     [](Event& e, double t, int n) {
       if (e.is_imu || t > 1.0) return;
       for (RadarDetection& d : e.scan.detections) {
         if (n % 3 == 0) d.range_rate = 1e299;
         if (n % 3 == 1) d.sigma_doppler = 1e200;
         if (n % 3 == 2) d.point_S *= 1e200;
       }
     },
     [](const Counters& c) { return c.detections_non_finite; }, 10},
};

double tilt_error(const NavState& x, const NavState& truth) {
  const Vector3d up = x.q_WB.conjugate() * Vector3d::UnitZ();
  const Vector3d true_up = truth.q_WB.conjugate() * Vector3d::UnitZ();
  return std::atan2(up.cross(true_up).norm(), up.dot(true_up));
}

class ContractTest : public testing::TestWithParam<BackEnd> {
 protected:
  static const sim::Flight& flight() {
    static const sim::Flight flight = [] {
      sim::Scenario scenario = experiment::cases_of("indoor-1", 1).front().scenario;
      scenario.max_duration = 30.0;
      return sim::simulate_flight(scenario);
    }();
    return flight;
  }
  static Options options() {
    Options o = options_for(flight(), "default");
    o.backend = GetParam();
    return o;
  }
  /// The stamps of the flight start at kStart.
  static std::vector<Event> events() {
    const Time by = kStart - flight().imu.front().time;
    std::vector<Event> all;
    for (const ImuSample& s : flight().imu) all.push_back({s.time, true, s, {}});
    for (std::size_t i = 0; i < flight().scans.size(); ++i) {
      all.push_back({flight().arrivals[i], false, {}, flight().scans[i]});
    }
    std::stable_sort(all.begin(), all.end(),
                     [](const Event& a, const Event& b) { return a.arrival < b.arrival; });
    for (Event& e : all) shift(e, by);
    return all;
  }
};

TEST_P(ContractTest, FaultsAreNoticedAndForgotten) {
  const Time begin = flight().imu.front().time + kFault;
  for (const Fault& fault : kFaults) {
    auto odometry = Odometry::create(options());
    ASSERT_NE(odometry, nullptr);
    int count[2] = {0, 0};
    double tilt = 0.0;
    double speed = 0.0;
    double far = 0.0;     // position error [m]
    double sigmas = 0.0;  // the same, of a position beyond half a metre
    for (Event& e : events()) {
      if (e.arrival >= begin) {
        fault.apply(e, to_seconds(e.arrival - begin), count[e.is_imu ? 1 : 0]++);
      }
      if (!e.is_imu) {
        (void)odometry->add_scan(e.scan);
        continue;
      }
      (void)odometry->add_imu(e.sample);
      if (e.arrival < begin + seconds(10)) continue;
      const NavState& x = odometry->now();
      ASSERT_EQ(x.time, e.sample.time) << fault.name;
      const NavState truth = flight().truth_at(e.arrival);
      tilt = std::max(tilt, tilt_error(x, truth));
      speed = std::max(speed, std::abs(x.v_WB.norm() - truth.v_WB.norm()));
      const double error = (x.p_WB - truth.p_WB).norm();
      const double sigma = std::sqrt(odometry->covariance().block<3, 3>(3, 3).trace());
      far = std::max(far, error);
      if (error > 0.5) sigmas = std::max(sigmas, error / sigma);
      ASSERT_TRUE(odometry->covariance().allFinite()) << fault.name;
    }
    const std::string name = fault.name;
    measured(name + ": tilt [deg]", tilt * 180.0 / M_PI, "below 3");
    measured(name + ": speed [m/s]", speed, "below 0.5");
    measured(name + ": position [m]", far, "below 0.5, or ...");
    measured(name + ": position [sigma]", sigmas, "below 5");
    EXPECT_LT(tilt * 180.0 / M_PI, 3.0) << name;
    EXPECT_LT(speed, 0.5) << name;
    EXPECT_LT(sigmas, 5.0) << name;
    EXPECT_GE(fault.noticed(odometry->counters()), fault.times) << name;
  }
}

/// The first `duration` of the flight.
void feed(Odometry& odometry, const std::vector<Event>& events, Time duration) {
  for (const Event& e : events) {
    if (e.arrival > events.front().arrival + duration) return;
    e.is_imu ? (void)odometry.add_imu(e.sample) : (void)odometry.add_scan(e.scan);
  }
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
    EXPECT_EQ(odometry->now().time, now.time);
    EXPECT_EQ(odometry->now().p_WB, now.p_WB);
    return given;
  };
  EXPECT_EQ(status(Time{0}), Status::kLate);
  EXPECT_EQ(status(Time::min()), Status::kLate);
  EXPECT_EQ(status(Time::max()), Status::kAhead);
  EXPECT_EQ(status(now.time + hours(1)), Status::kAhead);
  EXPECT_EQ(status(now.time - milliseconds(500)), Status::kOk);
  EXPECT_EQ(status(now.time + milliseconds(500)), Status::kOk);
}

TEST_P(ContractTest, AStartIsAUnitQuaternionAndACovariance) {
  auto odometry = Odometry::create(options());
  const auto status = [&](double norm, const BodyCovariance& P) {
    NavState prior;
    prior.q_WB.coeffs() = norm * flight().truth.front().q_WB.coeffs();
    return odometry->reset(prior, P);
  };
  const BodyCovariance P = 1e-4 * BodyCovariance::Identity();
  for (const double norm : {0.0, 1e-300, 1e-3, 0.4, 2.1, 1e200}) {
    EXPECT_EQ(status(norm, P), Status::kNumerical) << norm;
  }
  EXPECT_FALSE(odometry->initialized());
  EXPECT_EQ(status(1.001, P), Status::kOk);
  BodyCovariance mixed = P;  // indefinite where the numbers are small
  mixed.block<3, 3>(body::kPosition, body::kPosition) *= 1e10;
  EXPECT_EQ(status(1.0, mixed), Status::kOk);
  mixed(body::kGyroBias, body::kGyroBias) = -1e-8;
  EXPECT_EQ(status(1.0, mixed), Status::kNumerical);
  mixed(body::kGyroBias, body::kGyroBias) = 1e-8;
  mixed(body::kGyroBias, body::kAccelBias) = 1.1e-6;  // correlation 1.1
  mixed(body::kAccelBias, body::kGyroBias) = 1.1e-6;
  EXPECT_EQ(status(1.0, mixed), Status::kNumerical);
  EXPECT_EQ(status(1.0, BodyCovariance::Zero()), Status::kOk);
}

// Flight stacks that trap floating point exceptions must not end here.
TEST_P(ContractTest, AStartThatNoVehicleHasIsRefusedWithoutOverflow) {
  auto odometry = Odometry::create(options());
  std::feclearexcept(FE_ALL_EXCEPT);
  const auto status = [&](const auto& change) {
    NavState prior = flight().truth.front();
    BodyCovariance P = 1e-4 * BodyCovariance::Identity();
    change(prior, P);
    return odometry->reset(prior, P);
  };
  const auto none = [](NavState&, BodyCovariance&) {};
  EXPECT_EQ(status([](NavState& x, auto&) { x.p_WB.x() = 1e300; }), Status::kImplausible);
  EXPECT_EQ(status([](NavState& x, auto&) { x.v_WB.z() = -2e4; }), Status::kImplausible);
  EXPECT_EQ(status([](NavState& x, auto&) { x.gyro_bias.y() = 1e155; }), Status::kImplausible);
  EXPECT_EQ(status([](NavState& x, auto&) { x.accel_bias.y() = 2e4; }), Status::kImplausible);
  EXPECT_EQ(status([](auto&, BodyCovariance& P) { P(4, 4) = 1e300; }), Status::kImplausible);
  EXPECT_EQ(status([](NavState& x, auto&) { x.q_WB.w() = 1e200; }), Status::kNumerical);
  EXPECT_EQ(status([](auto&, BodyCovariance& P) {
              P(4, 4) = 0.0;
              P(4, 5) = P(5, 4) = 100.0;
            }),
            Status::kNumerical);
  EXPECT_FALSE(odometry->initialized());
  EXPECT_EQ(status(none), Status::kOk);
  EXPECT_EQ(std::fetestexcept(FE_INVALID | FE_OVERFLOW | FE_DIVBYZERO), 0);
}

// A time left at zero, and the first sample fifty years later.
TEST_P(ContractTest, AStartBeforeTheFirstSampleHoldsThere) {
  Options o = options();
  o.start.static_alignment = false;
  auto odometry = Odometry::create(o);
  NavState prior = flight().truth.front();
  prior.time = Time{0};
  ASSERT_EQ(odometry->reset(prior, 1e-4 * BodyCovariance::Identity()), Status::kOk);
  const std::vector<Event> all = events();
  EXPECT_EQ(odometry->add_scan({kStart + seconds(1), {}}), Status::kAhead);
  ASSERT_EQ(odometry->add_imu(all.front().sample), Status::kOk);
  EXPECT_EQ(odometry->now().time, all.front().sample.time);
  EXPECT_LT((odometry->now().p_WB - prior.p_WB).norm(), 0.01);
  feed(*odometry, {all.begin() + 1, all.end()}, seconds(15));
  const NavState truth = flight().truth_at(all.front().arrival + seconds(15));
  EXPECT_LT((odometry->now().p_WB - truth.p_WB).norm(), 0.5);
}

// The clock starts again while the estimator waits for a standstill.
TEST_P(ContractTest, AlignmentSurvivesAJump) {
  for (const Time by : {Time(-kStart), Time(hours(1))}) {
    auto odometry = Odometry::create(options());
    std::vector<Event> all = events();
    const Time begin = all.front().arrival;
    for (Event& e : all) {
      if (e.arrival - begin > milliseconds(300)) shift(e, by);
    }
    feed(*odometry, all, seconds(3));
    EXPECT_TRUE(odometry->initialized());
    EXPECT_EQ(odometry->counters().clock_restarts, 1U);
  }
}

INSTANTIATE_TEST_SUITE_P(BackEnds, ContractTest, testing::Values(BackEnd::kEkf, BackEnd::kSmoother),
                         [](const auto& backend) {
                           return backend.param == BackEnd::kEkf ? "Ekf" : "Smoother";
                         });

}  // namespace
}  // namespace rio::test
