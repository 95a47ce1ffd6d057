// SPDX-License-Identifier: BSD-3-Clause
// The inverse observation model that puts a landmark into the state. What is observed of it
// afterwards is in the model suite.
#include "rio/models/landmark_birth.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "rio/models/landmark_point.hpp"
#include "support/random_state.hpp"

namespace rio::test {
namespace {

TEST(LandmarkBirth, IsObservedWhereItWasBornAndMovesAsItsJacobianSays) {
  constexpr double kStep = 1e-6;
  Random random(41);
  for (int i = 0; i < 50; ++i) {
    const RigidPose T_WB(random.rotation().toRotationMatrix(), random.normal_vector());
    const RigidPose T_BS(random.rotation().toRotationMatrix(), random.normal_vector(0.2));
    const Vector3d seen_S = random.uniform(1.0, 8.0) * random.direction();
    const Detection d = make_detection({.point_S = seen_S}, RadarOptions{});
    const double raised = i % 2 == 0 ? 0.0 : random.uniform(-0.05, 0.05);
    const LandmarkBirth birth(T_WB, T_BS, raised, d);
    const Vector3d point_S = ObservedPoint(T_WB, T_BS, birth.p_WL).e_S;
    EXPECT_LT((point_S - d.point_S).norm(), 1e-13 + 1.001 * std::abs(raised) * d.range);
    Evaluation<LandmarkPointModel> seen;
    ASSERT_TRUE(evaluate(LandmarkPointModel{}, LandmarkPointModel::measurement(d),
                         {T_WB, T_BS, birth.p_WL, raised}, &seen));
    EXPECT_NEAR(seen.r[2], 0.0,
                1e-12 + std::abs(raised * raised * raised));  // atan d = d - d^3 / 3
    for (int k = 0; k < LandmarkBirth::Blocks::kDof; ++k) {
      const auto moved = [&](double step) {
        const Eigen::Matrix<double, 6, 1> e = Eigen::Matrix<double, 6, 1>::Unit(k % 6) * step;
        return LandmarkBirth(k < 6 ? PoseBlock::retract(T_WB, e) : T_WB,
                             k / 6 == 1 ? PoseBlock::retract(T_BS, e) : T_BS,
                             k < 12 ? raised : raised + step, d)
            .p_WL;
      };
      const Vector3d numeric = (moved(kStep) - moved(-kStep)) / (2.0 * kStep);
      // rounding: 1e-16 times ten metres over the step
      EXPECT_LT((birth.d_l.col(k) - numeric).cwiseAbs().maxCoeff(), 1e-8) << k;
    }
    const Matrix3d R_WS = T_WB.R * T_BS.R;
    const Matrix3d noise = R_WS * point_covariance(d) * R_WS.transpose();
    EXPECT_LT((birth.noise - noise).norm(), 1e-12 * noise.norm());
  }
}

}  // namespace
}  // namespace rio::test
