// SPDX-License-Identifier: BSD-3-Clause
// The suite of every model, for one from outside.
#include <cmath>

#include <rio/testing/model_suite.hpp>

#include "barometer.hpp"

namespace rio::test {  // where the suite is
namespace {

struct BarometerCase {
  using Model = Barometer;
  static constexpr double kUnit = 1e5;  // [Pa]
  static Model model() { return {}; }
  static Sample<Model> simulate(sim::Random& random, bool noise) {
    const Vector3d p = 50.0 * random.in_box(-Vector3d::Ones(), Vector3d::Ones());
    const PressureBias::Value bias(random.uniform(-50.0, 50.0));
    const double pressure =
        101325.0 * std::exp(5.25588 * std::log1p(-0.0065 / 288.15 * p.z())) + bias[0];
    const double sigma = 2.0;
    return {{noise ? pressure + sigma * random.normal() : pressure, sigma},
            {RigidPose(Matrix3d::Identity(), p), bias}};
  }
  static std::optional<Sample<Model>> outside(sim::Random& random) {
    Sample<Model> sample = simulate(random, false);
    std::get<0>(sample.x).p.z() = 30e3;
    return sample;
  }
};

INSTANTIATE_TYPED_TEST_SUITE_P(Barometer, ModelSuite, BarometerCase);

}  // namespace
}  // namespace rio::test
