// SPDX-License-Identifier: BSD-3-Clause
// Auxiliary states that are not known at the start: when they are determined, and how well.
#include "rio/update/delayed_start.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>

#include "rio/core/so3.hpp"
#include "support/random_state.hpp"
#include "support/ranging.hpp"

namespace rio::test {
namespace {

using namespace std::chrono_literals;

constexpr double kSigma = 0.1;  // of a range [m]
const Vector3d kAnchor(12.0, -7.0, 3.0);

/// The sum of the places of two anchors.
struct SecondAnchor : AuxiliaryBlock<3> {
  static constexpr const char* kName = "second_anchor";
  static constexpr double kSigma = 20.0;
  static constexpr double kWalk = 0.0;
};
struct SumModel {
  static constexpr const char* kName = "sum";
  static constexpr int kDim = 3;
  using Blocks = BlockList<Anchor, SecondAnchor>;
  using Measurement = Vector3d;
  bool evaluate(const Measurement& z, const Vector3d& a, const Vector3d& b, Vector3d& r,
                Eigen::Matrix<double, 3, 6>* J, Matrix3d& R) const {
    r = z - a - b;
    if (J != nullptr) *J << Matrix3d::Identity(), Matrix3d::Identity();
    R = kSigma * kSigma * Matrix3d::Identity();
    return true;
  }
};

/// An estimate that moves, without noise, and the ranges that it holds.
class DelayedStartTest : public testing::Test {
 protected:
  DelayedStartTest() {
    AuxiliaryState other = auxiliary_state<Anchor>(0);  // known from the start
    EXPECT_TRUE(options.auxiliary.declare(other));
    AuxiliaryState anchor = auxiliary_state<Anchor>(3);
    anchor.delayed = true;
    EXPECT_TRUE(options.auxiliary.declare(anchor));
    make();
  }
  void make() {
    starts.emplace(options);
    x.emplace(options, 0);
    x->reset({}, 1e-6 * BodyCovariance::Identity());
  }
  /// Ranges along a path; the index of the first after which the anchor is determined, or -1.
  /// @param displace what the estimate has for the true position
  template <class Path>
  int fly(
      const Path& path, int count, double outliers = 0.0,
      const std::function<void(Vector3d*)>& displace = [](Vector3d*) {}) {
    for (int i = 0; i < count; ++i) {
      NavState& nav = x->estimate().nav;
      nav.time = Time(i * 200ms);
      nav.p_WB = path(0.2 * i);
      nav.q_WB = Quaternion(Eigen::AngleAxisd(0.3 * i, Vector3d(1.0, 2.0, 2.0) / 3.0));
      double range = (kAnchor - nav.p_WB).norm() + kSigma * random.normal();
      if (i > 0) displace(&nav.p_WB);
      if (random.uniform(0.0, 1.0) < outliers) range += 5.0;
      const AidingMeasurement z(nav.time, RangeModel{}, {range, kSigma}, 0, 3);
      EXPECT_TRUE(starts->hold({z, {}, nav.time, {}}, *x));
      if (const DelayedStart* start = starts->determine(*x)) {
        found = *start;
        return i;
      }
    }
    return -1;
  }
  /// Squared error over its covariance, per dimension.
  double nees() const {
    const Vector3d error = found.value - kAnchor;
    return error.dot(Matrix3d(found.noise).inverse() * error) / 3.0;
  }

  /// Over runs along a spiral, each of which finds the anchor.
  double mean_nees(int runs, int ranges, double outliers) {
    double sum = 0.0;
    for (int run = 0; run < runs; ++run) {
      starts->reset();
      EXPECT_GT(fly(spiral, ranges, outliers), 0);
      EXPECT_FALSE(starts->any());
      EXPECT_EQ(found.first, 3);
      EXPECT_LT(found.noise.trace(), 1.0);
      sum += nees();
    }
    return sum / runs;
  }

  static Vector3d spiral(double t) {
    return {4.0 * std::cos(0.3 * t), 4.0 * std::sin(0.3 * t), 0.2 * t};
  }

  Options options;
  std::optional<DelayedStarts> starts;
  std::optional<StateEstimate> x;
  DelayedStart found;
  Random random{7};
};

TEST_F(DelayedStartTest, AnAnchorIsFoundWithinItsCovariance) {
  const double nees = mean_nees(40, 200, 0.0);
  EXPECT_GT(nees, 0.6);
  EXPECT_LT(nees, 1.4);
}

TEST_F(DelayedStartTest, OutliersDoNotMoveIt) {
  EXPECT_LT(mean_nees(20, 400, 0.1), 1.6);
}

TEST_F(DelayedStartTest, RangesOfWhichAThirdDoNotFitDetermineNothing) {
  EXPECT_EQ(fly(spiral, 200, 0.35), -1);
}

// On a line it may be anywhere on a circle, in a plane on either side of it.
TEST_F(DelayedStartTest, MotionThatLeavesTwoPlacesDeterminesNeither) {
  EXPECT_EQ(fly([](double) { return Vector3d(0.0, 0.0, 0.0); }, 200), -1);
  starts->reset();
  EXPECT_EQ(fly([](double t) { return Vector3d(0.5 * t, 0.0, 0.0); }, 200), -1);
  starts->reset();
  const auto level = [](double t) { return Vector3d(spiral(t).x(), spiral(t).y(), 0.0); };
  EXPECT_EQ(fly(level, 200), -1);
  EXPECT_TRUE(starts->waits(3));
  EXPECT_FALSE(starts->waits(0));
}

TEST_F(DelayedStartTest, OnlyWhatDependsOnItIsHeld) {
  const AidingMeasurement known(Time{0}, RangeModel{}, {1.0, kSigma}, 0, 0);
  EXPECT_FALSE(starts->hold({known, {}, Time{0}, {}}, *x));
  const AidingMeasurement unknown(Time{0}, RangeModel{}, {1.0, kSigma}, 0, 3);
  EXPECT_TRUE(starts->hold({unknown, {}, Time{0}, {}}, *x));
}

// An error of the whole estimate, as a rigid body, moves the anchor with it.
TEST_F(DelayedStartTest, TheAnchorMovesWithTheEstimate) {
  ASSERT_GT(fly(spiral, 200), 0);
  const RigidPose now = x->estimate().T_WB();
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d by_position = found.by_body.col(body::kPosition + axis);
    EXPECT_LT((by_position - Vector3d::Unit(axis)).norm(), 0.02);
    const Vector3d by_turn = found.by_body.col(body::kAttitude + axis);
    const Vector3d expected = now.R.col(axis).cross(Vector3d(found.value - now.p));
    EXPECT_LT((by_turn - expected).norm(), 0.02 * expected.norm());
  }
}

TEST_F(DelayedStartTest, TheEstimateTakesItWithItsCorrelation) {
  ASSERT_GT(fly(spiral, 200), 0);
  const Eigen::MatrixXd P_bb = x->covariance().body();
  x->set_auxiliary(found.first, found.value, found.by_body, found.noise);
  const Eigen::MatrixXd P = x->covariance().matrix();
  const int at = x->layout().auxiliary() + found.first;
  EXPECT_LT((P.block(at, 0, 3, body::kSize) - found.by_body * P_bb).norm(), 1e-12);
  const Matrix3d own = found.by_body * P_bb * found.by_body.transpose() + Matrix3d(found.noise);
  EXPECT_LT((P.block<3, 3>(at, at) - own).norm(), 1e-12);
  EXPECT_EQ(P, P.transpose());
  const Matrix3d other = P.block<3, 3>(at - 3, at);
  EXPECT_TRUE(other.isZero());
  EXPECT_EQ(Vector3d(x->estimate().auxiliary.segment<3>(found.first)), Vector3d(found.value));
}

// The path is flown with a position that drifts as its covariance says.
TEST_F(DelayedStartTest, ItsCovarianceCoversTheDriftOfThePosition) {
  constexpr int kRuns = 60;
  constexpr double kStep = 2e-4;  // variance of the drift from range to range [m^2]
  double sum = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    make();
    Vector3d off = Vector3d::Zero();  // true minus estimated
    ASSERT_GT(fly(spiral, 400, 0.0,
                  [&](Vector3d* p) {
                    x->covariance().inflate(body::kPosition, kStep);
                    off += random.normal_vector(std::sqrt(kStep));
                    *p -= off;
                  }),
              0);
    found.value += found.by_body.middleCols<3>(body::kPosition) * off;
    sum += nees();
  }
  EXPECT_GT(sum / kRuns, 0.6);
  EXPECT_LT(sum / kRuns, 1.5);
}

TEST_F(DelayedStartTest, OfTwoUnknownStatesNeitherIsDetermined) {
  AuxiliaryState second = auxiliary_state<SecondAnchor>();
  second.delayed = true;
  ASSERT_TRUE(options.auxiliary.declare(second));
  make();
  for (int i = 0; i < 100; ++i) {
    const Time time(i * 100ms);
    const AidingMeasurement z(time, SumModel{}, kAnchor, 0, 3);
    EXPECT_TRUE(starts->hold({z, {}, time, {}}, *x));
    EXPECT_EQ(starts->determine(*x), nullptr);
  }
}

TEST_F(DelayedStartTest, LongHoldingKeepsRangesFromAllOfThePath) {
  // a line for two minutes, then a climb in circles: the line's ranges are still there
  const auto path = [](double t) {
    return t < 120.0 ? Vector3d(0.05 * t, 0.0, 0.0)
                     : Vector3d(6.0, 0.0, 0.0) + spiral(t - 120.0) - spiral(0.0);
  };
  const int last = fly(path, 1000);
  ASSERT_GT(last, 600);
  EXPECT_LT((found.value - kAnchor).norm(), 1.0);
}

}  // namespace
}  // namespace rio::test
