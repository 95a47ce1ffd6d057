// SPDX-License-Identifier: BSD-3-Clause
// A person walking in a room: position and velocity of a cloud of scattering centres as exact
// functions of time. Frame W, metres, seconds.
//
// A walk is straight from one way point to the next; between walks the person stands and turns.
// (E1) S(u) = 3 u^2 - 2 u^3, its integral I(u) = u^3 - u^4/2: every change of speed;
//      Q(u) = 10 u^3 - 15 u^4 + 6 u^5: every change of heading
// (E2) distance walked while accelerating for T_r: v T_r I(t/T_r), speed v S(t/T_r); slowing down
//      mirrors it
// (E3) point = torso + Rz(heading) (a + A sin(2 pi way / stride) e_x), A = 0 but for the limbs
// (E4) velocity = v_torso + heading_rate e_z x (Rz (..)) + Rz e_x A (2 pi / stride) speed cos(..)
#pragma once

#include <cstdint>
#include <vector>

#include "rio/sim/random.hpp"
#include "rio/types.hpp"

namespace rio::sim {

/// A scattering centre in motion.
struct MovingPoint {
  Vector3d position_W = Vector3d::Zero();  ///< [m]
  Vector3d velocity_W = Vector3d::Zero();  ///< [m/s]
};

/// One person of a room. Different indices are different people.
class Person {
 public:
  static constexpr int kCentres = 30;       ///< torso and head 14, arms 6, legs 10
  static constexpr double kHeight = 1.75;   ///< [m]
  static constexpr double kStride = 1.2;    ///< two steps [m]: 1 Hz at 1.2 m/s
  static constexpr double kMinSpeed = 0.5;  ///< slowest walk [m/s]
  static constexpr double kMaxSpeed = 1.5;  ///< fastest walk [m/s]

  /// @param low_W, high_W corners of the room [m]; the person keeps away from its walls
  Person(std::uint64_t seed, int index, const Vector3d& low_W, const Vector3d& high_W);

  /// The centres `seconds` after the first scan, always in the same order; standing before that.
  std::vector<MovingPoint> at(double seconds);

  /// Distance walked since the first scan [m].
  double walked(double seconds) { return motion(seconds).way; }
  /// Cross section of a centre relative to the mean of all [dB].
  double rcs_db(std::size_t centre) const { return centres_[centre].rcs_db; }

 private:
  static constexpr double kRampTime = 0.6;  // T_r of (E2) [s]

  /// Position of a centre on the body, forward, left, up from between the feet.
  struct Centre {
    Vector3d offset;
    double swing;  ///< A of (E3) [m]
    double rcs_db;
  };
  /// A pause in which the person turns, and the walk after it.
  struct Leg {
    double begin;  ///< of the pause [s]
    double pause;  ///< [s]
    double walk;   ///< [s]
    double speed;  ///< [m/s]
    double length;
    double way;  ///< distance walked before [m]
    double heading;
    double turn;  ///< change of heading during the pause [rad]
    Vector3d from_W;

    double end() const { return begin + pause + walk; }
  };
  struct Motion {
    Vector3d feet_W;
    double heading;
    double heading_rate;
    double way;
    double speed;
  };

  static double smooth(double u) { return u * u * (3.0 - 2.0 * u); }               // S
  static double smooth_integral(double u) { return u * u * u * (1.0 - 0.5 * u); }  // I

  static double turned(double u) { return u * u * u * (10.0 - u * (15.0 - 6.0 * u)); }  // Q
  static double turn_rate(double u) { return 30.0 * u * u * (1.0 - u) * (1.0 - u); }    // dQ/du

  Vector3d way_point();

  /// A limb swings more, the further from its joint; arms move against the legs.
  Centre centre(int index);

  /// Legs are drawn in order, so that the walk does not depend on when it is evaluated.
  void plan(double seconds);

  Motion motion(double seconds);

  Random random_;
  Vector3d low_W_;
  Vector3d high_W_;
  Vector3d from_W_;
  double heading_ = 0.0;
  std::vector<Centre> centres_;
  std::vector<Leg> legs_;
};

}  // namespace rio::sim
