// SPDX-License-Identifier: BSD-3-Clause
#include "check/motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "check/numbers.hpp"
#include "rio/core/so3.hpp"
#include "rio/frontend/detection.hpp"
#include "rio/frontend/ego_velocity.hpp"

namespace rio::check {

namespace {

using Map9 = Eigen::Matrix<double, 3, 9>;

/// A scan within a window.
struct Entry {
  double t = 0.0;  ///< since the window's first scan [s]
  double weight = 0.0;
  Map9 G = Map9::Zero();
  Vector3d q = Vector3d::Zero();
};

/// Takes the line over t out of one quantity of all entries; `get` gives a reference to it.
template <typename Get>
void remove_line(std::vector<Entry>* entries, const Get& get) {
  double w = 0.0;
  double wt = 0.0;
  double wtt = 0.0;
  using Value = std::decay_t<decltype(get(entries->front()))>;
  Value y = Value::Zero();
  Value ty = Value::Zero();
  for (Entry& e : *entries) {
    w += e.weight;
    wt += e.weight * e.t;
    wtt += e.weight * e.t * e.t;
    y += e.weight * get(e);
    ty += e.weight * e.t * get(e);
  }
  const double det = w * wtt - wt * wt;
  const Value slope = (w * ty - wt * y) / det;
  const Value start = (wtt * y - wt * ty) / det;
  for (Entry& e : *entries) get(e) -= start + e.t * slope;
}

Agreement sum_up(std::vector<Entry>* entries) {
  Agreement out;
  constexpr std::size_t kFewest = 8;  // beside the six unknowns of v_0 and g
  constexpr double kShortest = 1.0;   // [s]
  if (entries->size() < kFewest || entries->back().t < kShortest) return out;
  remove_line(entries, [](Entry& e) -> Map9& { return e.G; });
  remove_line(entries, [](Entry& e) -> Vector3d& { return e.q; });
  for (const Entry& e : *entries) {
    out.A += e.weight * e.G.transpose() * e.G;
    out.b += e.weight * e.G.transpose() * e.q;
    out.c += e.weight * e.q.squaredNorm();
  }
  out.scans = static_cast<int>(entries->size());
  return out;
}

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
    ransac.estimate(list, std::nullopt, &ego);
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

std::optional<ImuPath::Point> ImuPath::at(Time time) const {
  if (times_.empty() || time < times_.front() || time >= times_.back()) return std::nullopt;
  const auto after = std::upper_bound(times_.begin(), times_.end(), time);
  const auto i = static_cast<std::size_t>(std::distance(times_.begin(), after)) - 1;
  const double dt = to_seconds(time - times_[i]);
  Point out = points_[i];
  out.turn = out.turn * quaternion_exp(dt * out.rate);
  const double share = dt / to_seconds(times_[i + 1] - times_[i]);
  out.sum += share * (points_[i + 1].sum - out.sum);
  return out;
}

Agreement& Agreement::operator+=(const Agreement& other) {
  A += other.A;
  b += other.b;
  c += other.c;
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

Agreement total(const Agreements& windows) {
  Agreement sum;
  for (const Agreement& w : windows) sum += w;
  return sum;
}

Agreements agreements(const std::vector<RadarSpeed>& speeds, const ImuPath& path,
                      const Vector3d& lever_B, double shift) {
  constexpr double kLength = 2.0;  // [s]
  Agreements out;
  std::vector<Entry> entries;
  Time begin{0};
  int piece = 0;
  const auto close = [&] {
    const Agreement window = sum_up(&entries);
    if (window.scans > 0) out.push_back(window);
    entries.clear();
  };
  for (const RadarSpeed& speed : speeds) {
    const auto first = path.at(speed.time - from_seconds(kMostShift));
    const auto last = path.at(speed.time + from_seconds(kMostShift));
    if (!first || !last || first->piece != last->piece) continue;
    const double since = to_seconds(speed.time - begin);
    if (!entries.empty() && (since > kLength || since < 0.0 || first->piece != piece)) close();
    if (entries.empty()) begin = speed.time;
    piece = first->piece;
    const ImuPath::Point p = *path.at(speed.time + from_seconds(shift));
    const Matrix3d C = p.turn.toRotationMatrix();
    Entry e;
    e.t = to_seconds(speed.time - begin);
    e.weight = speed.weight;
    for (int k = 0; k < 3; ++k) e.G.block<3, 3>(0, 3 * k) = speed.v_S[k] * C;
    e.q = p.sum + C * p.rate.cross(lever_B);
    entries.push_back(e);
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
