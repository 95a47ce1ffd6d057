// SPDX-License-Identifier: BSD-3-Clause
// The program whose instructions are counted: the first seconds of a recording through the default
// estimator. Nothing in it depends on time or chance.
//   instructions_flight_load DATASET ekf|smoother SECONDS
#include <cstdio>
#include <cstdlib>
#include <string>

#include "rio/io/dataset.hpp"
#include "rio/rio.hpp"

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const rio::io::Dataset dataset = rio::io::read_dataset(argv[1]);
  const double seconds = std::atof(argv[3]);
  rio::Options options;
  rio::io::apply_sensor_info(dataset, &options);
  if (std::string(argv[2]) == "smoother") options.backend = rio::BackEnd::kSmoother;
  const auto odometry = rio::Odometry::create(options);
  if (odometry == nullptr) return 1;

  auto scan = dataset.scans.begin();
  for (const rio::ImuSample& sample : dataset.imu) {
    if (rio::to_seconds(sample.time - dataset.imu.front().time) > seconds) break;
    for (; scan != dataset.scans.end() && scan->time < sample.time; ++scan) {
      (void)odometry->add_scan(*scan);
    }
    (void)odometry->add_imu(sample);
  }
  std::printf("%d scans\n", static_cast<int>(odometry->counters().scans));
  return odometry->counters().scans > 0 ? 0 : 1;
}
