// SPDX-License-Identifier: BSD-3-Clause
// The inverse observation model that puts a landmark into the state.
#include <gtest/gtest.h>

#include "rio/models/landmark_distance.hpp"
#include "rio/sim/random.hpp"

namespace rio::test {
namespace {

TEST(InverseObservation, JacobiansMatchCentralDifferences) {
  sim::Random random(41);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 50; ++i) {
    const RigidPose T_WB(gamma(0, random.normal3()), random.normal3());
    const RigidPose T_BS(gamma(0, random.normal3()), 0.2 * random.normal3());
    const Vector3d m = 3.0 * random.normal3();
    const InverseObservation at(T_WB, T_BS, m);
    for (int k = 0; k < 6; ++k) {
      const Eigen::Matrix<double, 6, 1> e = Eigen::Matrix<double, 6, 1>::Unit(k) * kStep;
      const Vector3d d_body = (InverseObservation(PoseBlock::retract(T_WB, e), T_BS, m).p_WL -
                               InverseObservation(PoseBlock::retract(T_WB, -e), T_BS, m).p_WL) /
                              (2.0 * kStep);
      const Vector3d d_mount = (InverseObservation(T_WB, PoseBlock::retract(T_BS, e), m).p_WL -
                                InverseObservation(T_WB, PoseBlock::retract(T_BS, -e), m).p_WL) /
                               (2.0 * kStep);
      // rounding: 1e-16 times ten metres over the step
      EXPECT_LT((at.d_l_d_body.col(k) - d_body).norm(), 1e-8);
      EXPECT_LT((at.d_l_d_extrinsics.col(k) - d_mount).norm(), 1e-8);
    }
    for (int k = 0; k < 3; ++k) {
      const Vector3d e = Vector3d::Unit(k);
      const Vector3d d = InverseObservation(T_WB, T_BS, m + e).p_WL - at.p_WL;  // it is linear
      EXPECT_LT((at.d_l_d_m.col(k) - d).norm(), 1e-13);
    }
  }
}

TEST(InverseObservation, UndoesTheObservation) {
  sim::Random random(42);
  const RigidPose T_WB(gamma(0, random.normal3()), random.normal3());
  const RigidPose T_BS(gamma(0, random.normal3()), random.normal3());
  const Vector3d m = random.normal3();
  EXPECT_LT((to_radar(T_WB, T_BS, InverseObservation(T_WB, T_BS, m).p_WL) - m).norm(), 1e-14);
}

}  // namespace
}  // namespace rio::test
