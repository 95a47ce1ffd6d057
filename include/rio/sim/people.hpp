// SPDX-License-Identifier: BSD-3-Clause
// Somebody who walks about in a room: position and velocity of a cloud of scattering centres as
// exact functions of time. Frame W, metres, seconds.
//
// A walk is straight from one way point to the next; between walks the person stands and turns.
// (E1) S(u) = 3 u^2 - 2 u^3, its integral I(u) = u^3 - u^4/2: every change of speed;
//      Q(u) = 10 u^3 - 15 u^4 + 6 u^5: every change of heading
// (E2) walked way while speeding up for T_r: v T_r I(t/T_r), speed v S(t/T_r); slowing down mirrors
// (E3) point = torso + Rz(heading) (a + A sin(2 pi way / stride) e_x), A = 0 but for the limbs
// (E4) velocity = v_torso + heading_rate e_z x (Rz (..)) + Rz e_x A (2 pi / stride) speed cos(..)
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
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

  /// @param low_W, high_W corners of the room [m]; the person stays clear of its walls
  Person(std::uint64_t seed, int index, const Vector3d& low_W, const Vector3d& high_W)
      : random_(seed, 6 + 100 * static_cast<std::uint64_t>(index)), low_W_(low_W), high_W_(high_W) {
    from_W_ = way_point();
    heading_ = random_.uniform(-std::numbers::pi, std::numbers::pi);
    for (int i = 0; i < kCentres; ++i) centres_.push_back(centre(i));
  }

  /// The centres `seconds` after the first scan, always in the same order; stands before that.
  std::vector<MovingPoint> at(double seconds) {
    const Motion torso = motion(seconds);
    const double phase = 2.0 * std::numbers::pi * torso.way / kStride;
    const double phase_rate = 2.0 * std::numbers::pi * torso.speed / kStride;
    const Vector3d ahead(std::cos(torso.heading), std::sin(torso.heading), 0.0);
    const Vector3d left(-ahead.y(), ahead.x(), 0.0);
    const Vector3d turn(0.0, 0.0, torso.heading_rate);
    std::vector<MovingPoint> points;
    for (const Centre& c : centres_) {
      const double forward = c.offset.x() + c.swing * std::sin(phase);
      const Vector3d arm = forward * ahead + c.offset.y() * left + c.offset.z() * Vector3d::UnitZ();
      const double stroke = c.swing * phase_rate * std::cos(phase);
      points.push_back({torso.feet_W + arm,  // (E3), (E4)
                        (torso.speed + stroke) * ahead + turn.cross(arm)});
    }
    return points;
  }

  /// Way walked since the first scan [m].
  double walked(double seconds) { return motion(seconds).way; }
  /// Cross section of a centre relative to the mean of all [dB].
  double rcs_db(std::size_t centre) const { return centres_[centre].rcs_db; }

 private:
  static constexpr double kRampTime = 0.6;  // T_r of (E2) [s]

  /// Where a centre sits on the body, forward, left, up from between the feet.
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
    double way;  ///< walked before [m]
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

  Vector3d way_point() {
    constexpr double kAside = 0.4;  // half a shoulder width and some air [m]
    const Vector3d margin(kAside, kAside, 0.0);
    Vector3d point = random_.in_box(low_W_ + margin, high_W_ - margin);
    point.z() = low_W_.z();
    return point;
  }

  /// A limb swings the more, the further from its joint; arms go against the legs.
  Centre centre(int index) {
    constexpr int kTorso = 12;
    constexpr int kHead = kTorso + 2;
    constexpr int kArms = kHead + 6;
    constexpr double kHip = 0.9;  // [m]
    constexpr double kShoulder = 1.4;
    constexpr double kFootSwing = 0.18;  // 0.94 m/s against the torso at 1 m/s
    constexpr double kHandSwing = 0.12;
    constexpr double kRcsSigma = 4.0;  // [dB]
    const double side = index % 2 == 0 ? 1.0 : -1.0;
    const double depth = 0.1 * random_.uniform(-1.0, 1.0);
    Centre c{.offset = {depth, 0.0, 0.0}, .swing = 0.0, .rcs_db = kRcsSigma * random_.normal()};
    const double u = random_.uniform();
    if (index < kTorso) {
      c.offset.tail<2>() << 0.2 * random_.uniform(-1.0, 1.0), kHip + u * (1.5 - kHip);
    } else if (index < kHead) {
      c.offset.tail<2>() << 0.05 * side, 1.55 + u * (kHeight - 1.55);
    } else if (index < kArms) {
      c.offset.tail<2>() << 0.27 * side, kShoulder - 0.6 * u;
      c.swing = -side * kHandSwing * u;
    } else {
      c.offset.tail<2>() << 0.1 * side, kHip * (1.0 - u);
      c.swing = side * kFootSwing * u;
    }
    return c;
  }

  /// Legs are drawn one after the other, so that the walk does not depend on when it is looked at.
  void plan(double seconds) {
    constexpr double kStandShare = 0.25;  // of the pauses are long
    constexpr double kTurnTime = 0.6;     // [s/rad]: a turn on the spot peaks at 3.1 rad/s
    while (legs_.empty() || legs_.back().end() <= seconds) {
      const Vector3d to_W = way_point();
      const Vector3d way = to_W - from_W_;
      const bool stands = random_.uniform() < kStandShare;
      Leg leg{.begin = legs_.empty() ? 0.0 : legs_.back().end(),
              .pause = stands ? random_.uniform(2.0, 6.0) : random_.uniform(0.6, 1.2),
              .walk = 0.0,
              .speed = random_.uniform(kMinSpeed, kMaxSpeed),
              .length = way.norm(),
              .way = legs_.empty() ? 0.0 : legs_.back().way + legs_.back().length,
              .heading = heading_,
              .turn = 0.0,
              .from_W = from_W_};
      leg.speed = std::min(leg.speed, leg.length / kRampTime);  // so that the ramps fit
      leg.walk = leg.length / leg.speed + kRampTime;
      leg.turn = std::remainder(std::atan2(way.y(), way.x()) - heading_, 2.0 * std::numbers::pi);
      leg.pause = std::max(leg.pause, kTurnTime * std::abs(leg.turn));
      heading_ += leg.turn;
      from_W_ = to_W;
      legs_.push_back(leg);
    }
  }

  Motion motion(double seconds) {
    plan(seconds);
    const auto after = std::upper_bound(legs_.begin() + 1, legs_.end(), seconds,
                                        [](double t, const Leg& leg) { return t < leg.begin; });
    const Leg& leg = *(after - 1);
    const double u = std::clamp((seconds - leg.begin) / leg.pause, 0.0, 1.0);
    const double t = std::clamp(seconds - leg.begin - leg.pause, 0.0, leg.walk);
    const double to_end = leg.walk - t;
    double way = leg.speed * (t - 0.5 * kRampTime);
    double speed = leg.speed;
    if (t < kRampTime) {  // (E2)
      way = leg.speed * kRampTime * smooth_integral(t / kRampTime);
      speed = leg.speed * smooth(t / kRampTime);
    } else if (to_end < kRampTime) {
      way = leg.length - leg.speed * kRampTime * smooth_integral(to_end / kRampTime);
      speed = leg.speed * smooth(to_end / kRampTime);
    }
    const double course = leg.heading + leg.turn;
    return {.feet_W = leg.from_W + way * Vector3d(std::cos(course), std::sin(course), 0.0),
            .heading = leg.heading + leg.turn * turned(u),
            .heading_rate = leg.turn * turn_rate(u) / leg.pause,
            .way = leg.way + way,
            .speed = speed};
  }

  Random random_;
  Vector3d low_W_;
  Vector3d high_W_;
  Vector3d from_W_;
  double heading_ = 0.0;
  std::vector<Centre> centres_;
  std::vector<Leg> legs_;
};

}  // namespace rio::sim
