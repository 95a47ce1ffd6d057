// SPDX-License-Identifier: BSD-3-Clause
#include "rio/checks/velocity_check.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "rio/core/motion.hpp"
#include "rio/core/random.hpp"
#include "rio/core/small_cholesky.hpp"
#include "rio/core/so3.hpp"
#include "rio/propagate/strapdown.hpp"

namespace rio {

VelocityCheck::VelocityCheck(const Options& options)
    : options_(options), tightest_(tightest_fold(options)) {
  for (std::size_t r = 0; r < options.radars(); ++r) {
    (void)folds_.push_back(doppler_fold(options, r));
  }
  rows_.reserve(kMaxRows);
}

std::optional<IndependentVelocity> VelocityCheck::observe(const DetectionList& scan,
                                                          const Estimate& x, double sigma,
                                                          double sigma_tilt, bool at_rest) {
  chance_ = 0.0;
  if (!options_.checks.velocity) return abstain(x.nav.time);
  drift_ = std::hypot(kDrift, options_.imu.gravity * sigma_tilt);
  take(scan, x);
  complete(x);
  const Time now = x.nav.time;
  const int n = static_cast<int>(rows_.size());
  if (n < kMinRows) return abstain(now);
  const Vector3d predicted = x.nav.q_WB.conjugate() * x.nav.v_WB;
  chance_ = chance_share(predicted, sigma);
  const double supported = static_cast<double>(count_support(predicted)) / n;
  const double likely = likelihood(predicted);
  const bool unique_fold = tightest_.is_unique(sigma * sigma);
  if (unique_fold && supported >= kAgreement && likely > kMinLikelihoodPerRow * n)
    return agree(now);

  Vector3d best = Vector3d::Zero();
  const bool alone = search(predicted, scan.time, &best);
  if (unique_fold && kLikelihoodRatio * likely > likelihood(best)) {
    return supported >= kMajority ? agree(now) : abstain(now);
  }
  if (!alone || rows_.back().time - rows_.front().time < kSpan) return std::nullopt;
  const int count = count_support(best);
  if (count < kMinRows || count < kMajority * n) return abstain(now);
  std::optional<IndependentVelocity> other = refine(best);
  if (!other) return abstain(now);
  // an error within the covariance is corrected by the update
  const double difference = (other->v_B - predicted).norm();
  if (unique_fold && difference < 3.0 * sigma) return std::nullopt;
  contradiction_ = difference;
  if (!record_.lasts(now, proven() && !at_rest ? kLongPatience : kPatience)) return std::nullopt;
  return other;
}

std::nullopt_t VelocityCheck::agree(Time now) {
  proven_ += to_seconds(now - record_.agreed());
  contradiction_ = 0.0;
  return record_.agree(now);
}

void VelocityCheck::carry(const Estimate& x, Time last, const ImuBuffer& imu, bool gap) {
  if (gap) {
    rows_.clear();
    proven_ = 0.0;
  }
  const ImuIncrements since = imu_increments(last, x.nav.time, x.nav, imu);
  const Matrix3d C = since.turn.transpose();
  for (Row& row : rows_) {
    row.a = C * row.a;
    row.s = C * (row.s + since.velocity);
    row.age = to_seconds(x.nav.time - row.time);
  }
  const auto young = std::find_if(rows_.begin(), rows_.end(),
                                  [&](const Row& row) { return x.nav.time - row.time <= kWindow; });
  rows_.erase(rows_.begin(), young);
}

void VelocityCheck::take(const DetectionList& scan, const Estimate& x) {
  const Matrix3d R_BS = x.T_BS.rotation.toRotationMatrix();
  const Vector3d lever = (x.gyro_B - x.nav.gyro_bias).cross(x.T_BS.translation);
  const DopplerFold fold = folds_[scan.radar].divided(1.0 + x.doppler_scale);
  const std::size_t stride = 1 + scan.items.size() / kScanRows;
  for (std::size_t i = 0; i < scan.items.size(); i += stride) {
    if (rows_.size() == kMaxRows) {
      rows_.erase(rows_.begin(), rows_.begin() + kMaxRows / 6);
    }
    const Detection& d = scan.items[i];
    Row row;
    row.time = x.nav.time;
    row.a = R_BS * d.direction_S;
    row.y = -d.range_rate - row.a.dot(lever);
    row.sigma_doppler = d.sigma_doppler;
    row.sigma_direction =
        std::sqrt(0.5 * (d.sigma_azimuth_S.squaredNorm() + d.sigma_elevation_S.squaredNorm()));
    row.fold = fold;
    rows_.push_back(row);
  }
}

void VelocityCheck::complete(const Estimate& x) {
  constexpr double kRootTwoPi = 2.5066282746;
  const Vector3d g_B = x.nav.q_WB.conjugate() * Vector3d(0.0, 0.0, -options_.imu.gravity);
  const auto n = static_cast<Eigen::Index>(rows_.size());
  columns_.a.resize(n, 3);
  for (RowArray* column :
       {&columns_.a_v, &columns_.variance_doppler, &columns_.variance_direction,
        &columns_.allowance, &columns_.period, &columns_.folds_per_metre, &columns_.range}) {
    column->resize(n);
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    Row& row = rows_[static_cast<std::size_t>(i)];
    row.a_v = row.y + row.a.dot(row.s + row.age * g_B);
    columns_.a.row(i) = row.a.transpose().array();
    columns_.a_v[i] = row.a_v;
    columns_.variance_doppler[i] = row.sigma_doppler * row.sigma_doppler;
    columns_.variance_direction[i] = row.sigma_direction * row.sigma_direction;
    columns_.allowance[i] = drift_ / 3.0 * row.age;
    columns_.period[i] = row.fold.ambiguous() ? 2.0 * row.fold.limit() : 0.0;
    columns_.folds_per_metre[i] = row.fold.ambiguous() ? 1.0 / columns_.period[i] : 0.0;
    columns_.range[i] = 2.0 * std::min(row.fold.limit(), kRange) / kRootTwoPi;
  }
}

double VelocityCheck::sigma(const Row& row, double speed) const {
  const double direction = row.sigma_direction * std::min(speed, kFastestRobot);
  const double own = std::sqrt(row.sigma_doppler * row.sigma_doppler + direction * direction);
  return std::max(options_.frontend.ransac_threshold / 3.0, own) + drift_ / 3.0 * row.age;
}

int VelocityCheck::count_support(const Vector3d& v) const {
  const double speed = v.norm();
  return static_cast<int>(std::count_if(rows_.begin(), rows_.end(), [&](const Row& row) {
    return std::abs(residual(row, v)) < 3.0 * sigma(row, speed);
  }));
}

double VelocityCheck::likelihood(const Vector3d& v, double needed) const {
  const double speed = std::min(v.norm(), kFastestRobot);
  const Columns& c = columns_;
  const RowArray own = (c.variance_doppler + speed * speed * c.variance_direction)
                           .sqrt()
                           .max(options_.frontend.ransac_threshold / 3.0) +
                       c.allowance;
  RowArray r = c.a_v - (c.a.col(0) * v.x() + c.a.col(1) * v.y() + c.a.col(2) * v.z());
  if (tightest_.ambiguous()) r -= c.period * (r * c.folds_per_metre).rint();  // all of them wrapped
  // no row contributes more than a zero residual with the smallest sigma
  const double most = std::log((c.range / own).maxCoeff());
  if (static_cast<double>((r.abs() <= 3.0 * own).count()) * most < needed) return 0.0;
  double sum = 0.0;
  for (Eigen::Index i = 0; i < r.size(); ++i) {
    const double square = r[i] * r[i];
    const double variance = own[i] * own[i];
    if (square > 9.0 * variance) continue;
    sum += std::max(0.0, std::log(c.range[i] / own[i]) - 0.5 * square / variance);
  }
  return sum;
}

double VelocityCheck::chance_share(const Vector3d& v, double sigma) const {
  const double speed = v.norm();
  double inside = 0.0;
  double expected = 0.0;
  for (const Row& row : rows_) {
    const double bound = 3.0 * (this->sigma(row, speed) + sigma);
    const double band = std::min(kPaceOfPeople, row.fold.limit() - bound);
    const double r = std::abs(residual(row, v));
    if (r < bound) {
      inside += 1.0;
    } else if (r < bound + band) {
      expected += bound / band;
    }
  }
  return expected < inside ? expected / inside : 1.0;
}

bool VelocityCheck::search(const Vector3d& predicted, Time seed, Vector3d* best) const {
  SplitMix64 random(static_cast<std::uint64_t>(seed.count()));
  const double apart = 0.5 * std::min(tightest_.limit(), 2.0);  // half a fold, 1 m/s at most
  *best = Vector3d::Zero();
  double most = likelihood(*best);
  double rival = 0.0;
  const auto consider = [&](Vector3d v) {
    if (v.norm() > kFastestRobot) return;
    double L = likelihood(v, kRivalRatio * most);
    if (L > kRivalRatio * most && (v - *best).norm() > apart) {  // another one, or does it scatter?
      v = local_maximum(v);
      if (v.norm() > kFastestRobot) return;
      L = likelihood(v, kRivalRatio * most);
    }
    const bool far = (v - *best).norm() > apart;
    if (L > most) {
      if (far) rival = most;
      most = L;
      *best = v;
    } else if (far) {
      rival = std::max(rival, L);
    }
  };
  consider(predicted);
  const auto n = static_cast<std::uint32_t>(rows_.size());
  for (int draw = 0; draw < kDraws; ++draw) {
    Matrix3d A;
    Vector3d b;
    Vector3d period;
    std::array<DopplerFold, 3> fold;
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t i = random.below(n);
      const Row& row = rows_[i];
      A.row(k) = row.a.transpose();
      b[k] = row.a_v;
      period[k] = columns_.period[i];
      fold[static_cast<std::size_t>(k)] = row.fold;
    }
    if (std::abs(A.determinant()) < kLeastVolume) continue;
    const Matrix3d inverse = A.inverse();
    consider(inverse * b);
    if (!tightest_.ambiguous()) continue;
    const Vector3d expected = A * predicted;
    consider(inverse * Vector3d(fold[0].nearest(b[0], expected[0]),
                                fold[1].nearest(b[1], expected[1]),
                                fold[2].nearest(b[2], expected[2])));
    if (draw % 4 != 0) continue;
    for (int k = 0; k < 27; ++k) {  // one fold up or down in each row
      const Eigen::Vector3i folds(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
      consider(inverse * (b + period.cwiseProduct(folds.cast<double>())));
    }
  }
  return rival < kRivalRatio * most;
}

Vector3d VelocityCheck::local_maximum(Vector3d v) const {
  for (int i = 0; i < kClimb; ++i) {
    const std::optional<IndependentVelocity> next = refine(v);
    if (!next) break;
    v = next->v_B;
  }
  return v;
}

std::optional<IndependentVelocity> VelocityCheck::refine(const Vector3d& v) const {
  const double speed = v.norm();
  Matrix3d A = Matrix3d::Zero();
  Vector3d b = Vector3d::Zero();
  for (const Row& row : rows_) {
    const double r = residual(row, v);
    const double own = sigma(row, speed);
    if (!(std::abs(r) < 3.0 * own)) continue;
    A += row.a * row.a.transpose() / (own * own);
    b += row.a * (r / (own * own));
  }
  const Matrix3d weakest = Matrix3d::Identity() / (kWeak * kWeak);
  if (!SmallCholesky<3>(A - weakest).positive()) return std::nullopt;  // an eigenvalue is less
  const Matrix3d inverse = A.inverse();
  return IndependentVelocity{v + inverse * b, kRepetitionInWindow * inverse +
                                                  kLeastSigma * kLeastSigma * Matrix3d::Identity()};
}

}  // namespace rio
