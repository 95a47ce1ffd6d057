// SPDX-License-Identifier: BSD-3-Clause
#include "check/imu_path.hpp"

#include <algorithm>
#include <iterator>

#include "rio/core/so3.hpp"

namespace rio::check {

void ImuPath::advance(std::size_t i, Point* now) const {
  constexpr double kPause = 0.1;  // [s]
  const ImuSample& last = samples_[i - 1];
  const ImuSample& sample = samples_[i];
  const double dt = to_seconds(sample.time - last.time);
  const Vector3d before = now->turn * last.accel_B;
  now->rate = 0.5 * (gyro_unit_ * (last.gyro_B + sample.gyro_B));
  now->turn = (now->turn * quaternion_exp(dt * now->rate)).normalized();
  now->sum += 0.5 * dt * accel_unit_ * (before + now->turn * sample.accel_B);
  if (dt > kPause) ++now->piece;
}

const std::vector<ImuPath::Point>& ImuPath::part(std::size_t k) const {
  Part& out = parts_[k % kParts];
  if (out.k == k) return out.points;
  if (marks_.empty()) marks_.emplace_back();
  for (std::size_t from = std::min(k, marks_.size() - 1); from <= k; ++from) {
    Part& now = parts_[from % kParts];
    const std::size_t begin = from * kPart;
    const std::size_t end = std::min(begin + kPart, samples_.size() - 1);
    now.k = from;
    now.points.assign(1, marks_[from]);
    for (std::size_t i = begin + 1; i <= end; ++i) {
      Point next = now.points.back();
      advance(i, &next);
      now.points.back().rate = next.rate;  // of the interval that begins here
      now.points.push_back(next);
    }
    if (marks_.size() == from + 1) marks_.push_back(now.points.back());
  }
  return out.points;
}

std::optional<ImuPath::Point> ImuPath::at(Time time) const {
  if (samples_.empty() || time < samples_.front().time || time >= samples_.back().time) {
    return std::nullopt;
  }
  const auto after = std::ranges::upper_bound(samples_, time, {}, &ImuSample::time);
  const ImuSample& before = *std::prev(after);
  const auto i = static_cast<std::size_t>(std::distance(samples_.begin(), after)) - 1;
  const double dt = to_seconds(time - before.time);
  const std::vector<Point>& points = part(i / kPart);
  Point out = points[i % kPart];
  out.turn = out.turn * quaternion_exp(dt * out.rate);
  const double share = dt / to_seconds(after->time - before.time);
  out.sum += share * (points[i % kPart + 1].sum - out.sum);
  return out;
}

}  // namespace rio::check
