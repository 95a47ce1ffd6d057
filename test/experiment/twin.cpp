// SPDX-License-Identifier: BSD-3-Clause
#include "experiment/twin.hpp"

#include <algorithm>
#include <cmath>

#include "experiment/signature.hpp"
#include "rio/io/scenario_yaml.hpp"
#include "rio/sim/flight.hpp"
#include "rio/sim/trajectory_fit.hpp"

namespace rio::experiment {

namespace {

/// The bands of the spectrum from here on are Shaking high, lower ones low.
constexpr std::size_t kHigh = 2;

double rms_below(const Bands& bands, std::size_t last) {
  double sum = 0.0;
  for (std::size_t i = 0; i < last; ++i) sum += bands[i] * bands[i];
  return std::sqrt(sum);
}

/// A measured value, and the scenario value that controls it.
struct Knob {
  double* value;
  double wanted;
  double found;
};

/// The rms values of a scenario with those measured in a recording and in its twin.
std::vector<Knob> knobs(const ImuSignature& wanted, const ImuSignature& found, sim::ImuModel* imu) {
  std::vector<Knob> all;
  const auto add = [&](Bands ImuSignature::*bands, double sim::Shaking::*value) {
    all.push_back(
        {&(imu->low.*value), rms_below(wanted.*bands, kHigh), rms_below(found.*bands, kHigh)});
    all.push_back(
        {&(imu->high.*value), rms_from(wanted.*bands, kHigh), rms_from(found.*bands, kHigh)});
  };
  add(&ImuSignature::gyro_rest, &sim::Shaking::gyro_rest);
  add(&ImuSignature::gyro_moving, &sim::Shaking::gyro_moving);
  add(&ImuSignature::accel_rest, &sim::Shaking::accel_rest);
  add(&ImuSignature::accel_moving, &sim::Shaking::accel_moving);
  return all;
}

void take_sensors(const io::Dataset& data, const Motion& motion, sim::Scenario* s) {
  const ImuSignature imu = imu_signature(data, motion);
  const RadarSignature radar = radar_signature(data, motion);
  s->imu.rate_hz = data.imu_info.rate_hz.value_or(imu.rate_hz);
  s->imu.lost_share = imu.missing + imu.interpolated;
  s->imu.lost_filled = imu.interpolated > imu.missing;
  s->imu.lost_run = std::isfinite(imu.run) ? std::max(1.0, imu.run) : 1.0;
  for (const Knob& knob : knobs(imu, imu, &s->imu)) {
    *knob.value = std::isfinite(knob.wanted) ? knob.wanted : 0.0;
  }
  const io::RadarInfo& info = data.radar_info;
  sim::RadarModel& model = s->radar;
  if (info.T_BS) model.T_BS = *info.T_BS;
  model.rate_hz = radar.rate_hz;
  model.max_range = info.max_range.value_or(model.max_range);
  model.range_resolution = info.range_resolution.value_or(model.range_resolution);
  model.fov_azimuth = info.fov_azimuth.value_or(model.fov_azimuth);
  model.fov_elevation = info.fov_elevation.value_or(model.fov_elevation);
  model.quantize = radar.doppler_grid > 0.0;
  if (model.quantize) model.doppler_resolution = radar.doppler_grid;
  model.ambiguous = info.max_doppler.has_value();
  model.max_doppler = info.max_doppler.value_or(model.max_doppler);
  model.threshold_db = radar.snr_floor_db;
  model.max_static = 2 * static_cast<int>(radar.points.high);
}

/// Rounds of twin_of(): each leaves a fraction of the difference.
constexpr int kRounds = 4;

/// One round: scales the rms by their quotients, the strength of the echoes by that of the points a
/// scan.
void bring_closer(const Twin& wanted, const Twin& found, sim::Scenario* s) {
  constexpr double kLargest = 4.0;  // quotient of a round
  const auto quotient = [kLargest](double a, double b) {
    return std::isfinite(a) && b > 0.0 ? std::clamp(a / b, 1.0 / kLargest, kLargest) : 1.0;
  };
  for (const Knob& knob : knobs(imu_signature(wanted.data, wanted.motion),
                                imu_signature(found.data, found.motion), &s->imu)) {
    *knob.value *= quotient(knob.wanted, knob.found);
  }
  // the number of points grows tenfold in about ten decibels
  s->radar.snr_1m_db +=
      10.0 * std::log10(quotient(radar_signature(wanted.data, wanted.motion).mean_points,
                                 radar_signature(found.data, found.motion).mean_points));
}

Motion motion_of(const sim::Flight& flight, double grid) {
  Motion motion{flight.imu.back().time, flight.imu.front().time};
  for (const NavState& truth : flight.truth) {
    if (truth.v_WB.norm() < still_bound(grid)) continue;
    motion.begin = std::min(motion.begin, truth.time);
    motion.end = std::max(motion.end, truth.time);
  }
  return motion;
}

Twin fly(const Recording& recording, const sim::Scenario& s) {
  const bool follows = !recording.reference.empty();
  const sim::Flight flight =
      follows ? sim::simulate_flight(
                    sim::fit_trajectory(recording.reference, s.path, s.start).trajectory, s)
              : sim::simulate_flight(s);
  Twin twin;
  twin.data.imu = flight.imu;
  twin.data.scans = flight.scans;
  twin.data.imu_info = recording.data.imu_info;
  twin.data.radar_info = recording.data.radar_info;
  twin.motion = motion_of(flight, s.radar.quantize ? s.radar.doppler_resolution : 0.0);
  return twin;
}

}  // namespace

sim::Scenario scenario_of(const std::string& name) {
  return io::load_scenario(name);
}

sim::Scenario as_recorded(const Recording& recording, sim::Scenario s) {
  const io::Dataset& data = recording.data;
  const Motion motion = motion_of(data);
  take_sensors(data, motion, &s);
  const double rest = to_seconds(motion.begin - data.imu.front().time);
  const double after = to_seconds(data.imu.back().time - motion.end);
  s.path.stand_before = std::max(0.0, rest);
  s.path.stand_after = std::max(0.0, after);
  if (recording.reference.empty()) {
    s.path.length = 0.0;
    s.path.duration = to_seconds(motion.end - motion.begin);
    s.path.max_speed = radar_signature(data, motion).speed.high;
    s.path.min_speed = std::min(s.path.min_speed, 0.5 * s.path.max_speed);
  } else {
    // the recorded path includes the rest; its leads are two seconds long
    s.path.stand_before = s.path.stand_after = 0.0;
  }
  return s;
}

Twin twin_of(const Recording& recording, const sim::Scenario& scenario) {
  sim::Scenario s = as_recorded(recording, scenario);
  const Twin own{recording.data, motion_of(recording.data)};
  for (int round = 0; round < kRounds; ++round) {
    bring_closer(own, fly(recording, s), &s);
  }
  return fly(recording, s);
}

}  // namespace rio::experiment
