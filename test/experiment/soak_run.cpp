// SPDX-License-Identifier: BSD-3-Clause
#include "experiment/soak_run.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <stdexcept>

#include "experiment/soak_flight.hpp"
#include "experiment/trial.hpp"
#include "rio/core/so3.hpp"
#include "rio/eval/nees.hpp"
#include "rio/io/start.hpp"
#include "rio/rio.hpp"

namespace rio::experiment {

namespace {

/// Memory of this process [MB]; 0 if unknown.
double resident_megabytes() {
  double size = 0.0;
  double resident = 0.0;
  std::ifstream("/proc/self/statm") >> size >> resident;  // pages
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1048576.0;
}

/// FNV-1a.
template <class T>
void add_to_hash(const T& value, std::uint64_t* hash) {
  const auto* bytes = reinterpret_cast<const unsigned char*>(&value);
  for (std::size_t i = 0; i < sizeof value; ++i) *hash = (*hash ^ bytes[i]) * 0x100000001b3ULL;
}

/// How early a scan is delivered relative to its time; negative: late.
Time ahead(Interleaving interleaving) {
  using std::chrono::milliseconds;
  if (interleaving == Interleaving::kEarly) return milliseconds(200);
  return interleaving == Interleaving::kLate ? milliseconds(-100) : milliseconds(0);
}

/// NEES of the direction of gravity over its two dimensions.
double nees_of_tilt(const eval::BodyError& e, const NavState& estimate, const BodyCovariance& P) {
  const Vector3d up = estimate.q_WB.conjugate() * Vector3d::UnitZ();
  Eigen::Matrix<double, 2, 3> across;
  across.row(0) = up.unitOrthogonal();
  across.row(1) = up.cross(Vector3d(across.row(0)));
  const Eigen::Vector2d error = across * e.segment<3>(body::kAttitude);
  const Eigen::Matrix2d covariance =
      across * P.block<3, 3>(body::kAttitude, body::kAttitude) * across.transpose();
  return eval::nees(error, covariance) / 2.0;
}

/// NEES of the velocity over its dimension, in body axes: in world axes the unbounded drift of the
/// heading rotates it beyond the linear range.
double nees_of_velocity(const NavState& estimate, const NavState& truth, const BodyCovariance& P) {
  const Vector3d v_B = estimate.q_WB.conjugate() * estimate.v_WB;
  const Vector3d error = v_B - truth.q_WB.conjugate() * truth.v_WB;
  Eigen::Matrix<double, 3, body::kSize> J = Eigen::Matrix<double, 3, body::kSize>::Zero();
  J.middleCols<3>(body::kAttitude) = skew(v_B);
  J.middleCols<3>(body::kVelocity) = estimate.q_WB.conjugate().toRotationMatrix();
  return eval::nees(error, J * P * J.transpose()) / 3.0;
}

/// Mean (error / sigma)^2 of the parameters; the configured values are the true ones.
double calibration_of(const UpdateReport& report) {
  double sum = 0.0;
  int parameters = 0;
  for (const CalibrationReport& c : report.calibration) {
    if (c.observability == Observability::kNotEstimated) continue;
    sum += c.value * c.value / (c.sigma * c.sigma);
    ++parameters;
  }
  return sum / parameters;
}

/// From a known state.
std::unique_ptr<Odometry> started(BackEnd backend, const NavState& start) {
  sim::Flight sensors;  // sensor parameters only
  sensors.configured_T_BS = sensors.scenario.radar.T_BS;
  Options options = options_for(sensors, "default");
  options.backend = backend;
  auto odometry = create_odometry(options);
  const BodyCovariance P0 = io::start_covariance(start.q_WB, options.start);
  if (odometry->reset(start, P0) != Status::kOk) throw std::runtime_error("no start");
  return odometry;
}

/// Adds a scan to a row, whose means are sums until it ends.
void add_scan(const Odometry& odometry, const NavState& truth, SoakRow* row, SoakRun* run) {
  const NavState& x = odometry.at_scan();
  const BodyCovariance& P = odometry.covariance();
  add_to_hash(x, &run->hash);
  add_to_hash(P, &run->hash);
  const eval::BodyError e = eval::body_error(x, truth);
  run->finite = run->finite && e.allFinite() && P.allFinite();
  row->position_error = e.segment<3>(body::kPosition);
  row->position_sigma = std::sqrt(P.block<3, 3>(body::kPosition, body::kPosition).trace());
  row->nees_velocity += nees_of_velocity(x, truth, P);
  row->nees_tilt += nees_of_tilt(e, x, P);
  row->calibration += calibration_of(odometry.report());
  row->asymmetry = std::max(row->asymmetry, (P - P.transpose()).cwiseAbs().maxCoeff());
  row->norm_error = std::max(row->norm_error, std::abs(x.q_WB.norm() - 1.0));
}

}  // namespace

SoakRun run_soak(const SoakSettings& settings) {
  constexpr double kRest = 0.5;  // without a scan, so that the last one is processed [s]
  const Time begin = sim::Scenario{}.start;
  const Time end = begin + from_seconds(settings.seconds);
  const Time last_scan = end - from_seconds(kRest);
  EndlessFlight flight({.seed = settings.seed});
  const auto odometry = started(settings.backend, flight.truth(begin));
  SoakRun run;
  SoakRow row;
  std::uint64_t seen = 0;    // scans
  std::uint64_t before = 0;  // scans of the rows before
  const auto look = [&] {
    if (odometry->counters().scans == seen) return;
    seen = odometry->counters().scans;
    add_scan(*odometry, flight.truth(odometry->at_scan().time), &row, &run);
  };
  const auto give = [&](const ImuSample& sample) {
    (void)odometry->add_imu(sample);
    look();
    row.lag = std::max(row.lag, std::abs(to_seconds(odometry->now().time - sample.time)));
  };
  const bool imu_first = settings.interleaving == Interleaving::kImuFirst;
  for (Time now = begin; now < end;) {
    const ImuSample sample = flight.next_imu();
    now = sample.time;
    if (imu_first) give(sample);
    while (flight.next_scan_time() < std::min(last_scan, now + ahead(settings.interleaving))) {
      ++run.scans;
      (void)odometry->add_scan(flight.next_scan());
      look();
    }
    if (!imu_first) give(sample);
    if (to_seconds(now - begin) < settings.every * static_cast<double>(run.rows.size() + 1))
      continue;
    row.resident = resident_megabytes();
    for (double* sum : {&row.nees_velocity, &row.nees_tilt, &row.calibration}) {
      *sum /= static_cast<double>(seen - before);
    }
    run.rows.push_back(row);
    row = {};
    before = seen;
  }
  run.counters = odometry->counters();
  return run;
}

}  // namespace rio::experiment
