// SPDX-License-Identifier: BSD-3-Clause
// A check of the gyro bias about the vertical, from what the updates do to it. Nothing else watches
// it: no Doppler and no gravity tells the heading. A bias that has made a step turns the landmarks,
// scan after scan the same way; a small sigma keeps the estimate from following.
//
// A right estimate is corrected by increments that are white, each with the covariance by which the
// update reduces P (innovations are orthogonal). So, summed over the scans of a window,
// (E1) d = sum of db,  S = sum of P(before) - P(after),  d ~ N(0, S)
// (E2) along the vertical u: (u . d)^2 > 16 u^T S u contradicts the estimate
// (E3) errors that repeat, echoes counted twice, a wrong mounting, throw the parts of the window
//      about: chi^2 = sum (u . d_i - m u^T S_i u)^2 / u^T S_i u, m of (E1), n parts; where
//      chi^2 / (n - 1) is above 1 it scales S
// (E4) the updates alone have seen the error e = u . d (u^T P u) / (u^T S u): S = P^2 I, d = P I e
//      for a small share I of the information, mean over the window. Its sigma is that of a window
//      which tells enough: with less, errors that no model has would decide.
#pragma once

#include <optional>

#include "rio/core/ring.hpp"
#include "rio/options.hpp"
#include "rio/state/estimate.hpp"

namespace rio {

/// What the updates say of the gyro bias about the vertical.
struct GyroBiasOpinion {
  double error = 0.0;                   ///< true minus estimated, mean of the window [rad/s]
  double duration = 0.0;                ///< of the window [s]
  Vector3d moved_W = Vector3d::Zero();  ///< in it [m]
};

/// No allocation after construction.
class GyroBiasCheck {
 public:
  explicit GyroBiasCheck(const Options& options)
      : enabled_(options.frontend.velocity_recovery), parts_(kParts) {}

  /// Starts over.
  void reset() { parts_.clear(); }

  /// Before an update.
  /// @param P_body of x, order of namespace body
  void predicted(const Estimate& x, const BodyCovariance& P_body);
  /// After it; the result is the error, if the window contradicts the estimate.
  std::optional<GyroBiasOpinion> corrected(const Estimate& x, const BodyCovariance& P_body);

 private:
  /// A second.
  struct Part {
    Time begin{0};
    Vector3d p_WB = Vector3d::Zero();  ///< at its begin [m]
    Vector3d d = Vector3d::Zero();     ///< (E1) [rad/s]
    Matrix3d S = Matrix3d::Zero();     ///< (E1) [(rad/s)^2]
  };

  /// (E3): chi^2 a degree of freedom; slope is m.
  double scatter(const Vector3d& up_B, double slope) const;

  static constexpr Time kPart = std::chrono::seconds(1);
  static constexpr std::size_t kParts = 20;   // a landmark is seen for so long; a take-off is over
  static constexpr std::size_t kEnough = 10;  // make a chi^2
  static constexpr Time kPatience = std::chrono::seconds(2);  // chance does not last
  static constexpr double kSigmas = 4.0;                      // one window in sixteen thousand
  static constexpr double kWeak = 0.005;  // sigma of (E4), beyond any step of a bias [rad/s]

  bool enabled_;
  Time agreed_{0};  ///< the last window that did not contradict
  Ring<Part> parts_;
  Vector3d bias_ = Vector3d::Zero();      ///< before the update
  Matrix3d variance_ = Matrix3d::Zero();  ///< same
};

}  // namespace rio
