// SPDX-License-Identifier: BSD-3-Clause
// Every model against the shared suite. A new model adds its case here, or to
// support/model_cases.hpp if other tests need it.
#include "rio/models/aids.hpp"

#include <numbers>

#include "support/model_cases.hpp"

namespace rio::test {
namespace {

/// A covariance that is not diagonal, and its noise.
struct Noise {
  Matrix3d L = Matrix3d::Zero();
  explicit Noise(sim::Random& random) {
    for (int i = 0; i < 3; ++i) L(i, i) = random.uniform(0.01, 0.1);
    L(1, 0) = random.uniform(-0.05, 0.05);
    L.row(2).head<2>() = 0.05 * in_cube(random).head<2>();
  }
  Matrix3d covariance() const { return L * L.transpose(); }
  Vector3d draw(sim::Random& random, bool noise) const {
    return noise ? Vector3d(L * random.normal3()) : Vector3d::Zero();
  }
};
double draw(sim::Random& random, double sigma, bool noise) {
  return noise ? sigma * random.normal() : 0.0;
}

struct PositionCase : CaseOf<PositionModel> {
  static Sample<Model> simulate(sim::Random& random, bool noise) {
    const RandomBody body(random);
    const Noise error(random);
    const Vector3d lever = in_cube(random);
    const Vector3d at = body.point.nav.q_WB * lever + body.point.nav.p_WB;
    return {{at + error.draw(random, noise), error.covariance(), lever}, {body.pose()}};
  }
};

struct HeadingCase : CaseOf<HeadingModel> {
  static Sample<Model> simulate(sim::Random& random, bool noise) {
    const double heading = random.uniform(-7.0, 7.0);
    const Quaternion q = Quaternion(Eigen::AngleAxisd(heading, Vector3d::UnitZ())) *
                         Eigen::AngleAxisd(random.uniform(-0.9, 0.9), Vector3d::UnitY()) *
                         Eigen::AngleAxisd(random.uniform(-3.0, 3.0), Vector3d::UnitX());
    return {{heading + draw(random, 0.1, noise), 0.1},
            {RigidPose(q.toRotationMatrix(), in_cube(random))}};
  }
  static std::optional<Sample<Model>> outside(sim::Random& /*random*/) {
    const Quaternion up(Eigen::AngleAxisd(-0.5 * std::numbers::pi, Vector3d::UnitY()));
    return Sample<Model>{{}, {RigidPose(up.toRotationMatrix(), Vector3d::Zero())}};
  }
};

struct BodyVelocityCase : CaseOf<BodyVelocityModel> {
  static Sample<Model> simulate(sim::Random& random, bool noise) {
    const RandomBody body(random);
    const Noise error(random);
    const Vector3d lever = in_cube(random);
    const Vector3d rate = body.point.gyro_B - body.gyro_bias;
    const Vector3d v = body.point.nav.q_WB.conjugate() * body.point.nav.v_WB + rate.cross(lever);
    return {{v + error.draw(random, noise), error.covariance(), lever, body.point.gyro_B},
            {body.pose(), body.point.nav.v_WB, body.gyro_bias}};
  }
};

struct WorldVelocityCase : CaseOf<WorldVelocityModel> {
  static Sample<Model> simulate(sim::Random& random, bool noise) {
    const RandomBody body(random);
    const Noise error(random);
    return {{body.point.nav.v_WB + error.draw(random, noise), error.covariance()},
            {body.point.nav.v_WB}};
  }
};

struct HeightCase : CaseOf<HeightModel> {
  static Sample<Model> simulate(sim::Random& random, bool noise) {
    const RandomBody body(random);
    const HeightOffset::Value offset(random.uniform(-5.0, 5.0));
    return {{body.point.nav.p_WB.z() + offset[0] + draw(random, 0.3, noise), 0.3},
            {body.pose(), offset}};
  }
};

/// The beam is followed to the ground.
struct GroundRangeCase : CaseOf<GroundRangeModel> {
  static Sample<Model> simulate(sim::Random& random, bool noise) {
    const Quaternion q = quaternion_exp(0.4 * in_cube(random));
    Model::Measurement z;
    z.sigma = 0.05;
    z.lever_B = 0.3 * in_cube(random);
    z.direction_B = (q.conjugate() * -Vector3d::UnitZ() + 0.1 * in_cube(random)).normalized();
    const Vector3d foot(random.uniform(-9.0, 9.0), random.uniform(-9.0, 9.0),
                        random.uniform(-1.0, 1.0));
    const double range = random.uniform(0.5, 8.0);
    z.range = range + draw(random, z.sigma, noise);
    const Vector3d p = foot - range * (q * z.direction_B) - q * z.lever_B;
    return {z, {RigidPose(q.toRotationMatrix(), p), GroundHeight::Value(foot.z())}};
  }
  static std::optional<Sample<Model>> outside(sim::Random& /*random*/) {
    Model::Measurement z;
    z.direction_B = Vector3d::UnitX();
    return Sample<Model>{z, {RigidPose(), GroundHeight::Value(0.0)}};
  }
};

using Cases =
    testing::Types<DopplerCase, TrailDistanceCase, LandmarkDistanceCase, LandmarkPositionCase,
                   LandmarkPointCase, LandmarkDopplerCase, RestCase, PositionCase, HeadingCase,
                   BodyVelocityCase, WorldVelocityCase, HeightCase, GroundRangeCase>;
INSTANTIATE_TYPED_TEST_SUITE_P(AllModels, ModelSuite, Cases);

}  // namespace
}  // namespace rio::test
