// SPDX-License-Identifier: BSD-3-Clause
// The rotation of the scene in the state estimate (state/scene_rotation.hpp).
#include <gtest/gtest.h>

#include <cmath>

#include "rio/core/so3.hpp"
#include "rio/update/state_estimate.hpp"

namespace rio {
namespace {

class SceneEstimateTest : public testing::Test {
 protected:
  SceneEstimateTest() {
    options_.calibration.scene_sigma = 0.12;
    nav_.time = Time(1'000'000'000);
  }
  StateEstimate state_estimate() const { return state_estimate(nav_); }
  StateEstimate state_estimate(const NavState& nav) const {
    StateEstimate b(options_, 3);
    b.reset(nav, 1e-6 * BodyCovariance::Identity());
    return b;
  }
  /// A second at constant velocity.
  void fly(StateEstimate* b) const {
    ImuBuffer imu(options_.timing, options_.imu);
    for (int i = 0; i <= 200; ++i) {
      imu.push_back({nav_.time + Time(5'000'000 * i), Vector3d::Zero(),
                     Vector3d(0.0, 0.0, options_.imu.gravity)});
    }
    bool gap = true;
    ASSERT_EQ(b->propagate(imu.newest().time, imu, &gap), Status::kOk);
  }

  Options options_;
  NavState nav_;
};

/// Covariance of the difference of two blocks of three.
Matrix3d difference(const StateEstimate& b, int x, int y) {
  const auto P = b.covariance().matrix();
  return P.block<3, 3>(x, x) + P.block<3, 3>(y, y) - P.block<3, 3>(x, y) - P.block<3, 3>(y, x);
}

TEST_F(SceneEstimateTest, TheSceneTurnsTheRadarBesideItsMounting) {
  const StateEstimate b = state_estimate();
  const Layout& layout = b.layout();
  const auto P = b.covariance().matrix();
  const Matrix3d mounting = P.block<3, 3>(layout.mounting(), layout.mounting());
  const double sigma = options_.calibration.rotation_sigma;
  EXPECT_LT((mounting - sigma * sigma * Matrix3d::Identity()).norm(), 1e-15);
  const Vector3d scene = scene_variance(options_.calibration.scene_sigma, b.estimate().points);
  const Matrix3d off = difference(b, layout.extrinsics(), layout.mounting());
  EXPECT_LT((off - Matrix3d(scene.asDiagonal())).norm(), 1e-15);
}

// After many lengths of the way it is a new one, however well it was known.
TEST_F(SceneEstimateTest, TheSceneChangesOnTheWay) {
  NavState fast = nav_;
  fast.v_WB = {30.0, 0.0, 0.0};
  StateEstimate b = state_estimate(fast);
  b.estimate().T_BS.rotation = b.estimate().mounting * quaternion_exp({0.0, 0.05, -0.05});
  const Layout& layout = b.layout();
  b.covariance().relax(layout.extrinsics(), layout.mounting(), 0.0, Vector3d::Zero());
  fly(&b);
  const Vector3d scene = scene_variance(options_.calibration.scene_sigma, b.estimate().points);
  const Matrix3d off = difference(b, layout.extrinsics(), layout.mounting());
  EXPECT_LT((off - Matrix3d(scene.asDiagonal())).norm(), 1e-3 * scene.norm());
  EXPECT_LT(b.estimate().T_BS.rotation.angularDistance(b.estimate().mounting), 1e-5);
}

TEST_F(SceneEstimateTest, MorePointsTurnLess) {
  StateEstimate b = state_estimate();
  for (int scan = 0; scan < 200; ++scan) b.count_points(40);
  EXPECT_NEAR(b.estimate().points, 40.0, 0.1);
  EXPECT_LT(b.scene_step(0, 1.0).variance.y(),
            state_estimate().scene_step(0, 1.0).variance.y() / 3);
  for (int scan = 0; scan < 200; ++scan) b.count_points(0);
  EXPECT_NEAR(b.estimate().points, 1.0, 0.1);
}

// The limit is that of the mounting.
TEST_F(SceneEstimateTest, CorrectionsTurnMountingAndSceneEachByItsColumns) {
  StateEstimate b = state_estimate();
  b.estimate().points = 40.0;
  const Quaternion start = b.estimate().mounting;
  Eigen::VectorXd dx = Eigen::VectorXd::Zero(b.layout().capacity());
  dx.segment<3>(b.layout().extrinsics()) << 0.0, 0.3, 0.1;
  dx.segment<3>(b.layout().mounting()) << 0.02, -0.03, 9.0;
  b.correct(dx);
  const double limit = kCalibrationLimit * options_.calibration.rotation_sigma;
  const Vector3d mounting = quaternion_log(start.conjugate() * b.estimate().mounting);
  EXPECT_LT(mounting.cwiseAbs().maxCoeff(), limit + 1e-9);
  EXPECT_GT(mounting.z(), 0.9 * limit);
  const Vector3d seen = quaternion_log(start.conjugate() * b.estimate().T_BS.rotation);
  EXPECT_LT((seen - Vector3d(0.0, 0.3, 0.1)).norm(), 1e-12);
  EXPECT_EQ(b.estimate().points, 40.0);
}

// The search for an unknown mounting knows nothing of the scene: its prior is added to what was
// found.
TEST_F(SceneEstimateTest, AFoundMountingIsSeenThroughAScene) {
  StateEstimate b = state_estimate();
  Mounting found;
  found.T_BS = {quaternion_exp({0.4, -0.7, 0.2}), Vector3d(0.1, 0.2, -0.3)};
  found.covariance.setIdentity();
  found.covariance *= 1e-4;
  b.set_mounting(0, found);
  EXPECT_EQ(b.estimate().mounting.coeffs(), found.T_BS.rotation.coeffs());
  EXPECT_EQ(b.estimate().T_BS.rotation.coeffs(), found.T_BS.rotation.coeffs());
  const Layout& layout = b.layout();
  const auto P = b.covariance().matrix();
  const Matrix3d mounting = P.block<3, 3>(layout.mounting(), layout.mounting());
  EXPECT_LT((mounting - 1e-4 * Matrix3d::Identity()).norm(), 1e-15);
  const Vector3d scene = scene_variance(options_.calibration.scene_sigma, b.estimate().points);
  const Matrix3d off = difference(b, layout.extrinsics(), layout.mounting());
  EXPECT_LT((off - Matrix3d(scene.asDiagonal())).norm(), 1e-15);
}

}  // namespace
}  // namespace rio
