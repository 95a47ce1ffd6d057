// SPDX-License-Identifier: BSD-3-Clause
// Consistency: does the error agree with the covariance?
//
// (E1) e = true - estimate in the error state: dphi = Log(q_est^-1 q_true) [rad], dp, dv, dbg, dba
// (E2) NEES = e^T P^-1 e, chi-squared with dim(e) degrees of freedom if P is right
// (E3) ANEES of N independent runs: mean NEES; N times it is chi-squared with N dim(e)
// Reference: Bar-Shalom, Li, Kirubarajan, 2001, sec. 5.4.
#pragma once

#include <Eigen/Core>
#include <limits>

#include "rio/core/assert.hpp"
#include "rio/core/chi2.hpp"
#include "rio/core/so3.hpp"

namespace rio::eval {

using BodyError = Eigen::Matrix<double, body::kSize, 1>;

/// Error of a state (E1), order of namespace body: head<9>() is attitude (body axes), position and
/// velocity, and goes with the top left 9 x 9 of a BodyCovariance.
BodyError body_error(const NavState& estimate, const NavState& truth);

/// Normalised estimation error squared (E2); NaN if P is not positive definite.
double nees(const Eigen::Ref<const Eigen::VectorXd>& error,
            const Eigen::Ref<const Eigen::MatrixXd>& P);

/// Bounds of the ANEES of consistent runs.
struct AneesBounds {
  double lower = 0.0;
  double upper = 0.0;
  bool contain(double value) const { return value >= lower && value <= upper; }
};

/// The two-sided interval (E3) that contains the ANEES of `runs` independent consistent runs of a
/// state of `dof` dimensions with `probability`, with equal tails.
AneesBounds anees_bounds(int dof, int runs, double probability);

}  // namespace rio::eval
