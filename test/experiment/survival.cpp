// SPDX-License-Identifier: BSD-3-Clause
#include "experiment/survival.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <vector>

#include "experiment/trial.hpp"
#include "rio/core/small_cholesky.hpp"
#include "rio/eval/metrics.hpp"
#include "rio/eval/nees.hpp"

namespace rio::experiment {

namespace {

constexpr double kWrongTilt = 3.0;      // [deg]
constexpr double kWrongSpeed = 0.5;     // [m/s]
constexpr double kWrongPosition = 0.5;  // [m], and ...
constexpr double kWrongSigmas = 5.0;
constexpr double kStuck = 1.0;           // [s]
constexpr double kCheck = 0.02;          // period of the checks of the estimate [s]
constexpr double kReportedWithin = 1.0;  // [s]

/// Of a block of the covariance in the direction of the error; NaN if that has none.
template <class Vector, class Matrix>
double sigmas(const Vector& error, const Matrix& P) {
  const double square = error.squaredNorm();
  return square > 0.0 ? square / std::sqrt(error.dot(P * error)) : 0.0;
}

/// No eigenvalue of the correlations below -1e-9.
bool is_covariance(const BodyCovariance& P) {
  if (!(P.diagonal().minCoeff() >= 0.0)) return false;
  const double least = std::numeric_limits<double>::min();
  const Eigen::Matrix<double, body::kSize, 1> scale =
      P.diagonal().cwiseMax(least).cwiseSqrt().cwiseInverse();
  BodyCovariance C = scale.asDiagonal() * P * scale.asDiagonal();
  if (!((C - C.transpose()).cwiseAbs().maxCoeff() <= 1e-9)) return false;
  C.diagonal().array() += 1e-9;
  return SmallCholesky<body::kSize>(C).positive();
}

/// The accepted samples since the clock started last.
struct Clock {
  std::map<Time, Time> measured;  ///< true times, by stamp
  std::uint64_t restarts = 0;

  Time measured_at(Time stamp) const {
    const auto after = measured.upper_bound(stamp);
    if (after == measured.begin()) return after->second;
    const auto& [last, time] = *std::prev(after);
    return std::min(time + (stamp - last), after == measured.end() ? Time::max() : after->second);
  }
};

void give(const Event& e, Odometry& odometry, Clock* clock) {
  if (e.is_scan()) (void)odometry.add_scan(e.scan);
  if (e.kind == Event::Kind::kReset) (void)odometry.reset(e.start->state, e.start->covariance);
  if (!e.is_imu() || odometry.add_imu(e.sample) != Status::kOk) return;
  const std::uint64_t restarts = odometry.counters().clock_restarts;
  if (restarts > clock->restarts) clock->measured.clear();
  clock->restarts = restarts;
  clock->measured[e.sample.time] = e.measured;
}

/// @param time that the estimate is of, true time
Deviation deviation(const Odometry& odometry, const sim::Flight& flight, Time time, Time now) {
  const NavState& x = odometry.now();
  const BodyCovariance& P = odometry.covariance_now();
  Deviation d;
  d.finite = is_finite(x) && is_finite(odometry.at_scan()) && P.allFinite();
  d.covariance = d.finite && is_covariance(P) && is_covariance(odometry.covariance());
  d.age = to_seconds(now - time);
  if (!d.finite) return d;
  const NavState truth = flight.truth_at(time);
  d.tilt = eval::tilt_error(x.q_WB, truth.q_WB);
  d.speed = (x.q_WB.conjugate() * x.v_WB - truth.q_WB.conjugate() * truth.v_WB).norm();
  d.position = (x.p_WB - truth.p_WB).norm();
  const auto e = eval::body_error(x, truth);
  const auto block = [&](int at) {
    return sigmas(e.segment<3>(at).eval(), P.block<3, 3>(at, at).eval());
  };
  d.position_sigmas = block(body::kPosition);
  d.velocity_sigmas = block(body::kVelocity);
  const Vector3d up = x.q_WB.conjugate() * Vector3d::UnitZ();
  const Matrix3d level = Matrix3d::Identity() - up * up.transpose();
  d.tilt_sigmas = sigmas((level * e.segment<3>(body::kAttitude)).eval(),
                         P.block<3, 3>(body::kAttitude, body::kAttitude).eval());
  return d;
}

bool is_kept(const Promised& promised, const Survival& s, bool ever_wrong, bool ever_dishonest) {
  const Counters& n = s.counters;
  switch (promised.promise) {
    case Promise::kIgnored:
      return !ever_wrong &&
             n.velocity_resets + n.attitude_resets + n.restarts + n.clock_restarts == 0;
    case Promise::kBridged:
      return !ever_wrong;
    case Promise::kHonest:
      return !ever_dishonest && !s.last.wrong();
    case Promise::kRecovered:
      return !ever_wrong || s.wrong_until < promised.within;
    case Promise::kReported:
      break;
  }
  return s.longest_unreported <= kReportedWithin;
}

}  // namespace

std::string Deviation::why() const {
  std::vector<std::string> all;
  if (!finite) all.emplace_back("not finite");
  if (finite && !covariance) all.emplace_back("P indefinite");
  if (!(age <= kStuck)) all.emplace_back("stuck");
  if (tilt > kWrongTilt) all.emplace_back("tilt");
  if (speed > kWrongSpeed) all.emplace_back("speed");
  if (position > kWrongPosition && !(position_sigmas <= kWrongSigmas)) {
    all.emplace_back("position");
  }
  return fmt::format("{}", fmt::join(all, ", "));
}

bool Deviation::dishonest() const {
  const auto beyond = [](double value, double limit, double in_sigmas) {
    return value > limit && !(in_sigmas <= kWrongSigmas);
  };
  return !finite || !covariance || beyond(tilt, kWrongTilt, tilt_sigmas) ||
         beyond(speed, kWrongSpeed, velocity_sigmas) ||
         beyond(position, kWrongPosition, position_sigmas);
}

bool Deviation::outside_3_sigma() const {
  return !finite || !(tilt_sigmas <= 3.0) || !(velocity_sigmas <= 3.0) || !(position_sigmas <= 3.0);
}

Survival survive(const sim::Flight& flight, const Options& options, const Fault& fault,
                 double begin, double after) {
  Options used = options;
  if (fault.configure) fault.configure(used);
  const auto odometry = create_odometry(used);
  const Time first = flight.imu.front().time + from_seconds(begin);
  const Time end = first + from_seconds(std::isinf(fault.duration) ? 0.0 : fault.duration);
  Survival result;
  Clock clock;
  Time next_check{0};
  Time last_check = first;
  bool ever_wrong = false;
  bool ever_dishonest = false;
  double unreported = 0.0;
  for (const Event& e : disturbed(flight, fault, from_seconds(begin))) {
    const Time now = e.arrival;
    if (now > end + from_seconds(after)) break;
    give(e, *odometry, &clock);
    const HealthState state = odometry->health().state;
    const bool reported = state != HealthState::kOk;
    result.reported_last = reported;
    if (now < next_check || clock.measured.empty()) continue;
    next_check = now + from_seconds(kCheck);
    if (now < first) {
      result.reported_before |= state > HealthState::kOk;
      continue;
    }
    const double step = to_seconds(now - last_check);
    last_check = now;
    const Deviation d = deviation(*odometry, flight, clock.measured_at(odometry->now().time), now);
    const bool wrong = d.wrong();
    result.last = d;
    result.states |= 1U << static_cast<std::uint32_t>(state);
    result.always_finite = result.always_finite && d.finite;
    result.always_covariance = result.always_covariance && d.covariance;
    result.outside_unreported += d.outside_3_sigma() && !reported ? step : 0.0;
    if (wrong) result.wrong_until = to_seconds(now - end);
    ever_wrong = ever_wrong || wrong;
    ever_dishonest = ever_dishonest || d.dishonest();
    unreported = wrong && !reported ? unreported + step : 0.0;
    result.longest_unreported = std::max(result.longest_unreported, unreported);
  }
  result.counters = odometry->counters();
  result.kept = is_kept(fault.promised, result, ever_wrong, ever_dishonest);
  return result;
}

}  // namespace rio::experiment
