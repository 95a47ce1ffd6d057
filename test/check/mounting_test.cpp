// SPDX-License-Identifier: BSD-3-Clause
// The mounting that `rio check` finds and proposes.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "check/check_it.hpp"
#include "rio/core/so3.hpp"
#include "support/measured.hpp"

namespace rio::test {
namespace {

TEST(CheckMounting, WhatItSaysToChangePutsItRight) {
  io::Dataset dataset = flown("indoor-1", 60.0);
  const Quaternion truth = dataset.radar_info.T_BS->rotation;
  turn_mounting(&dataset, {0.0, 0.0, kHalfTurn}, true);
  const std::string line = said(dataset, "axes and Doppler sign").change;
  const Quaternion q = mounting_in(line);
  EXPECT_LT(quaternion_log(truth.conjugate() * q).norm(), 1e-3) << line;
}

TEST(CheckMounting, FindsOneThatNobodyConfigured) {
  io::Dataset dataset = flight();
  Quaternion& configured = dataset.radar_info.T_BS->rotation;  // 45 deg down
  const Quaternion truth = configured;
  configured = quaternion_exp(Vector3d(0.6, -0.9, 0.4)) * truth;
  const Finding finding = said(dataset, "axes and Doppler sign");
  EXPECT_EQ(finding.verdict, Verdict::kWrong) << finding.text;
  const double off = quaternion_log(truth.conjugate() * mounting_in(finding.change)).norm();
  expect_below("mounting found at any angle, off by [deg]", off * 180.0 / kHalfTurn, 10.0);
}

TEST(CheckMounting, IsToldByFiveScansASecond) {
  io::Dataset dataset = flight();
  std::size_t i = 0;
  std::erase_if(dataset.scans, [&i](const RadarScan&) { return i++ % 3 != 0; });
  dataset.radar_info.rate_hz = 5.0;
  expect_ok(dataset);
  turn_mounting(&dataset, {0.0, 0.0, kHalfTurn}, true);
  EXPECT_EQ(said(dataset, "axes and Doppler sign").verdict, Verdict::kWrong);
}

TEST(CheckMounting, FindsOneWhoseArmNobodyMeasured) {
  sim::Scenario scenario = scenario_named("aggressive");
  scenario.path.length = 60.0;
  scenario.radar.T_BS.translation = {0.25, -0.1, 0.1};
  io::Dataset dataset = flown(scenario);
  Pose& configured = *dataset.radar_info.T_BS;
  const Quaternion truth = configured.rotation;
  configured = {quaternion_exp(Vector3d(0.6, -0.9, 0.4)) * truth, Vector3d::Zero()};
  const Finding finding = said(dataset, "axes and Doppler sign");
  const double off = quaternion_log(truth.conjugate() * mounting_in(finding.change)).norm();
  expect_below("mounting found without its arm of 0.29 m, off by [deg]", off * 180.0 / kHalfTurn,
               4.5);
}

// 17 deg from a rotation by right angles of the configured one, which stays where the data do not
// tell it from the true one.
TEST(CheckMounting, SaysHowWellTheMotionShowsIt) {
  for (const char* name : {"indoor-2", "aggressive", "people"}) {
    io::Dataset dataset = flown(name, 60.0);
    Quaternion& configured = dataset.radar_info.T_BS->rotation;
    const Quaternion truth = configured;
    const double angle = 17.0 / 180.0 * kHalfTurn;
    configured = truth * quaternion_exp(angle * Vector3d(0.6, 0.0, 0.8)) *
                 quaternion_exp(Vector3d(0.0, 0.5 * kHalfTurn, 0.0));
    const std::string change = said(dataset, "axes and Doppler sign").change;
    const double off =
        quaternion_log(truth.conjugate() * mounting_in(change)).norm() * 180.0 / kHalfTurn;
    const std::size_t at = change.find("+- ");
    ASSERT_NE(at, std::string::npos) << change;
    const double sigma = std::stod(change.substr(at + 3));
    expect_below("near a right angle, off by [sigmas]", off / sigma, 3.0);
    if (std::string(name) == "indoor-2") expect_below("fitted, off by [deg]", off, 8.0);
    EXPECT_EQ(contains(change, "calibration: {rotation_sigma: "), sigma > 2.9) << change;
  }
}

TEST(CheckMounting, FindsTheAxesOfALateRadar) {
  io::Dataset dataset = flight();
  turn_mounting(&dataset, {0.0, 0.0, kHalfTurn}, true);
  delay_scans(&dataset, 0.12);
  for (const char* subject : {"axes and Doppler sign", "delay of the radar"}) {
    EXPECT_EQ(said(dataset, subject).verdict, Verdict::kWrong) << subject;
  }
}

TEST(CheckMounting, ElevationsFromTheZenithAreNamed) {
  // a kart drives in a plane and sees six points a scan
  for (io::Dataset dataset : {flight(), flown(scenario_named("rough-ground", 4))}) {
    EXPECT_EQ(find(check_it(dataset), "elevation"), nullptr);
    each_detection(&dataset, [](RadarDetection& d) {
      const Vector3d p = d.point_S;
      d.point_S << p.z() / p.head<2>().norm() * p.head<2>(), p.head<2>().norm();
    });
    expect(said(dataset, "elevation"), Verdict::kWrong, "counted from the zenith", "90 deg less");
  }
}

TEST(CheckMounting, ALineDoesNotShowTheTurnAboutIt) {
  std::vector<sim::Trajectory::Control> path(5, sim::Trajectory::Control::Zero());
  for (int i = 0; i < 120; ++i) {
    const double step = 0.3 + 0.2 * std::sin(0.8 * i);
    path.emplace_back(path.back() + step * sim::Trajectory::Control::UnitX());
  }
  path.resize(path.size() + 4, path.back());
  const sim::Trajectory line(path, {.stand_before = 4.0, .stand_after = 2.0, .level = true});
  sim::Scenario scenario;
  scenario.radar.T_BS = {Quaternion::Identity(), {0.1, 0.0, 0.0}};
  io::Dataset dataset = flown(scenario, sim::simulate_flight(line, scenario));
  expect_ok(dataset);
  turn_mounting(&dataset, {0.0, 0.0, 0.7}, true);
  expect(said(dataset, "axes and Doppler sign"), Verdict::kWrong, "the turn about it is not shown",
         "measure the mounting");
}

}  // namespace
}  // namespace rio::test
