// SPDX-License-Identifier: BSD-3-Clause
#include "rio/checks/tilt_check.hpp"

#include <algorithm>
#include <cmath>

#include "rio/core/motion.hpp"
#include "rio/core/small_cholesky.hpp"
#include "rio/core/so3.hpp"
#include "rio/propagate/strapdown.hpp"

namespace rio {

TiltCheck::TiltCheck(const Options& options)
    : options_(options), fold_(tightest_fold(options)), scans_(kMaxScans) {}

std::optional<IndependentGravity> TiltCheck::observe(const Observations& seen, const Estimate& x,
                                                     const BodyCovariance& P_body,
                                                     const Matrix4d& P_radar) {
  const Time now = x.nav.time;
  if (!options_.checks.tilt) return record_.agree(now);
  // without a unique fold the unfolded Dopplers may be wrong
  const double variance = P_body.block<3, 3>(body::kVelocity, body::kVelocity).trace();
  if (!fold_.is_unique(variance)) reset(now);
  take(seen, x);
  const double span = to_seconds(now - scans_.front().time);
  if (span < to_seconds(kSpan)) return record_.agree(now);
  const std::optional<Fit> fitted = fit_dopplers(now);
  const Fit other = fitted ? *fitted : without_dopplers(x);
  const Vector3d g_B = x.nav.q_WB.conjugate() * Vector3d(0.0, 0.0, -options_.imu.gravity);
  const Vector3d D = other.g - g_B;  // (E3)
  const Matrix3d J = skew(g_B);      // dD/dtheta; dD/db = -I
  const Matrix3d cross = J * P_body.block<3, 3>(body::kAttitude, body::kAccelBias);
  Matrix3d S = J * P_body.block<3, 3>(body::kAttitude, body::kAttitude) * J.transpose();  // (E4)
  S += P_body.block<3, 3>(body::kAccelBias, body::kAccelBias) - cross - cross.transpose();
  S += other.covariance;
  S += other.slope * P_radar * other.slope.transpose();
  S.diagonal().array() += 1.2 * density_ / span + kMovers * kMovers;
  const SmallCholesky<3> root(S);
  if (!root.positive() || root.whitened(D).squaredNorm() < kSigmas * kSigmas) {
    return record_.agree(now);
  }
  if (!record_.lasts(now, kPatience)) return std::nullopt;
  const double bias = std::min(D.norm(), kMaxBias);
  return IndependentGravity{other.g, std::sqrt(other.covariance.trace() / 3.0 + bias * bias),
                            other.velocity};
}

void TiltCheck::carry(const Estimate& x, Time last, const ImuBuffer& imu, bool gap) {
  if (gap) reset(x.nav.time);
  const ImuIncrements since = imu_increments(last, x.nav.time, x.nav, imu);
  const Matrix3d R = since.turn.transpose();
  for (std::size_t i = 0; i < scans_.size(); ++i) {
    Scan& scan = scans_[i];
    scan.N = R * scan.N * R.transpose();
    scan.U = R * scan.U * R.transpose();
    scan.c = R * scan.c;
    scan.s = R * (scan.s + since.velocity);
    scan.C = R * scan.C;
  }
  if (since.seconds > 0.0) {
    double variance = 0.0;
    imu.for_each_step(last, x.nav.time, [&](const ImuStep& step) {
      variance += to_seconds(step.end - step.begin) * process_noise(options_.imu, step).accel;
    });
    const double forgotten = std::exp(-since.seconds / to_seconds(kWindow));
    density_ = std::max(forgotten * density_, variance / since.seconds);
  }
  while (!scans_.empty() && x.nav.time - scans_.front().time > kWindow) scans_.pop_front();
}

void TiltCheck::take(const Observations& seen, const Estimate& x) {
  const Matrix3d R_BS = x.T_BS.rotation.toRotationMatrix();
  const Vector3d lever = (x.gyro_B - x.nav.gyro_bias).cross(x.T_BS.translation);
  const Vector3d v_S = radar_velocity(x);
  Scan scan;
  scan.time = x.nav.time;
  for (std::size_t i = 0; i < seen.scan->items.size(); ++i) {
    if (!seen.is_static(i)) continue;
    const Detection& d = seen.detection(i);
    const double weight = 1.0 / residual_variance(d, v_S);
    const Vector3d a = R_BS * d.direction_S;
    const double y = -d.range_rate - a.dot(lever);
    const Vector3d azimuth = R_BS * d.sigma_azimuth_S;
    const Vector3d elevation = R_BS * d.sigma_elevation_S;
    scan.N += weight * a * a.transpose();
    scan.U += weight * (azimuth * azimuth.transpose() + elevation * elevation.transpose());
    scan.c += weight * y * a;
    scan.square += weight * y * y;
    ++scan.rows;
  }
  scan.N -= scan.U;
  scan.C << R_BS * skew(v_S), R_BS * v_S;
  scans_.push_back(scan);
}

std::optional<TiltCheck::Fit> TiltCheck::fit_dopplers(Time now) const {
  using Matrix6d = Eigen::Matrix<double, 6, 6>;
  Matrix6d A = Matrix6d::Zero();
  Eigen::Matrix<double, 6, 5> B = Eigen::Matrix<double, 6, 5>::Zero();  // right-hand sides
  double square = 0.0;
  int rows = 0;
  for (std::size_t i = 0; i < scans_.size(); ++i) {
    const Scan& scan = scans_[i];
    const double T = to_seconds(now - scan.time);
    Eigen::Matrix<double, 3, 5> b;
    b << scan.c + scan.N * scan.s, scan.N * scan.C;
    A.topLeftCorner<3, 3>() += scan.N;
    A.topRightCorner<3, 3>() -= T * scan.N;
    A.bottomRightCorner<3, 3>() += T * T * scan.N;
    B.topRows<3>() += b;
    B.bottomRows<3>() -= T * b;
    square += scan.square + scan.s.dot(2.0 * scan.c + scan.N * scan.s);
    rows += scan.rows;
  }
  A.bottomLeftCorner<3, 3>() = A.topRightCorner<3, 3>().transpose();
  const SmallCholesky<6> root(A);
  if (!root.positive() || rows <= 6) return std::nullopt;
  const Eigen::Matrix<double, 6, 5> solution = root.solve(B);
  const double misfit = (square - B.col(0).dot(solution.col(0))) / (rows - 6);
  if (misfit > kBadFit) return std::nullopt;
  Fit out;
  out.g = solution.bottomRows<3>().col(0);
  Eigen::Matrix<double, 6, 1> h = Eigen::Matrix<double, 6, 1>::Zero();
  for (std::size_t i = 0; i < scans_.size(); ++i) {
    const double T = to_seconds(now - scans_[i].time);
    const Vector3d v = solution.topRows<3>().col(0) - scans_[i].s - T * out.g;
    const Vector3d U_v = scans_[i].U * v;
    h.head<3>() += U_v;
    h.tail<3>() -= T * U_v;
  }
  h = (kShare * root.solve(h)).eval();
  const Matrix6d P =
      kRepetitionInWindow * std::max(1.0, misfit) * root.inverse() + h * h.transpose();
  out.covariance = P.bottomRightCorner<3, 3>();
  out.velocity = {solution.topRows<3>().col(0), P.topLeftCorner<3, 3>()};
  out.slope = solution.bottomRightCorner<3, 4>();
  if (!(out.covariance.trace() < kWeak * kWeak)) return std::nullopt;
  // the norm of gravity is known: a fit that misses it has wrong folds or moving points
  const double long_by = std::abs(out.g.norm() - options_.imu.gravity);
  if (long_by > kMaxBias + 3.0 * std::sqrt(out.covariance.trace() / 3.0)) return std::nullopt;
  return out;
}

TiltCheck::Fit TiltCheck::without_dopplers(const Estimate& x) const {
  const double T = to_seconds(x.nav.time - scans_.front().time);
  const double sigma = kVelocityChange / T;
  Fit out;
  out.g = -scans_.front().s / T;
  out.covariance = sigma * sigma * Matrix3d::Identity();
  const double run = options_.imu.gravity * T;  // largest velocity error accumulated in T
  out.velocity = {x.nav.q_WB.conjugate() * x.nav.v_WB, run * run * Matrix3d::Identity()};
  return out;
}

}  // namespace rio
