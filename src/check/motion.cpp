// SPDX-License-Identifier: BSD-3-Clause
#include "check/motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "check/numbers.hpp"
#include "rio/core/so3.hpp"
#include "rio/frontend/ego_velocity.hpp"
#include "rio/models/detection.hpp"

namespace rio::check {

namespace {

/// What (E3) needs of the scans of a window: sums over w times products of G = [y_x C, y_y C, y_z
/// C], q, 1 and t.
struct Sums {
  using Map9 = Eigen::Matrix<double, 3, 9>;
  int scans = 0;
  double last = 0.0;  ///< t of the last scan [s]
  double w = 0.0;
  double wt = 0.0;
  double wtt = 0.0;
  double qq = 0.0;
  Vector3d q = Vector3d::Zero();
  Vector3d tq = Vector3d::Zero();
  Matrix3d yy = Matrix3d::Zero();
  Matrix3d Cq_y = Matrix3d::Zero();  ///< column after column G^T q
  Map9 G = Map9::Zero();
  Map9 tG = Map9::Zero();

  void add(double t, double weight, const Vector3d& y, const Matrix3d& C, const Vector3d& value) {
    const Vector3d wy = weight * y;
    ++scans;
    last = t;
    w += weight;
    wt += weight * t;
    wtt += weight * t * t;
    qq += weight * value.squaredNorm();
    q += weight * value;
    tq += weight * t * value;
    yy += wy * y.transpose();
    Cq_y += (C.transpose() * value) * wy.transpose();
    for (int k = 0; k < 3; ++k) {
      const Matrix3d part = wy[k] * C;
      G.block<3, 3>(0, 3 * k) += part;
      tG.block<3, 3>(0, 3 * k) += t * part;
    }
  }

  /// Less the lines over t, as normal equations: with N the inverse of [w, wt; wt, wtt], the
  /// products of the lines of a and b are [sum a, sum ta]^T N [sum b, sum tb].
  Agreement less_lines() const {
    Agreement out;
    const double det = w * wtt - wt * wt;
    const Map9 start = (wtt * G - wt * tG) / det;
    const Map9 slope = (w * tG - wt * G) / det;
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) {
        out.A.block<3, 3>(3 * j, 3 * k).diagonal().setConstant(yy(j, k));
      }
    }
    out.A -= G.transpose() * start + tG.transpose() * slope;
    out.b = Eigen::Map<const Eigen::Matrix<double, 9, 1>>(Cq_y.data());
    out.b -= start.transpose() * q + slope.transpose() * tq;
    out.c = qq - (q.dot(wtt * q - wt * tq) + tq.dot(w * tq - wt * q)) / det;
    out.weight = w;
    out.scans = scans;
    return out;
  }
};

Eigen::Matrix<double, 9, 1> flat(const Matrix3d& R) {
  return Eigen::Map<const Eigen::Matrix<double, 9, 1>>(R.data());  // column after column
}

constexpr double kModels = 0.1;  // what the noise model does not know of a good scan [m/s]

/// Whether the velocity is like those around it; a wrong fold, or somebody who passes by, is not.
bool is_alike(const std::vector<RadarSpeed>& speeds, std::size_t k) {
  constexpr double kAround = 0.25;  // [s]
  constexpr double kNoise = 0.3;    // [m/s]
  constexpr std::size_t kMost = 8;  // on each side
  std::array<std::vector<double>, 3> around;
  const std::size_t end = std::min(speeds.size(), k + kMost + 1);
  for (std::size_t i = k - std::min(k, kMost); i < end; ++i) {
    if (i == k || std::abs(to_seconds(speeds[i].time - speeds[k].time)) > kAround) continue;
    for (int axis = 0; axis < 3; ++axis) {
      around[static_cast<std::size_t>(axis)].push_back(speeds[i].v_S[axis]);
    }
  }
  if (around[0].size() < 3) return false;
  const Vector3d middle(median(around[0]), median(around[1]), median(around[2]));
  const double sigma = kModels * std::sqrt(1.0 / speeds[k].weight - 1.0);
  return (speeds[k].v_S - middle).norm() < kNoise + 3.0 * sigma;
}

/// Like that of the scan before, if it is not long ago. It is one hypothesis more, and spares
/// trying all folds of every triple; the scan alone decides whether it is believed.
std::optional<RadarVelocity> as_before(const std::vector<RadarSpeed>& speeds, Time time) {
  constexpr double kLong = 0.25;         // [s]
  constexpr double kAcceleration = 2.0;  // [m/s^2]
  if (speeds.empty()) return std::nullopt;
  const double dt = to_seconds(time - speeds.back().time);
  if (dt <= 0.0 || dt > kLong) return std::nullopt;
  const double sigma = kModels + kAcceleration * dt;
  return RadarVelocity{speeds.back().v_S, Matrix3d::Identity() * sigma * sigma};
}

}  // namespace

std::vector<RadarSpeed> radar_speeds(const std::vector<RadarScan>& scans, Options options) {
  constexpr double kWeak = 1.0;  // a velocity no better than this tells nothing [m/s]
  options.radar.fov_azimuth = 7.0;
  options.radar.fov_elevation = 7.0;
  EgoVelocityRansac ransac(options.frontend, options.radar.max_doppler);
  DetectionList list;
  EgoVelocity ego;
  std::vector<RadarSpeed> all;
  for (const RadarScan& scan : scans) {
    filter_detections(scan, options.radar, options.frontend.max_detections, list);
    ransac.estimate(list, as_before(all, scan.time), &ego);
    if (!ego.valid || !ego.covariance) continue;
    const double variance = ego.covariance->trace() / 3.0;
    if (!(variance < kWeak * kWeak)) continue;
    all.push_back({scan.time, ego.v_S, kModels * kModels / (kModels * kModels + variance),
                   static_cast<double>(ego.inliers) / static_cast<double>(list.items.size())});
  }
  std::vector<RadarSpeed> out;
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (is_alike(all, k)) out.push_back(all[k]);
  }
  return out;
}

ImuPath::ImuPath(const std::vector<ImuSample>& samples, double gyro_unit, double accel_unit) {
  constexpr double kPause = 0.1;  // [s]
  Point now;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (i > 0) {
      const double dt = to_seconds(samples[i].time - samples[i - 1].time);
      const Vector3d before = now.turn * samples[i - 1].accel_B;
      now.rate = 0.5 * gyro_unit * (samples[i - 1].gyro_B + samples[i].gyro_B);
      points_.back().rate = now.rate;  // of the interval that begins there
      now.turn = (now.turn * quaternion_exp(dt * now.rate)).normalized();
      now.sum += 0.5 * dt * accel_unit * (before + now.turn * samples[i].accel_B);
      if (dt > kPause) ++now.piece;
    }
    times_.push_back(samples[i].time);
    points_.push_back(now);
  }
}

std::optional<std::size_t> ImuPath::before(Time time) const {
  if (times_.empty() || time < times_.front() || time >= times_.back()) return std::nullopt;
  const auto after = std::upper_bound(times_.begin(), times_.end(), time);
  return static_cast<std::size_t>(std::distance(times_.begin(), after)) - 1;
}

std::optional<int> ImuPath::piece_at(Time time) const {
  const auto i = before(time);
  return i ? std::optional<int>(points_[*i].piece) : std::nullopt;
}

std::optional<ImuPath::Point> ImuPath::at(Time time) const {
  const auto i = before(time);
  if (!i) return std::nullopt;
  const double dt = to_seconds(time - times_[*i]);
  Point out = points_[*i];
  out.turn = out.turn * quaternion_exp(dt * out.rate);
  const double share = dt / to_seconds(times_[*i + 1] - times_[*i]);
  out.sum += share * (points_[*i + 1].sum - out.sum);
  return out;
}

Agreement& Agreement::operator+=(const Agreement& other) {
  A += other.A;
  b += other.b;
  c += other.c;
  weight += other.weight;
  scans += other.scans;
  return *this;
}

double Agreement::cost(double a, const Matrix3d& R) const {
  const Eigen::Matrix<double, 9, 1> r = flat(R);
  return a * a * r.dot(A * r) - 2.0 * a * b.dot(r) + c;
}

double Agreement::inverse_scale(const Matrix3d& R) const {
  const Eigen::Matrix<double, 9, 1> r = flat(R);
  const double square = r.dot(A * r);
  return square > 0.0 ? std::max(0.0, b.dot(r) / square) : 0.0;
}

double Agreement::explained(const Matrix3d& R) const {
  return c > 0.0 ? 1.0 - cost(inverse_scale(R), R) / c : 0.0;
}

double Agreement::movement() const {
  // r^T A r of a rotation r, in the mean over all
  return weight > 0.0 ? std::sqrt(A.trace() / (3.0 * weight)) : 0.0;
}

double noise(const std::vector<RadarSpeed>& speeds) {
  constexpr double kNear = 0.25;  // [s]
  double sum = 0.0;
  double weight = 0.0;
  for (std::size_t k = 2; k < speeds.size(); ++k) {
    if (!(to_seconds(speeds[k].time - speeds[k - 2].time) < kNear)) continue;
    const Vector3d bend = speeds[k].v_S - 2.0 * speeds[k - 1].v_S + speeds[k - 2].v_S;
    sum += speeds[k - 1].weight * bend.squaredNorm() / 6.0;
    weight += speeds[k - 1].weight;
  }
  return weight > 0.0 ? std::sqrt(sum / weight) : 0.0;
}

Agreement total(const Agreements& windows) {
  Agreement sum;
  for (const Agreement& w : windows) sum += w;
  return sum;
}

Agreements agreements(const std::vector<RadarSpeed>& speeds, const ImuPath& path,
                      const Vector3d& lever_B, double shift) {
  constexpr double kLength = 2.0;    // [s]
  constexpr int kFewest = 8;         // beside the six unknowns of v_0 and g
  constexpr double kShortest = 1.0;  // [s]
  Agreements out;
  Sums sums;
  Time begin{0};
  Vector3d first_sum = Vector3d::Zero();
  int piece = 0;
  const auto close = [&] {
    if (sums.scans >= kFewest && sums.last >= kShortest) out.push_back(sums.less_lines());
    sums = Sums();
  };
  for (const RadarSpeed& speed : speeds) {
    const auto first = path.piece_at(speed.time - from_seconds(kMostShift));
    const auto last = path.piece_at(speed.time + from_seconds(kMostShift));
    if (!first || !last || *first != *last) continue;
    const double since = to_seconds(speed.time - begin);
    if (sums.scans > 0 && (since > kLength || since < 0.0 || *first != piece)) close();
    const ImuPath::Point p = *path.at(speed.time + from_seconds(shift));
    if (sums.scans == 0) {
      begin = speed.time;
      first_sum = p.sum;
    }
    piece = *first;
    const Matrix3d C = p.turn.toRotationMatrix();
    sums.add(to_seconds(speed.time - begin), speed.weight, speed.v_S, C,
             p.sum - first_sum + C * p.rate.cross(lever_B));
  }
  close();
  return out;
}

double significance(double worse, double better, std::size_t windows) {
  constexpr double kNoBetter = 1e-3;  // no recording agrees more exactly
  const double gain = std::max(0.0, better - worse);
  return std::sqrt(3.0 * static_cast<double>(windows) * gain / std::max(kNoBetter, 1.0 - better));
}

}  // namespace rio::check
