// SPDX-License-Identifier: BSD-3-Clause
// The place of a point in Cartesian axes with its covariance Sigma_m, and its range and direction
// with their sigmas, say the same to first order: distances, and what they tell of the state.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <type_traits>

#include "rio/models/landmark_point.hpp"
#include "rio/models/landmark_position.hpp"
#include "support/random_state.hpp"

namespace rio::test {
namespace {

/// Body, mounting, a landmark and a detection of it.
struct Scene {
  RigidPose T_WB;
  RigidPose T_BS;
  Vector3d p_WL = Vector3d::Zero();
  Detection detection;
};

/// Off by `scale` times `sigmas` of range, azimuth and elevation along their straight tangents.
Scene make_scene(Random& random, double scale, const Vector3d& sigmas) {
  Scene scene;
  scene.T_WB = {random.rotation().toRotationMatrix(), random.normal_vector(5.0)};
  scene.T_BS = {random.rotation().toRotationMatrix(), random.normal_vector(0.2)};
  RadarOptions radar;
  radar.sigma_azimuth = 0.03;
  radar.sigma_elevation = 0.07;
  const Vector3d point(random.uniform(1.0, 8.0), random.uniform(-3.0, 3.0),
                       random.uniform(-2.0, 2.0));
  scene.detection = make_detection({.point_S = point}, radar);
  const Detection& d = scene.detection;
  const Vector3d offset =
      sigmas[0] * d.sigma_range * d.direction_S +
      d.range * (sigmas[1] * d.sigma_azimuth_S + sigmas[2] * d.sigma_elevation_S);
  scene.p_WL = to_world(scene.T_WB, scene.T_BS, d.point_S + scale * offset);
  return scene;
}

template <class M>
Evaluation<M> evaluate_at(const Scene& s) {
  Evaluation<M> at;
  EXPECT_TRUE(M{}.evaluate(M::measurement(s.detection), s.T_WB, s.T_BS, s.p_WL, at.r, &at.J, at.R));
  return at;
}

/// r^T (J P J^T + R)^-1 r.
template <class M>
double squared_distance(const Evaluation<M>& at, const Eigen::MatrixXd& P) {
  const Matrix3d S = at.J * P * at.J.transpose() + at.R;
  return at.r.dot(S.inverse() * at.r);
}

TEST(PointEquivalence, DistancesAgreeToFirstOrder) {
  static_assert(std::is_same_v<LandmarkPointModel::Blocks, LandmarkPositionModel::Blocks>);
  constexpr int kDof = LandmarkPointModel::Blocks::kDof;
  Random random(41);
  for (int i = 0; i < 200; ++i) {
    const Vector3d sigmas = random.normal_vector();
    // a state without errors, and one whose errors and correlations are as large as the noise
    Eigen::MatrixXd root = Eigen::MatrixXd::Zero(kDof, kDof);
    for (double& value : root.reshaped()) value = random.normal(0.02);
    const Eigen::MatrixXd P = root * root.transpose();
    for (const Eigen::MatrixXd& covariance : {Eigen::MatrixXd(0.0 * P), P}) {
      // what is left falls with the offset: a sphere bends by a sigma^2 / sigma_range of the range,
      // up to 1.5, a sigma aside, which counts twice in a square
      for (const double scale : {1e-2, 1e-4}) {
        Random same(static_cast<unsigned>(i));
        const Scene s = make_scene(same, scale, sigmas);
        const double cartesian =
            squared_distance(evaluate_at<LandmarkPositionModel>(s), covariance);
        const double polar = squared_distance(evaluate_at<LandmarkPointModel>(s), covariance);
        EXPECT_NEAR(polar / cartesian, 1.0, 4.0 * scale) << i << " " << scale;
        if (covariance.isZero(0.0)) {
          EXPECT_NEAR(cartesian, scale * scale * sigmas.squaredNorm(), 1e-6 * cartesian);
        }
      }
    }
  }
}

TEST(PointEquivalence, BothTellTheSameOfTheState) {
  Random random(42);
  for (int i = 0; i < 200; ++i) {
    const Scene s = make_scene(random, 0.0, Vector3d::Zero());
    const auto cartesian = evaluate_at<LandmarkPositionModel>(s);
    const auto polar = evaluate_at<LandmarkPointModel>(s);
    const Eigen::MatrixXd a = cartesian.J.transpose() * cartesian.R.inverse() * cartesian.J;
    const Eigen::MatrixXd b = polar.J.transpose() * polar.R.inverse() * polar.J;
    EXPECT_LT((a - b).norm(), 1e-9 * b.norm()) << i;
  }
}

// Xu et al., eq. 15-18: l - (R (R_E p + t_E) + p_i) with the covariance R R_E Sigma R_E^T R^T.
TEST(PointEquivalence, TheWorldAxesOfThePaperGiveTheSameDistance) {
  Random random(43);
  for (int i = 0; i < 100; ++i) {
    const Scene s = make_scene(random, 1.0, random.normal_vector());
    const Vector3d r_W = s.p_WL - to_world(s.T_WB, s.T_BS, s.detection.point_S);
    const Matrix3d R_WS = s.T_WB.R * s.T_BS.R;
    const Matrix3d Sigma_W = R_WS * point_covariance(s.detection) * R_WS.transpose();
    const auto at = evaluate_at<LandmarkPositionModel>(s);
    const double expected = r_W.dot(Sigma_W.inverse() * r_W);
    EXPECT_NEAR(at.r.dot(at.R.inverse() * at.r), expected, 1e-9 * expected);
  }
}

}  // namespace
}  // namespace rio::test
