// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/judge.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cstddef>
#include <utility>

namespace rio::fuzz {

namespace {

bool finite(const NavState& x) {
  return x.q_WB.coeffs().allFinite() && x.p_WB.allFinite() && x.v_WB.allFinite() &&
         x.gyro_bias.allFinite() && x.accel_bias.allFinite();
}

bool finite(const RadarDetection& d) {
  const Eigen::Vector4d sigmas(d.sigma_range, d.sigma_azimuth, d.sigma_elevation, d.sigma_doppler);
  const Vector3d others(d.range_rate, d.snr_db, d.noise_db);
  return d.point_S.allFinite() && others.allFinite() && sigmas.allFinite();
}

bool unit(const Quaternion& q) {
  return std::abs(q.norm() - 1.0) < 1e-9;
}

/// No correlation matrix with an eigenvalue below -1e-9.
bool positive_semidefinite(const BodyCovariance& P) {
  if (!(P.diagonal().minCoeff() >= 0.0)) return false;
  const double least = std::numeric_limits<double>::min();
  const Eigen::Matrix<double, body::kSize, 1> scale =
      P.diagonal().cwiseMax(least).cwiseSqrt().cwiseInverse();
  using Matrix = Eigen::Matrix<double, body::kSize, body::kSize>;
  Matrix C = scale.asDiagonal() * P * scale.asDiagonal();
  C.diagonal().array() += 1e-9;
  return Eigen::LLT<Matrix>(C).info() == Eigen::Success;
}

/// The counters, in their order.
using Totals = std::array<std::uint64_t, sizeof(Counters) / sizeof(std::uint64_t)>;

/// The counters that answer for a status.
struct Answer {
  Status status;
  std::uint64_t Counters::*counter;
};
constexpr Answer kOfImu[] = {
    {Status::kOk, &Counters::imu_samples},
    {Status::kMoving, &Counters::imu_samples},
    {Status::kStale, &Counters::imu_stale},
    {Status::kAhead, &Counters::imu_ahead},
    {Status::kNonFinite, &Counters::imu_non_finite},
    {Status::kImplausible, &Counters::imu_out_of_range},
    {Status::kImplausible, &Counters::imu_frozen},
};
constexpr Answer kOfScan[] = {
    // kWaiting has none
    {Status::kOk, &Counters::scans},
    {Status::kNotInitialized, &Counters::scans_uninitialized},
    {Status::kDuplicate, &Counters::scans_duplicate},
    {Status::kLate, &Counters::scans_late},
    {Status::kAhead, &Counters::scans_ahead},
    {Status::kQueueFull, &Counters::scans_overflow},
    {Status::kNonFinite, &Counters::scans_non_finite},
    {Status::kNumerical, &Counters::updates_failed},
};
template <std::size_t n>
std::uint64_t answered(const Answer (&answers)[n], const Counters& counters, Status status) {
  std::uint64_t sum = 0;
  for (const Answer& a : answers) sum += a.status == status ? counters.*a.counter : 0;
  return sum;
}

/// The answer of a call; floating point exceptions are trapped if its data are finite.
template <class Call>
Status trapped(bool clean, const Call& call) {
  const TrapFloatingPoint trap(clean);
  return call();
}

}  // namespace

Judge::Judge(std::unique_ptr<Odometry> odometry, const Options& options)
    : odometry_(std::move(odometry)),
      queue_(options.timing.scan_queue * static_cast<int>(options.radars())),
      several_(options.radars() > 1) {}

bool Judge::Estimate::operator==(const Estimate& other) const {
  return same(now, other.now) && same(at_scan, other.at_scan) &&
         same(covariance, other.covariance) && same(extrinsics, other.extrinsics) &&
         initialized == other.initialized;
}

Judge::Estimate Judge::estimate() const {
  return {odometry_->now(), odometry_->at_scan(), odometry_->covariance(), odometry_->extrinsics(),
          odometry_->initialized()};
}

void Judge::check_estimate(const Counters& before) const {
  RIO_FUZZ_CHECK(finite(odometry_->now()));
  RIO_FUZZ_CHECK(finite(odometry_->at_scan()));
  RIO_FUZZ_CHECK(unit(odometry_->now().q_WB));
  RIO_FUZZ_CHECK(unit(odometry_->at_scan().q_WB));
  const Pose& T_BS = odometry_->extrinsics();
  RIO_FUZZ_CHECK(T_BS.translation.allFinite());
  RIO_FUZZ_CHECK(std::abs(T_BS.rotation.norm() - 1.0) < 1e-5);
  const BodyCovariance& P = odometry_->covariance();
  RIO_FUZZ_CHECK(P.allFinite());
  RIO_FUZZ_CHECK(P == P.transpose());
  RIO_FUZZ_CHECK(positive_semidefinite(P));
  for (const CalibrationReport& c : odometry_->report().calibration) {
    RIO_FUZZ_CHECK(std::abs(c.value) <= std::numeric_limits<double>::max());
    RIO_FUZZ_CHECK(c.sigma >= 0.0);
  }
  const auto now = std::bit_cast<Totals>(odometry_->counters());
  const auto then = std::bit_cast<Totals>(before);
  for (std::size_t i = 0; i < now.size(); ++i) RIO_FUZZ_CHECK(now[i] >= then[i]);
}

void Judge::check_scans() const {
  const Counters& c = odometry_->counters();
  const std::uint64_t answered = c.scans + c.scans_late + c.scans_ahead + c.scans_duplicate +
                                 c.scans_overflow + c.scans_non_finite + c.scans_uninitialized;
  RIO_FUZZ_CHECK(answered <= scans_given_);  // the others wait, or their update failed
  RIO_FUZZ_CHECK(scans_given_ <= answered + static_cast<std::uint64_t>(queue_) + c.updates_failed);
}

Status Judge::add_imu(const ImuSample& sample) {
  ++calls.add_imu;
  const Counters before = odometry_->counters();
  const Estimate old = estimate();
  const Status status = trapped(sample.gyro_B.allFinite() && sample.accel_B.allFinite(),
                                [&] { return odometry_->add_imu(sample); });
  check_estimate(before);
  RIO_FUZZ_CHECK(answered(kOfImu, odometry_->counters(), status) ==
                 answered(kOfImu, before, status) + 1);
  const bool taken = status == Status::kOk || status == Status::kMoving;
  RIO_FUZZ_CHECK(taken || estimate() == old);
  if (status == Status::kOk && odometry_->initialized()) {
    RIO_FUZZ_CHECK(odometry_->now().time == std::max(sample.time, odometry_->at_scan().time));
  }
  calls.processed += odometry_->counters().scans - before.scans;
  check_scans();
  return status;
}

Status Judge::add_scan(const RadarScan& scan, std::size_t radar) {
  ++calls.add_scan;
  ++scans_given_;
  const Counters before = odometry_->counters();
  const Estimate old = estimate();
  const bool clean = std::all_of(scan.detections.begin(), scan.detections.end(),
                                 [](const RadarDetection& d) { return finite(d); });
  const Status status = trapped(clean, [&] { return odometry_->add_scan(scan, radar); });
  check_estimate(before);
  if (status == Status::kUndeclared) {  // no such radar
    --scans_given_;
    RIO_FUZZ_CHECK(estimate() == old && same(odometry_->counters(), before));
    return status;
  }
  // of several radars one call may process the scans of others
  const bool others = several_ && (status == Status::kOk || status == Status::kWaiting);
  if (status == Status::kOk && !others) {
    RIO_FUZZ_CHECK(odometry_->report().time == scan.time);
  } else if (status != Status::kNumerical && !others) {  // then it is as the IMU predicts
    RIO_FUZZ_CHECK(estimate() == old);
  }
  if (status != Status::kWaiting) {
    const std::uint64_t more =
        answered(kOfScan, odometry_->counters(), status) - answered(kOfScan, before, status);
    RIO_FUZZ_CHECK(others || status == Status::kNumerical ? more >= 1 : more == 1);
  }
  calls.processed += odometry_->counters().scans - before.scans;
  check_scans();
  return status;
}

Status Judge::add_measurement(const AidingMeasurement& measurement) {
  ++calls.aiding;
  const Counters before = odometry_->counters();
  const Estimate old = estimate();
  const Status status = odometry_->add_measurement(measurement);
  check_estimate(before);
  RIO_FUZZ_CHECK(estimate() == old);  // it counts with a scan
  const auto answers = [](const Counters& c) {
    return c.aiding + c.aiding_late + c.aiding_ahead + c.aiding_overflow;
  };
  const bool counted = status != Status::kNotInitialized && status != Status::kUndeclared;
  RIO_FUZZ_CHECK(answers(odometry_->counters()) - answers(before) == (counted ? 1 : 0));
  return status;
}

Status Judge::reset(const NavState& prior, const BodyCovariance& P0) {
  ++calls.reset;
  const Counters before = odometry_->counters();
  const Estimate old = estimate();
  const Status status =
      trapped(finite(prior) && P0.allFinite(), [&] { return odometry_->reset(prior, P0); });
  if (status == Status::kOk) {
    check_new(true);
    return status;
  }
  check_estimate(before);
  RIO_FUZZ_CHECK(estimate() == old);
  RIO_FUZZ_CHECK(same(odometry_->counters(), before));
  return status;
}

void Judge::reset() {
  ++calls.reset;
  {
    const TrapFloatingPoint trap(true);
    odometry_->reset();
  }
  check_new(false);
}

void Judge::check_new(bool initialized) {
  scans_given_ = 0;
  check_estimate(Counters{});
  RIO_FUZZ_CHECK(odometry_->initialized() == initialized);
  RIO_FUZZ_CHECK(same(odometry_->counters(), Counters{}));
}

}  // namespace rio::fuzz
