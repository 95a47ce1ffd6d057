// SPDX-License-Identifier: BSD-3-Clause
#include "experiment/recording.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <stdexcept>

#include "rio/io/trajectory.hpp"
#include "rio/rio.hpp"
#include "rio/sim/random.hpp"

namespace rio::experiment {

namespace {

namespace fs = std::filesystem;

/// Share of the detections that have a Doppler.
double moving_share(const RadarScan& scan, double grid) {
  const double still = 0.5 * grid + 0.03;  // half a cell and the noise [m/s]
  const auto moving =
      std::count_if(scan.detections.begin(), scan.detections.end(),
                    [still](const auto& d) { return std::abs(d.range_rate) > still; });
  return static_cast<double>(moving) / static_cast<double>(scan.detections.size());
}

}  // namespace

eval::Trajectory poses_of(const Replay& replay) {
  eval::Trajectory poses;
  for (const RecordedStep& step : replay.steps) {
    poses.push_back({step.state.time, step.state.p_WB, step.state.q_WB});
  }
  return poses;
}

Motion motion_of(const io::Dataset& data) {
  constexpr double kMajority = 0.5;
  const double grid = data.radar_info.doppler_resolution.value_or(0.0);
  Motion motion{data.scans.back().time, data.scans.front().time};
  for (const RadarScan& scan : data.scans) {
    if (scan.detections.size() < 3 || moving_share(scan, grid) < kMajority) continue;
    motion.begin = std::min(motion.begin, scan.time);
    motion.end = std::max(motion.end, scan.time);
  }
  return motion;
}

bool Recording::flat() const {
  return !reference.empty() && std::all_of(reference.begin(), reference.end(),
                                           [](const auto& pose) { return pose.p.z() == 0.0; });
}

std::vector<Recording> find_recordings(const fs::path& folder) {
  if (!fs::is_directory(folder)) throw std::runtime_error(folder.string() + " is not a folder");
  std::vector<fs::path> places;
  const auto consider = [&places](const fs::path& place) {
    if (fs::exists(place / "imu0") && fs::exists(place / "radar0")) places.push_back(place);
  };
  consider(folder);
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_directory()) consider(entry.path());
  }
  if (places.empty()) {
    throw std::runtime_error(folder.string() + ": no recording, a folder with imu0 and radar0");
  }
  std::sort(places.begin(), places.end());
  std::vector<Recording> recordings;
  for (const fs::path& place : places) {
    const fs::path group = place.parent_path() == folder ? place : place.parent_path();
    Recording recording{
        place.filename().string(), group.filename().string(), io::read_dataset(place), {}};
    for (const char* name : {"reference.tum", "truth.tum"}) {
      const fs::path reference = place / name;
      if (!fs::exists(reference)) continue;
      recording.reference = io::read_trajectory(reference, io::TumOrder::kSorted);
    }
    recordings.push_back(std::move(recording));
  }
  return recordings;
}

std::vector<Copy> perturbed(const Recording& recording, int draws, std::uint64_t seed) {
  constexpr double kThreeDegrees = 0.0523599;  // [rad]
  std::vector<Copy> copies;
  const auto copy = [&](const char* kind) -> io::Dataset& {
    copies.push_back({kind, recording});
    return copies.back().recording.data;
  };
  io::Dataset& cut = copy("2 s of rest before the start");
  const Time begin = motion_of(recording.data).begin - std::chrono::seconds(2);
  std::erase_if(cut.imu, [&](const ImuSample& s) { return s.time < begin; });
  std::erase_if(cut.scans, [&](const RadarScan& s) { return s.time < begin; });
  for (const std::size_t parity : {0U, 1U}) {
    std::size_t i = 0;
    std::erase_if(copy("every other scan").scans,
                  [&](const RadarScan&) { return i++ % 2 != parity; });
  }
  sim::Random random(seed, 11);
  for (int i = 0; i < draws; ++i) {
    for (RadarScan& scan : copy("30 % of the points dropped").scans) {
      std::erase_if(scan.detections, [&](const auto&) { return random.uniform(0.0, 1.0) < 0.3; });
    }
    if (std::optional<Pose>& T_BS = copy("mounting wrong by 3 deg").radar_info.T_BS) {
      const Vector3d axis = random.normal3().normalized();
      T_BS->rotation = (T_BS->rotation * quaternion_exp(kThreeDegrees * axis)).normalized();
    }
  }
  for (const int milliseconds : {-20, 20}) {
    for (RadarScan& scan : copy("stamps wrong by 20 ms").scans) {
      scan.time += std::chrono::milliseconds(milliseconds);
    }
  }
  return copies;
}

Replay replay(const io::Dataset& data, const Options& options) {
  const auto odometry = create_odometry(options);
  Replay out;
  const auto record = [&] {
    const Matrix3d P = odometry->covariance().block<3, 3>(body::kPosition, body::kPosition);
    out.steps.push_back({odometry->at_scan(), P});
    const HealthState state = odometry->health().state;
    out.healthy = out.healthy && (state == HealthState::kOk || state == HealthState::kInitializing);
  };
  std::vector<const std::vector<RadarScan>*> radars = {&data.scans};
  for (const io::Dataset::OtherRadar& other : data.other_radars) radars.push_back(&other.scans);
  std::vector<std::size_t> next(radars.size());
  std::uint64_t recorded = 0;
  const auto begin = std::chrono::steady_clock::now();
  for (const ImuSample& sample : data.imu) {
    (void)odometry->add_imu(sample);  // its outcome is counted
    for (std::size_t r = 0; r < radars.size(); ++r) {
      const std::vector<RadarScan>& scans = *radars[r];
      for (std::size_t& i = next[r]; i < scans.size() && scans[i].time <= sample.time; ++i) {
        (void)odometry->add_scan(scans[i], r);
      }
    }
    if (odometry->counters().scans != recorded) record();
    recorded = odometry->counters().scans;
  }
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  out.state = odometry->health().state;
  out.calibration = odometry->report().calibration;
  for (const CalibrationReport& c : out.calibration) {
    const bool doubted =
        c.observability == Observability::kDoubtful || c.observability == Observability::kAtLimit;
    out.healthy = out.healthy && !doubted;
  }
  return out;
}

std::vector<RealRun> replay_campaign(const std::vector<Recording>& recordings,
                                     const Variants& variants, int seeds,
                                     const Settings& settings) {
  const auto count = static_cast<std::size_t>(seeds);
  std::vector<RealRun> runs;
  for (const Recording& recording : recordings) {
    for (std::size_t v = 0; v < variants.size(); ++v) {
      runs.push_back({&recording, v, std::vector<RealScore>(count)});
    }
  }
  parallel_for(runs.size() * count, settings.threads, settings.on_progress, [&](std::size_t i) {
    RealRun& run = runs[i / count];
    const Variant& variant = variants[run.variant];
    Options options;
    if (!preset(variant.preset, &options)) throw std::runtime_error("no such preset");
    io::apply_sensor_info(run.recording->data, &options);
    options.frontend.ransac_seed = run.recording->first_seed + static_cast<int>(i % count);
    if (variant.change) variant.change(options);
    run.scores[i % count] = judge(*run.recording, replay(run.recording->data, options));
  });
  return runs;
}

}  // namespace rio::experiment
