// SPDX-License-Identifier: BSD-3-Clause
// Monte Carlo of the noise of a point and of what it does to its Doppler, in every direction a
// radar may report, straight up and sideways included: no direction is singular.
//
// (E1) m = (r + sigma_r n) R Exp((0, -d_el, d_az)) e_x, R the rotation of boresight to the point:
//      the error of the direction on the sphere               Xu et al., eq. 5-6
// (E2) range rate = -u . v + sigma_D n at the true direction u
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "rio/core/so3.hpp"
#include "rio/models/detection.hpp"
#include "rio/models/doppler.hpp"
#include "support/constants.hpp"
#include "support/random_state.hpp"
#include "support/symmetric.hpp"

namespace rio::test {
namespace {

constexpr int kDraws = 40000;
constexpr double kTolerance = 0.04;  // 4 sqrt(2 / kDraws) = 2.8 %, and 1 % of second order
constexpr double kMinCosine = 0.25;  // of the detection's noise model, off the view of any array

struct Direction {
  double azimuth;    // [deg]
  double elevation;  // same
};
constexpr Direction kDirections[] = {{0.0, 0.0},   {50.0, 20.0},  {-70.0, -40.0}, {90.0, 0.0},
                                     {30.0, 80.0}, {0.0, 89.999}, {0.0, 90.0},    {0.0, -90.0}};

/// Angles fine enough for first order, four times as large upwards: 1.5 m/s bent by 2 deg is
/// 0.001 m/s.
RadarOptions radar() {
  return {.sigma_range = 0.03,
          .sigma_azimuth = 0.004,
          .sigma_elevation = 0.008,
          .weak_snr_db = -200.0,  // all echoes are alike
          .sigma_doppler = 0.01};
}

/// Draws of (E1) and (E2).
class Source {
 public:
  Source(const Direction& at, double range, const Vector3d& v_S)
      : range_(range),
        v_S_(v_S),
        R_(Eigen::AngleAxisd(at.azimuth * kDegree, Vector3d::UnitZ()) *
           Eigen::AngleAxisd(-at.elevation * kDegree, Vector3d::UnitY())) {
    const double cos_azimuth = std::max(kMinCosine, std::cos(at.azimuth * kDegree));
    const double cos_elevation = std::max(kMinCosine, std::cos(at.elevation * kDegree));
    sigma_az_ = radar().sigma_azimuth / cos_azimuth * cos_elevation;
    sigma_el_ = radar().sigma_elevation / cos_elevation;
  }
  Vector3d point() const { return range_ * R_.col(0); }

  RadarDetection draw(Random& random) const {
    const double d_az = random.normal(sigma_az_);
    const double d_el = random.normal(sigma_el_);
    const double r = range_ + random.normal(radar().sigma_range);
    return {r * (R_ * (quaternion_exp({0.0, -d_el, d_az}) * Vector3d::UnitX())),
            -R_.col(0).dot(v_S_) + random.normal(radar().sigma_doppler)};
  }

 private:
  double range_;
  Vector3d v_S_;
  Matrix3d R_;
  double sigma_az_ = 0.0;
  double sigma_el_ = 0.0;
};

TEST(PointNoise, CovarianceIsThatOfTheErrorsInEveryDirection) {
  for (const Direction& at : kDirections) {
    const Source source(at, 5.0, Vector3d::Zero());
    Random random(51);
    Matrix3d sum = Matrix3d::Zero();
    for (int i = 0; i < kDraws; ++i) {
      const Vector3d e = source.draw(random).point_S - source.point();
      sum += e * e.transpose() / kDraws;
    }
    const Matrix3d stated = point_covariance(make_detection({.point_S = source.point()}, radar()));
    const Matrix3d whitened = test::whitened(sum, stated);
    EXPECT_LT((whitened - Matrix3d::Identity()).cwiseAbs().maxCoeff(), kTolerance)
        << at.azimuth << " " << at.elevation << "\n"
        << whitened;
  }
}

TEST(PointNoise, DopplerVarianceIsThatOfTheResidualInEveryDirection) {
  const DopplerModel model(DopplerDirections::kNoisy);
  for (const Direction& at : kDirections) {
    for (const Vector3d& v_S : {Vector3d(1.5, 0.0, 0.0), Vector3d(0.0, 1.5, 0.0),
                                Vector3d(0.0, 0.0, 1.5), Vector3d(0.8, -0.6, 1.1)}) {
      const Source source(at, 5.0, v_S);
      const auto evaluate_at = [&](const RadarDetection& d) {
        const auto z = DopplerModel::measurement(make_detection(d, radar()), Vector3d::Zero());
        Evaluation<DopplerModel> result;
        EXPECT_TRUE(evaluate(model, z, {RigidPose(), v_S, Vector3d::Zero(), RigidPose(), 0.0},
                             &result, false));
        return result;
      };
      Random random(52);
      double sum = 0.0;
      for (int i = 0; i < kDraws; ++i) {
        const double r = evaluate_at(source.draw(random)).r[0];
        sum += r * r / kDraws;
      }
      const double stated = evaluate_at({.point_S = source.point()}).R(0, 0);
      EXPECT_NEAR(sum / stated, 1.0, kTolerance)
          << at.azimuth << " " << at.elevation << ": " << v_S.transpose();
    }
  }
}

}  // namespace
}  // namespace rio::test
