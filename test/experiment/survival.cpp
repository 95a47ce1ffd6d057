// SPDX-License-Identifier: BSD-3-Clause
#include "experiment/survival.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

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

bool is_finite(const NavState& x) {
  return x.q_WB.coeffs().allFinite() && x.p_WB.allFinite() && x.v_WB.allFinite() &&
         x.gyro_bias.allFinite() && x.accel_bias.allFinite();
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

/// Stamps of the accepted samples and their true measurement times.
class Clock {
 public:
  void took(Time stamp, Time measured) { samples_.push_back({stamp, measured}); }
  /// Earlier stamps are of another clock.
  void restart() {
    if (samples_.size() > 1) samples_.erase(samples_.begin(), samples_.end() - 1);
  }
  bool empty() const { return samples_.empty(); }
  Time measured(Time stamp) const {
    for (std::size_t i = samples_.size(); i-- > 0;) {
      if (samples_[i].stamp > stamp) continue;
      const Time next = i + 1 < samples_.size() ? samples_[i + 1].measured : Time::max();
      return std::min(samples_[i].measured + (stamp - samples_[i].stamp), next);
    }
    return samples_.front().measured;
  }

 private:
  struct Pair {
    Time stamp;
    Time measured;
  };
  std::vector<Pair> samples_;
};

/// Feeds the events and evaluates the results.
class Watch {
 public:
  Watch(const sim::Flight& flight, const Fault& fault, double begin, double after,
        Odometry& odometry)
      : flight_(flight),
        fault_(fault),
        begin_(flight.imu.front().time + from_seconds(begin)),
        end_(begin_ + from_seconds(std::isinf(fault.duration) ? 0.0 : fault.duration)),
        last_(end_ + from_seconds(after)),
        odometry_(odometry) {}

  Survival run() {
    for (const Event& e : disturbed(flight_, fault_, begin_ - flight_.imu.front().time)) {
      if (e.arrival > last_) break;
      give(e);
      if (e.arrival < next_check_ || clock_.empty()) continue;
      next_check_ = e.arrival + from_seconds(kCheck);
      check(e.arrival);
    }
    result_.reported_last = is_reported(odometry_);
    result_.counters = odometry_.counters();
    result_.kept = kept();
    return result_;
  }

 private:
  void give(const Event& e) {
    if (e.is_scan()) (void)odometry_.add_scan(e.scan);
    if (e.kind == Event::Kind::kReset) (void)odometry_.reset(e.start->state, e.start->covariance);
    if (!e.is_imu() || odometry_.add_imu(e.sample) != Status::kOk) return;
    clock_.took(e.sample.time, e.measured);
    if (odometry_.counters().clock_restarts > restarts_) clock_.restart();
    restarts_ = odometry_.counters().clock_restarts;
  }

  Deviation deviation(Time now) const {
    const NavState& x = odometry_.now();
    const BodyCovariance& P = odometry_.covariance_now();
    Deviation d;
    d.finite = is_finite(x) && is_finite(odometry_.at_scan()) && P.allFinite();
    d.covariance = d.finite && is_covariance(P) && is_covariance(odometry_.covariance());
    const Time measured = clock_.measured(x.time);
    d.age = to_seconds(now - measured);
    if (!d.finite) return d;
    const NavState truth = flight_.truth_at(measured);
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

  void check(Time now) {
    const bool reported = is_reported(odometry_);
    if (now < begin_) {
      result_.reported_before |= odometry_.health().state > HealthState::kOk;
      return;
    }
    const double step = to_seconds(now - std::max(last_check_, begin_));
    last_check_ = now;
    const Deviation d = deviation(now);
    result_.last = d;
    result_.states |= 1U << static_cast<std::uint32_t>(odometry_.health().state);
    result_.always_finite = result_.always_finite && d.finite;
    result_.always_covariance = result_.always_covariance && d.covariance;
    result_.outside_unreported += d.outside_3_sigma() && !reported ? step : 0.0;
    const bool wrong = d.wrong();
    if (wrong) result_.wrong_until = to_seconds(now - end_);
    ever_wrong_ = ever_wrong_ || wrong;
    ever_dishonest_ = ever_dishonest_ || d.dishonest();
    unreported_ = wrong && !reported ? unreported_ + step : 0.0;
    result_.longest_unreported = std::max(result_.longest_unreported, unreported_);
  }

  bool kept() const {
    const Counters& n = result_.counters;
    switch (fault_.promised.promise) {
      case Promise::kIgnored:
        return !ever_wrong_ &&
               n.velocity_resets + n.attitude_resets + n.restarts + n.clock_restarts == 0;
      case Promise::kBridged:
        return !ever_wrong_;
      case Promise::kHonest:
        return !ever_dishonest_ && !result_.last.wrong();
      case Promise::kRecovered:
        return !ever_wrong_ || result_.wrong_until < fault_.promised.within;
      case Promise::kReported:
        break;
    }
    return result_.longest_unreported <= kReportedWithin;
  }

  const sim::Flight& flight_;
  const Fault& fault_;
  Time begin_;
  Time end_;   ///< of the fault; for a permanent one, its beginning
  Time last_;  ///< of the verdict
  Odometry& odometry_;
  Clock clock_;
  std::uint64_t restarts_ = 0;
  Time next_check_{0};
  Time last_check_{0};
  bool ever_wrong_ = false;
  bool ever_dishonest_ = false;
  double unreported_ = 0.0;
  Survival result_;
};

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

std::string states_text(std::uint32_t states) {
  std::vector<std::string> names;
  for (std::uint32_t i = 0; states >> i != 0; ++i) {
    if ((states >> i & 1U) != 0) names.emplace_back(to_string(static_cast<HealthState>(i)));
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

bool is_reported(const Odometry& odometry) {
  return odometry.health().state != HealthState::kOk;
}

Survival survive(const sim::Flight& flight, const Options& options, const Fault& fault,
                 double begin, double after) {
  Options used = options;
  if (fault.configure) fault.configure(used);
  std::string why;
  const auto odometry = Odometry::create(used, &why);
  if (odometry == nullptr) throw std::runtime_error(why);
  return Watch(flight, fault, begin, after, *odometry).run();
}

}  // namespace rio::experiment
