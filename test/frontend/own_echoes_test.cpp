// SPDX-License-Identifier: BSD-3-Clause
#include "rio/frontend/own_echoes.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <utility>

#include "support/random_state.hpp"

namespace rio {
namespace {

constexpr Time kScan = std::chrono::milliseconds(33);

/// A coarse radar that moves, with something of the vehicle in view and static points about it.
class OwnEchoesTest : public testing::Test {
 protected:
  OwnEchoesTest() { radar_.doppler_resolution = 0.4; }

  void see(const Vector3d& point_S, double range_rate) {
    const double grid = radar_.doppler_resolution;
    scan_.items.push_back(make_detection({point_S, grid * std::round(range_rate / grid)}, radar_));
  }
  void see_static(const Vector3d& point_S, const Vector3d& v_S) {
    see(point_S, -point_S.normalized().dot(v_S));
  }
  void see_static(const Vector3d& point_S) { see_static(point_S, v_S_); }
  std::vector<std::size_t> observe(const Vector3d& predicted_v_S, double scale = 1.0) {
    scan_.time += kScan;
    OwnEchoList own;
    echoes_.observe(scan_, predicted_v_S, 1e-4 * Matrix3d::Identity(), &own, scale);
    scan_.items.clear();
    return {own.begin(), own.end()};
  }
  /// The part of the vehicle at rest in radar axes, and three static points ahead.
  std::size_t pass(const Vector3d& v_S) {
    see(part_S_, 0.0);
    for (const double y : {1.0, 0.0, -1.0}) see_static({5.0, y, 0.5}, v_S);
    return observe(v_S).size();
  }
  /// Three points of the world, the second scanned being a part of the vehicle, with noise.
  std::vector<std::size_t> drive() {
    for (int i = 0; i < 3; ++i) {
      const Vector3d place = random_.normal_vector(2.0);
      see_static(Vector3d(4.0 + place.x() * place.x(), place.y(), place.z()));
      if (i == 0) see(part_S_ + random_.normal_vector(0.01), 0.0);
    }
    return observe(v_S_);
  }

  test::Random random_{7};
  RadarOptions radar_;
  const Vector3d v_S_{0.8, 0.1, 0.0};
  const Vector3d part_S_{0.9, 0.3, -0.4};
  DetectionList scan_;
  OwnEchoes echoes_{DopplerFold()};
};

TEST_F(OwnEchoesTest, APartOfTheVehicleIsFoundInMotion) {
  int scans = 0;
  while (scans < 60 && drive().empty()) ++scans;
  EXPECT_GT(scans, 0);
  EXPECT_LT(scans, 30);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(drive(), std::vector<std::size_t>{1});
  echoes_.reset();
  EXPECT_TRUE(drive().empty());
}

TEST_F(OwnEchoesTest, WhatLooksLikeAPartOfTheVehicleIsNone) {
  const std::pair<const char*, std::function<void(int scan)>> scenes[] = {
      // no Doppler either, and below a vehicle at constant height it stays where it is
      {"a static point across the motion",
       [this](int) {
         see_static(Vector3d(v_S_.y(), -v_S_.x(), 0.0).normalized());
         see_static({5.0, 1.0, 0.0});
         see_static({4.0, 0.0, 1.0});
       }},
      {"farther than a vehicle reaches",
       [this](int) {
         see({2.5, 0.0, 0.0}, 0.0);
         see_static({5.0, 1.0, 0.0});
         see_static({4.0, 0.0, 1.0});
       }},
      {"all the world stands still: a wrong velocity",
       [this](int scan) {
         see(part_S_, 0.0);
         see({5.0, 1.0, 0.0}, 0.0);
         see({4.0, 2.0, 0.0}, scan % 2 == 0 ? 2.0 : 0.8);
         see({6.0, -1.0, 1.0}, -0.8);  // as predicted, by chance
         see({5.0, -2.0, 0.5}, -0.8);
       }},
  };
  for (const auto& [name, see_scene] : scenes) {
    echoes_.reset();
    for (int i = 0; i < 300; ++i) {
      see_scene(i);
      EXPECT_TRUE(observe(v_S_).empty()) << name << " " << i;
    }
  }
}

// What moves along for a moment is no part of the vehicle.
TEST_F(OwnEchoesTest, OneContradictionIsNotEnough) {
  for (int scans = 1; scans <= 4; ++scans) {
    EXPECT_EQ(pass({10.0, 0.0, 0.0}), scans > 2 ? 1 : 0) << scans;
  }
}

// At twice the largest Doppler what lies ahead folds to none.
TEST_F(OwnEchoesTest, AFoldedDopplerIsNoContradiction) {
  constexpr double kScale = 1.05;
  echoes_ = OwnEchoes(DopplerFold(kScale * 2.5));
  const DopplerFold fold(2.5);  // of the divided range rates
  const Vector3d fast(5.0, 0.0, 0.0);
  for (int i = 0; i < 300; ++i) {
    see({1.0, 0.0, 0.0}, fold.wrap(-fast.x()));
    for (const double y : {4.0, -5.0, 2.0}) {
      const Vector3d world(5.0, y, 0.5);
      see(world, fold.wrap(-world.normalized().dot(fast)));
    }
    EXPECT_TRUE(observe(fast, kScale).empty()) << i;
  }
}

// At rest, where no Doppler tells. Two detections of one place differ by the noise of both.
TEST_F(OwnEchoesTest, AnEchoWithinTheNoiseOfBothIsTheSame) {
  for (int i = 0; i < 60; ++i) drive();
  const Detection d = make_detection({.point_S = part_S_}, radar_);
  for (const auto& [sigmas, same] : {std::pair{4.0, true}, std::pair{5.5, false}}) {
    see(part_S_ + sigmas * d.range * d.sigma_elevation_S, 0.0);
    EXPECT_EQ(observe(Vector3d::Zero()).size(), same ? 1U : 0U) << sigmas;
  }
}

// At a fifth of a metre a second a static point would have read nearly no Doppler, too.
TEST_F(OwnEchoesTest, ASlowVehicleTakesMoreScans) {
  int scans = 1;
  while (scans < 100 && pass({0.25, 0.0, 0.0}) == 0) ++scans;
  EXPECT_GT(scans, 6);
  EXPECT_LT(scans, 30);
}

}  // namespace
}  // namespace rio
