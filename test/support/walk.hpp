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
  explicit Walk(const Options& options);

  Estimate& estimate() { return x_; }
  Frontend& frontend() { return frontend_; }
  const Observations& seen() const { return seen_; }
  const Promotions& promotions() const { return promotions_; }
  ScanId scans() const { return id_; }

  // A step of 0.6 m and 0.1 rad: in the radar frame most points of kRoom move by more than the
  // gate. The velocity need not fit the step; each scan only has to agree with itself.
  void move();

  // Static world points as this scan sees them, by the geometry of a lever arm on a rigid body.
  DetectionList scan(const Points& world) const;

  void observe(const DetectionList& scan) {
    current_ = scan;
    frontend_.observe(current_, x_, &seen_);
  }
  void advance(std::size_t room = 0);
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
