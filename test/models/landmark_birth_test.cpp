// SPDX-License-Identifier: BSD-3-Clause
// The inverse observation model that puts a landmark into the state, and the landmark in radar
// axes.
#include "rio/models/landmark_birth.hpp"

#include <gtest/gtest.h>

#include "rio/core/so3.hpp"
#include "rio/sim/radar_model.hpp"
#include "rio/sim/random.hpp"

namespace rio::test {
namespace {

constexpr double kStep = 1e-6;

struct Place {
  explicit Place(sim::Random& random)
      : T_WB(gamma(0, random.normal3()), random.normal3()),
        T_BS(gamma(0, random.normal3()), 0.2 * random.normal3()),
        polar{random.uniform(1.0, 8.0), random.uniform(-1.0, 1.0), random.uniform(-0.4, 0.4)} {}
  Detection detection() const { return detection(polar); }
  static Detection detection(const sim::Polar& polar) {
    return make_detection({polar.point(), 1.0, 20.0}, RadarOptions{});
  }
  RigidPose T_WB;
  RigidPose T_BS;
  sim::Polar polar;
};

/// Columns by central differences of f over the retraction of a pose.
template <class F>
Eigen::Matrix<double, 3, 6> pose_derivative(const RigidPose& pose, const F& f) {
  Eigen::Matrix<double, 3, 6> d;
  for (int k = 0; k < 6; ++k) {
    const Eigen::Matrix<double, 6, 1> e = Eigen::Matrix<double, 6, 1>::Unit(k) * kStep;
    d.col(k) = (f(PoseBlock::retract(pose, e)) - f(PoseBlock::retract(pose, -e))) / (2.0 * kStep);
  }
  return d;
}

TEST(LandmarkBirth, JacobiansMatchCentralDifferences) {
  sim::Random random(41);
  for (int i = 0; i < 50; ++i) {
    const Place place(random);
    const Detection d = place.detection();
    const LandmarkBirth birth(place.T_WB, place.T_BS, d);
    Eigen::Matrix<double, 3, LandmarkBirth::Blocks::kDof> numeric;
    numeric.leftCols<6>() = pose_derivative(
        place.T_WB, [&](const RigidPose& pose) { return LandmarkBirth(pose, place.T_BS, d).p_WL; });
    numeric.middleCols<6>(6) = pose_derivative(place.T_BS, [&](const RigidPose& mount) {
      return LandmarkBirth(place.T_WB, mount, d).p_WL;
    });
    // rounding: 1e-16 times ten metres over the step
    EXPECT_LT((birth.d_l - numeric).cwiseAbs().maxCoeff(), 1e-8) << birth.d_l << "\n\n" << numeric;
  }
}

TEST(LandmarkBirth, NoiseIsThatOfTheDetection) {
  sim::Random random(43);
  for (int i = 0; i < 20; ++i) {
    const Place place(random);
    const Detection d = place.detection();
    Matrix3d expected = Matrix3d::Zero();
    const auto add = [&](const sim::Polar& moved, double sigma) {
      const Vector3d column = to_world(place.T_WB, place.T_BS, moved.point()) -
                              to_world(place.T_WB, place.T_BS, place.polar.point());
      expected += sigma * sigma / (kStep * kStep) * column * column.transpose();
    };
    const double az = std::cos(place.polar.elevation);
    add({place.polar.range + kStep, place.polar.azimuth, place.polar.elevation}, d.sigma_range);
    add({place.polar.range, place.polar.azimuth + kStep, place.polar.elevation},
        d.sigma_azimuth_S.norm() / az);
    add({place.polar.range, place.polar.azimuth, place.polar.elevation + kStep},
        d.sigma_elevation_S.norm());
    const LandmarkBirth birth(place.T_WB, place.T_BS, d);
    EXPECT_LT((birth.noise - expected).norm(), 1e-5 * expected.norm());  // one-sided differences
  }
}

TEST(ObservedPoint, JacobiansMatchCentralDifferencesAndUndoTheBirth) {
  sim::Random random(42);
  for (int i = 0; i < 50; ++i) {
    const Place place(random);
    const Detection d = place.detection();
    const Vector3d l = LandmarkBirth(place.T_WB, place.T_BS, d).p_WL;
    const ObservedPoint point(place.T_WB, place.T_BS, l);
    EXPECT_LT((point.e_S - d.point_S).norm(), 1e-13);
    EXPECT_LT((point.d_body() - pose_derivative(place.T_WB,
                                                [&](const RigidPose& pose) {
                                                  return ObservedPoint(pose, place.T_BS, l).e_S;
                                                }))
                  .cwiseAbs()
                  .maxCoeff(),
              1e-8);
    EXPECT_LT(
        (point.d_extrinsics() - pose_derivative(place.T_BS,
                                                [&](const RigidPose& mount) {
                                                  return ObservedPoint(place.T_WB, mount, l).e_S;
                                                }))
            .cwiseAbs()
            .maxCoeff(),
        1e-8);
    for (int k = 0; k < 3; ++k) {
      const Vector3d moved = l + Vector3d::Unit(k);  // it is linear in the landmark
      const Vector3d column = ObservedPoint(place.T_WB, place.T_BS, moved).e_S - point.e_S;
      EXPECT_LT((point.d_landmark().col(k) - column).norm(), 1e-13);
    }
  }
}

}  // namespace
}  // namespace rio::test
