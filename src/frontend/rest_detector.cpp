// SPDX-License-Identifier: BSD-3-Clause
#include "rio/frontend/rest_detector.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "rio/core/motion.hpp"
#include "rio/core/so3.hpp"

namespace rio {

RestDetector::RestDetector(const Options& options)
    : options_(options), scans_(kMaxScans), samples_(kMaxSamples) {
  for (std::size_t r = 0; r < options.radars(); ++r) {
    coarse_[r] = options.radar_of(r).doppler_resolution > kCoarse;
  }
}

void RestDetector::reset() {
  scans_.clear();
  samples_.clear();
  calm_.reset();
  since_.reset();
  settled_ = true;
}

std::optional<RestModel::Measurement> RestDetector::observe(const DetectionList& scan, Time from,
                                                            const ImuBuffer& imu, const NavState& x,
                                                            const BodyCovariance& P) {
  if (!options_.frontend.detect_rest) return std::nullopt;
  const Time to = x.time;
  const Span span = measure_vibration(from, to, imu, x.gyro_bias);
  const double duration = to_seconds(to - from);
  Points points = points_of(scan, to);
  points.force = force_beyond_gravity(from, imu, x, options_.imu);
  if (span.samples == 0.0 && duration < kSameInstant && !scans_.empty()) {
    scans_.push_back(points);  // of another radar at the same instant: tested with the next scan
    return std::nullopt;
  }
  if (span.samples == 0.0 || duration > kLongestSpan || points.still < 0.5 * points.all) {
    scans_.clear();
    since_.reset();
    settled_ = false;
    return std::nullopt;
  }
  scans_.push_back(points);
  while (to - scans_.front().time > kWindow) scans_.pop_front();
  if (points.all == 0.0 || !calm_ || to - *calm_ > kCalmLasts || !without_doppler()) {
    return std::nullopt;
  }
  if (coarse_[scan.radar] && settled_ && starts_to_move(x, P)) return std::nullopt;
  if (!since_) since_ = to;
  settled_ = settled_ || to - *since_ > kSettled;
  const double noise = options_.imu.gyro_noise_density / std::sqrt(duration);
  const bool quiet = span.loudest < kQuiet;  // (E4)
  return RestModel::Measurement{span.gyro_B, quiet ? kStandstillVelocity : kTouchedVelocity,
                                quiet ? std::max(noise, kSmallestRate) : kUnknown};
}

RestDetector::Points RestDetector::points_of(const DetectionList& scan, Time time) {
  Points points;
  points.time = time;
  for (const Detection& d : scan.items) {
    points.all += 1.0;
    if (std::abs(d.range_rate) > kDopplerSigmas * d.sigma_doppler) continue;
    points.still += 1.0;
    const Vector3d u = d.direction_S / d.sigma_doppler;
    points.A += u * u.transpose();
    points.b += u * (d.range_rate / d.sigma_doppler);
  }
  return points;
}

bool RestDetector::without_doppler() const {
  if (scans_.back().time - scans_.front().time < kDuration) return false;
  Points sum;
  for (std::size_t i = 0; i < scans_.size(); ++i) {
    sum.all += scans_[i].all;
    sum.still += scans_[i].still;
    sum.A += scans_[i].A;
    sum.b += scans_[i].b;
  }
  if (sum.still < kMinPoints || sum.still < kShare * sum.all) return false;  // (E1)
  const Matrix3d A = sum.A + Matrix3d::Identity() / (kSlow * kSlow);
  const double chi2 = sum.b.dot(A.inverse() * sum.b);
  return chi2 < kChi2 * static_cast<double>(scans_.size());  // (E2)
}

RestDetector::Force RestDetector::force_beyond_gravity(Time from, const ImuBuffer& imu,
                                                       const NavState& x,
                                                       const ImuOptions& options) {
  const Vector3d gravity_B = x.q_WB.conjugate() * Vector3d(0.0, 0.0, -options.gravity);
  const double declared = options.accel_noise_density * options.accel_noise_density;
  Force force;
  imu.for_each_step(from, x.time, [&](const ImuStep& step) {
    const double dt = to_seconds(step.end - step.begin);
    force.duration += dt;
    force.sum_B += dt * (step.accel_B - x.accel_bias + gravity_B);
    force.variance += dt * std::max(declared, step.measured.accel);
  });
  return force;
}

bool RestDetector::starts_to_move(const NavState& x, const BodyCovariance& P) const {
  Force sum;
  for (std::size_t i = scans_.size(); i-- > 0 && x.time - scans_[i].time < kSteady;) {
    sum.duration += scans_[i].force.duration;
    sum.sum_B += scans_[i].force.sum_B;
    sum.variance += scans_[i].force.variance;
  }
  const Vector3d up_B = x.q_WB.conjugate() * Vector3d::UnitZ();
  Eigen::Matrix<double, 3, 6> J;  // of the force by tilt and bias
  J << options_.imu.gravity * skew(up_B), Matrix3d::Identity();
  Eigen::Matrix<double, 6, 6> known;
  known << P.block<3, 3>(body::kAttitude, body::kAttitude),
      P.block<3, 3>(body::kAttitude, body::kAccelBias),
      P.block<3, 3>(body::kAccelBias, body::kAttitude),
      P.block<3, 3>(body::kAccelBias, body::kAccelBias);
  const Matrix3d S = sum.duration * sum.duration * (J * known * J.transpose()) +
                     sum.variance * Matrix3d::Identity();
  return sum.sum_B.dot(S.inverse() * sum.sum_B) > kForceChi2;
}

RestDetector::Span RestDetector::measure_vibration(Time from, Time to, const ImuBuffer& imu,
                                                   const Vector3d& gyro_bias) {
  Span span;
  for (std::size_t i = 0; i < imu.size(); ++i) {
    if (imu[i].time <= from || imu[i].time > to) continue;
    samples_.push_back(imu[i]);
    span.samples += 1.0;
    span.gyro_B += (imu[i].gyro_B - span.gyro_B) / span.samples;
    const std::optional<Moment> now = moment(gyro_bias);
    if (!now) continue;
    span.loudest = std::max(span.loudest, now->spread);
    if (now->spread < kCalm && now->vibration < kVibration) calm_ = imu[i].time;
  }
  return span;
}

std::optional<RestDetector::Moment> RestDetector::moment(const Vector3d& gyro_bias) const {
  std::size_t n = std::min(kMinSamples, samples_.size());
  const Time end = samples_.back().time;
  while (n < samples_.size() && end - samples_[samples_.size() - n - 1].time < kMoment) ++n;
  if (n < kMinSamples) return std::nullopt;
  const std::size_t first = samples_.size() - n;
  const auto values = [&](std::size_t i) {
    Vector6d x;
    x << samples_[first + i].gyro_B, samples_[first + i].accel_B;
    return x;
  };
  Vector6d mean = Vector6d::Zero();
  for (std::size_t i = 0; i < n; ++i) mean += values(i);
  mean /= static_cast<double>(n);
  Vector6d square = Vector6d::Zero();
  Vector6d rough = Vector6d::Zero();
  for (std::size_t i = 0; i < n; ++i) {
    square += (values(i) - mean).cwiseAbs2();
    if (i < 4) continue;
    const Vector6d e =
        values(i) - 4.0 * values(i - 1) + 6.0 * values(i - 2) - 4.0 * values(i - 3) + values(i - 4);
    rough += e.cwiseAbs2();
  }
  square /= static_cast<double>(n - 1);
  rough /= 70.0 * static_cast<double>(n - 4);  // 70 = 1 + 16 + 36 + 16 + 1
  const double root_rate =
      std::sqrt(static_cast<double>(n - 1) / to_seconds(end - samples_[first].time));
  Vector6d white;
  white.head<3>().setConstant(std::max(options_.imu.gyro_noise_density * root_rate, kGyroFloor));
  white.tail<3>().setConstant(std::max(options_.imu.accel_noise_density * root_rate, kAccelFloor));
  const double rate = (mean.head<3>() - gyro_bias).cwiseAbs().maxCoeff() / white[0];
  return Moment{std::max(rate, square.cwiseSqrt().cwiseQuotient(white).maxCoeff()),
                rough.cwiseSqrt().cwiseQuotient(white).maxCoeff()};
}

}  // namespace rio
