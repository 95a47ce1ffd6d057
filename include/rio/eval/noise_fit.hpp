// SPDX-License-Identifier: BSD-3-Clause
// The noise of the radar from the innovations of a run: maximum likelihood for the four sigmas and
// the growth of the angle sigmas of weak echoes.
//
// For sample i the filter predicts nu ~ N(0, S_i), S_i = C_i + diag(q_i + G_i s^2), with C_i = H P
// H^T, q_i the variance of the grids, s the sigmas (range, azimuth, elevation, Doppler), and G_i
// the gains of their variances, the columns of the angles times
// (E1) g^2 = 1 + min(1, 10^(-(SNR_i - w) / 10))                 as models/detection.hpp (E3)
// (E2) score in x_k (ln s_k, or w): sum_i [nu^T A_k nu / c - tr(A_k S)] / 2,
//      A_k = S^-1 dS/dx_k S^-1, summed over the samples with nu^T S^-1 nu below its 95 % quantile:
//      outliers do not enter
// (E3) c = F_{n+2}(q) / F_n(q), q that quantile of chi-squared of n degrees of freedom, F its
//      distribution: the share of the covariance of a normal variable that the cut leaves
// (E4) Fisher scoring, x += I^-1 score with I_kl = sum tr(A_k dS/dx_l) / 2
// (E5) covariance of x: J^-1 (sum_b g_b g_b^T) J^-T, J the Jacobian of the score by differences,
//      g_b the scores of consecutive segments of the flight: errors within one may be correlated
// Reference: (E3) Tallis, Elliptical and Radial Truncation in Normal Populations, 1963; (E4)
// Harville, Maximum Likelihood Approaches to Variance Component Estimation, 1977; (E5) White,
// Maximum Likelihood Estimation of Misspecified Models, 1982.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

namespace rio::eval {

/// An innovation with the known parts of its covariance.
struct NoiseSample {
  static constexpr int kMaxDof = 3;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxDof, 1>;
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxDof, kMaxDof>;
  using Gain = Eigen::Matrix<double, Eigen::Dynamic, 4, 0, kMaxDof, 4>;

  Vector innovation;    ///< nu
  Matrix predicted;     ///< C: from the error of the state
  Vector grid;          ///< q: of the grids
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
  std::array<bool, 4> at_bound{};  ///< the sigma is at its lower bound, or smaller; no error
  double weak_error_db = 0.0;      ///< one sigma of w [dB]
  bool growth_seen = false;  ///< false: no echo is weak enough to observe (E1), w is only a bound
};

class NoiseFitter {
 public:
  /// Samples in the order of the flight; they must outlive the fitter.
  explicit NoiseFitter(const std::vector<NoiseSample>& samples);

  /// Empty if the samples do not determine the sigmas.
  /// @param start sigmas positive, within an order of magnitude
  /// @param smallest smallest sigmas distinguishable from zero given the grids, positive
  std::optional<NoiseFit> fit(
      const RadarNoise& start,
      const Eigen::Vector4d& smallest = Eigen::Vector4d::Constant(kSmallest)) const;

 private:
  static constexpr double kSmallest = 1e-5;  // below that of any radar [m, rad, m/s]

  const std::vector<NoiseSample>& samples_;
  double lowest_w_ = 0.0;
  double highest_w_ = 0.0;
};

}  // namespace rio::eval
