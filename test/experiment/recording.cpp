// SPDX-License-Identifier: BSD-3-Clause
#include "experiment/recording.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <stdexcept>

#include "rio/core/so3.hpp"
#include "rio/eval/metrics.hpp"
#include "rio/eval/pairing.hpp"
#include "rio/io/barometer.hpp"
#include "rio/io/trajectory.hpp"
#include "rio/rio.hpp"
#include "rio/sim/random.hpp"

namespace rio::experiment {

namespace {

namespace fs = std::filesystem;

double heading(const Quaternion& q) {
  const Matrix3d R = q.toRotationMatrix();
  return std::atan2(R(1, 0), R(0, 0));
}

/// Share of the detections that have a Doppler.
double moving_share(const RadarScan& scan, double grid) {
  const double still = 0.5 * grid + 0.03;  // half a cell and the noise [m/s]
  const auto moving =
      std::count_if(scan.detections.begin(), scan.detections.end(),
                    [still](const auto& d) { return std::abs(d.range_rate) > still; });
  return static_cast<double>(moving) / static_cast<double>(scan.detections.size());
}

/// Heights above the mean pressure of the first two seconds, each from the mean of a second.
eval::Trajectory barometer_heights(const std::vector<io::BaroSample>& baro) {
  eval::Trajectory heights;
  std::size_t first = 0;
  std::size_t end = 0;
  double sum = 0.0;
  const auto still = std::find_if(baro.begin(), baro.end(), [&](const io::BaroSample& sample) {
    return to_seconds(sample.time - baro.front().time) > 2.0;
  });
  const double zero =
      std::accumulate(baro.begin(), still, 0.0,
                      [](double total, const auto& sample) { return total + sample.pressure; }) /
      static_cast<double>(still - baro.begin());
  for (const io::BaroSample& sample : baro) {
    for (; end < baro.size() && to_seconds(baro[end].time - sample.time) < 0.5; ++end) {
      sum += baro[end].pressure;
    }
    for (; to_seconds(sample.time - baro[first].time) > 0.5; ++first) sum -= baro[first].pressure;
    const double mean = sum / static_cast<double>(end - first);
    heights.push_back({sample.time, Vector3d(0.0, 0.0, -io::kPressureScale * std::log(mean / zero)),
                       Quaternion::Identity()});
  }
  return heights;
}

/// Sampled every half second, so that the jitter of the estimate does not count.
double length_of(const eval::Trajectory& poses) {
  double distance = 0.0;
  std::size_t last = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    if (to_seconds(poses[i].time - poses[last].time) < 0.5) continue;
    distance += (poses[i].p - poses[last].p).norm();
    last = i;
  }
  return distance;
}

void judge_against_reference(const eval::Trajectory& reference, const eval::Trajectory& poses,
                             RealScore* score) {
  const std::vector<eval::PosePair> pairs = eval::associate(reference, poses).pairs;
  if (pairs.empty()) return;
  const eval::PosePair& first = pairs.front();
  const double turn = heading(first.truth.q) - heading(first.estimate.q);
  const Quaternion R = quaternion_exp(Vector3d(0.0, 0.0, turn));
  const auto laid_over = [&](const Vector3d& p) -> Vector3d {
    return R * (p - first.estimate.p) + first.truth.p;
  };
  std::vector<double> errors;
  for (const eval::PosePair& pair : pairs) {
    errors.push_back((laid_over(pair.estimate.p) - pair.truth.p).head<2>().norm());
  }
  score->horizontal = eval::statistics(errors).rmse;
}

void judge_height(const Recording& recording, const Replay& replay, RealScore* score) {
  const std::vector<RecordedStep>& steps = replay.steps;
  const eval::Trajectory heights =
      recording.flat() ? eval::Trajectory{} : barometer_heights(recording.data.baro);
  if (!recording.flat() && heights.empty()) return;
  std::vector<double> errors;
  std::vector<double> sigmas;
  double honest = 0.0;
  std::optional<double> zero;
  std::size_t next = 0;
  for (const RecordedStep& step : steps) {
    double truth = 0.0;
    if (!recording.flat()) {
      while (next < heights.size() && heights[next].time < step.state.time) ++next;
      if (next == heights.size()) break;
      truth = heights[next].p.z();
    }
    const double error = step.state.p_WB.z() - truth;
    if (!zero) zero = error;
    errors.push_back(error - *zero);
    honest += std::abs(errors.back()) < 3.0 * step.sigma_height ? 1.0 : 0.0;
    if (2 * errors.size() > steps.size()) {
      sigmas.push_back(std::abs(errors.back()) / step.sigma_height);
    }
  }
  score->height = eval::statistics(errors).rmse;
  if (!recording.flat()) return;  // a barometer with centimetres of noise validates no sigma
  score->honest = honest / static_cast<double>(errors.size());
  std::sort(sigmas.begin(), sigmas.end());
  score->sigmas_median = sigmas[sigmas.size() / 2];
  score->sigmas_worst = sigmas.back();
}

void judge_rest(const Recording& recording, const Replay& replay, RealScore* score) {
  constexpr double kSettled = 1.0;   // after the last motion [s]
  constexpr double kShortest = 2.0;  // shortest rest to measure creep [s]
  const Time rest = motion_of(recording.data).end + from_seconds(kSettled);
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const RecordedStep& step : replay.steps) {
    if (step.state.time < rest) continue;
    low = std::min(low, step.state.p_WB.z());
    high = std::max(high, step.state.p_WB.z());
  }
  const RecordedStep& last = replay.steps.back();
  if (to_seconds(last.state.time - rest) < kShortest) return;
  score->creep = high - low;
  score->creep_sigmas = score->creep / last.sigma_height;
}

Recording thinned(const Recording& recording, std::size_t first) {
  Recording copy = recording;
  copy.data.scans.clear();
  for (std::size_t i = first; i < recording.data.scans.size(); i += 2) {
    copy.data.scans.push_back(recording.data.scans[i]);
  }
  return copy;
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

std::vector<Recording> fused(const std::vector<Recording>& recordings) {
  std::vector<Recording> drives;
  for (std::size_t i = 0; i + 1 < recordings.size(); ++i) {
    const Recording& a = recordings[i];
    const Recording& b = recordings[i + 1];
    const std::string drive = a.name.substr(0, a.name.size() - 1);
    if (a.name != drive + "A" || b.name != drive + "B" || a.group != b.group) continue;
    Recording both = a;
    both.name = drive + "AB";
    both.data.other_radars.push_back({b.data.scans, b.data.radar_info});
    drives.push_back(std::move(both));
  }
  return drives;
}

std::vector<Copy> perturbed(const Recording& recording, int draws, std::uint64_t seed) {
  constexpr double kThreeDegrees = 0.0523599;  // [rad]
  std::vector<Copy> copies;
  {
    Copy cut{"2 s of rest before the start", recording};
    const Time begin = motion_of(recording.data).begin - std::chrono::seconds(2);
    std::erase_if(cut.recording.data.imu, [&](const auto& s) { return s.time < begin; });
    std::erase_if(cut.recording.data.scans, [&](const auto& s) { return s.time < begin; });
    copies.push_back(std::move(cut));
  }
  copies.push_back({"every other scan", thinned(recording, 0)});
  copies.push_back({"every other scan", thinned(recording, 1)});
  sim::Random random(seed, 11);
  for (int i = 0; i < draws; ++i) {
    Copy dropped{"30 % of the points dropped", recording};
    for (RadarScan& scan : dropped.recording.data.scans) {
      std::erase_if(scan.detections, [&](const auto&) { return random.uniform(0.0, 1.0) < 0.3; });
    }
    copies.push_back(std::move(dropped));
    Copy turned{"mounting wrong by 3 deg", recording};
    if (std::optional<Pose>& T_BS = turned.recording.data.radar_info.T_BS) {
      const Vector3d axis = random.normal3().normalized();
      T_BS->rotation = (T_BS->rotation * quaternion_exp(kThreeDegrees * axis)).normalized();
    }
    copies.push_back(std::move(turned));
  }
  for (const int milliseconds : {-20, 20}) {
    Copy late{"stamps wrong by 20 ms", recording};
    for (RadarScan& scan : late.recording.data.scans) {
      scan.time += std::chrono::milliseconds(milliseconds);
    }
    copies.push_back(std::move(late));
  }
  return copies;
}

Replay replay(const io::Dataset& data, const Options& options) {
  std::string why;
  const std::unique_ptr<Odometry> odometry = Odometry::create(options, &why);
  if (!odometry) throw std::runtime_error(why);
  Replay out;
  const auto record = [&] {
    const Matrix3d P = odometry->covariance().block<3, 3>(body::kPosition, body::kPosition);
    out.steps.push_back({odometry->at_scan(), std::sqrt(P(2, 2)), P});
    const HealthState state = odometry->health().state;
    out.healthy = out.healthy && (state == HealthState::kOk || state == HealthState::kInitializing);
  };
  std::array<std::size_t, 1 + Options::kMaxOtherRadars> next{};
  std::uint64_t recorded = 0;
  const auto give = [&](const std::vector<RadarScan>& scans, std::size_t radar, Time until) {
    std::size_t& i = next[radar];
    for (; i < scans.size() && scans[i].time <= until; ++i) {
      (void)odometry->add_scan(scans[i], radar);
    }
  };
  const auto begin = std::chrono::steady_clock::now();
  for (const ImuSample& sample : data.imu) {
    (void)odometry->add_imu(sample);  // its outcome is counted
    give(data.scans, 0, sample.time);
    for (std::size_t r = 0; r < data.other_radars.size(); ++r) {
      give(data.other_radars[r].scans, r + 1, sample.time);
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

RealScore judge(const Recording& recording, const Replay& replay) {
  RealScore score;
  score.started =
      !replay.steps.empty() && replay.steps.front().state.time < motion_of(recording.data).end;
  if (!recording.reference.empty()) score.distance = length_of(recording.reference);
  if (!score.started) return score;
  const eval::Trajectory poses = poses_of(replay);
  if (recording.reference.empty()) score.distance = length_of(poses);
  score.healthy = replay.healthy;
  score.farthest = 0.0;
  for (const auto& pose : poses) {
    score.farthest = std::max(score.farthest, (pose.p - poses.front().p).norm());
  }
  score.closure = (poses.back().p - poses.front().p).norm();
  if (!recording.reference.empty()) {
    judge_against_reference(recording.reference, poses, &score);
  }
  judge_height(recording, replay, &score);
  judge_rest(recording, replay, &score);
  return score;
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
    options.frontend.ransac_seed = static_cast<int>(i % count) + 1;
    if (variant.change) variant.change(options);
    run.scores[i % count] = judge(*run.recording, replay(run.recording->data, options));
  });
  return runs;
}

}  // namespace rio::experiment
