// SPDX-License-Identifier: BSD-3-Clause
// Stage 3: errors in variables: how much of the spread of a scan's directions is their error.
//
// The expected directions u^ = u_true + e of a scan (models/doppler.hpp) measure the velocity error
// d by the score s = sum u^ r / R. With S = sum u^ u^^T / R and C = sum cov(e) / R, e uncorrelated
// with r, and A = S - C = sum u_true u_true^T / R:
// (E1) E[s] = A d,  cov(s) = S      where a filter that takes u^ for true expects S d
// (E2) u^ <- L u^,  L = A S^-1      E[L s] = A S^-1 A d,  cov(L s) = A S^-1 A: the information is
//                                   that of the score, and the solution s = 0 is unchanged
// Without L the filter is overconfident in the velocity along poorly measured angles: by a factor
// of 1.4 to 1.7 in variance with 4 deg in a field of view of 30 deg.
// Reference: L is the reliability matrix of errors-in-variables regression (Fuller, Measurement
// Error Models, 1987; Gleser 1992).
#pragma once

#include "rio/models/doppler.hpp"
#include "rio/types.hpp"

namespace rio {

class Reliability {
 public:
  /// @param v_S velocity of the radar in its axes [m/s]
  void add(const DopplerModel::Measurement& z, const Vector3d& v_S);
  /// @param u expected direction, @param covariance cov(e), @param variance R [m^2/s^2]
  void add(const Vector3d& u, const Matrix3d& covariance, double variance);

  /// L. Zero along axes where the spread does not exceed that of the errors; identity if nothing
  /// was added.
  Matrix3d matrix() const;

 private:
  Matrix3d S_ = Matrix3d::Zero();
  Matrix3d C_ = Matrix3d::Zero();
};

}  // namespace rio
