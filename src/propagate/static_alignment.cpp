// SPDX-License-Identifier: BSD-3-Clause
#include "rio/propagate/static_alignment.hpp"

#include <algorithm>
#include <cmath>

namespace rio {

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
  const Time half = from_seconds(0.5 * start_.duration);
  if (halves_[0].count == 0) begin_ = sample.time;
  halves_[sample.time - begin_ < half ? 0 : 1].add(sample);
  if (sample.time - begin_ < 2 * half) return Status::kOk;
  const bool still = standstill();
  if (still) *result = align(sample.time);
  reset();
  return still ? Status::kOk : Status::kMoving;
}

void StaticAligner::Half::add(const ImuSample& s) {
  Eigen::Matrix<double, 6, 1> x;
  x << s.gyro_B, s.accel_B;
  count += 1.0;
  const Eigen::Matrix<double, 6, 1> delta = x - mean;
  mean += delta / count;
  squares += delta.cwiseProduct(x - mean);
}

bool StaticAligner::standstill() const {
  for (const Half& half : halves_) {
    if (half.count < 3.0) return false;
    if (half.deviation().head<3>().maxCoeff() > start_.max_gyro_std) return false;
    if (half.deviation().tail<3>().maxCoeff() > start_.max_accel_std) return false;
  }
  const Eigen::Matrix<double, 6, 1> mean = 0.5 * (halves_[0].mean + halves_[1].mean);
  if (mean.head<3>().norm() > start_.max_rate) return false;
  // an accelerometer at rest reads gravity; more than ten prior sigmas off is acceleration
  if (std::abs(mean.tail<3>().norm() - imu_.gravity) > 10.0 * start_.sigma_accel_bias) return false;
  // the halves agree within five sigmas of their own noise, or a tenth of the largest deviation
  const Eigen::Matrix<double, 6, 1> difference = (halves_[1].mean - halves_[0].mean).cwiseAbs();
  const Eigen::Matrix<double, 6, 1> noise =
      5.0 * (halves_[0].deviation().cwiseAbs2() / halves_[0].count +
             halves_[1].deviation().cwiseAbs2() / halves_[1].count)
                .cwiseSqrt();
  for (int i = 0; i < 6; ++i) {
    const double floor = 0.1 * (i < 3 ? start_.max_gyro_std : start_.max_accel_std);
    if (difference[i] > std::max(noise[i], floor)) return false;
  }
  return true;
}

Alignment StaticAligner::align(Time time) const {
  const double count = halves_[0].count + halves_[1].count;
  const Eigen::Matrix<double, 6, 1> mean =
      (halves_[0].count * halves_[0].mean + halves_[1].count * halves_[1].mean) / count;
  const Vector3d f = mean.tail<3>();
  const Vector3d y = f.normalized();
  const double duration = start_.duration;

  Alignment out;
  out.state.time = time;
  out.state.q_WB = level(y);
  out.state.gyro_bias = mean.head<3>();
  // scalar Kalman update of y.b_a with |f| - g; local gravity varies by some 0.02 m/s^2 on Earth
  const double prior = start_.sigma_accel_bias * start_.sigma_accel_bias;
  const double noise = imu_.accel_noise_density * imu_.accel_noise_density / duration;
  const double gain = prior / (prior + noise + kGravitySpread * kGravitySpread);
  out.state.accel_bias = y * (gain * (f.norm() - imu_.gravity));

  using namespace body;
  const Matrix3d along = y * y.transpose();
  const Matrix3d across = Matrix3d::Identity() - along;
  const Matrix3d tilt_from_bias = skew(y) / imu_.gravity;  // (E2)
  const Matrix3d P_aa = prior * (across + (1.0 - gain) * along);
  const double gyro_bias_sigma = imu_.gyro_noise_density / std::sqrt(duration) + kGyroBiasFloor;
  BodyCovariance& P = out.covariance;
  P.block<3, 3>(kAccelBias, kAccelBias) = P_aa;
  P.block<3, 3>(kAttitude, kAccelBias) = tilt_from_bias * P_aa;
  P.block<3, 3>(kAccelBias, kAttitude) = P_aa * tilt_from_bias.transpose();
  P.block<3, 3>(kAttitude, kAttitude) = tilt_from_bias * P_aa * tilt_from_bias.transpose() +
                                        noise / (imu_.gravity * imu_.gravity) * across +
                                        start_.sigma_yaw * start_.sigma_yaw * along;
  P.block<3, 3>(kGyroBias, kGyroBias) = Matrix3d::Identity() * gyro_bias_sigma * gyro_bias_sigma;
  P.block<3, 3>(kPosition, kPosition) =
      Matrix3d::Identity() * start_.sigma_position * start_.sigma_position;
  P.block<3, 3>(kVelocity, kVelocity) = Matrix3d::Identity() * kStillVelocity * kStillVelocity;
  return out;
}

std::optional<Vector3d> standstill_gyro_bias(const std::vector<ImuSample>& samples, Time from,
                                             const Options& options) {
  StaticAligner aligner(options.start, options.imu);
  std::optional<Alignment> result;
  for (const ImuSample& sample : samples) {
    if (sample.time < from) continue;
    if (aligner.add(sample, &result) == Status::kMoving) return std::nullopt;
    if (result) return result->state.gyro_bias;
  }
  return std::nullopt;
}

}  // namespace rio
