// SPDX-License-Identifier: BSD-3-Clause
#include "rio/propagate/static_alignment.hpp"

#include "rio/core/motion.hpp"
#include "rio/core/so3.hpp"

#include <algorithm>
#include <cmath>

namespace rio {

namespace {

// deviation of a sample at a standstill with the engine running
constexpr double kMaxGyroStd = 0.1;   // [rad/s]
constexpr double kMaxAccelStd = 1.0;  // [m/s^2]
// of the gyro with the engine off: some times the noise of a MEMS gyro at 200 Hz
constexpr double kQuietGyroStd = 0.01;  // [rad/s]
constexpr double kQuietSway = 0.05;     // of the accelerometer: a tilt by 0.3 deg [m/s^2]

}  // namespace

Quaternion level(const Vector3d& y) {
  Vector3d forward = Vector3d::UnitX() - y.x() * y;
  if (forward.norm() < 1e-3) forward = Vector3d::UnitY().cross(y);
  forward.normalize();
  Matrix3d R;
  R.row(0) = forward;
  R.row(1) = y.cross(forward);
  R.row(2) = y;
  return Quaternion(R);
}

Status StaticAligner::add(const ImuSample& sample, std::optional<Alignment>* result) {
  result->reset();
  const Time length = from_seconds(start_.duration / kParts);
  const Time window = static_cast<int>(kParts) * length;
  if (begin_ && sample.time - *begin_ > 2 * window) reset();  // the IMU paused
  if (!begin_) begin_ = sample.time;
  const Time elapsed = sample.time - *begin_;
  parts_[std::min(static_cast<std::size_t>(elapsed / length), kParts - 1)].add(sample);
  if (elapsed < window) return Status::kOk;
  for (std::size_t n = kParts; n >= (first_ ? kLeast : kParts); --n) {
    if (!standstill(n)) continue;
    *result = align(n == kParts ? sample.time : *begin_ + static_cast<int>(n) * length, n);
    reset();
    return Status::kOk;
  }
  first_ = false;
  std::rotate(parts_.begin(), parts_.begin() + 1, parts_.end());
  parts_.back() = Part{};
  *begin_ += length;
  return Status::kMoving;
}

StaticAligner::Vector6d StaticAligner::Part::deviation() const {
  return (squares / (count - 1.0)).cwiseSqrt();
}

void StaticAligner::Part::add(const ImuSample& s) {
  Vector6d x;
  x << s.gyro_B, s.accel_B;
  count += 1.0;
  const Vector6d delta = x - mean;
  mean += delta / count;
  squares += delta.cwiseProduct(x - mean);
}

StaticAligner::Vector6d StaticAligner::mean(std::size_t n) const {
  Vector6d sum = Vector6d::Zero();
  for (std::size_t i = 0; i < n; ++i) sum += parts_[i].mean;
  return sum / static_cast<double>(n);
}

StaticAligner::Vector6d StaticAligner::scatter(std::size_t n) const {
  const Vector6d m = mean(n);
  Vector6d sum = Vector6d::Zero();
  for (std::size_t i = 0; i < n; ++i) sum += (parts_[i].mean - m).cwiseAbs2();
  return sum / static_cast<double>(n - 1);
}

bool StaticAligner::standstill(std::size_t n) const {
  const bool noisy = n >= kLeastNoisy;
  const double gyro_std = noisy ? kMaxGyroStd : kQuietGyroStd;
  const double accel_sway = noisy ? kSway * kMaxAccelStd : kQuietSway;
  Vector6d white = Vector6d::Zero();  // variance of the mean of a part if its noise were white
  for (std::size_t i = 0; i < n; ++i) {
    const Part& part = parts_[i];
    if (part.count < 2.0) return false;
    if (part.deviation().head<3>().maxCoeff() > gyro_std) return false;
    if (part.deviation().tail<3>().maxCoeff() > kMaxAccelStd) return false;
    white += part.deviation().cwiseAbs2() / (part.count * static_cast<double>(n));
  }
  const Vector6d sway = scatter(n).cwiseSqrt();
  for (int i = 0; i < 6; ++i) {
    const double largest = i < 3 ? kSway * gyro_std : accel_sway;
    if (sway[i] > std::max(largest, kWhiteSigmas * std::sqrt(white[i]))) return false;
  }
  const Vector6d mean = this->mean(n);
  if (mean.head<3>().norm() > start_.max_rate) return false;
  // an accelerometer at rest reads gravity; more than ten prior sigmas off is acceleration
  return std::abs(mean.tail<3>().norm() - imu_.gravity) <= 10.0 * start_.sigma_accel_bias;
}

StaticAligner::Turn StaticAligner::slow_turn(double rate) const {  // (E5)
  const auto density = [rate](double sigma) {
    return std::exp(-0.5 * rate * rate / (sigma * sigma)) / sigma;
  };
  const double bias = std::max(kTurnOn, start_.sigma_gyro_bias);
  const double turns = kTurning * density(std::max(start_.max_rate, 2.0 * bias));
  const double w = turns / (turns + (1.0 - kTurning) * density(bias));
  return {w * rate, w * (bias * bias + (1.0 - w) * rate * rate)};
}

Alignment StaticAligner::align(Time time, std::size_t n) const {
  const Vector6d mean = this->mean(n);
  const Vector6d scatter = this->scatter(n);
  const auto parts = static_cast<double>(n);
  const Vector3d f = mean.tail<3>();
  const Vector3d y = f.normalized();
  const double duration = start_.duration * parts / static_cast<double>(kParts);
  const auto noise_of_mean = [&](double density, double variance) {  // (E4)
    return std::max(density * density / duration, variance / parts);
  };

  Alignment out;
  out.state.time = time;
  out.state.q_WB = level(y);
  // scalar Kalman update of y.b_a with |f| - g; local gravity varies by some 0.02 m/s^2 on Earth
  const double prior = start_.sigma_accel_bias * start_.sigma_accel_bias;
  const double noise = noise_of_mean(imu_.accel_noise_density, scatter.tail<3>().mean());
  const double gain = prior / (prior + noise + kGravitySpread * kGravitySpread);
  out.state.accel_bias = y * (gain * (f.norm() - imu_.gravity));
  const Turn turn = slow_turn(y.dot(mean.head<3>()));
  out.state.gyro_bias = mean.head<3>() - turn.rate * y;

  using namespace body;
  const Matrix3d along = y * y.transpose();
  const Matrix3d across = Matrix3d::Identity() - along;
  const Matrix3d tilt_from_bias = skew(y) / imu_.gravity;  // (E2)
  const Matrix3d P_aa = prior * (across + (1.0 - gain) * along);
  const double gyro_bias_sigma =
      std::sqrt(noise_of_mean(imu_.gyro_noise_density, scatter.head<3>().mean())) + kGyroBiasFloor;
  // independent accelerations of that scatter, one per part, integrated over the window
  const double sway = scatter.tail<3>().mean() * duration * duration / parts;
  BodyCovariance& P = out.covariance;
  P.block<3, 3>(kAccelBias, kAccelBias) = P_aa;
  P.block<3, 3>(kAttitude, kAccelBias) = tilt_from_bias * P_aa;
  P.block<3, 3>(kAccelBias, kAttitude) = P_aa * tilt_from_bias.transpose();
  P.block<3, 3>(kAttitude, kAttitude) = tilt_from_bias * P_aa * tilt_from_bias.transpose() +
                                        noise / (imu_.gravity * imu_.gravity) * across +
                                        start_.sigma_yaw * start_.sigma_yaw * along;
  P.block<3, 3>(kGyroBias, kGyroBias) =
      gyro_bias_sigma * gyro_bias_sigma * Matrix3d::Identity() + turn.variance * along;
  P.block<3, 3>(kPosition, kPosition) =
      Matrix3d::Identity() * start_.sigma_position * start_.sigma_position;
  P.block<3, 3>(kVelocity, kVelocity) =
      (kStandstillVelocity * kStandstillVelocity + sway) * Matrix3d::Identity();
  return out;
}

std::optional<Vector3d> standstill_gyro_bias(const NextSample& next, Time from,
                                             const Options& options) {
  StaticAligner aligner(options.start, options.imu);
  std::optional<Alignment> result;
  for (ImuSample sample; next(&sample);) {
    if (sample.time < from || !(sample.gyro_B + sample.accel_B).allFinite()) continue;
    if (aligner.add(sample, &result) == Status::kMoving) return std::nullopt;
    if (result) return result->state.gyro_bias;
  }
  return std::nullopt;
}

}  // namespace rio
