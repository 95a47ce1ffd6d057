// SPDX-License-Identifier: BSD-3-Clause
// What the innovations of a run say about the noise of the radar: maximum likelihood for the four
// sigmas and the growth of the angle sigmas of weak echoes.
//
// Of sample i the filter predicts nu ~ N(0, S_i), S_i = C_i + diag(q_i + G_i s^2), with C_i = H P
// H^T, q_i the variance of the grids, s the sigmas (range, azimuth, elevation, Doppler), G_i how
// their variances enter, the columns of the angles times
// (E1) g^2 = 1 + min(1, 10^(-(SNR_i - w) / 10))                 as frontend/detection.hpp (E3)
// (E2) score in x_k (ln s_k, or w): sum_i [nu^T A_k nu / c - tr(A_k S)] / 2,
//      A_k = S^-1 dS/dx_k S^-1, summed over the samples with nu^T S^-1 nu below its 95 % quantile:
//      outliers do not enter
// (E3) c = F_{n+2}(q) / F_n(q), q that quantile of chi-squared of n degrees of freedom, F its
//      distribution: what the cut leaves of the covariance of a normal variable
// (E4) Fisher scoring, x += I^-1 score with I_kl = sum tr(A_k dS/dx_l) / 2
// (E5) covariance of x: J^-1 (sum_b g_b g_b^T) J^-T, J the Jacobian of the score by differences,
//      g_b the scores of consecutive stretches of the flight: errors within one may be correlated
// Reference: (E3) Tallis, Elliptical and Radial Truncation in Normal Populations, 1963; (E4)
// Harville, Maximum Likelihood Approaches to Variance Component Estimation, 1977; (E5) White,
// Maximum Likelihood Estimation of Misspecified Models, 1982.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "rio/core/chi2.hpp"

namespace rio::eval {

/// An innovation with what is known of its covariance.
struct NoiseSample {
  static constexpr int kMaxDof = 3;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxDof, 1>;
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxDof, kMaxDof>;
  using Gain = Eigen::Matrix<double, Eigen::Dynamic, 4, 0, kMaxDof, 4>;

  Vector innovation;    ///< nu
  Matrix predicted;     ///< C: by the error of the state
  Vector grid;          ///< q: by the grids
  Gain gain;            ///< G without the growth of (E1)
  double snr_db = 0.0;  ///< [dB]
};

/// Noise of a radar.
struct RadarNoise {
  /// Range [m], azimuth [rad], elevation [rad], Doppler [m/s]; the angles at boresight.
  Eigen::Vector4d sigma = Eigen::Vector4d::Ones();
  double weak_snr_db = 0.0;  ///< w [dB]
};

/// A fitted noise.
struct NoiseFit {
  RadarNoise noise;
  Eigen::Vector4d relative_error = Eigen::Vector4d::Zero();  ///< one sigma of each sigma, relative
  std::array<bool, 4> at_bound{};  ///< the sigma is at its lower bound, or smaller; no error told
  double weak_error_db = 0.0;      ///< one sigma of w [dB]
  bool growth_seen = false;  ///< false: no echo is weak enough to show (E1), w is only a bound
};

class NoiseFitter {
 public:
  /// Samples in the order of the flight; they must outlive the fitter.
  explicit NoiseFitter(const std::vector<NoiseSample>& samples) : samples_(samples) {
    const auto weaker = [](const NoiseSample& a, const NoiseSample& b) {
      return a.snr_db < b.snr_db;
    };
    const auto [low, high] = std::minmax_element(samples.begin(), samples.end(), weaker);
    if (low == samples.end()) return;
    lowest_w_ = low->snr_db - kInvisible;
    highest_w_ = high->snr_db;
  }

  /// Nothing if the samples do not fix the sigmas.
  /// @param start sigmas positive, within an order of magnitude
  /// @param smallest sigmas that can be told from none beside the grids, positive
  std::optional<NoiseFit> fit(
      const RadarNoise& start,
      const Eigen::Vector4d& smallest = Eigen::Vector4d::Constant(kSmallest)) const {
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
    return with_errors(x, lowest);
  }

 private:
  static constexpr int kCount = 5;
  static constexpr int kWeak = 4;
  using Parameters = Eigen::Matrix<double, kCount, 1>;
  using Information = Eigen::Matrix<double, kCount, kCount>;
  using Iterator = std::vector<NoiseSample>::const_iterator;

  static constexpr double kSmallest = 1e-5;   // no radar measures anything so well [m, rad, m/s]
  static constexpr double kKept = 0.95;       // of normal innovations
  static constexpr int kIterations = 60;      // the cut makes convergence linear, about 0.5 a step
  static constexpr double kTolerance = 1e-3;  // of ln s: far below any standard error
  static constexpr double kToleranceDb = 0.02;
  static constexpr double kLargestStep = 0.5;  // of ln s
  static constexpr double kLargestStepDb = 5.0;
  static constexpr double kInvisible = 20.0;  // growth by 1 % of the variance [dB]
  static constexpr std::ptrdiff_t kStretches = 20;

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

  static const Cut& cut(Eigen::Index dof) {
    static const std::array<Cut, NoiseSample::kMaxDof> kCuts = {Cut(1), Cut(2), Cut(3)};
    return kCuts[static_cast<std::size_t>(dof - 1)];
  }

  Sums accumulate(const Parameters& x, Iterator begin, Iterator end) const {
    Sums sums;
    for (; begin != end; ++begin) add(*begin, x, &sums);
    return sums;
  }

  /// (E2) and (E4) of one sample.
  static void add(const NoiseSample& sample, const Parameters& x, Sums* sums) {
    const Eigen::Vector4d variance = (2.0 * x.head<4>()).array().exp();
    const double weak = std::pow(10.0, -0.1 * (sample.snr_db - x[kWeak]));
    const double growth = 1.0 + std::min(1.0, weak);  // (E1)
    const Eigen::Vector4d grown(variance[0], growth * variance[1], growth * variance[2],
                                variance[3]);
    NoiseSample::Matrix S = sample.predicted;
    S.diagonal() += sample.grid + sample.gain * grown;
    const Eigen::LLT<NoiseSample::Matrix> llt(S);
    if (llt.info() != Eigen::Success) return;
    const NoiseSample::Vector y = llt.solve(sample.innovation);
    const Cut& cut_here = cut(S.rows());
    if (!(sample.innovation.dot(y) < cut_here.limit)) return;
    const NoiseSample::Matrix inverse =
        llt.solve(NoiseSample::Matrix::Identity(S.rows(), S.rows()));

    // dS/dx_k is diagonal: its columns
    Eigen::Matrix<double, Eigen::Dynamic, kCount, 0, NoiseSample::kMaxDof, kCount> d(S.rows(),
                                                                                     kCount);
    d.leftCols<4>() = 2.0 * sample.gain * grown.asDiagonal();
    const double growth_slope = weak < 1.0 ? 0.1 * std::log(10.0) * weak : 0.0;
    d.col(kWeak) = growth_slope * sample.gain.middleCols<2>(1) * variance.segment<2>(1);
    const NoiseSample::Vector excess = y.cwiseAbs2() / cut_here.kept_variance - inverse.diagonal();
    sums->score += 0.5 * d.transpose() * excess;
    sums->information += 0.5 * d.transpose() * inverse.cwiseAbs2() * d;
  }

  /// (E4); w rests where no echo is weak enough to show it.
  static std::optional<Parameters> scoring_step(const Sums& sums) {
    Information information = sums.information;
    constexpr double kVague = 1e-3;  // a sigma of 30 dB: keeps w where the samples say nothing
    information(kWeak, kWeak) += kVague;
    const Eigen::LLT<Information> llt(information);
    if (llt.info() != Eigen::Success) return std::nullopt;
    const Parameters step = llt.solve(sums.score);
    if (!step.allFinite()) return std::nullopt;
    return step;
  }

  /// (E5)
  std::optional<NoiseFit> with_errors(const Parameters& x, const Eigen::Vector4d& lowest) const {
    const auto total = static_cast<std::ptrdiff_t>(samples_.size());
    Information spread = Information::Zero();
    for (std::ptrdiff_t b = 0; b < kStretches; ++b) {
      const Parameters g = accumulate(x, samples_.begin() + b * total / kStretches,
                                      samples_.begin() + (b + 1) * total / kStretches)
                               .score;
      spread += g * g.transpose();
    }
    NoiseFit fit;
    fit.noise = {x.head<4>().array().exp(), x[kWeak]};
    fit.growth_seen = x[kWeak] > lowest_w_ + 0.25 * kInvisible;
    std::vector<int> free;
    for (int k = 0; k < kWeak; ++k) {
      const auto at = static_cast<std::size_t>(k);
      fit.at_bound[at] = x[k] <= lowest[k] + kTolerance;
      if (!fit.at_bound[at]) free.push_back(k);
    }
    if (fit.growth_seen) free.push_back(kWeak);
    const Eigen::FullPivLU<Eigen::MatrixXd> lu(score_jacobian(x)(free, free));
    if (!lu.isInvertible()) return std::nullopt;
    const Eigen::MatrixXd inverse = lu.inverse();
    const Eigen::MatrixXd covariance = inverse * spread(free, free) * inverse.transpose();
    for (std::size_t i = 0; i < free.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      const double error = std::sqrt(covariance(row, row));
      (free[i] == kWeak ? fit.weak_error_db : fit.relative_error[free[i]]) = error;
    }
    return fit;
  }

  Information score_jacobian(const Parameters& x) const {
    Information J;
    for (int k = 0; k < kCount; ++k) {
      // wide enough that many samples cross the cut
      const double step = k == kWeak ? 2.0 : 0.2;
      const Parameters change = step * Parameters::Unit(k);
      J.col(k) = (accumulate(x + change, samples_.begin(), samples_.end()).score -
                  accumulate(x - change, samples_.begin(), samples_.end()).score) /
                 (2.0 * step);
    }
    return J;
  }

  const std::vector<NoiseSample>& samples_;
  double lowest_w_ = 0.0;
  double highest_w_ = 0.0;
};

}  // namespace rio::eval
