// SPDX-License-Identifier: BSD-3-Clause
// The second-order terms of a landmark's range against Monte Carlo. The Jacobians are in the model
// suite.
#include "rio/models/landmark_point.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "rio/sim/random.hpp"

namespace rio {
namespace {

struct RangeMoments {
  double mean;
  double variance;
};

/// Of |e| for an e that is normal across the line of sight: sigmas in rad, correlation `rho`.
RangeMoments sampled_range(double range, double sigma_az, double sigma_el, double rho) {
  constexpr int kSamples = 200'000;
  sim::Random random(7);
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const double az = random.normal();
    const double el = rho * az + std::sqrt(1.0 - rho * rho) * random.normal();
    const double excess =
        Vector3d(range, range * sigma_az * az, range * sigma_el * el).norm() - range;
    sum += excess;
    squares += excess * excess;
  }
  const double mean = sum / kSamples;
  return {mean, squares / kSamples - mean * mean};
}

TEST(LandmarkPoint, RangeOfAnUncertainPoint) {
  struct Case {
    double range, sigma_az, sigma_el, rho;
  };
  for (const Case& c : {Case{5.0, 0.05, 0.1, 0.0}, Case{5.0, 0.05, 0.1, 0.8},
                        Case{12.0, 0.08, 0.02, -0.5}, Case{2.0, 0.03, 0.03, 1.0}}) {
    Eigen::Matrix2d M;
    const double covariance = c.rho * c.sigma_az * c.sigma_el;
    M << c.sigma_az * c.sigma_az, covariance, covariance, c.sigma_el * c.sigma_el;
    const auto curvature = LandmarkPointModel::range_curvature(c.range, M);
    const RangeMoments sampled = sampled_range(c.range, c.sigma_az, c.sigma_el, c.rho);
    // terms of fourth order: 3/4 sigma^2 of the mean; the variance of the samples' variance: 1 %
    EXPECT_NEAR(curvature.mean, sampled.mean, 0.02 * sampled.mean) << c.range << " " << c.rho;
    EXPECT_NEAR(curvature.variance, sampled.variance, 0.08 * sampled.variance)
        << c.range << " " << c.rho;
  }
}

}  // namespace
}  // namespace rio
