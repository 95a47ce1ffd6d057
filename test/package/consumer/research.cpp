// SPDX-License-Identifier: BSD-3-Clause
#include <rio/ekf/ekf.hpp>
#include <rio/pipeline.hpp>

int main() {
  rio::Pipeline<rio::Ekf> pipeline(rio::Options{});
  pipeline.reset({}, rio::BodyCovariance::Identity());
  return pipeline.estimate().landmarks.empty() ? 0 : 1;
}
