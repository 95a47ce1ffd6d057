// SPDX-License-Identifier: BSD-3-Clause
// Detects a step of the gyro bias about the vertical from the corrections that the updates make to
// it. No other check covers it, because neither Doppler nor gravity depends on the heading. After a
// step the landmarks appear to rotate, in the same direction scan after scan, but a small sigma
// keeps the estimate from following.
//
// The corrections of a consistent estimate are white, each with the covariance by which the update
// reduces P (innovations are uncorrelated). So, summed over the scans of a window,
// (E1) d = sum of db,  S = sum of P(before) - P(after),  d ~ N(0, S)
// (E2) along the vertical u: (u . d)^2 > 16 u^T S u contradicts the estimate
// (E3) repeated errors, echoes counted twice or a wrong mounting scatter the n parts of the window:
//      chi^2 = sum (u . d_i - m u^T S_i u)^2 / u^T S_i u, m = u . d / u^T S u; if chi^2 / (n - 1)
//      exceeds 1, it scales S
// (E4) error by the updates of the window alone: e = u . d (u^T P u) / (u^T S u), since S = P^2 I
//      and d = P I e for a small gain I of information; mean over the window. It is used only if
//      its sigma is at most kWeak: otherwise unmodelled errors would dominate.
#pragma once

#include <optional>

#include "rio/checks/record.hpp"
#include "rio/core/ring.hpp"
#include "rio/options.hpp"
#include "rio/state/estimate.hpp"

namespace rio {

/// Independent estimate of the error of the gyro bias about the vertical.
struct GyroBiasStep {
  double error = 0.0;                   ///< true minus estimated, mean of the window [rad/s]
  double duration = 0.0;                ///< of the window [s]
  Vector3d moved_W = Vector3d::Zero();  ///< displacement in the window [m]
};

/// No allocation after construction.
class HeadingCheck {
 public:
  explicit HeadingCheck(const Options& options)
      : enabled_(options.checks.heading), parts_(kParts) {}

  /// Starts over.
  void reset() { parts_.clear(); }

  /// Call before an update, with the predicted state.
  /// @param P_body covariance of x, order of namespace body
  void predicted(const Estimate& x, const BodyCovariance& P_body);
  /// Call after it, with the corrected state; the error, if the window contradicts the estimate.
  std::optional<GyroBiasStep> corrected(const Estimate& x, const BodyCovariance& P_body);

 private:
  /// Sums over kPart.
  struct Part {
    Time begin{0};
    Vector3d p_WB = Vector3d::Zero();  ///< at `begin` [m]
    Vector3d d = Vector3d::Zero();     ///< (E1) [rad/s]
    Matrix3d S = Matrix3d::Zero();     ///< (E1) [(rad/s)^2]
  };

  /// (E3): chi^2 per degree of freedom; slope is m.
  double scatter(const Vector3d& up_B, double slope) const;

  static constexpr Time kPart = std::chrono::seconds(1);
  static constexpr std::size_t kParts = 20;  // a landmark is seen that long, longer than a take-off
  static constexpr std::size_t kEnough = 10;                  // parts, for a meaningful chi^2
  static constexpr Time kPatience = std::chrono::seconds(2);  // a coincidence does not last
  static constexpr double kSigmas = 4.0;                      // one window in sixteen thousand
  static constexpr double kWeak = 0.005;  // sigma of (E4), beyond any step of a bias [rad/s]

  bool enabled_;
  CheckRecord record_;
  Ring<Part> parts_;
  Vector3d bias_ = Vector3d::Zero();      ///< before the update
  Matrix3d variance_ = Matrix3d::Zero();  ///< same
};

}  // namespace rio
