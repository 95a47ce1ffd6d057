// SPDX-License-Identifier: BSD-3-Clause
#include "support/walk.hpp"

namespace rio::test {

Walk::Walk(const Options& options) : options_(options), frontend_(options) {
  x_.T_BS.rotation = rotation_of(Vector3d(0.1, 0.7, -0.3));
  x_.T_BS.translation = Vector3d(0.2, -0.1, 0.05);
}

void Walk::move() {
  const Vector3d turn(0.02, -0.03, 0.1);
  x_.nav.q_WB = x_.nav.q_WB * rotation_of(turn);
  x_.nav.v_WB = Vector3d(1.5, 1.0, -0.5);
  x_.nav.p_WB += Vector3d(0.5, 0.3, -0.2);
  x_.nav.gyro_bias = Vector3d(0.01, 0.02, -0.01);
  x_.gyro_B = x_.nav.gyro_bias + turn / 0.1;
}

DetectionList Walk::scan(const Points& world) const {
  const Quaternion q_WS = x_.nav.q_WB * x_.T_BS.rotation;
  const Vector3d p_WS = x_.nav.p_WB + x_.nav.q_WB * x_.T_BS.translation;
  const Vector3d w_W = x_.nav.q_WB * (x_.gyro_B - x_.nav.gyro_bias);
  const Vector3d v_WS = x_.nav.v_WB + w_W.cross(x_.nav.q_WB * x_.T_BS.translation);
  DetectionList out;
  for (const Vector3d& p_W : world) {
    RadarDetection raw;
    raw.point_S = q_WS.conjugate() * (p_W - p_WS);
    raw.range_rate = -(p_W - p_WS).normalized().dot(v_WS);
    out.items.push_back(make_detection(raw, options_.radar));
  }
  return out;
}

void Walk::advance(std::size_t room) {
  frontend_.advance(seen_, id_, room, &promotions_);
  const auto max_clones = static_cast<std::size_t>(options_.update.max_clones);
  if (x_.clones.size() == max_clones) x_.clones.erase(0);
  x_.clones.push_back({id_, x_.T_WB()});
  ++id_;
}

}  // namespace rio::test
