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
#include "experiment/parallel.hpp"
#include "experiment/recording.hpp"
#include "experiment/spread.hpp"
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

Recording control(const Recording& recording, const Drive& drive, Cause cause, std::uint64_t seed) {
  Recording out = recording;
  if (cause == Cause::kRecorded) return out;
  if (cause == Cause::kIdealDopplers) {
    for (RadarScan& scan : out.data.scans) {
      const Vector3d v_S = drive.radar_velocity(scan.time, *out.data.radar_info.T_BS);
      for (RadarDetection& d : scan.detections) {
        d.range_rate = -Vector3d(d.point_S).normalized().dot(v_S);
      }
    }
    return out;
  }
  std::vector<std::size_t> moving;
  std::vector<Eigen::Matrix<double, 6, 1>> residuals;
  Eigen::Matrix<double, 6, 1> mean = Eigen::Matrix<double, 6, 1>::Zero();
  for (std::size_t i = 0; i < out.data.imu.size(); ++i) {
    const ImuSample ideal = drive.imu(out.data.imu[i].time);
    if (drive.moves(ideal.time)) {
      Eigen::Matrix<double, 6, 1> r;
      r << out.data.imu[i].gyro_B - ideal.gyro_B, out.data.imu[i].accel_B - ideal.accel_B;
      moving.push_back(i);
      residuals.push_back(r);
      mean += r;
    }
    out.data.imu[i] = ideal;
  }
  mean /= static_cast<double>(residuals.size());
  Eigen::Matrix<double, 6, 1> variance = Eigen::Matrix<double, 6, 1>::Zero();
  for (auto& r : residuals) variance += (r - mean).cwiseAbs2();
  const Eigen::Matrix<double, 6, 1> sigma =
      (variance / static_cast<double>(residuals.size())).cwiseSqrt();
  sim::Random random(seed, 5);
  if (cause == Cause::kPermuted) {
    for (std::size_t i = residuals.size(); i-- > 1;) {
      const auto other =
          static_cast<std::size_t>(random.uniform(0.0, 1.0) * static_cast<double>(i + 1));
      std::swap(residuals[i], residuals[std::min(other, i)]);
    }
  }
  for (std::size_t k = 0; k < moving.size(); ++k) {
    ImuSample& s = out.data.imu[moving[k]];
    const auto white = [&](int first) -> Vector3d {
      return sigma.segment<3>(first).cwiseProduct(random.normal3());
    };
    if (cause == Cause::kGaussianGyro) s.gyro_B += white(0);
    if (cause == Cause::kGaussianAccel) s.accel_B += white(3);
    if (cause != Cause::kPermuted) continue;
    const Eigen::Matrix<double, 6, 1> r = residuals[k] - mean;
    s.gyro_B += r.head<3>();
    s.accel_B += r.tail<3>();
  }
  return out;
}

}  // namespace

Result control(const Settings& settings) {
  if (settings.data.empty()) throw std::runtime_error("control needs --data, as real does");
  std::vector<Recording> recordings = find_recordings(settings.data);
  std::erase_if(recordings, [](const Recording& r) {
    return !r.flat() || r.stands() || !r.data.radar_info.T_BS;
  });
  if (recordings.empty()) throw std::runtime_error("control: no drive with a flat reference");
  constexpr BackEnd kBackEnds[] = {BackEnd::kEkf, BackEnd::kSmoother};
  constexpr std::size_t kBoth = 2;
  constexpr int kSeeds = 8;  // of the RANSAC
  const std::size_t causes = std::size(kCauses);
  struct Found {
    RealScore score;
    double pitch = 0.0;  ///< of the mounting, estimate minus given [rad]
    double sigma = 0.0;
  };
  const auto seeds = static_cast<std::size_t>(settings.seeds > 0 ? settings.seeds : kSeeds);
  std::vector<Found> found(recordings.size() * causes * kBoth * seeds);
  parallel_for(found.size(), settings.threads, settings.on_progress, [&](std::size_t i) {
    const std::size_t one = i / seeds;  // drive, cause and back-end
    const Recording& recording = recordings[one / (causes * kBoth)];
    const Cause cause = kCauses[one / kBoth % causes].first;
    const Recording flown = control(recording, Drive(recording), cause, one / kBoth + 1);
    Options options;
    io::apply_sensor_info(flown.data, &options);
    options.backend = kBackEnds[one % kBoth];
    options.frontend.ransac_seed = static_cast<int>(i % seeds) + 1;
    const Replay result = replay(flown.data, options);
    const auto pitch = static_cast<std::size_t>(Calibration::kRotationY);
    found[i] = {judge(flown, result), result.calibration[pitch].value,
                result.calibration[pitch].sigma};
  });
  constexpr double kDegree = 180.0 / 3.14159265358979;
  MarkdownTable table({"sensors", "back-end", "pitch of the mounting, mean [deg]",
                       "over its sigma, RMS", "largest",
                       "height at 3 sigma, share of scans, lowest", "height [%], median (worst)"});
  for (std::size_t c = 0; c < causes; ++c) {
    for (std::size_t b = 0; b < kBoth; ++b) {
      std::vector<double> pitch, height;
      double square = 0.0, largest = 0.0, lowest = 1.0, n = 0.0;
      for (std::size_t r = 0; r < recordings.size(); ++r) {
        double started = 0.0, pitches = 0.0, heights = 0.0;
        for (std::size_t s = 0; s < seeds; ++s) {
          const Found& f = found[((r * causes + c) * kBoth + b) * seeds + s];
          if (!f.score.started) continue;
          const double sigmas = std::abs(f.pitch) / f.sigma;
          started += 1.0;
          pitches += kDegree * f.pitch;
          heights += 100.0 * f.score.height / f.score.distance;
          square += sigmas * sigmas;
          largest = std::max(largest, sigmas);
          lowest = std::min(lowest, f.score.honest);
        }
        n += started;
        if (started > 0.0) pitch.push_back(pitches / started);
        if (started > 0.0) height.push_back(heights / started);
      }
      std::sort(height.begin(), height.end());
      table.add({kCauses[c].second, b == 0 ? "filter" : "smoother", mean_with_error(pitch, 2),
                 number(std::sqrt(square / n), 2), number(largest, 2), number(lowest, 3),
                 height.empty() ? "-"
                                : fmt::format("{} ({})", number(height[height.size() / 2], 2),
                                              number(height.back(), 2))});
    }
  }
  Result out;
  out.markdown = fmt::format(
      "{} drives of a level vehicle, `default`, no option set. The given mounting is taken as\n"
      "true. Ideal: of the path of the reference. Each drive with {} seeds of the RANSAC: the "
      "mean\n"
      "of the seeds counts for the drive, largest and lowest are of all.\n\n{}",
      recordings.size(), seeds, table.text());
  return out;
}

}  // namespace rio::experiment
