// SPDX-License-Identifier: BSD-3-Clause
#include "experiment/trial.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "rio/aiding.hpp"
#include "rio/core/so3.hpp"
#include "rio/eval/nees.hpp"
#include "rio/io/start.hpp"
#include "rio/models/aids.hpp"
#include "rio/sim/random.hpp"

namespace rio::experiment {

namespace {

constexpr double kLongestSilence = 2.0;  // [s]
constexpr double kAllAlike = -200.0;     // of RadarOptions::weak_snr_db [dB]

/// Heights over the start with white noise, over a zero that walks as HeightModel has it.
class Barometer {
 public:
  explicit Barometer(const sim::Flight& flight)
      : flight_(flight), random_(flight.scenario.seed, 12), time_(flight.imu.front().time) {}

  void give(Time until, Odometry& odometry) {
    constexpr std::chrono::milliseconds kPeriod{40};
    constexpr double kSigma = 0.1;  // [m]
    for (; time_ <= until; time_ += kPeriod) {
      zero_ += HeightOffset::kWalk * std::sqrt(to_seconds(kPeriod)) * random_.normal();
      const double height = flight_.truth_at(time_).p_WB.z() + zero_ + kSigma * random_.normal();
      (void)odometry.add_measurement({time_, HeightModel{}, {height, kSigma}});
    }
  }

 private:
  const sim::Flight& flight_;
  sim::Random random_;
  Time time_;
  double zero_ = 0.0;  ///< [m]
};

void add_step(const sim::Flight& flight, const Odometry& odometry, Trial* trial) {
  const UpdateReport& report = odometry.report();
  trial->doubted += report.health.state > HealthState::kOk ? 1 : 0;
  const NavState& x = odometry.at_scan();
  trial->steps.push_back({x, flight.truth_at(x.time), odometry.covariance()});
  for (std::size_t i = 0; i < kModelCount; ++i) {
    trial->models[i].rows_used += report.models[i].rows_used;
    trial->models[i].nis += report.models[i].nis;
  }
  trial->propagation_time += report.propagation_time;
  trial->update_time += report.update_time;
}

bool is_complete(const sim::Flight& flight, const Trial& trial) {
  const std::vector<Step>& steps = trial.steps;
  if (steps.empty() || trial.counters.updates_failed > 0) return false;
  const double allowed = flight.scenario.disturbances.outages.duration + kLongestSilence;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const Time next = i + 1 < steps.size() ? steps[i + 1].estimate.time : flight.imu.back().time;
    if (!is_finite(steps[i].estimate) || !steps[i].covariance.allFinite()) return false;
    if (to_seconds(next - steps[i].estimate.time) > allowed) return false;
  }
  return true;
}

/// The true first state with the scenario's error, biases unknown.
void start_wrongly(const sim::Flight& flight, const StartOptions& start, Odometry& odometry) {
  const NavState state = flight.configured_start();
  BodyCovariance P = io::start_covariance(state.q_WB, start);
  const double sigma = flight.scenario.errors.start_velocity_sigma;
  P.block<3, 3>(body::kVelocity, body::kVelocity) = Matrix3d::Identity() * sigma * sigma;
  if (odometry.reset(state, P) != Status::kOk) throw std::runtime_error("the start was refused");
}

}  // namespace

bool is_finite(const NavState& x) {
  return x.q_WB.coeffs().allFinite() && x.p_WB.allFinite() && x.v_WB.allFinite() &&
         x.gyro_bias.allFinite() && x.accel_bias.allFinite();
}

Options options_for(const sim::Flight& flight, const std::string& name) {
  Options o;
  if (!preset(name, &o)) throw std::runtime_error("no such preset: \"" + name + "\"");
  const sim::ImuModel& imu = flight.scenario.imu;
  o.imu.gyro_noise_density = imu.gyro_noise_density;
  o.imu.gyro_random_walk = imu.gyro_random_walk;
  o.imu.accel_noise_density = imu.accel_noise_density;
  o.imu.accel_random_walk = imu.accel_random_walk;
  o.start.sigma_gyro_bias = std::max(o.start.sigma_gyro_bias, imu.gyro_turn_on_sigma);
  o.start.sigma_accel_bias = std::max(o.start.sigma_accel_bias, imu.accel_turn_on_sigma);
  const sim::RadarModel& radar = flight.scenario.radar;
  o.radar.T_BS = flight.configured_T_BS;
  o.radar.sigma_range = radar.sigma_range;
  o.radar.sigma_azimuth = radar.sigma_azimuth;
  o.radar.sigma_elevation = radar.sigma_elevation;
  o.radar.sigma_doppler = radar.sigma_doppler;
  if (o.radar.weak_snr_db > kAllAlike) {
    o.radar.weak_snr_db = radar.weak_angle_growth > 0.0 ? radar.threshold_db : kAllAlike;
  }
  if (o.radar.noise_distance > 0.0) {
    o.radar.noise_distance = radar.fresh_noise < 1.0 ? radar.noise_distance : 0.0;
  }
  o.radar.range_resolution = radar.quantize ? radar.range_resolution : 0.0;
  o.radar.doppler_resolution = radar.reported_doppler_resolution();
  o.radar.max_doppler = radar.reported_max_doppler();
  return o;
}

std::unique_ptr<Odometry> create_odometry(const Options& options) {
  std::string why;
  auto odometry = Odometry::create(options, &why);
  if (odometry == nullptr) throw std::runtime_error(why);
  return odometry;
}

Trial replay(const sim::Flight& flight, Odometry& odometry, const EachReport& each,
             bool with_barometer) {
  Trial trial;
  Barometer barometer(flight);
  std::uint64_t seen = odometry.counters().scans;
  const auto look = [&] {
    if (odometry.counters().scans == seen) return;
    seen = odometry.counters().scans;
    if (odometry.report().status != Status::kOk) return;
    add_step(flight, odometry, &trial);
    if (each) each(odometry.report());
  };
  Time newest = Time::min();  // of the IMU
  std::size_t next = 0;       // scan
  // not while one waits for the IMU: its report would be overwritten
  const auto give_scans = [&](Time until) {
    for (; next < flight.scans.size() && flight.arrivals[next] < until; ++next) {
      if (next > 0 && flight.scans[next - 1].time > newest) return;
      (void)odometry.add_scan(flight.scans[next]);
      look();
    }
  };
  for (const ImuSample& sample : flight.imu) {
    give_scans(sample.time);
    (void)odometry.add_imu(sample);
    newest = sample.time;
    look();
    if (with_barometer) barometer.give(newest, odometry);
  }
  give_scans(Time::max());
  trial.counters = odometry.counters();
  trial.complete = is_complete(flight, trial);
  return trial;
}

Trial fly(const sim::Flight& flight, const Options& options, const EachReport& each) {
  Options used = options;
  const bool wrong = flight.scenario.errors.starts_wrongly();
  if (wrong) used.start.static_alignment = false;
  const auto odometry = create_odometry(used);
  if (wrong) start_wrongly(flight, used.start, *odometry);
  const AidingMeasurement height({}, HeightModel{}, {});
  return replay(flight, *odometry, each, height.is_declared(used.auxiliary));
}

Trial with_drawn_start(const Trial& trial, const StartOptions& start, std::uint64_t seed) {
  Trial drawn = trial;
  if (trial.steps.empty()) return drawn;
  sim::Random random(seed, 9);
  const Quaternion turn = quaternion_exp(start.sigma_yaw * random.normal() * Vector3d::UnitZ());
  const Vector3d shift = start.sigma_position * random.normal3();
  const Vector3d origin = trial.steps.front().truth.p_WB;
  for (Step& step : drawn.steps) {
    NavState& truth = step.truth;
    truth.q_WB = turn * truth.q_WB;
    truth.p_WB = turn * (truth.p_WB - origin) + origin + shift;
    truth.v_WB = turn * truth.v_WB;
  }
  return drawn;
}

void forget_mounting(Options& options) {
  options.radar.T_BS = Pose{};
  for (RadarMount& other : options.other_radars) other.T_BS = Pose{};
  options.calibration.rotation_sigma = std::numbers::pi;
  options.calibration.translation_sigma = 1.0;
}

Time steady_now() {
  return std::chrono::steady_clock::now().time_since_epoch();
}

std::vector<eval::PosePair> pose_pairs(const Trial& trial) {
  std::vector<eval::PosePair> pairs;
  pairs.reserve(trial.steps.size());
  for (const Step& step : trial.steps) {
    const NavState& x = step.estimate;
    const NavState& truth = step.truth;
    pairs.push_back({{truth.time, truth.p_WB, truth.q_WB}, {x.time, x.p_WB, x.q_WB}});
  }
  return pairs;
}

BlockNees block_nees(const Step& step) {
  const BodyCovariance& P = step.covariance;
  const eval::BodyError e = eval::body_error(step.estimate, step.truth);
  const auto block = [&](int at) {
    return eval::nees(e.segment<3>(at).eval(), Matrix3d(P.block<3, 3>(at, at))) / 3.0;
  };
  const Vector3d up = step.estimate.q_WB.conjugate() * Vector3d::UnitZ();
  const double yaw = up.dot(e.segment<3>(body::kAttitude));
  const double yaw_var = up.dot(P.block<3, 3>(body::kAttitude, body::kAttitude) * up);
  return {.position = block(body::kPosition),
          .attitude = block(body::kAttitude),
          .heading = yaw * yaw / yaw_var,
          .velocity = block(body::kVelocity)};
}

}  // namespace rio::experiment
