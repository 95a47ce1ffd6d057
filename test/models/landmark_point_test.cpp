// SPDX-License-Identifier: BSD-3-Clause
// The second-order terms of a landmark's range against Monte Carlo, and a place in Cartesian axes
// against the same as range and direction. The Jacobians are in the model suite.
#include "rio/models/landmark_point.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "rio/models/landmark_position.hpp"
#include "rio/sim/random.hpp"
#include "support/random_state.hpp"

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

// A place with its covariance, and range and direction with their sigmas, tell the same of the
// state to first order.
TEST(LandmarkPoint, APlaceTellsTheSameOfTheState) {
  test::Random random(42);
  const RadarOptions radar{.sigma_azimuth = 0.03, .sigma_elevation = 0.07};
  for (int i = 0; i < 200; ++i) {
    const RigidPose T_WB(random.rotation().toRotationMatrix(), random.normal_vector(5.0));
    const RigidPose T_BS(random.rotation().toRotationMatrix(), random.normal_vector(0.2));
    const Vector3d seen_S(random.uniform(1.0, 8.0), random.uniform(-3.0, 3.0),
                          random.uniform(-2.0, 2.0));
    const Detection d = make_detection({.point_S = seen_S}, radar);
    const auto information = [&]<class M>(const M& model,
                                          const typename M::Blocks::Values& x) -> Eigen::MatrixXd {
      Evaluation<M> at;
      EXPECT_TRUE(evaluate(model, M::measurement(d), x, &at));
      const Eigen::MatrixXd J = at.J.template leftCols<ObservedPoint::Blocks::kDof>();
      return J.transpose() * at.R.inverse() * J;
    };
    const Vector3d p_WL = to_world(T_WB, T_BS, d.point_S);
    const Eigen::MatrixXd polar = information(LandmarkPointModel{}, {T_WB, T_BS, p_WL, 0.0});
    const Eigen::MatrixXd cartesian = information(LandmarkPositionModel{}, {T_WB, T_BS, p_WL});
    EXPECT_LT((cartesian - polar).norm(), 1e-9 * polar.norm()) << i;
  }
}

}  // namespace
}  // namespace rio
