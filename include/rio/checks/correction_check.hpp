// SPDX-License-Identifier: BSD-3-Clause
// Detects a lasting error of one quantity from the corrections that the updates make to it, where a
// small sigma keeps the estimate from following and no gate notices:
//   - the gyro bias about the vertical, which neither Doppler nor gravity shows: after a step the
//     landmarks appear to rotate, in the same direction scan after scan;
//   - the velocity: after a step of a bias, as motors that heat or shake the sensor make, it drifts
//     away slowly. Points at low elevation hardly measure its vertical part.
//
// The corrections of a consistent estimate are white, each with the variance by which the update
// reduces P (innovations are uncorrelated). So, summed over the scans of a window,
// (E1) d = sum of dx,  S = sum of P(before) - P(after),  d ~ N(0, S)
// (E2) d^2 > 16 S contradicts the estimate
// (E3) repeated errors, echoes counted twice or a wrong mounting scatter the n parts of the window:
//      chi^2 = sum (d_i - m S_i)^2 / S_i, m = d / S; if chi^2 / (n - 1) exceeds 1, it scales S
// (E4) a wrong scale or mounting corrects a velocity in proportion to its change c in the window:
//      (kScale c)^2 is added
// (E5) error by the updates of the window alone: e = d P / S, since S = P^2 I and d = P I e for a
//      small gain I of information; mean over the window. It is used only if its sigma is small:
//      otherwise unmodelled errors would dominate.
#pragma once

#include <optional>

#include "rio/checks/record.hpp"
#include "rio/core/ring.hpp"
#include "rio/state/estimate.hpp"

namespace rio {

/// A lasting error; units of the quantity.
struct LastingError {
  double error = 0.0;                   ///< true minus estimated, mean of the window
  double duration = 0.0;                ///< of the window [s]
  Vector3d moved_W = Vector3d::Zero();  ///< displacement in the window [m]
};

/// No allocation after construction.
class CorrectionCheck {
 public:
  /// What differs between the quantities.
  struct Window {
    Time part;           ///< length of a part
    std::size_t parts;   ///< of the window
    std::size_t enough;  ///< parts, for a meaningful chi^2
    Time patience;       ///< a coincidence does not last
    double weak;         ///< largest sigma of (E5) that is used
  };

  explicit CorrectionCheck(const Window& window) : window_(window), parts_(window.parts) {}

  /// Starts over.
  void reset() { parts_.clear(); }

  /// Call before an update.
  /// @param x predicted
  /// @param value of the quantity
  /// @param variance of it
  void predicted(const NavState& x, double value, double variance);
  /// Call after it, same; the error, if the window contradicts the estimate.
  std::optional<LastingError> corrected(const NavState& x, double value, double variance);

 private:
  /// Sums over a part of the window.
  struct Part {
    Time begin{0};
    Vector3d p_WB = Vector3d::Zero();  ///< at `begin` [m]
    double value = 0.0;                ///< same
    double d = 0.0;                    ///< (E1)
    double S = 0.0;                    ///< (E1)
  };

  /// (E3): chi^2 per degree of freedom; slope is m.
  double scatter(double slope) const;

  static constexpr double kSigmas = 4.0;  // one window in sixteen thousand
  static constexpr double kScale = 0.02;  // 2 %, or a degree

  Window window_;
  CheckRecord record_;
  Ring<Part> parts_;
  double value_ = 0.0;     ///< before the update
  double variance_ = 0.0;  ///< same
};

}  // namespace rio
