// SPDX-License-Identifier: BSD-3-Clause
#include "rio/eval/noise_fit.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "rio/core/chi2.hpp"
#include "rio/core/small_cholesky.hpp"
#include "rio/types.hpp"

namespace rio::eval {

namespace {

constexpr int kCount = 5;
constexpr int kWeak = 4;
using Parameters = Eigen::Matrix<double, kCount, 1>;
using Information = Eigen::Matrix<double, kCount, kCount>;
using Iterator = std::vector<NoiseSample>::const_iterator;

constexpr double kKept = 0.95;       // of normal innovations
constexpr int kIterations = 60;      // the cut makes convergence linear, about 0.5 per step
constexpr double kTolerance = 1e-3;  // of ln s: far below any standard error
constexpr double kToleranceDb = 0.02;
constexpr double kLargestStep = 0.5;  // of ln s
constexpr double kLargestStepDb = 5.0;
constexpr double kInvisible = 20.0;  // growth by 1 % of the variance [dB]
constexpr std::ptrdiff_t kStretches = 20;

struct Sums {
  Parameters score = Parameters::Zero();
  Information information = Information::Zero();
};

/// (E3) for each number of degrees of freedom.
struct Cut {
  explicit Cut(int dof)
      : limit(chi2_quantile(kKept, dof)), kept_variance(chi2_cdf(limit, dof + 2.0) / kKept) {}
  double limit;
  double kept_variance;
};

const Cut& cut(Eigen::Index dof) {
  static const std::array<Cut, NoiseSample::kMaxDof> kCuts = {Cut(1), Cut(2), Cut(3)};
  return kCuts[static_cast<std::size_t>(dof - 1)];
}

/// (E2) and (E4) of one sample.
void add(const NoiseSample& sample, const Parameters& x, Sums* sums) {
  const Eigen::Vector4d variance = (2.0 * x.head<4>()).array().exp();
  const double weak = std::pow(10.0, -0.1 * (sample.snr_db - x[kWeak]));
  const double growth = 1.0 + std::min(1.0, weak);  // (E1)
  const Eigen::Vector4d grown(variance[0], growth * variance[1], growth * variance[2], variance[3]);
  // padded to three dimensions, on which nothing depends
  const Eigen::Index n = sample.innovation.size();
  Matrix3d S = Matrix3d::Identity();
  Vector3d innovation = Vector3d::Zero();
  Eigen::Matrix<double, kCount, 3> d = Eigen::Matrix<double, kCount, 3>::Zero();  // of S_ii by x
  const double growth_slope = weak < 1.0 ? 0.1 * std::log(10.0) * weak : 0.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) S(i, j) = sample.predicted(i, j);
    S(i, i) += sample.grid[i];
    innovation[i] = sample.innovation[i];
    for (Eigen::Index k = 0; k < 4; ++k) {
      S(i, i) += sample.gain(i, k) * grown[k];
      d(k, i) = 2.0 * sample.gain(i, k) * grown[k];
    }
    d(kWeak, i) =
        growth_slope * (sample.gain(i, 1) * variance[1] + sample.gain(i, 2) * variance[2]);
  }
  const SmallCholesky<3> cholesky(S);
  if (!cholesky.positive()) return;
  const Vector3d y = cholesky.solve(innovation);
  const Cut& cut_here = cut(n);
  if (!(innovation.dot(y) < cut_here.limit)) return;
  const Matrix3d inverse = cholesky.inverse();
  for (int i = 0; i < 3; ++i) {
    const double excess = y[i] * y[i] / cut_here.kept_variance - inverse(i, i);
    sums->score += 0.5 * excess * d.col(i);
    for (int j = 0; j < 3; ++j) {
      const Parameters weighted = 0.5 * inverse(i, j) * inverse(i, j) * d.col(j);
      sums->information += d.col(i) * weighted.transpose();
    }
  }
}

Sums accumulate(const Parameters& x, Iterator begin, Iterator end) {
  Sums sums;
  for (; begin != end; ++begin) add(*begin, x, &sums);
  return sums;
}

/// (E4); w is fixed if no echo is weak enough to observe it.
std::optional<Parameters> scoring_step(const Sums& sums) {
  Information information = sums.information;
  constexpr double kVague = 1e-3;  // a sigma of 30 dB: keeps w without information
  information(kWeak, kWeak) += kVague;
  const SmallCholesky<kCount> cholesky(information);
  if (!cholesky.positive()) return std::nullopt;
  const Parameters step = cholesky.solve(sums.score);
  if (!step.allFinite()) return std::nullopt;
  return step;
}

Information score_jacobian(const std::vector<NoiseSample>& samples, const Parameters& x) {
  Information J;
  for (int k = 0; k < kCount; ++k) {
    // wide enough that many samples cross the cut
    const double step = k == kWeak ? 2.0 : 0.2;
    const Parameters change = step * Parameters::Unit(k);
    J.col(k) = (accumulate(x + change, samples.begin(), samples.end()).score -
                accumulate(x - change, samples.begin(), samples.end()).score) /
               (2.0 * step);
  }
  return J;
}

/// (E5)
/// @param lowest_w below it no growth can be seen
std::optional<NoiseFit> with_errors(const std::vector<NoiseSample>& samples, const Parameters& x,
                                    const Eigen::Vector4d& lowest, double lowest_w) {
  const auto total = static_cast<std::ptrdiff_t>(samples.size());
  Information spread = Information::Zero();
  for (std::ptrdiff_t b = 0; b < kStretches; ++b) {
    const Parameters g = accumulate(x, samples.begin() + b * total / kStretches,
                                    samples.begin() + (b + 1) * total / kStretches)
                             .score;
    spread += g * g.transpose();
  }
  NoiseFit fit;
  fit.noise = {x.head<4>().array().exp(), x[kWeak]};
  fit.growth_seen = x[kWeak] > lowest_w + 0.25 * kInvisible;
  std::vector<int> free;
  for (int k = 0; k < kWeak; ++k) {
    const auto at = static_cast<std::size_t>(k);
    fit.at_bound[at] = x[k] <= lowest[k] + kTolerance;
    if (!fit.at_bound[at]) free.push_back(k);
  }
  if (fit.growth_seen) free.push_back(kWeak);
  const auto of_free = [&free](const Information& all) {
    const auto n = static_cast<Eigen::Index>(free.size());
    Eigen::MatrixXd part(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = 0; j < n; ++j) {
        part(i, j) = all(free[static_cast<std::size_t>(i)], free[static_cast<std::size_t>(j)]);
      }
    }
    return part;
  };
  const Eigen::FullPivLU<Eigen::MatrixXd> jacobian(of_free(score_jacobian(samples, x)));
  if (!jacobian.isInvertible()) return std::nullopt;
  const Eigen::MatrixXd half = jacobian.solve(of_free(spread)).transpose();
  const Eigen::MatrixXd covariance = jacobian.solve(half);  // J^-1 spread J^-T
  for (std::size_t i = 0; i < free.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const double error = std::sqrt(covariance(row, row));
    (free[i] == kWeak ? fit.weak_error_db : fit.relative_error[free[i]]) = error;
  }
  return fit;
}

}  // namespace

NoiseFitter::NoiseFitter(const std::vector<NoiseSample>& samples) : samples_(samples) {
  const auto weaker = [](const NoiseSample& a, const NoiseSample& b) {
    return a.snr_db < b.snr_db;
  };
  const auto [low, high] = std::minmax_element(samples.begin(), samples.end(), weaker);
  if (low == samples.end()) return;
  lowest_w_ = low->snr_db - kInvisible;
  highest_w_ = high->snr_db;
}

std::optional<NoiseFit> NoiseFitter::fit(const RadarNoise& start,
                                         const Eigen::Vector4d& smallest) const {
  const Eigen::Vector4d lowest = smallest.array().log();
  Parameters x;
  x << start.sigma.array().log(), std::clamp(start.weak_snr_db, lowest_w_, highest_w_);
  for (int i = 0; i < kIterations; ++i) {
    const Sums sums = accumulate(x, samples_.begin(), samples_.end());
    const std::optional<Parameters> step = scoring_step(sums);
    if (!step) return std::nullopt;
    const Parameters before = x;
    x.head<4>() += step->head<4>().cwiseMin(kLargestStep).cwiseMax(-kLargestStep);
    x.head<4>() = x.head<4>().cwiseMax(lowest);
    const double change = std::clamp((*step)[kWeak], -kLargestStepDb, kLargestStepDb);
    x[kWeak] = std::clamp(x[kWeak] + change, lowest_w_, highest_w_);
    const Parameters changed = (x - before).cwiseAbs();
    if (changed.head<4>().maxCoeff() < kTolerance && changed[kWeak] < kToleranceDb) break;
  }
  return with_errors(samples_, x, lowest, lowest_w_);
}

}  // namespace rio::eval
