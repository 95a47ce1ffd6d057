// SPDX-License-Identifier: BSD-3-Clause
// The marginalisation prior: the information of all marginalised states about the remaining ones, a
// quadratic in the right-invariant error about its linearisation point x_l.
//
// cost = xi^T A xi / 2 - g^T xi, xi over [states 0..leading-1 | calibration, auxiliary | landmarks]
// (E1) R_0 R_0l^T = Z Exp(tau), Z = Exp(psi e_z), tau_z = 0: rotation of state 0 as tilt and
//      heading
// (E2) state 0  phi = (tau_x, tau_y, psi);  other states  phi = Log(Z^T R R_l^T)
//      all      eta_p = Z^T p - p_l, eta_v = Z^T v - v_l, biases b - b_l;  landmarks  Z^T l - l_l
// (E3) T_BS Log(R_l^T R), p - p_l; other calibration and auxiliary states c - c_l
// (E4) dxi = (I + w e_psi^T) B dx with B by blocks: phi_0 [Jl(tau) e_x, Jl(tau) e_y, e_z]^-1 Z^T R,
//      phi Jl^-1(phi) Z^T R, eta Z^T;  w: -Jl^-1(phi) e_z at phi, -e_z x (Z^T y) at the eta of y
// (E5) consider: with m, s the mean and variance of the elevation error d in the prior alone,
//      (A^-1 + e q e^T)^-1 = A - A e (1/q + e^T A e)^-1 e^T A with q = s_0 - s, and the mean is
//      moved by -m e:  g <- g - A e (1/q + e^T A e)^-1 e^T g - m A' e, A' the new A
// Observability constraint: a rotation of everything about gravity changes psi only, a translation
// changes every eta equally. These unobservable directions do not depend on x, so A gains no
// information about them, wherever the states move. (With the standard error, first-estimate
// Jacobians, FEJ, in every factor serve the same purpose.)
// Reference: Michalczyk et al., IROS 2024, eq. 9-10 (the Schur complement that gives A and g).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "rio/core/so3.hpp"
#include "rio/smoother/block_cholesky.hpp"
#include "rio/smoother/normal_equations.hpp"
#include "rio/smoother/window.hpp"
#include "rio/state/estimate.hpp"
#include "rio/state/layout.hpp"

namespace rio {

class Prior {
 public:
  /// @param layout [newest state | border], without clones
  Prior(const Layout& layout, int max_states);

  int leading_states() const { return static_cast<int>(states_.size()); }
  /// Information and vector at the linearisation point, in xi.
  Eigen::Ref<const Eigen::MatrixXd> A() const { return A_.topLeftCorner(size(), size()); }
  Eigen::Ref<const Eigen::VectorXd> g() const { return g_.head(size()); }

  /// Sets the prior from information and vector in the standard error at the current point, over
  /// the states [first .. first + leading - 1] of the window and the border of x.
  void assign(const Eigen::Ref<const Eigen::MatrixXd>& A,
              const Eigen::Ref<const Eigen::VectorXd>& g, const Window& window, std::size_t first,
              int leading, const Estimate& x);

  /// Adds the prior to the system at the current point; returns its cost.
  double add_to(NormalEquations* system, const Window& window, const Estimate& x);

  /// Random walk of every landmark (E3 of update/look_correlation.hpp): A <- (A^-1 + Q)^-1. Ten
  /// landmarks per call, in turn, each with the variances accumulated since its last turn.
  /// @param p_WB position, from which they are seen [m]
  /// @param walk of every landmark [m/sqrt(m)]
  /// @param distance travelled [m]
  void add_landmark_noise(const Estimate& x, const Vector3d& p_WB, double walk, double distance);

  /// Random walk of the parameters over `seconds`.
  /// @param walk ParameterNoise::walk
  void add_parameter_noise(const Eigen::VectorXd& walk, double seconds);

  /// (E5): what is considered has mean zero and these variances again.
  /// @param variances ParameterNoise::prior
  void consider(const Eigen::VectorXd& variances);

  /// Marginalises landmark i, if the prior has it; the last one takes its place.
  void remove_landmark(std::size_t i, std::size_t last);

 private:
  int size() const { return landmark(landmarks_.size()); }
  /// Column of the prior for a column of [newest state | border].
  int border(int column) const { return column - body::kSize + body::kSize * leading_states(); }
  /// First column of landmark i.
  int landmark(std::size_t i) const { return border(layout_.landmark(static_cast<int>(i))); }

  /// Adds independent noise of the variances 1 / inverse to the unknowns from `at` on; 0 =
  /// infinite.
  void add_noise(int at, const Eigen::Ref<const Eigen::VectorXd>& inverse);

  /// xi at the current point (E1) (E2) (E3).
  void evaluate(const Window& window, const Estimate& x);

  static constexpr int kHeading = body::kAttitude + 2;  // of state 0
  double heading() const { return xi_[kHeading]; }

  /// Left Jacobian of the rotation of state s in (E4), to be inverted: in (tau, psi) for state 0,
  /// in phi for the others.
  Matrix3d turn_jacobian(int s) const;

  /// w of (E4) at xi_.
  /// @param first index in the window of state 0
  void fill_heading_part(const Window& window, std::size_t first, const Estimate& x,
                         const Matrix3d& Zt);

  /// A <- (I + w e^T)^T A (I + w e^T), g <- (I + w e^T)^T g.
  void add_heading_part(Eigen::MatrixXd* A, Eigen::VectorXd* g);

  /// Applies B of (E4) to work_, as multiply_block() does, for all blocks Z^T, which rotate the
  /// first two of their unknowns by -heading.
  void turn_back(double heading);

  Layout layout_;
  std::vector<NavState> states_;
  StaticVector<LandmarkState, kMaxLandmarks> landmarks_;
  std::array<Vector3d, kMaxLandmarks> pending_walk_;  ///< variances since its last turn [m^2]
  std::size_t turn_ = 0;                              ///< the landmark whose turn is next
  std::array<RadarState, kMaxRadars> radars_;
  AuxiliaryValues auxiliary_ = AuxiliaryValues::Zero();
  Eigen::VectorXd g_;
  Eigen::MatrixXd A_;
  Eigen::MatrixXd work_;
  Eigen::VectorXd work_g_;
  Eigen::VectorXd xi_;
  Eigen::VectorXd w_;
  Eigen::VectorXd A_xi_;
};

}  // namespace rio
