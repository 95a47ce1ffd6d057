// SPDX-License-Identifier: BSD-3-Clause
// Controls on real drives: which error is the estimator's, which the sensors'? The same recording
// with the IMU replaced by that of the driven path, ideal or with one cause of noise at a time, or
// with ideal Dopplers on the real points. A mounting that is estimated away from the truth without
// the cause in the data is a bias of the estimator.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"
#include "experiment/recording.hpp"
#include "rio/core/so3.hpp"
#include "rio/propagate/static_alignment.hpp"
#include "rio/sim/random.hpp"
#include "rio/sim/trajectory_fit.hpp"

namespace rio::experiment {

namespace {

/// What the sensors of a control measure.
enum class Cause {
  kRecorded,
  kIdealImu,
  kGaussianAccel,  ///< ideal and white noise as strong as the recorded residual
  kGaussianGyro,   ///< same
  kPermuted,       ///< ideal and the recorded residuals, permuted in time
  kIdealDopplers,  ///< recorded IMU
};
constexpr std::pair<Cause, const char*> kCauses[] = {
    {Cause::kRecorded, "as recorded"},
    {Cause::kIdealImu, "ideal IMU"},
    {Cause::kGaussianAccel, "ideal IMU, Gaussian noise of the accelerometer"},
    {Cause::kGaussianGyro, "ideal IMU, Gaussian noise of the gyroscope"},
    {Cause::kPermuted, "ideal IMU, recorded residuals permuted in time"},
    {Cause::kIdealDopplers, "recorded IMU, ideal Dopplers on the recorded points"}};

/// The path of the reference: a level vehicle, with the IMU mounted as it leans at rest.
class Drive {
 public:
  explicit Drive(const Recording& recording) : first_(recording.reference.front().time) {
    sim::PathOptions path;
    path.ground = true;
    fit_ = sim::fit_trajectory(recording.reference, path);
    Vector3d up = Vector3d::Zero();
    for (const ImuSample& s : recording.data.imu) {
      if (s.time - recording.data.imu.front().time < std::chrono::seconds(1)) up += s.accel_B;
    }
    lean_ = level(up.normalized()).toRotationMatrix().transpose();
  }

  /// The fitted path creeps in the rest before and after.
  bool moves(Time time) const {
    constexpr double kCreep = 0.1;  // [m/s]
    return at(time).nav.v_WB.norm() > kCreep;
  }
  ImuSample imu(Time time) const {
    const sim::Trajectory::Point p = at(time);
    return {time, lean_ * p.gyro_B, lean_ * p.accel_B};
  }
  /// Velocity of the radar in its axes [m/s].
  Vector3d radar_velocity(Time time, const Pose& T_BS) const {
    const sim::Trajectory::Point p = at(time);
    const Vector3d v_B = lean_ * (p.nav.q_WB.conjugate() * p.nav.v_WB);
    const Vector3d rate_B = lean_ * p.gyro_B;
    return T_BS.rotation.conjugate() * (v_B + rate_B.cross(T_BS.translation));
  }

 private:
  sim::Trajectory::Point at(Time time) const {
    return fit_.trajectory.at(fit_.first + to_seconds(time - first_));
  }

  sim::TrajectoryFit fit_;
  Time first_;
  Matrix3d lean_;  ///< level axes of the vehicle to the IMU's
};

using Residual = Eigen::Matrix<double, 6, 1>;  ///< of gyro and accelerometer

void make_dopplers_ideal(const Drive& drive, io::Dataset* data) {
  for (RadarScan& scan : data->scans) {
    const Vector3d v_S = drive.radar_velocity(scan.time, *data->radar_info.T_BS);
    for (RadarDetection& d : scan.detections) {
      d.range_rate = -Vector3d(d.point_S).normalized().dot(v_S);
    }
  }
}

/// With one cause of noise while it moves, or none.
void make_imu_ideal(const Drive& drive, Cause cause, std::uint64_t seed, io::Dataset* data) {
  std::vector<ImuSample*> moving;
  std::vector<Residual> residuals;
  Residual mean = Residual::Zero();
  for (ImuSample& s : data->imu) {
    const ImuSample ideal = drive.imu(s.time);
    if (drive.moves(s.time)) {
      Residual r;
      r << s.gyro_B - ideal.gyro_B, s.accel_B - ideal.accel_B;
      moving.push_back(&s);
      residuals.push_back(r);
      mean += r;
    }
    s = ideal;
  }
  const auto n = static_cast<double>(residuals.size());
  mean /= n;
  Residual variance = Residual::Zero();
  for (Residual& r : residuals) variance += (r - mean).cwiseAbs2();
  const Residual sigma = (variance / n).cwiseSqrt();
  sim::Random random(seed, 5);
  if (cause == Cause::kPermuted) {
    for (std::size_t i = residuals.size(); i-- > 1;) {
      const auto other =
          static_cast<std::size_t>(random.uniform(0.0, 1.0) * static_cast<double>(i + 1));
      std::swap(residuals[i], residuals[std::min(other, i)]);
    }
  }
  for (std::size_t k = 0; k < moving.size(); ++k) {
    ImuSample& s = *moving[k];
    if (cause == Cause::kGaussianGyro) {
      s.gyro_B += sigma.head<3>().cwiseProduct(random.normal3());
    } else if (cause == Cause::kGaussianAccel) {
      s.accel_B += sigma.tail<3>().cwiseProduct(random.normal3());
    } else if (cause == Cause::kPermuted) {
      s.gyro_B += (residuals[k] - mean).head<3>();
      s.accel_B += (residuals[k] - mean).tail<3>();
    }
  }
}

/// Of all drives the runs of a cause and a back-end; a drive counts with the mean of its seeds.
std::vector<std::string> row_of(const std::vector<RealRun>& runs, const std::string& cause,
                                std::size_t back_end) {
  std::vector<double> pitch, height;
  double square = 0.0, largest = 0.0, lowest = 1.0, n = 0.0;
  for (const RealRun& run : runs) {
    if (run.recording->group != cause || run.variant != back_end) continue;
    double started = 0.0, pitches = 0.0, heights = 0.0;
    for (const RealScore& s : run.scores) {
      if (!s.started) continue;
      const double sigmas = std::abs(s.pitch) / s.pitch_sigma;
      started += 1.0;
      pitches += s.pitch / kDegree;
      heights += s.height_share();
      square += sigmas * sigmas;
      largest = std::max(largest, sigmas);
      lowest = std::min(lowest, s.honest);
    }
    n += started;
    if (started > 0.0) pitch.push_back(pitches / started);
    if (started > 0.0) height.push_back(heights / started);
  }
  std::sort(height.begin(), height.end());
  const std::string heights =
      height.empty()
          ? "-"
          : fmt::format("{} ({})", number(height[height.size() / 2], 2), number(height.back(), 2));
  return {cause,
          back_end == 0 ? "filter" : "smoother",
          mean_with_error(pitch, 2),
          number(std::sqrt(square / n), 2),
          number(largest, 2),
          number(lowest, 3),
          heights};
}

}  // namespace

Result control(const Settings& settings) {
  if (settings.data.empty()) throw std::runtime_error("control needs --data, as real does");
  std::vector<Recording> drives = find_recordings(settings.data);
  std::erase_if(drives, [](const Recording& r) {
    return !r.flat() || r.stands() || !r.data.radar_info.T_BS;
  });
  if (drives.empty()) throw std::runtime_error("control: no drive with a flat reference");
  std::vector<Recording> controls;
  for (const Recording& recorded : drives) {
    const Drive drive(recorded);
    for (const auto& [cause, name] : kCauses) {
      Recording& control = controls.emplace_back(recorded);
      control.group = name;
      if (cause == Cause::kIdealDopplers) {
        make_dopplers_ideal(drive, &control.data);
      } else if (cause != Cause::kRecorded) {
        make_imu_ideal(drive, cause, controls.size(), &control.data);
      }
    }
  }
  const Variants back_ends = {{"filter", "default"}, {"smoother", "default", use_smoother}};
  constexpr int kSeeds = 8;  // of the RANSAC
  const int seeds = settings.seeds_or(kSeeds);
  const std::vector<RealRun> runs = replay_campaign(controls, back_ends, seeds, settings);
  MarkdownTable table({"sensors", "back-end", "pitch of the mounting, mean [deg]",
                       "over its sigma, RMS", "largest",
                       "height at 3 sigma, share of scans, lowest", "height [%], median (worst)"});
  for (const auto& [cause, name] : kCauses) {
    for (const std::size_t back_end : {0U, 1U}) table.add(row_of(runs, name, back_end));
  }
  return {fmt::format(
      "{} drives of a level vehicle, `default`, no option set. The given mounting is taken as\n"
      "true. Ideal: of the path of the reference. Each drive with {} seeds of the RANSAC: the "
      "mean\n"
      "of the seeds counts for the drive, largest and lowest are of all.\n\n{}",
      drives.size(), seeds, table.text())};
}

}  // namespace rio::experiment
