// SPDX-License-Identifier: BSD-3-Clause
// Ranges to anchors at unknown places, through the odometry API, with either back-end.
#include <array>

#include "api/aided.hpp"
#include "support/ranging.hpp"

namespace rio::test {
namespace {

using AnchorsTest = AidedTest;

/// Ranges to anchors whose places nobody knows, a few reflected.
struct Ranging {
  static constexpr double kSigma = 0.1;  // [m]
  std::array<Vector3d, 3> anchors = {Vector3d(9.0, 4.0, 3.5), Vector3d(-7.0, 8.0, 0.5),
                                     Vector3d(2.0, -10.0, 2.0)};
  void operator()(Odometry& o, const NavState& x, sim::Random& random) const {
    for (std::size_t i = 0; i < anchors.size(); ++i) {
      double range = (anchors[i] - x.p_WB).norm() + kSigma * random.normal();
      if (random.uniform(0.0, 1.0) < 0.03) range += random.uniform(1.0, 5.0);
      EXPECT_EQ(o.add_measurement({x.time, RangeModel{}, {range, kSigma}, 0, static_cast<int>(i)}),
                Status::kWaiting);
    }
  }
  static Options declared(Options o) {
    for (int i = 0; i < 3; ++i) {
      AuxiliaryState anchor = auxiliary_state<Anchor>(i);
      anchor.delayed = true;
      EXPECT_TRUE(o.auxiliary.declare(anchor));
    }
    return o;
  }
};

// They carry the estimate through six seconds without the radar.
TEST_P(AnchorsTest, OfUnknownPlaceHelp) {
  const Ranging ranging;
  const std::pair<double, double> blind{45.0, 51.0};
  const Errors alone = fly(options(), kNone, 40ms, Time{0}, blind);
  const Errors aided = fly(Ranging::declared(options()), ranging, 200ms, Time{0}, blind);
  for (std::size_t i = 0; i < ranging.anchors.size(); ++i) {
    const auto anchor = auxiliary<Anchor>(*odometry, static_cast<int>(i));
    ASSERT_TRUE(anchor) << i;
    const Vector3d error = anchor->value - ranging.anchors[i];
    EXPECT_LT(error.dot(anchor->covariance.inverse() * error), 16.3) << i << error.transpose();
    EXPECT_LT(anchor->covariance.trace(), 0.25);
  }
  EXPECT_FALSE(auxiliary<Anchor>(*odometry, 3));
  EXPECT_LT(aided.position_nees / aided.steps, 1.5);
  expect_below("unknown anchors, " + name() + ": RMS over that without", aided.rms() / alone.rms(),
               0.8);
}

// Until then, nothing of the estimate changes.
TEST_P(AnchorsTest, RangesAreHeldUntilTheyDetermineThem) {
  fly(options(), kNone);
  const Vector3d end = odometry->at_scan().p_WB;
  int held = 0;
  const Aids ranging = [&](Odometry& o, const NavState& x, sim::Random& random) {
    held += o.report().aiding_held;
    if (x.time < start() + 4s) Ranging{}(o, x, random);
  };
  fly(Ranging::declared(options()), ranging);
  EXPECT_GT(held, 0);
  EXPECT_EQ(rows, 0.0);
  EXPECT_LT((odometry->at_scan().p_WB - end).norm(), 1e-6);
  EXPECT_FALSE(auxiliary<Anchor>(*odometry, 0));
}

INSTANTIATE_TEST_SUITE_P(BackEnds, AnchorsTest, kBothBackEnds, back_end_name);

}  // namespace
}  // namespace rio::test
