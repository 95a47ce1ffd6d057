// SPDX-License-Identifier: BSD-3-Clause
#include "rio/core/so3.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "support/random_state.hpp"

namespace rio {
namespace {

using LongMatrix = Eigen::Matrix<long double, 3, 3>;
using LongVector = Eigen::Matrix<long double, 3, 1>;

constexpr double kPi = std::numbers::pi;
constexpr double kEpsilon = 2.220446049250313e-16;
// both sides of the switch between series and recursion at 1 rad
constexpr double kNorms[] = {0.0, 1e-8, 1e-4, 0.3, 0.999, 1.001, 2.5, kPi, 6.0};

LongMatrix long_skew(const LongVector& v) {
  LongMatrix m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

// The definition sum_k [phi]^k / (k+m)!, 60 terms: below 1e-25 for |phi| <= 6.
LongMatrix gamma_reference(int m, const LongVector& phi) {
  LongMatrix term = LongMatrix::Identity();
  for (int k = 2; k <= m; ++k) term /= k;
  LongMatrix sum = term;
  for (int k = 1; k <= 60; ++k) {
    term = (term * long_skew(phi) / (k + m)).eval();
    sum += term;
  }
  return sum;
}

/// Rounding of the reference where a long double is a double, as on armhf.
double reference_error(double norm) {
  constexpr bool kLonger = std::numeric_limits<long double>::digits > 53;
  return kLonger ? 0.0 : kEpsilon * std::exp(norm);
}

double largest(const Matrix3d& m) {
  return m.cwiseAbs().maxCoeff();
}

TEST(So3, SkewIsTheCrossProduct) {
  test::Random random(1);
  for (int i = 0; i < 20; ++i) {
    const Vector3d v = random.normal_vector();
    const Vector3d w = random.normal_vector();
    EXPECT_NEAR((skew(v) * w - v.cross(w)).norm(), 0.0, 1e-14);
  }
}

TEST(So3, GammaEqualsThePowerSeries) {
  test::Random random(2);
  for (const double norm : kNorms) {
    for (int i = 0; i < 20; ++i) {
      const Vector3d phi = norm * random.direction();
      for (int m = 0; m <= 2; ++m) {
        const Matrix3d expected = gamma_reference(m, phi.cast<long double>()).cast<double>();
        // entries are at most 1, with |phi|^2 / 2 of it summed from smaller terms
        EXPECT_LT(largest(gamma(m, phi) - expected), 20.0 * kEpsilon + reference_error(norm))
            << m << " at " << norm;
      }
    }
  }
}

TEST(So3, DerivativeOfGammaEqualsDifferences) {
  test::Random random(4);
  constexpr long double kStep = 1e-3L;  // five points: h^4/30 = 3e-14 of truncation
  for (const double norm : kNorms) {
    for (int i = 0; i < 10; ++i) {
      const Vector3d phi = norm * random.direction();
      const Vector3d a = random.direction();
      for (int m = 0; m <= 2; ++m) {
        Matrix3d expected;
        for (int c = 0; c < 3; ++c) {
          const auto value = [&](int steps) -> LongVector {
            LongVector moved = phi.cast<long double>();
            moved[c] += kStep * steps;
            return gamma_reference(m, moved) * a.cast<long double>();
          };
          const LongVector slope =
              (8.0L * (value(1) - value(-1)) - (value(2) - value(-2))) / (12.0L * kStep);
          expected.col(c) = slope.cast<double>();
        }
        EXPECT_LT(largest(d_gamma_a_d_phi(m, phi, a, GammaSeries(phi.squaredNorm())) - expected),
                  2e-13 + reference_error(norm) / static_cast<double>(kStep))
            << m << " at " << norm;
      }
    }
  }
}

TEST(So3, QuaternionExpIsTheRotation) {
  test::Random random(5);
  for (const double norm : {0.0, 1e-12, 1e-8, 0.3, 1.999, 2.001, 3.1, kPi, 5.0, 12.0}) {
    const Vector3d phi = norm * random.direction();
    EXPECT_LT((quaternion_exp(phi).coeffs() - test::rotation_of(phi).coeffs()).norm(), 1e-14)
        << norm;
  }
}

TEST(So3, LogOfExpIsTheRotationVector) {
  test::Random random(6);
  // 2e-5 is where the logarithm leaves its series
  for (const double norm : {0.0, 1e-300, 1e-12, 1e-8, 1.99e-5, 2.01e-5, 1e-3, 0.3, 1.999, 2.001,
                            2.5, 3.14, kPi - 1e-6, kPi - 1e-12}) {
    for (int i = 0; i < 20; ++i) {
      const Vector3d phi = norm * random.direction();
      const Quaternion q = quaternion_exp(phi);
      EXPECT_LE((quaternion_log(q) - phi).norm(), 10.0 * kEpsilon * norm) << norm;
      const Quaternion opposite(-q.w(), -q.x(), -q.y(), -q.z());
      EXPECT_LE((quaternion_log(opposite) - phi).norm(), 10.0 * kEpsilon * norm) << norm;
    }
  }
}

TEST(So3, ExpOfLogIsTheRotationAndLogIsNeverLongerThanPi) {
  test::Random random(8);
  std::vector<Quaternion> rotations = {Quaternion(0.0, 0.0, 1.0, 0.0)};
  for (const double norm : {kPi, kPi + 1e-9, 4.0, 6.0, 2.0 * kPi, 9.0}) {
    rotations.push_back(quaternion_exp(norm * random.direction()));
  }
  for (int i = 0; i < 200; ++i) rotations.push_back(random.rotation());
  for (const Quaternion& q : rotations) {
    const Vector3d log = quaternion_log(q);
    EXPECT_LE(log.norm(), kPi * (1.0 + 2.0 * kEpsilon));
    EXPECT_NEAR(std::abs(quaternion_exp(log).dot(q)), 1.0, 1e-15);
    EXPECT_LT(largest(gamma(0, log) - q.toRotationMatrix()), 1e-14);
  }
}

TEST(So3, RotationBetweenTurnsAIntoBByTheAngleBetweenThem) {
  test::Random random(9);
  for (const double angle : {0.0, 1e-9, 1e-4, 0.7, 2.0, 3.0, kPi - 1e-7, kPi}) {
    for (int i = 0; i < 20; ++i) {
      const Vector3d a = random.direction();
      const Vector3d axis = a.cross(random.direction()).normalized();
      const Vector3d b = test::rotation_of(angle * axis) * a;
      const Quaternion q = rotation_between(2.0 * a, 0.3 * b);
      // the half way between directions nearly opposite is the small difference of both
      const double lost = angle < kPi ? 10.0 * kEpsilon / (kPi - angle) : 0.0;
      EXPECT_LT((q * a - b).norm(), 1e-12 + lost) << angle;
      EXPECT_NEAR(quaternion_log(q).norm(), angle, 1e-8) << angle;
    }
  }
}

TEST(So3, RightAnglesAreTheRotationsOfACube) {
  const auto all = right_angles();
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i] * all[i].transpose(), Matrix3d::Identity());
    EXPECT_EQ(all[i].determinant(), 1.0);
    for (std::size_t k = 0; k < i; ++k) EXPECT_NE(all[i], all[k]);
  }
}

// The angles about the vertical and across it, in world axes.
TEST(So3, VariancesOfHeadingAndTilt) {
  test::Random random(10);
  for (int i = 0; i < 20; ++i) {
    const Quaternion q_WB = random.rotation();
    const Matrix3d R = q_WB.toRotationMatrix();
    const Matrix3d P_W = Vector3d(0.01, 0.02, 0.5).asDiagonal();
    const AttitudeVariance variance = attitude_variance(q_WB, R.transpose() * P_W * R);
    EXPECT_NEAR(variance.heading, 0.5, 1e-14);
    EXPECT_NEAR(variance.tilt, 0.03, 1e-14);
  }
  const Matrix3d indefinite = -1e-20 * Matrix3d::Identity();
  EXPECT_EQ(attitude_variance(Quaternion::Identity(), indefinite).heading, 0.0);
  EXPECT_EQ(attitude_variance(Quaternion::Identity(), indefinite).tilt, 0.0);
}

TEST(GammaSeries, HoldsForAnyAngle) {
  for (const double angle : {1e-4, 0.5, 1.0, 3.0, 1e2, 1e5}) {
    const GammaSeries all(angle * angle);
    for (int m = 1; m <= 6; ++m) {
      EXPECT_NEAR(all[m], GammaSeries::term(m, angle * angle), 1e-16) << angle << " " << m;
    }
    const Vector3d phi = angle * Vector3d(0.6, 0.0, 0.8);
    const Matrix3d R = gamma(0, phi, all);
    EXPECT_LT((R * R.transpose() - Matrix3d::Identity()).norm(), 1e-14) << angle;
  }
}

}  // namespace
}  // namespace rio
