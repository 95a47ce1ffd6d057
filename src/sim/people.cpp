// SPDX-License-Identifier: BSD-3-Clause
#include "rio/sim/people.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rio::sim {

Person::Person(std::uint64_t seed, int index, const Vector3d& low_W, const Vector3d& high_W)
    : random_(seed, 6 + 100 * static_cast<std::uint64_t>(index)), low_W_(low_W), high_W_(high_W) {
  from_W_ = way_point();
  heading_ = random_.uniform(-std::numbers::pi, std::numbers::pi);
  for (int i = 0; i < kCentres; ++i) centres_.push_back(centre(i));
}

std::vector<MovingPoint> Person::at(double seconds) {
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

Vector3d Person::way_point() {
  constexpr double kAside = 0.4;  // half a shoulder width and clearance [m]
  const Vector3d margin(kAside, kAside, 0.0);
  Vector3d point = random_.in_box(low_W_ + margin, high_W_ - margin);
  point.z() = low_W_.z();
  return point;
}

Person::Centre Person::centre(int index) {
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

void Person::plan(double seconds) {
  constexpr double kStandShare = 0.25;  // share of long pauses
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

Person::Motion Person::motion(double seconds) {
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

}  // namespace rio::sim
