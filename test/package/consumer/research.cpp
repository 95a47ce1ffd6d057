// SPDX-License-Identifier: BSD-3-Clause
#include <rio/ekf/ekf.hpp>
#include <rio/pipeline.hpp>
#include <rio/sim/catalogue.hpp>

int main() {
  rio::Pipeline<rio::Ekf> pipeline(rio::Options{});
  pipeline.reset({}, rio::BodyCovariance::Identity());
  rio::sim::Scenario scenario;
  if (!rio::sim::scenario("hover", &scenario)) return 1;
  return pipeline.estimate().landmarks.empty() ? 0 : 1;
}
