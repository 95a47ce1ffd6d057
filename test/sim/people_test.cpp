// SPDX-License-Identifier: BSD-3-Clause
// People who walk about: exact velocities, plausible gait, and what the radar makes of them.
#include "rio/sim/people.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "sim/radar_cases.hpp"
#include "support/short_flight.hpp"

namespace rio::sim {
namespace {

Person person(std::uint64_t seed, int index) {
  const Room room = empty_room();
  return {seed, index, room.low_W, room.high_W};
}

TEST(Person, VelocityIsTheDerivativeOfThePosition) {
  constexpr double kStep = 1e-4;
  double turning = 0.0;
  for (int index = 0; index < 3; ++index) {
    Person walker = person(5, index);
    for (double t = 0.05; t < 60.0; t += 0.0371) {
      const auto before = walker.at(t - kStep);
      const auto now = walker.at(t);
      const auto after = walker.at(t + kStep);
      for (std::size_t i = 0; i < now.size(); ++i) {
        const Vector3d rate = (after[i].position_W - before[i].position_W) / (2.0 * kStep);
        // truncation: kStep^2/6 times a third derivative below 500; less where it jumps
        ASSERT_LT((now[i].velocity_W - rate).norm(), 1e-6) << t;
        if (walker.walked(t + kStep) == walker.walked(t - kStep)) {
          turning = std::max(turning, now[i].velocity_W.norm());
        }
      }
    }
  }
  EXPECT_GT(turning, 0.3);  // shoulders, while the feet stand
}

TEST(Person, WalksStandsAndStaysInTheRoom) {
  const Room room = empty_room();
  for (int index = 0; index < 4; ++index) {
    Person walker = person(6, index);
    int standing = 0;
    int walking = 0;
    double lowest = std::numeric_limits<double>::infinity();
    double highest = -lowest;
    for (double t = 0.0; t < 300.0; t += 0.1) {
      const double speed = (walker.walked(t + 1e-3) - walker.walked(t)) / 1e-3;
      ASSERT_GE(speed, 0.0);
      ASSERT_LE(speed, Person::kMaxSpeed + 1e-9);
      standing += speed == 0.0 ? 1 : 0;
      walking += speed > Person::kMinSpeed - 1e-9 ? 1 : 0;
      for (const MovingPoint& point : walker.at(t)) {
        ASSERT_TRUE((point.position_W.array() > room.low_W.array()).all()) << t;
        ASSERT_TRUE((point.position_W.array() < room.high_W.array()).all()) << t;
        lowest = std::min(lowest, point.position_W.z() - room.low_W.z());
        highest = std::max(highest, point.position_W.z() - room.low_W.z());
      }
    }
    EXPECT_GT(standing, 300);  // a tenth of the time
    EXPECT_GT(walking, 1200);
    EXPECT_LT(lowest, 0.3);
    EXPECT_GT(highest, 1.55);
    EXPECT_LE(highest, Person::kHeight);
  }
}

TEST(Person, LimbsSwingAboutTheTorsoOnceAStride) {
  Person walker = person(7, 0);
  double fastest = 0.0;
  double widest = 0.0;
  for (double t = 0.0; t < 60.0; t += 0.05) {
    const auto now = walker.at(t);
    if (walker.walked(t + 0.01) == walker.walked(t)) continue;
    const auto at_way = [&](double way) {
      double later = t;
      while (walker.walked(later) < walker.walked(t) + way) later += 1e-3;
      return walker.at(later);
    };
    const auto half = at_way(0.5 * Person::kStride);
    const auto full = at_way(Person::kStride);
    for (std::size_t i = 1; i < now.size(); ++i) {  // the first belongs to the torso
      const auto from_torso = [&](const std::vector<MovingPoint>& points) {
        return (points[i].position_W - points[0].position_W).norm();
      };
      fastest = std::max(fastest, (now[i].velocity_W - now[0].velocity_W).norm());
      widest = std::max(widest, std::abs(from_torso(half) - from_torso(now)));
      // within a millisecond a limb gets 1.5 mm further
      ASSERT_NEAR(from_torso(full), from_torso(now), 2e-3);
    }
  }
  EXPECT_GT(widest, 0.02);
  EXPECT_GT(fastest, 0.6);
  EXPECT_LT(fastest, 1.5);
}

TEST(Person, DoesNotDependOnWhenItIsLookedAt) {
  Person once = person(8, 1);
  Person often = person(8, 1);
  for (double t = 0.0; t < 50.0; t += 0.3) often.at(t);
  const auto a = once.at(37.0);
  const auto b = often.at(37.0);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].position_W, b[i].position_W);
  EXPECT_NE(person(8, 2).at(37.0)[0].position_W, a[0].position_W);
  EXPECT_NE(person(9, 1).at(37.0)[0].position_W, a[0].position_W);
}

TEST(RadarPeople, RangeRateIsTheDerivativeOfTheRangeInFlight) {
  RadarModel model = with_lever(noise_free());
  model.people = 4;
  std::vector<Person> people;
  for (int i = 0; i < model.people; ++i) people.push_back(person(6, i));
  // the centre of the person that is nearest to the detection
  const auto centre_W = [&](const FlownDetection& d, double t, const Vector3d&) {
    Person& who = people.at(static_cast<std::size_t>(d.reflector));
    const Vector3d seen_W = in_world(d.point_S, d.body.nav, model);
    const auto off = [&](const MovingPoint& p) { return (p.position_W - seen_W).norm(); };
    const auto then = who.at(d.seconds - kCheckedFrom);
    const auto nearest = std::min_element(
        then.begin(), then.end(), [&](const auto& a, const auto& b) { return off(a) < off(b); });
    return who.at(t - kCheckedFrom)[static_cast<std::size_t>(nearest - then.begin())].position_W;
  };
  const auto detections = with_true_range_rates(model, empty_room(), centre_W);
  double largest_excess = 0.0;
  for (const FlownDetection& d : detections) {
    ASSERT_EQ(d.cause, Cause::kPerson);
    const double if_static = -d.point_S.normalized().dot(radar_velocity_S(d.body, model));
    largest_excess = std::max(largest_excess, std::abs(d.range_rate - if_static));
  }
  EXPECT_GT(detections.size(), 1000U);
  EXPECT_GT(largest_excess, 1.0);
}

TEST(RadarPeople, DoNotCountAsStaticAndObeyTheThreshold) {
  RadarModel model = noise_free();
  model.people = 8;
  model.fov_azimuth = model.fov_elevation = 170.0 * kDegree;
  model.max_static = 0;
  const auto count = [&] {
    RadarSimulator radar(model, make_room(2), 2);
    const LabeledScan result = radar.scan(Trajectory::Point{});
    for (const Label& label : result.labels) EXPECT_EQ(label.cause, Cause::kPerson);
    return result.labels.size();
  };
  EXPECT_GT(count(), 20U);
  model.person_rcs_dbsm = -80.0;
  EXPECT_EQ(count(), 0U);
}

TEST(RadarPeople, GiveFourTenthsOfTheDetectionsOfTheirScenario) {
  Scenario chosen = test::scenario_named("people");
  double people = 0.0;
  double all = 0.0;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U, 6U}) {
    chosen.seed = seed;
    for (const auto& labels : simulate_flight(chosen).labels) {
      for (const Label& label : labels) people += label.cause == Cause::kPerson ? 1.0 : 0.0;
      all += static_cast<double>(labels.size());
    }
  }
  RecordProperty("share", std::to_string(people / all));
  EXPECT_NEAR(people / all, 0.4, 0.05);
}

TEST(RadarScenarios, SparseScansHoldThreeToEightPoints) {
  Scenario chosen = test::scenario_named("sparse");
  double outside = 0.0;
  double all = 0.0;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    chosen.seed = seed;
    for (const RadarScan& scan : simulate_flight(chosen).scans) {
      outside += scan.detections.size() < 3 || scan.detections.size() > 8 ? 1.0 : 0.0;
      all += 1.0;
    }
  }
  EXPECT_LT(outside / all, 0.005);
}

TEST(RadarScenarios, OutdoorsManyPointsAreFar) {
  const Flight flight = simulate_flight(test::scenario_named("outdoor"));
  double far = 0.0;
  double all = 0.0;
  for (const RadarScan& scan : flight.scans) {
    for (const RadarDetection& detection : scan.detections) {
      far += detection.point_S.norm() > 15.0 ? 1.0 : 0.0;
      all += 1.0;
    }
  }
  EXPECT_GT(far / all, 0.15);
  const double per_scan = all / static_cast<double>(flight.scans.size());
  EXPECT_GT(per_scan, 15.0);
  EXPECT_LT(per_scan, 40.0);
}

}  // namespace
}  // namespace rio::sim
