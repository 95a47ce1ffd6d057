// SPDX-License-Identifier: BSD-3-Clause
#include "rio/core/so3.hpp"

#include <algorithm>
#include <cmath>

namespace rio {
namespace {

constexpr std::array<double, 7> kFactorial = {1.0, 1.0, 2.0, 6.0, 24.0, 120.0, 720.0};

// Terms of a series for x < 1 and for x < 0.01: the remainder is below double precision.
constexpr int kTerms = 10;
constexpr int kFewTerms = 5;
constexpr double kSmall = 0.01;

// (-1)^k / (2k+m)! by m and k.
constexpr auto kCoefficients = [] {
  std::array<std::array<double, kTerms + 1>, 7> c{};
  for (int m = 0; m < 7; ++m) {
    double term = 1.0 / kFactorial[static_cast<std::size_t>(m)];
    for (int k = 0; k <= kTerms; ++k) {
      c[static_cast<std::size_t>(m)][static_cast<std::size_t>(k)] = term;
      term /= -(2.0 * (k + 1) + m) * (2.0 * (k + 1) + m - 1.0);
    }
  }
  return c;
}();

/// (E1) for m in 0..6.
double series(int m, double x) {
  const auto index = static_cast<std::size_t>(m);
  if (x < 1.0) {
    const auto& c = kCoefficients[index];
    double sum = 0.0;
    for (auto k = static_cast<std::size_t>(x < kSmall ? kFewTerms : kTerms); k-- > 0;) {
      sum = sum * x + c[k];
    }
    return sum;
  }
  const double t = std::sqrt(x);
  if (m == 0) return std::cos(t);
  if (m == 1) return std::sin(t) / t;
  return (1.0 / kFactorial[index - 2] - series(m - 2, x)) / x;
}

/// (E2) with S_{m+1} and S_{m+2}.
Matrix3d gamma_of(int m, const Vector3d& phi, double next, double after) {
  const Vector3d scaled = after * phi;
  // [phi]^2 = phi phi^T - |phi|^2 I
  const double diagonal = 1.0 / kFactorial[static_cast<std::size_t>(m)] - scaled.dot(phi);
  Matrix3d out = skew(next * phi);
  out += scaled * phi.transpose();
  for (int i = 0; i < 3; ++i) out(i, i) += diagonal;
  return out;
}

}  // namespace

GammaSeries::GammaSeries(double x) {
  s_[0] = 0.0;
  s_[6] = series(6, x);
  s_[5] = series(5, x);
  for (int m = 4; m > 0; --m) {  // downward recursion; for x >= 1 its differences cancel
    const auto i = static_cast<std::size_t>(m);
    s_[i] = x < 1.0 ? 1.0 / kFactorial[i] - x * s_[i + 2] : series(m, x);
  }
}

double GammaSeries::term(int m, double x) {
  return series(m, x);
}

Matrix3d gamma(int m, const Vector3d& phi, const GammaSeries& S) {
  return gamma_of(m, phi, S[m + 1], S[m + 2]);
}

Matrix3d gamma(int m, const Vector3d& phi) {
  const double x = phi.squaredNorm();
  return gamma_of(m, phi, series(m + 1, x), series(m + 2, x));
}

Matrix3d d_gamma_a_d_phi(int m, const Vector3d& phi, const Vector3d& a, const GammaSeries& S) {
  const Vector3d cross = phi.cross(a);
  // d([phi]^2 a)/dphi = phi a^T + (phi . a) I - 2 a phi^T
  const Vector3d twice = phi.cross(cross);
  Vector3d along = S.derivative(m + 1) * cross;
  along += S.derivative(m + 2) * twice;
  along -= S[m + 2] * a;
  along *= 2.0;
  const Vector3d scaled = S[m + 2] * a;
  const double diagonal = scaled.dot(phi);
  Matrix3d out = skew(-S[m + 1] * a);
  out += along * phi.transpose();
  out += phi * scaled.transpose();
  for (int i = 0; i < 3; ++i) out(i, i) += diagonal;
  return out;
}

Quaternion quaternion_exp(const Vector3d& phi) {
  const double quarter = 0.25 * phi.squaredNorm();  // (|phi|/2)^2
  const Vector3d xyz = 0.5 * series(1, quarter) * phi;
  return Quaternion(series(0, quarter), xyz.x(), xyz.y(), xyz.z()).normalized();
}

Vector3d quaternion_log(const Quaternion& q) {
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  const Vector3d xyz = sign * q.vec();
  const double sine = xyz.norm();
  const double w = sign * q.w();
  // atan(s)/s = 1 - s^2/3 + ...: two terms are exact to 1e-16 below the bound
  if (sine < 1e-5) return 2.0 / w * (1.0 - sine * sine / (3.0 * w * w)) * xyz;
  return 2.0 * std::atan2(sine, w) / sine * xyz;
}

Quaternion rotation_between(const Vector3d& a, const Vector3d& b) {
  constexpr double kOpposite = 1e-12;
  const Vector3d from = a.normalized();
  const Vector3d sum = from + b.normalized();
  if (sum.norm() < kOpposite) {
    const Vector3d axis = from.unitOrthogonal();
    return Quaternion(0.0, axis.x(), axis.y(), axis.z());
  }
  const Vector3d middle = sum.normalized();  // half the rotation
  const Vector3d xyz = from.cross(middle);
  return Quaternion(from.dot(middle), xyz.x(), xyz.y(), xyz.z()).normalized();
}

std::array<Matrix3d, 24> right_angles() {
  std::array<Matrix3d, 24> all;
  std::size_t n = 0;
  for (int x = 0; x < 3; ++x) {
    for (int y = 0; y < 3; ++y) {
      if (x == y) continue;
      for (int signs = 0; signs < 4; ++signs) {
        Matrix3d& R = all[n++];
        R.setZero();
        R(x, 0) = (signs & 1) != 0 ? -1.0 : 1.0;
        R(y, 1) = (signs & 2) != 0 ? -1.0 : 1.0;
        R.col(2) = R.col(0).cross(R.col(1));
      }
    }
  }
  return all;
}

AttitudeVariance attitude_variance(const Quaternion& q_WB, const Matrix3d& P) {
  const Vector3d up_B = q_WB.conjugate() * Vector3d::UnitZ();
  const double heading = up_B.dot(P * up_B);
  return {std::max(0.0, heading), std::max(0.0, P.trace() - heading)};
}

}  // namespace rio
