// SPDX-License-Identifier: BSD-3-Clause
#include "experiment/pose_errors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "rio/core/so3.hpp"
#include "support/constants.hpp"

namespace rio::experiment {
namespace {

using test::kDegree;

/// A body that flies 1 m forward a frame and turns left by 90 deg after each, estimated off by a
/// constant rotation about the origin and, from the third frame on, by 0.3 m.
std::vector<eval::PosePair> square() {
  const Quaternion turn = quaternion_exp({0.0, 0.0, 90.0 * kDegree});
  const Quaternion off = quaternion_exp({0.0, 0.0, 2.0 * kDegree});
  eval::StampedPose truth;
  std::vector<eval::PosePair> pairs;
  for (int i = 0; i < 4; ++i) {
    eval::StampedPose estimate{truth.time, off * truth.p, off * truth.q};
    if (i >= 2) estimate.p.z() += 0.3;
    pairs.push_back({truth, estimate});
    truth.p += truth.q * Vector3d::UnitX();
    truth.q = truth.q * turn;
  }
  return pairs;
}

TEST(PoseErrors, AreThoseOfAHandMadeFlight) {
  const PoseErrors e = pose_errors(square());
  // off by 2 deg about the origin at (0, 0), (1, 0), (1, 1), (0, 1), and 0.3 m up at the last two
  const double aside = 2.0 * std::sin(1.0 * kDegree);
  const double squares = aside * aside * (1.0 + 2.0 + 1.0) + 2.0 * 0.09;
  EXPECT_NEAR(e.ape, std::sqrt(squares / 4.0), 1e-12);
  EXPECT_NEAR(e.ape_angle, 2.0, 1e-12);
  // of the three steps one is off, whatever the common rotation
  EXPECT_NEAR(e.rpe, 0.3 / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(e.rpe_angle, 0.0, 1e-6);
}

TEST(PoseErrors, ATurnBetweenTwoFramesCountsOnce) {
  std::vector<eval::PosePair> pairs = square();
  for (std::size_t i = 2; i < 4; ++i) {
    pairs[i].estimate.q = pairs[i].estimate.q * quaternion_exp({0.0, 0.0, 3.0 * kDegree});
  }
  EXPECT_NEAR(pose_errors(pairs).rpe_angle, 3.0 / std::sqrt(3.0), 1e-9);
}

TEST(PoseErrors, OfNothingAreNone) {
  EXPECT_TRUE(std::isnan(pose_errors({}).ape));
  EXPECT_TRUE(std::isnan(pose_errors({square().front()}).rpe));
}

TEST(PoseErrorTable, PairsRunsBySeed) {
  PoseErrorTable table;
  table.add({"room", "a"}, 2, {.ape = 1.0});
  table.add({"room", "a"}, 1, {.ape = 5.0});
  table.add({"room", "b"}, 1, {.ape = 5.5});
  table.add({"room", "b"}, 2, {.ape = 1.7});
  table.add({"hall", "a"}, 1, {.ape = 9.0});
  EXPECT_EQ(table.values({"room", "a"}, &PoseErrors::ape), (std::vector<double>{5.0, 1.0}));
  // differences 0.5 and 0.7: their deviation 0.141, that of the mean 0.1
  EXPECT_EQ(table.change({"room", "b"}, "a", kPoseErrors[0]), "+0.60 ± 0.10");
  EXPECT_EQ(table.change({"room", "a"}, "b", kPoseErrors[0]), "-0.60 ± 0.10");
  EXPECT_THROW(static_cast<void>(table.values({"hall", "b"}, &PoseErrors::ape)), std::out_of_range);
  EXPECT_EQ(table.as_csv(),
            "group,variant,seed,ape [m],ape [deg],rpe [m],rpe [deg]\n"
            "hall,\"a\",1,9,0,0,0\n"
            "room,\"a\",1,5,0,0,0\nroom,\"a\",2,1,0,0,0\n"
            "room,\"b\",1,5.5,0,0,0\nroom,\"b\",2,1.7,0,0,0\n");
}

}  // namespace
}  // namespace rio::experiment
