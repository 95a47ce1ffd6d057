// SPDX-License-Identifier: BSD-3-Clause
// `rio simulate`: an indoor flight with exact truth, written as a dataset.
#include <CLI/CLI.hpp>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "commands.hpp"
#include "rio/io/dataset.hpp"
#include "rio/io/text_file.hpp"
#include "rio/sim/flight.hpp"

namespace rio::tools {

namespace {

struct Arguments {
  std::string out;
  std::uint64_t seed = 1;
  double length = 150.0;
  bool ideal = false;
};

io::ImuInfo describe(const sim::ImuModel& model) {
  return {.rate_hz = model.rate_hz,
          .gyro_noise_density = model.gyro_noise_density,
          .gyro_random_walk = model.gyro_random_walk,
          .accel_noise_density = model.accel_noise_density,
          .accel_random_walk = model.accel_random_walk};
}

io::RadarInfo describe(const sim::RadarModel& model) {
  io::RadarInfo info;
  info.T_BS = model.T_BS;
  info.rate_hz = model.rate_hz;
  info.max_range = model.max_range;
  info.fov_azimuth = model.fov_azimuth;
  info.fov_elevation = model.fov_elevation;
  info.sigma_range = model.sigma_range;
  info.sigma_azimuth = model.sigma_azimuth;
  info.sigma_elevation = model.sigma_elevation;
  info.sigma_doppler = model.sigma_doppler;
  if (model.ambiguous) info.max_doppler = model.max_doppler;
  if (model.quantize) {
    info.range_resolution = model.range_resolution;
    info.doppler_resolution = model.doppler_resolution;
  }
  return info;
}

void write_labels(const std::filesystem::path& path, const sim::Flight& flight) {
  io::TextFile file(path);
  file.write("#timestamp [ns],detection,label,reflector\n");
  for (std::size_t i = 0; i < flight.scans.size(); ++i) {
    const std::string stamp = std::to_string(flight.scans[i].time.count());
    for (std::size_t k = 0; k < flight.labels[i].size(); ++k) {
      const sim::Label& label = flight.labels[i][k];
      file.write(stamp + ',' + std::to_string(k) + ',' + sim::to_string(label.cause) + ',' +
                 std::to_string(label.reflector) + '\n');
    }
  }
  file.close();
}

void run(const Arguments& arguments) {
  sim::FlightOptions options = arguments.ideal ? sim::FlightOptions::ideal() : sim::FlightOptions();
  options.seed = arguments.seed;
  options.length_m = arguments.length;
  const sim::Flight flight = sim::simulate_flight(options);

  io::Dataset dataset;
  dataset.imu = flight.imu;
  dataset.scans = flight.scans;
  dataset.ground_truth = flight.truth;
  dataset.imu_info = describe(flight.imu_model);
  dataset.radar_info = describe(flight.radar_model);
  const std::filesystem::path out(arguments.out);
  io::write_dataset(out, dataset);
  write_labels(out / "radar0" / "labels.csv", flight);

  std::size_t detections = 0;
  for (const RadarScan& scan : flight.scans) detections += scan.detections.size();
  std::printf("%s: %.1f m in %.1f s, %zu IMU samples, %zu scans, %zu detections\n",
              arguments.out.c_str(), flight.trajectory.length(), flight.trajectory.duration(),
              flight.imu.size(), flight.scans.size(), detections);
}

}  // namespace

void add_simulate_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("simulate", "Write a simulated indoor flight");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("OUT", arguments->out, "folder of the new dataset")->required();
  command->add_option("--seed", arguments->seed, "of everything random")->capture_default_str();
  command->add_option("--length", arguments->length, "of the flown path [m]")
      ->check(CLI::Range(20.0, 1000.0))
      ->capture_default_str();
  command->add_flag("--ideal", arguments->ideal,
                    "Gaussian noise only: no grids, folding, outliers or vibration");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace rio::tools
