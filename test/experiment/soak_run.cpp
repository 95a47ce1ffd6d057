// SPDX-License-Identifier: BSD-3-Clause
#include "experiment/soak_run.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>

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
  long size = 0;
  long resident = 0;
  std::FILE* file = std::fopen("/proc/self/statm", "r");
  if (file == nullptr) return 0.0;
  const int read = std::fscanf(file, "%ld %ld", &size, &resident);
  std::fclose(file);
  const auto pages = static_cast<double>(read == 2 ? resident : 0);
  return pages * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1048576.0;
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

/// Norm of an error and its NEES over its dimension.
struct Error {
  double norm = 0.0;
  double nees = 0.0;
};

/// Of the direction of gravity, in two perpendicular axes [rad].
Error tilt_of(const eval::BodyError& e, const NavState& estimate, const BodyCovariance& P) {
  const Vector3d up = estimate.q_WB.conjugate() * Vector3d::UnitZ();
  Eigen::Matrix<double, 2, 3> across;
  across.row(0) = up.unitOrthogonal();
  across.row(1) = up.cross(Vector3d(across.row(0)));
  const Eigen::Vector2d error = across * e.segment<3>(body::kAttitude);
  const Eigen::Matrix2d covariance =
      across * P.block<3, 3>(body::kAttitude, body::kAttitude) * across.transpose();
  return {error.norm(), eval::nees(error, covariance) / 2.0};
}

/// Of the velocity in body axes [m/s]: in world axes the unbounded drift of the heading rotates it
/// beyond the linear range.
Error velocity_of(const NavState& estimate, const NavState& truth, const BodyCovariance& P) {
  const Vector3d v_B = estimate.q_WB.conjugate() * estimate.v_WB;
  const Vector3d error = v_B - truth.q_WB.conjugate() * truth.v_WB;
  Eigen::Matrix<double, 3, body::kSize> J = Eigen::Matrix<double, 3, body::kSize>::Zero();
  J.middleCols<3>(body::kAttitude) = skew(v_B);
  J.middleCols<3>(body::kVelocity) = estimate.q_WB.conjugate().toRotationMatrix();
  return {error.norm(), eval::nees(error, J * P * J.transpose()) / 3.0};
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

class Run {
 public:
  Run(const SoakSettings& settings, const std::function<void(const SoakRow&)>& each)
      : settings_(settings), each_(each), flight_(scenario()) {
    sim::Flight sensors;  // sensor parameters only
    sensors.scenario = scenario();
    sensors.configured_T_BS = sensors.scenario.radar.T_BS;
    Options options = options_for(sensors, "default");
    options.backend = settings.backend;
    options.timing.clock = &steady_now;
    std::string why;
    odometry_ = Odometry::create(options, &why);
    if (odometry_ == nullptr) throw std::runtime_error(why);
    const NavState start = flight_.truth(sensors.scenario.start);
    BodyCovariance P0 = io::start_covariance(start.q_WB, options.start);
    if (odometry_->reset(start, P0) != Status::kOk) throw std::runtime_error("no start");
  }

  SoakRun fly() {
    constexpr double kRest = 0.5;  // without a scan, so that the last one is processed [s]
    const Time begin = scenario().start;
    const Time last_scan = begin + from_seconds(settings_.seconds - kRest);
    const Time end = begin + from_seconds(settings_.seconds);
    const bool imu_first = settings_.interleaving == Interleaving::kImuFirst;
    for (Time now = begin; now < end;) {
      const ImuSample sample = flight_.next_imu();
      now = sample.time;
      if (imu_first) give(sample);
      while (flight_.next_scan_time() < std::min(last_scan, now + ahead(settings_.interleaving))) {
        ++run_.scans;
        (void)odometry_->add_scan(flight_.next_scan());
        look();
      }
      if (!imu_first) give(sample);
      if (to_seconds(now - begin) >= settings_.every * static_cast<double>(run_.rows.size() + 1)) {
        end_row(to_seconds(now - begin));
      }
    }
    run_.counters = odometry_->counters();
    return run_;
  }

 private:
  sim::Scenario scenario() const {
    sim::Scenario scenario;
    scenario.seed = settings_.seed;
    return scenario;
  }

  void give(const ImuSample& sample) {
    (void)odometry_->add_imu(sample);
    look();
    const double lag = std::abs(to_seconds(odometry_->now().time - sample.time));
    row_.lag = std::max(row_.lag, lag);
  }

  /// At a new scan.
  void look() {
    if (odometry_->counters().scans == seen_) return;
    seen_ = odometry_->counters().scans;
    const NavState& x = odometry_->at_scan();
    const BodyCovariance& P = odometry_->covariance();
    add_to_hash(x, &run_.hash);
    add_to_hash(P, &run_.hash);
    const NavState truth = flight_.truth(x.time);
    const eval::BodyError e = eval::body_error(x, truth);
    run_.finite = run_.finite && e.allFinite() && P.allFinite();
    const Vector3d position = e.segment<3>(body::kPosition);
    const Matrix3d P_position = P.block<3, 3>(body::kPosition, body::kPosition);
    const Error velocity = velocity_of(x, truth, P);
    const Error tilt = tilt_of(e, x, P);
    const UpdateReport& report = odometry_->report();
    const double took = to_seconds(report.propagation_time + report.update_time);
    ++scans_in_row_;
    row_.position_error = position.norm();
    row_.position_sigma = std::sqrt(P_position.trace());
    row_.velocity_error = velocity.norm;
    row_.tilt_error = tilt.norm;
    row_.nees_position = eval::nees(position, P_position) / 3.0;
    row_.nees_velocity += velocity.nees;
    row_.nees_tilt += tilt.nees;
    row_.calibration += calibration_of(report);
    row_.asymmetry = std::max(row_.asymmetry, (P - P.transpose()).cwiseAbs().maxCoeff());
    row_.norm_error = std::max(row_.norm_error, std::abs(x.q_WB.norm() - 1.0));
    row_.time_per_scan += took;
    row_.longest_scan = std::max(row_.longest_scan, took);
  }

  void end_row(double time) {
    row_.time = time;
    row_.resident = resident_megabytes();
    for (double* sum :
         {&row_.nees_velocity, &row_.nees_tilt, &row_.calibration, &row_.time_per_scan}) {
      *sum /= scans_in_row_;
    }
    run_.rows.push_back(row_);
    if (each_) each_(row_);
    row_ = {};
    scans_in_row_ = 0;
  }

  SoakSettings settings_;
  const std::function<void(const SoakRow&)>& each_;
  EndlessFlight flight_;
  std::unique_ptr<Odometry> odometry_;
  SoakRun run_;
  SoakRow row_;
  int scans_in_row_ = 0;
  std::uint64_t seen_ = 0;  ///< scans
};

}  // namespace

SoakRun run_soak(const SoakSettings& settings, const std::function<void(const SoakRow&)>& each) {
  return Run(settings, each).fly();
}

}  // namespace rio::experiment
