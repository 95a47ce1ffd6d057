// SPDX-License-Identifier: BSD-3-Clause
#include "rio/core/so3.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/random_state.hpp"

namespace rio {
namespace {

using LongMatrix = Eigen::Matrix<long double, 3, 3>;
using LongVector = Eigen::Matrix<long double, 3, 1>;

constexpr double kPi = 3.14159265358979323846;
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

// int_0^1 (1-s)^(m-1)/(m-1)! Exp(s phi) ds by Simpson, Exp from Eigen's axis and angle.
Matrix3d gamma_integral(int m, const Vector3d& phi) {
  constexpr int kIntervals = 2000;
  Matrix3d sum = Matrix3d::Zero();
  for (int i = 0; i <= kIntervals; ++i) {
    const double s = static_cast<double>(i) / kIntervals;
    const double simpson = i == 0 || i == kIntervals ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0);
    const double kernel = m == 1 ? 1.0 : 1.0 - s;
    sum += simpson * kernel * test::rotation_of(s * phi).toRotationMatrix();
  }
  return sum / (3.0 * kIntervals);
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
        EXPECT_LT(largest(gamma(m, phi) - expected), 20.0 * kEpsilon) << m << " at " << norm;
      }
    }
  }
}

TEST(So3, GammaIsTheIntegralOfTheRotation) {
  test::Random random(3);
  for (const double norm : kNorms) {
    const Vector3d phi = norm * random.direction();
    EXPECT_LT(largest(gamma(0, phi) - test::rotation_of(phi).toRotationMatrix()), 1e-14) << norm;
    for (int m = 1; m <= 2; ++m) {
      // Simpson: |phi|^4 / (180 * 2000^4) = 5e-13 at 6 rad
      EXPECT_LT(largest(gamma(m, phi) - gamma_integral(m, phi)), 1e-12) << m << " at " << norm;
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
                  2e-13)
            << m << " at " << norm;
      }
    }
  }
}

TEST(So3, QuaternionExpIsTheRotationMatrix) {
  test::Random random(5);
  for (const double norm : {0.0, 1e-12, 1e-8, 0.3, 1.999, 2.001, 3.1, kPi, 5.0, 12.0}) {
    const Vector3d phi = norm * random.direction();
    const Quaternion q = quaternion_exp(phi);
    EXPECT_NEAR(q.norm(), 1.0, 4.0 * kEpsilon);
    const Quaternion expected = test::rotation_of(phi);
    EXPECT_LT((q.coeffs() - expected.coeffs()).norm(), 1e-14) << norm;
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

TEST(So3, LogIsNeverLongerThanPi) {
  test::Random random(7);
  for (const double norm : {kPi, kPi + 1e-9, 4.0, 6.0, 2.0 * kPi, 9.0}) {
    const Vector3d axis = random.direction();
    const Vector3d log = quaternion_log(quaternion_exp(norm * axis));
    EXPECT_LE(log.norm(), kPi * (1.0 + 2.0 * kEpsilon));
    const double turns = std::round(norm / (2.0 * kPi));
    const Vector3d expected = (norm - 2.0 * kPi * turns) * axis;
    // at pi both signs are right
    const bool ambiguous = std::abs(norm - kPi) < 1e-10;
    const double other = ambiguous ? (log + expected).norm() : 1e9;
    EXPECT_LT(std::min((log - expected).norm(), other), 1e-14) << norm;
  }
  EXPECT_NEAR(quaternion_log(Quaternion(0.0, 0.0, 1.0, 0.0)).y(), kPi, 1e-15);
}

TEST(So3, ExpOfLogIsTheRotation) {
  test::Random random(8);
  for (int i = 0; i < 200; ++i) {
    const Quaternion q = random.rotation();
    const Quaternion back = quaternion_exp(quaternion_log(q));
    EXPECT_NEAR(std::abs(back.dot(q)), 1.0, 1e-15);
    EXPECT_LT(largest(gamma(0, quaternion_log(q)) - q.toRotationMatrix()), 1e-14);
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

// The angles about the vertical and across it, in world axes.
TEST(So3, RightAnglesAreTheRotationsOfACube) {
  const auto all = right_angles();
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i] * all[i].transpose(), Matrix3d::Identity());
    EXPECT_EQ(all[i].determinant(), 1.0);
    for (std::size_t k = 0; k < i; ++k) EXPECT_NE(all[i], all[k]);
  }
}

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
