// SPDX-License-Identifier: BSD-3-Clause
// The stages alone, without the odometry API.
#include <rio/ekf/ekf.hpp>
#include <rio/pipeline.hpp>

#include <cstdio>

int main() {
  rio::Options options;
  if (!rio::preset("default", &options) || !options.validate()) return 1;
  rio::Pipeline<rio::Ekf> pipeline(options);
  pipeline.reset({}, rio::BodyCovariance::Identity());
  std::printf("%s %s\n", to_string(pipeline.health().state), to_string(rio::Model::kDoppler));
  return 0;
}
