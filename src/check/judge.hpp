// SPDX-License-Identifier: BSD-3-Clause
// What the checks from the motion judge: the windows of one length.
#pragma once

#include "check/advice.hpp"
#include "check/motion.hpp"
#include "check/motion_data.hpp"
#include "rio/options.hpp"

namespace rio::check {

inline constexpr double kShortestWindow = 2.0;  ///< hardly notices the biases of the IMU [s]

struct Judge {
  const MotionData& data;
  const Agreement& all;  ///< of the windows
  double length;         ///< of a window [s]
  const Options& options;
  const Advice& advice;
  Matrix3d configured = options.radar.T_BS.rotation.toRotationMatrix();

  double doubt(const Matrix3d& worse, const Matrix3d& better) const {
    return significance(all.explained(worse), all.explained(better), all.windows);
  }
};

}  // namespace rio::check
