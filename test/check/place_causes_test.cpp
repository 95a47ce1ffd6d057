// SPDX-License-Identifier: BSD-3-Clause
// Delays of the radar, and places and units of its points: the cause is named, with its size.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "check/check_it.hpp"
#include "check/motion.hpp"
#include "rio/core/so3.hpp"

namespace rio::test {
namespace {

TEST(DelayCauses, ADelayHasOneProposal) {
  io::Dataset dataset = flight();
  delay_scans(&dataset, 0.066);
  const Finding finding = said(dataset, "delay of the radar");
  EXPECT_TRUE(finding.change.starts_with("radar: {time_offset: 0.0")) << finding.change;
  EXPECT_FALSE(contains(finding.change, "--radar-offset")) << finding.change;
  delay_scans(&dataset, 0.24);  // longer than those that are tested first
  expect(said(dataset, "delay of the radar"), Verdict::kWrong, "moved by -0.3", "--radar-offset");
  for (const double delay : {0.41, 0.73, 2.112, 4.53, -1.01, -6.37, -9.1}) {
    io::Dataset late = flight();
    delay_scans(&late, delay);
    const Finding far = said(late, "delay of the radar");
    EXPECT_NEAR(std::atof(far.change.substr(far.change.find('"') + 1).c_str()), -delay,
                0.007)  // steps of the search: 0.02
        << far.change;
  }
}

TEST(DelayCauses, TheNoiseOfASlowRadarIsNoDelay) {
  sim::Scenario scenario;
  scenario.path.length = 200.0;
  scenario.path.ground = true;
  scenario.radar.T_BS = {quaternion_exp(Vector3d(0.0, 0.25 * kHalfTurn, 0.0)), {0.4, 0.0, 0.3}};
  expect_ok(flown(scenario));
}

/// As a driver gives them in the frame of the vehicle.
TEST(PointsCauses, PointsThatAreNotCountedFromTheRadarAreNamed) {
  const Vector3d place(1.2, 0.0, 0.5);
  io::Dataset dataset = flight();
  EXPECT_EQ(find(check_it(dataset), "origin of the points"), nullptr);
  each_detection(&dataset, [&place](RadarDetection& d) { d.point_S += place; });
  const Finding finding = said(dataset, "origin of the points");
  Vector3d found;
  const std::string key = "from the place (";
  const char* at = finding.text.c_str() + finding.text.find(key) + key.size();
  ASSERT_EQ(std::sscanf(at, "%lf %lf %lf", &found.x(), &found.y(), &found.z()), 3) << finding.text;
  EXPECT_LT((found - place).norm(), 0.5) << finding.text;
  expect(finding, Verdict::kDoubtful, "frame of the vehicle", "in the frame of the radar");
}

TEST(PointsCauses, PointsInAnotherUnitAreNotSaidToMove) {
  io::Dataset dataset = flight();
  each_detection(&dataset, [](RadarDetection& d) { d.point_S *= 100.0; });
  const Findings findings = check_it(dataset);
  EXPECT_EQ(said(findings, "distances").verdict, Verdict::kWrong);
  EXPECT_EQ(find(findings, "points"), nullptr) << text_of(findings);
}

}  // namespace
}  // namespace rio::test
