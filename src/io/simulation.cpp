// SPDX-License-Identifier: BSD-3-Clause
#include "rio/io/simulation.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <stdexcept>
#include <vector>

#include "fields_yaml.hpp"
#include "rio/io/trajectory.hpp"
#include "rio/sim/catalogue.hpp"
#include "rio/sim/scenario_fields.hpp"
#include "rio/sim/trajectory_fit.hpp"
#include "yaml.hpp"

namespace rio::io {

namespace fs = std::filesystem;

namespace {

constexpr const char* kBaseKey = "scenario";

std::vector<std::string> scenario_names() {
  std::vector<std::string> names;
  for (const sim::CatalogueEntry& entry : sim::catalogue()) names.emplace_back(entry.name);
  return names;
}

void apply_base(const YamlFile& file, sim::Scenario* scenario) {
  const YAML::Node node = file.root[kBaseKey];
  if (!node.IsDefined()) return;
  if (!node.IsScalar() || !sim::scenario(node.Scalar(), scenario)) {
    fail_at(file, node,
            "scenario: no such scenario: \"" + node.Scalar() + "\"" +
                did_you_mean(node.Scalar(), scenario_names()));
  }
}

/// The first inconsistent values; empty if there are none.
std::string coherence_problem(const sim::Scenario& s) {
  constexpr double kSmallestBox = 0.1;  // a smaller one leaves no space to fly [m]
  const Vector3d box = s.path.high - s.path.low;
  if (box.minCoeff() < 0.0) return "path.low is above path.high";
  if (box.maxCoeff() < kSmallestBox) return "the box from path.low to path.high is below 0.1 m";
  if (s.path.min_speed > s.path.max_speed) return "path.min_speed exceeds path.max_speed";
  if (s.path.min_leg > s.path.max_leg) return "path.min_leg exceeds path.max_leg";
  if (s.radar.min_range >= s.radar.max_range) {
    return "radar.min_range is not below radar.max_range";
  }
  return {};
}

sim::Scenario load_file(const fs::path& path) {
  const YamlFile file = load_yaml(path);
  sim::Scenario scenario;
  apply_base(file, &scenario);
  read_fields(file, kBaseKey, &scenario);
  const std::string problem = coherence_problem(scenario);
  if (!problem.empty()) throw std::runtime_error(file.name + ": " + problem);
  if (!scenario.path.file.empty()) {
    scenario.path.file = (path.parent_path() / scenario.path.file).lexically_normal().string();
  }
  return scenario;
}

/// The recorded path of the scenario, smoothed.
sim::Trajectory recorded_path(const sim::Scenario& scenario) {
  const Trajectory poses = read_trajectory(scenario.path.file);
  try {
    return sim::fit_trajectory(poses, scenario.path, scenario.start).trajectory;
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(scenario.path.file + ": " + error.what());
  }
}

}  // namespace

sim::Scenario load_scenario(const std::string& name_or_file) {
  sim::Scenario scenario;
  if (sim::scenario(name_or_file, &scenario)) return scenario;
  if (fs::exists(name_or_file)) return load_file(name_or_file);
  const std::vector<std::string> names = scenario_names();
  throw std::runtime_error(fmt::format("no such scenario and no such file: \"{}\"{}\nscenarios: {}",
                                       name_or_file, did_you_mean(name_or_file, names),
                                       fmt::join(names, ", ")));
}

std::string scenario_as_yaml(const sim::Scenario& scenario) {
  return "# A whole scenario. Numbers are in the unit shown; \"2 deg\", \"5 cm\" also work.\n" +
         fields_text(scenario);
}

sim::Flight fly_scenario(const sim::Scenario& scenario,
                         const std::function<void(std::size_t, std::size_t)>& each) {
  const sim::Trajectory path =
      scenario.path.file.empty() ? sim::random_flight(scenario.seed, scenario.path, scenario.start)
                                 : recorded_path(scenario);
  sim::Flight flight = sim::simulate_flight(path, scenario, each);
  if (flight.imu.empty() || flight.scans.empty()) {
    throw std::runtime_error("the disturbances silence a sensor for the whole flight");
  }
  return flight;
}

RadarInfo radar_info_of(const sim::RadarModel& model, const Pose& configured_T_BS) {
  RadarInfo info;
  info.T_BS = configured_T_BS;
  info.rate_hz = model.rate_hz;
  info.max_range = model.max_range;
  info.fov_azimuth = model.fov_azimuth;
  info.fov_elevation = model.fov_elevation;
  info.sigma_range = model.sigma_range;
  info.sigma_azimuth = model.sigma_azimuth;
  info.sigma_elevation = model.sigma_elevation;
  info.sigma_doppler = model.sigma_doppler;
  if (model.ambiguous) info.max_doppler = model.reported_max_doppler();
  info.range_resolution = model.quantize ? model.range_resolution : 0.0;
  info.doppler_resolution = model.reported_doppler_resolution();
  return info;
}

Dataset dataset_of(const sim::Flight& flight) {
  Dataset dataset;
  dataset.imu = flight.imu;
  dataset.scans = flight.scans;
  dataset.ground_truth = flight.truth;
  const sim::ImuModel& imu = flight.scenario.imu;
  dataset.imu_info = {.rate_hz = imu.rate_hz,
                      .gyro_noise_density = imu.gyro_noise_density,
                      .gyro_random_walk = imu.gyro_random_walk,
                      .accel_noise_density = imu.accel_noise_density,
                      .accel_random_walk = imu.accel_random_walk};
  dataset.radar_info = radar_info_of(flight.scenario.radar, flight.configured_T_BS);
  return dataset;
}

}  // namespace rio::io
