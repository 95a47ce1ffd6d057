// SPDX-License-Identifier: BSD-3-Clause
// What all marginalised states say about those that are left: a quadratic in the right-invariant
// error about the point where it was made.
//
// cost = xi^T A xi / 2 - g^T xi, xi over [states 0..leading-1 | calibration | landmarks], about x_l
// (E1) R_0 R_0l^T = Z Exp(tau), Z = Exp(psi e_z), tau_z = 0: the turn of state 0, heading last
// (E2) state 0  phi = (tau_x, tau_y, psi);  other states  phi = Log(Z^T R R_l^T)
//      all      eta_p = Z^T p - p_l, eta_v = Z^T v - v_l, biases b - b_l;  landmarks  Z^T l - l_l
// (E3) T_BS Log(R_l^T R), p - p_l; other calibration c - c_l
// (E4) dxi = (I + w e_psi^T) B dx with B by blocks: phi_0 [Jl(tau) e_x, Jl(tau) e_y, e_z]^-1 Z^T R,
//      phi Jl^-1(phi) Z^T R, eta Z^T;  w: -Jl^-1(phi) e_z at phi, -e_z x (Z^T y) at the eta of y
// A turn of everything about gravity moves psi and nothing else, a translation moves every eta by
// the same: directions that do not depend on x. What A cannot tell when it is made it can never
// tell, wherever the states move. (The standard error needs first-estimate Jacobians in every
// factor for the same end.)
// Reference: Michalczyk et al., IROS 2024, eq. 9-10 (the Schur complement that makes A and g).
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "rio/core/so3.hpp"
#include "rio/smoother/block_cholesky.hpp"
#include "rio/smoother/normal_equations.hpp"
#include "rio/smoother/quadratic.hpp"
#include "rio/smoother/window.hpp"
#include "rio/state/estimate.hpp"
#include "rio/state/layout.hpp"

namespace rio {

class Prior {
 public:
  /// @param layout [newest state | border], without clones
  Prior(const Layout& layout, int max_states)
      : layout_(layout),
        A_(matrix(layout, max_states)),
        work_(A_),
        g_(Eigen::VectorXd::Zero(A_.rows())),
        work_g_(g_),
        xi_(g_),
        w_(g_),
        A_xi_(g_) {
    states_.reserve(static_cast<std::size_t>(max_states));
  }

  int leading_states() const { return static_cast<int>(states_.size()); }
  /// Information and vector at the point where it was made, in xi.
  Eigen::Ref<const Eigen::MatrixXd> A() const { return A_.topLeftCorner(size(), size()); }
  Eigen::Ref<const Eigen::VectorXd> g() const { return g_.head(size()); }

  /// Made from information and vector in the standard error at the present point, over the
  /// states [first .. first + leading - 1] of the window and the border of x.
  void assign(const Eigen::Ref<const Eigen::MatrixXd>& A,
              const Eigen::Ref<const Eigen::VectorXd>& g, const Window& window, std::size_t first,
              int leading, const Estimate& x) {
    states_.clear();
    for (int s = 0; s < leading; ++s) {
      states_.push_back(window[first + static_cast<std::size_t>(s)].nav);
    }
    landmarks_ = x.landmarks;
    T_BS_ = x.T_BS;
    radar_errors_ = x.radar_errors;
    time_offset_ = x.time_offset;
    A_.topLeftCorner(size(), size()) = A;
    g_.head(size()) = g;
    for (int s = 0; s < leading; ++s) {  // the inverse of (E4) where xi = 0
      const Matrix3d R = states_[static_cast<std::size_t>(s)].q_WB.toRotationMatrix();
      quadratic::multiply_block(size(), body::kSize * s + body::kAttitude, R.transpose(), &A_, &g_);
    }
    cholesky::mirror_lower(A_.topLeftCorner(size(), size()));
    xi_.head(size()).setZero();
    fill_heading_part(window, first, x, Matrix3d::Identity());
    w_ *= -1.0;
    add_heading_part(&A_, &g_);
  }

  /// Adds it to the system at the present point; the result is its cost.
  double add_to(NormalEquations* system, const Window& window, const Estimate& x) {
    evaluate(window, x);
    const int n = size();
    auto xi = xi_.head(n);
    A_xi_.head(n).noalias() = A() * xi;
    const double cost = 0.5 * xi.dot(A_xi_.head(n)) - g().dot(xi);
    work_.topLeftCorner(n, n) = A();
    work_g_.head(n) = g() - A_xi_.head(n);
    const Matrix3d Zt = gamma(0, -heading() * Vector3d::UnitZ());
    fill_heading_part(window, 0, x, Zt);
    add_heading_part(&work_, &work_g_);
    for (int s = 0; s < leading_states(); ++s) {
      const Matrix3d R = window[static_cast<std::size_t>(s)].nav.q_WB.toRotationMatrix();
      quadratic::multiply_block(n, body::kSize * s + body::kAttitude,
                                turn_jacobian(s).inverse() * Zt * R, &work_, &work_g_);
    }
    turn_back(heading());
    if (layout_.has_extrinsics()) {
      const int at = border(layout_.extrinsics());
      quadratic::multiply_block(n, at, gamma(1, -xi.segment<3>(at)).inverse(), &work_, &work_g_);
    }
    system->add_quadratic(leading_states(), work_.topLeftCorner(n, n), work_g_.head(n));
    return cost;
  }

  /// Every landmark walks by this variance per axis [m^2]: A <- (A^-1 + Q)^-1, some landmarks after
  /// the other by (A^-1 + q E E^T)^-1 = A - A E (I / q + E^T A E)^-1 E^T A, three columns E each.
  void add_landmark_noise(double variance) {
    if (!(variance > 0.0)) return;
    constexpr int kPanel = 3 * (cholesky::kPanel / 3);  // whole landmarks
    const int n = size();
    for (int at = border(layout_.landmark(0)); at < n; at += kPanel) {
      const int width = std::min(kPanel, n - at);
      quadratic::subtract_projection(n, at, width, 1.0 / variance, &A_, &g_, &work_);
    }
    cholesky::mirror_lower(A_.topLeftCorner(size(), size()));
  }

  /// Landmark i is marginalised; the last one takes its place. Landmarks that came after the prior
  /// was made are none of its business.
  void remove_landmark(std::size_t i, std::size_t last) {
    if (i >= landmarks_.size()) return;
    const int at = border(layout_.landmark(static_cast<int>(i)));
    quadratic::subtract_projection(size(), at, 3, 0.0, &A_, &g_, &work_);
    cholesky::mirror_lower(A_.topLeftCorner(size(), size()));
    // the window's last landmark moves to i; the prior's own last one may be an earlier one
    const std::size_t own_last = landmarks_.size() - 1;
    if (last != own_last) {
      forget_in_place(i);
      return;
    }
    move_landmark(own_last, i);
    landmarks_.pop_back();
  }

 private:
  static Eigen::MatrixXd matrix(const Layout& layout, int max_states) {
    const int size = body::kSize * (max_states - 1) + layout.capacity();
    return Eigen::MatrixXd::Zero(size, size);
  }
  int size() const { return border(layout_.size(static_cast<int>(landmarks_.size()))); }
  /// Column of the prior for a column of [newest state | border].
  int border(int column) const { return column - body::kSize + body::kSize * leading_states(); }

  /// xi at the present point (E1) (E2) (E3).
  void evaluate(const Window& window, const Estimate& x) {
    const Quaternion turn = window[0].nav.q_WB * states_[0].q_WB.conjugate();
    const Quaternion back = Quaternion(turn.w(), 0.0, 0.0, -turn.z()).normalized();  // Z^T
    for (int s = 0; s < leading_states(); ++s) {
      const NavState& then = states_[static_cast<std::size_t>(s)];
      const NavState& now = window[static_cast<std::size_t>(s)].nav;
      auto xi = xi_.segment<body::kSize>(body::kSize * s);
      xi.segment<3>(body::kAttitude) = quaternion_log(back * now.q_WB * then.q_WB.conjugate());
      xi.segment<3>(body::kPosition) = back * now.p_WB - then.p_WB;
      xi.segment<3>(body::kVelocity) = back * now.v_WB - then.v_WB;
      xi.segment<3>(body::kGyroBias) = now.gyro_bias - then.gyro_bias;
      xi.segment<3>(body::kAccelBias) = now.accel_bias - then.accel_bias;
    }
    xi_[kHeading] = -quaternion_log(back).z();
    if (layout_.has_extrinsics()) {
      const int at = border(layout_.extrinsics());
      xi_.segment<3>(at) = quaternion_log(T_BS_.rotation.conjugate() * x.T_BS.rotation);
      xi_.segment<3>(at + 3) = x.T_BS.translation - T_BS_.translation;
    }
    if (layout_.has_radar_errors()) {
      xi_.segment<2>(border(layout_.radar_errors())) = x.radar_errors - radar_errors_;
    }
    if (layout_.has_time_offset()) {
      xi_[border(layout_.time_offset())] = x.time_offset - time_offset_;
    }
    for (std::size_t i = 0; i < landmarks_.size(); ++i) {
      xi_.segment<3>(border(layout_.landmark(static_cast<int>(i)))) =
          back * x.landmarks[i].p_W - landmarks_[i].p_W;
    }
  }

  static constexpr int kHeading = body::kAttitude + 2;  // of state 0
  double heading() const { return xi_[kHeading]; }

  /// d(turn of state s, Z^T first)/d(its phi), (E4).
  Matrix3d turn_jacobian(int s) const {
    Vector3d phi = xi_.segment<3>(body::kSize * s + body::kAttitude);
    if (s > 0) return gamma(1, phi);
    phi.z() = 0.0;
    Matrix3d J = gamma(1, phi);
    J.col(2) = Vector3d::UnitZ();
    return J;
  }

  /// w of (E4) at xi_.
  /// @param first of the window's states that is state 0
  void fill_heading_part(const Window& window, std::size_t first, const Estimate& x,
                         const Matrix3d& Zt) {
    const Vector3d z = Vector3d::UnitZ();
    w_.head(size()).setZero();
    for (int s = 0; s < leading_states(); ++s) {
      const NavState& now = window[first + static_cast<std::size_t>(s)].nav;
      auto w = w_.segment<body::kSize>(body::kSize * s);
      if (s > 0) w.segment<3>(body::kAttitude) = -turn_jacobian(s).inverse() * z;
      w.segment<3>(body::kPosition) = -z.cross(Zt * now.p_WB);
      w.segment<3>(body::kVelocity) = -z.cross(Zt * now.v_WB);
    }
    for (std::size_t i = 0; i < landmarks_.size(); ++i) {
      w_.segment<3>(border(layout_.landmark(static_cast<int>(i)))) =
          -z.cross(Zt * x.landmarks[i].p_W);
    }
  }

  /// A <- (I + w e^T)^T A (I + w e^T), g <- (I + w e^T)^T g.
  void add_heading_part(Eigen::MatrixXd* A, Eigen::VectorXd* g) {
    const int n = size();
    const auto w = w_.head(n);
    auto A_w = A_xi_.head(n);
    A_w.noalias() = A->topLeftCorner(n, n) * w;
    const double w_A_w = w.dot(A_w);
    A->col(kHeading).head(n) += A_w;
    A->row(kHeading).head(n) += A_w.transpose();
    (*A)(kHeading, kHeading) += w_A_w;
    (*g)[kHeading] += w.dot(g->head(n));
  }

  /// B of (E4) on work_ as multiply_block() does it, for all blocks Z^T, which turn the first two
  /// of their unknowns by -heading.
  void turn_back(double heading) {
    const double cosine = std::cos(heading);
    const double sine = std::sin(heading);
    const auto turn = [&](double* x, double* y) {  // the columns of Z^T are the rows of Z
      const double x_before = *x;
      *x = cosine * x_before - sine * *y;
      *y = sine * x_before + cosine * *y;
    };
    const int n = size();
    for_each_turned([&](int at) {
      for (int r = at; r < n; ++r) turn(&work_(r, at), &work_(r, at + 1));
      turn(&work_g_[at], &work_g_[at + 1]);
    });
    for (int c = 0; c < n; ++c) {
      for_each_turned([&](int at) {
        if (c < at + 2) turn(&work_(at, c), &work_(at + 1, c));
      });
    }
  }
  /// f(first column) for each block that is a vector in W.
  template <class F>
  void for_each_turned(const F& f) const {
    for (int s = 0; s < leading_states(); ++s) {
      f(body::kSize * s + body::kPosition);
      f(body::kSize * s + body::kVelocity);
    }
    for (int at = border(layout_.landmark(0)); at < size(); at += Landmark::kDof) f(at);
  }

  /// Nothing is known of landmark i any more, whose place another one takes.
  void forget_in_place(std::size_t i) {
    const int at = border(layout_.landmark(static_cast<int>(i)));
    A_.middleRows(at, 3).leftCols(size()).setZero();
    A_.middleCols(at, 3).topRows(size()).setZero();
    g_.segment<3>(at).setZero();
  }
  void move_landmark(std::size_t from, std::size_t to) {
    if (from == to) return;
    const int n = size();
    const int source = border(layout_.landmark(static_cast<int>(from)));
    const int target = border(layout_.landmark(static_cast<int>(to)));
    A_.block(target, 0, 3, n) = A_.block(source, 0, 3, n);
    A_.block(0, target, n, 3) = A_.block(0, source, n, 3);
    g_.segment<3>(target) = g_.segment<3>(source);
    landmarks_[to] = landmarks_[from];
  }

  Layout layout_;
  std::vector<NavState> states_;
  StaticVector<LandmarkState, kMaxLandmarks> landmarks_;
  Pose T_BS_;
  RadarErrors::Value radar_errors_ = RadarErrors::Value::Zero();
  double time_offset_ = 0.0;
  Eigen::MatrixXd A_;
  Eigen::MatrixXd work_;
  Eigen::VectorXd g_;
  Eigen::VectorXd work_g_;
  Eigen::VectorXd xi_;
  Eigen::VectorXd w_;
  Eigen::VectorXd A_xi_;
};

}  // namespace rio
