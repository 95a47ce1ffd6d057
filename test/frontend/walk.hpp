// SPDX-License-Identifier: BSD-3-Clause
// A noise-free walk through points for the front-end tests, with a projection of its own.
#pragma once

#include <vector>

#include "rio/frontend/frontend.hpp"
#include "support/random_state.hpp"

namespace rio::test {

using Points = std::vector<Vector3d>;

// A room seen by a radar that moves; plays the back-end: clones every scan, keeps the landmarks.
class Walk {
 public:
  explicit Walk(const Options& options) : options_(options), frontend_(options) {
    x_.T_BS.rotation = rotation_of(Vector3d(0.1, 0.7, -0.3));
    x_.T_BS.translation = Vector3d(0.2, -0.1, 0.05);
  }

  Estimate& estimate() { return x_; }
  Frontend& frontend() { return frontend_; }
  const Observations& seen() const { return seen_; }
  const Promotions& promotions() const { return promotions_; }
  ScanId scans() const { return id_; }

  // A step of 0.6 m and 0.1 rad: in the radar frame most points of kRoom move by more than the
  // gate. The velocity need not fit the step; each scan only has to agree with itself.
  void move() {
    const Vector3d turn(0.02, -0.03, 0.1);
    x_.nav.q_WB = x_.nav.q_WB * rotation_of(turn);
    x_.nav.v_WB = Vector3d(1.5, 1.0, -0.5);
    x_.nav.p_WB += Vector3d(0.5, 0.3, -0.2);
    x_.nav.gyro_bias = Vector3d(0.01, 0.02, -0.01);
    x_.gyro_B = x_.nav.gyro_bias + turn / 0.1;
  }

  // Static world points as this scan sees them, by the geometry of a lever arm on a rigid body.
  DetectionList scan(const Points& world) const {
    const Quaternion q_WS = x_.nav.q_WB * x_.T_BS.rotation;
    const Vector3d p_WS = x_.nav.p_WB + x_.nav.q_WB * x_.T_BS.translation;
    const Vector3d w_W = x_.nav.q_WB * (x_.gyro_B - x_.nav.gyro_bias);
    const Vector3d v_WS = x_.nav.v_WB + w_W.cross(x_.nav.q_WB * x_.T_BS.translation);
    DetectionList out;
    for (const Vector3d& p_W : world) {
      const double rate = -(p_W - p_WS).normalized().dot(v_WS);
      out.items.push_back(make_detection({q_WS.conjugate() * (p_W - p_WS), rate}, options_.radar));
    }
    return out;
  }

  void observe(const DetectionList& scan) {
    current_ = scan;
    frontend_.observe(current_, x_, &seen_);
  }
  void advance(std::size_t room = 0) {
    frontend_.advance(seen_, id_, room, &promotions_);
    const auto max_clones = static_cast<std::size_t>(options_.update.max_clones);
    if (x_.clones.size() == max_clones) x_.clones.erase(0);
    x_.clones.push_back({id_, x_.T_WB()});
    ++id_;
  }
  void step(const Points& world, std::size_t room = 0) {
    move();
    observe(scan(world));
    advance(room);
  }

 private:
  Options options_;
  Frontend frontend_;
  Estimate x_;
  DetectionList current_;
  Observations seen_;
  Promotions promotions_;
  ScanId id_ = 0;
};

// All around, metres apart: no two within the gate, no plane through the radar.
inline const Points kRoom = {{4.0, 0.5, 0.3},   {3.0, 3.0, 1.5},   {-1.0, 4.0, -0.5},
                             {2.0, -4.0, 1.0},  {-4.0, 1.0, 2.0},  {0.5, 1.0, -3.0},
                             {6.0, -2.0, -1.0}, {-2.0, -3.5, -1.5}};

inline Options options_with(int promote_after, int max_clones) {
  Options o;
  o.frontend.matching = Matching::kEuclidean;
  o.frontend.promote_after = promote_after;
  o.update.max_clones = max_clones;
  return o;
}

}  // namespace rio::test
