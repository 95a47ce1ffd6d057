// SPDX-License-Identifier: BSD-3-Clause
// Errors and innovations against what their covariances say: NEES, and the fit of the radar's noise
// to innovations drawn from a known one.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "rio/eval/nees.hpp"
#include "rio/eval/noise_fit.hpp"
#include "rio/sim/random.hpp"
#include "support/random_state.hpp"

namespace rio::eval {
namespace {

TEST(BodyError, IsWhatTakesTheEstimateToTheTruth) {
  const NavState estimate{
      .q_WB = quaternion_exp({0.3, -0.8, 1.9}), .p_WB = {1.0, 2.0, 3.0}, .v_WB = {-1.0, 0.5, 0.0}};
  BodyError expected;
  expected << 0.02, -0.03, 0.05, 0.1, 0.2, -0.3, 0.4, -0.5, 0.6, 1e-3, 2e-3, -3e-3, 0.01, -0.02,
      0.03;
  const NavState truth = test::perturbed(estimate, expected);
  EXPECT_LT((body_error(estimate, truth) - expected).norm(), 1e-15);
}

TEST(Nees, OfKnownErrors) {
  const Vector3d error(0.1, -0.4, 3.0);
  Matrix3d P = Vector3d(0.01, 0.04, 9.0).asDiagonal();
  EXPECT_NEAR(nees(error, P), 1.0 + 4.0 + 1.0, 1e-14);
  // correlated: P = A A^T and error = A w have NEES |w|^2
  Matrix3d A;
  A << 1.0, 0.0, 0.0, 0.5, 2.0, 0.0, -0.3, 0.7, 0.1;
  EXPECT_NEAR(nees(A * Vector3d(1.0, 2.0, -3.0), A * A.transpose()), 14.0, 1e-10);
}

TEST(Nees, OfPartOfABodyCovariance) {
  BodyCovariance P = BodyCovariance::Identity() * 4.0;
  P(12, 12) = -1.0;  // outside the part
  const BodyError error = BodyError::Ones();
  EXPECT_NEAR(nees(error.head<9>(), P.topLeftCorner<9, 9>()), 9.0 / 4.0, 1e-14);
  EXPECT_TRUE(std::isnan(nees(error, P)));
}

TEST(AneesBounds, EqualTheTextbook) {
  // Bar-Shalom et al., 2001, sec. 5.4.2: 50 runs, 2 states, 95 %: chi2_100 quantiles over 50
  const AneesBounds bounds = anees_bounds(2, 50, 0.95);
  EXPECT_NEAR(bounds.lower, 74.22193 / 50.0, 1e-6);
  EXPECT_NEAR(bounds.upper, 129.56120 / 50.0, 1e-6);
  EXPECT_TRUE(bounds.contain(2.0));
  EXPECT_FALSE(bounds.contain(1.48));
  EXPECT_FALSE(bounds.contain(2.60));
  // 10 runs, 3 states, 90 %: tables of chi2_30
  EXPECT_NEAR(anees_bounds(3, 10, 0.9).lower, 18.49266 / 10.0, 1e-6);
  EXPECT_NEAR(anees_bounds(3, 10, 0.9).upper, 43.77297 / 10.0, 1e-6);
}

/// Draws the innovations of a radar: landmark matches and Dopplers in turn.
class Radar {
 public:
  Radar(const RadarNoise& noise, bool growth, std::uint64_t seed)
      : noise_(noise), growth_(growth), random_(seed, 20) {}

  std::vector<NoiseSample> innovations(int count) {
    std::vector<NoiseSample> samples;
    for (int i = 0; i < count; ++i) samples.push_back(i % 2 == 0 ? match() : doppler());
    return samples;
  }

 private:
  NoiseSample match() {
    NoiseSample sample = empty(3);
    const Eigen::Vector3d own(0.02, 0.01, 0.03);
    sample.predicted.diagonal() = own.cwiseAbs2();
    sample.predicted(0, 1) = sample.predicted(1, 0) = 0.3 * own[0] * own[1];
    sample.grid[0] = 0.04 * 0.04 / 12.0;
    sample.gain(0, 0) = 1.0;
    sample.gain(1, 1) = random_.uniform(1.0, 4.0);  // 1/cos^2
    sample.gain(2, 2) = random_.uniform(1.0, 1.1);
    return drawn(sample);
  }
  NoiseSample doppler() {
    NoiseSample sample = empty(1);
    sample.predicted(0, 0) = 0.01 * 0.01;
    sample.grid[0] = 0.03 * 0.03 / 12.0;
    sample.gain << 0.0, random_.uniform(0.0, 1.0), random_.uniform(0.0, 1.0), 1.0;
    return drawn(sample);
  }
  NoiseSample empty(int dof) {
    NoiseSample sample;
    sample.predicted.setZero(dof, dof);
    sample.grid.setZero(dof);
    sample.gain.setZero(dof, 4);
    sample.snr_db = random_.uniform(10.0, 30.0);
    return sample;
  }
  NoiseSample drawn(NoiseSample sample) {
    Eigen::Vector4d variance = noise_.sigma.cwiseAbs2();
    if (growth_) {
      const double weak = std::pow(10.0, -0.1 * (sample.snr_db - noise_.weak_snr_db));
      variance.segment<2>(1) *= 1.0 + std::min(1.0, weak);
    }
    NoiseSample::Matrix S = sample.predicted;
    S.diagonal() += sample.grid + sample.gain * variance;
    NoiseSample::Vector n(S.rows());
    for (double& value : n) value = random_.normal();
    sample.innovation = S.llt().matrixL() * n;
    return sample;
  }

  RadarNoise noise_;
  bool growth_;
  sim::Random random_;
};

const RadarNoise kTrue{{0.04, 0.035, 0.07, 0.05}, 14.0};
constexpr int kSamples = 20000;

TEST(NoiseFit, FindsTheNoiseFromAFactorTwoEitherWay) {
  const auto samples = Radar(kTrue, true, 1).innovations(kSamples);
  for (const double factor : {0.5, 2.0}) {
    const auto fit = NoiseFitter(samples).fit({factor * kTrue.sigma, 10.0});
    ASSERT_TRUE(fit);
    for (int k = 0; k < 4; ++k) {
      // four standard errors, which are 1 to 3 %
      EXPECT_NEAR(fit->noise.sigma[k] / kTrue.sigma[k], 1.0, 4.0 * fit->relative_error[k]) << k;
      EXPECT_LT(fit->relative_error[k], 0.03) << k;
    }
    EXPECT_TRUE(fit->growth_seen);
    EXPECT_NEAR(fit->noise.weak_snr_db, kTrue.weak_snr_db, 4.0 * fit->weak_error_db);
    EXPECT_LT(fit->weak_error_db, 1.0);
  }
}

TEST(NoiseFit, StandardErrorsAreThoseOfRepeatedFits) {
  constexpr int kFits = 40;
  Eigen::Vector4d claimed = Eigen::Vector4d::Zero();
  Eigen::Vector4d squares = Eigen::Vector4d::Zero();
  for (int i = 0; i < kFits; ++i) {
    const auto samples = Radar(kTrue, true, 100 + static_cast<std::uint64_t>(i)).innovations(4000);
    const auto fit = NoiseFitter(samples).fit(kTrue);
    ASSERT_TRUE(fit);
    claimed += fit->relative_error / kFits;
    squares +=
        (fit->noise.sigma.cwiseQuotient(kTrue.sigma).array() - 1.0).square().matrix() / kFits;
  }
  for (int k = 0; k < 4; ++k) {
    // a standard deviation from 40 values is off by 11 %, one from 20 stretches by 16 % in each
    EXPECT_NEAR(claimed[k] / std::sqrt(squares[k]), 1.0, 0.35) << k;
  }
}

TEST(NoiseFit, OutliersDoNotEnter) {
  auto samples = Radar(kTrue, true, 2).innovations(kSamples);
  for (std::size_t i = 0; i < samples.size(); i += 20) samples[i].innovation *= 20.0;
  const auto fit = NoiseFitter(samples).fit(kTrue);
  ASSERT_TRUE(fit);
  // a twentieth, of them every second a match: a few percent of them fall below the cut
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(fit->noise.sigma[k] / kTrue.sigma[k], 1.0, 0.08) << k;
}

TEST(NoiseFit, WithoutGrowthTheAnglesAreThoseOfStrongEchoes) {
  const auto samples = Radar(kTrue, false, 3).innovations(kSamples);
  const auto fit = NoiseFitter(samples).fit({kTrue.sigma, 10.0});
  ASSERT_TRUE(fit);
  // growth of a tenth of the variance at the weakest echo, 10 dB, is not told from none
  EXPECT_LT(fit->noise.weak_snr_db, 0.0);
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(fit->noise.sigma[k] / kTrue.sigma[k], 1.0, 0.06) << k;
}

TEST(NoiseFit, ASigmaBelowTheGridStopsAtItsBound) {
  RadarNoise noise = kTrue;
  noise.sigma[3] = 1e-6;
  const auto samples = Radar(noise, true, 5).innovations(kSamples);
  const Eigen::Vector4d smallest(1e-4, 1e-4, 1e-4, 0.003);
  const auto fit = NoiseFitter(samples).fit(kTrue, smallest);
  ASSERT_TRUE(fit);
  EXPECT_TRUE(fit->at_bound[3]);
  EXPECT_DOUBLE_EQ(fit->noise.sigma[3], smallest[3]);
  EXPECT_EQ(fit->relative_error[3], 0.0);
  for (int k = 0; k < 3; ++k) EXPECT_FALSE(fit->at_bound[static_cast<std::size_t>(k)]) << k;
}

TEST(NoiseFit, NothingWithoutSamples) {
  EXPECT_FALSE(NoiseFitter({}).fit(kTrue));
  const auto all = Radar(kTrue, true, 4).innovations(200);
  std::vector<NoiseSample> dopplers;
  for (std::size_t i = 1; i < all.size(); i += 2) dopplers.push_back(all[i]);
  EXPECT_FALSE(NoiseFitter(dopplers).fit(kTrue)) << "Dopplers say nothing of the range";
}

}  // namespace
}  // namespace rio::eval
