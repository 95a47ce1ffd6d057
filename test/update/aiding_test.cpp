// SPDX-License-Identifier: BSD-3-Clause
// Measurements of other sensors: they come in any order and leave in that of their time, each at
// its own time as rows of a later state.
#include <gtest/gtest.h>

#include "rio/models/aids.hpp"
#include "rio/propagate/strapdown.hpp"
#include "rio/state/layout.hpp"
#include "rio/update/aiding.hpp"
#include "rio/update/aiding_queue.hpp"
#include "support/constants.hpp"
#include "support/dense_rows.hpp"
#include "support/random_state.hpp"

namespace rio::test {
namespace {

using std::chrono::milliseconds;

AidingMeasurement measured(int ms) {
  return {milliseconds(ms), GroundRangeModel{}, {1.0, 0.1}};
}

class AidingQueueTest : public testing::Test {
 protected:
  AidingQueueTest() { x_.time = milliseconds(1000); }
  /// Takes those up to `ms`; the state 7 ms later keeps each.
  std::vector<int> take(int ms) {
    queue_.take(milliseconds(ms), x_, imu_, [](Time t) { return t + milliseconds(7); });
    std::vector<int> times;
    for (const AidingObservation& seen : queue_.taken()) {
      times.push_back(static_cast<int>(seen.measurement.time() / milliseconds(1)));
      EXPECT_EQ(seen.anchor, seen.measurement.time() + milliseconds(7));
    }
    return times;
  }

  AidingQueue queue_;
  NavState x_;
  ImuBuffer imu_{TimingOptions{}, ImuOptions{}};
};

TEST_F(AidingQueueTest, TakesTheOldestInTheOrderOfTheirTime) {
  for (const int ms : {30, 10, 40, 20}) EXPECT_TRUE(queue_.add(measured(ms)));
  EXPECT_EQ(queue_.next(), milliseconds(10));
  EXPECT_EQ(take(30), (std::vector<int>{10, 20, 30}));
  EXPECT_EQ(queue_.next(), milliseconds(40));
  EXPECT_TRUE(take(39).empty());
  EXPECT_EQ(take(40), std::vector<int>{40});
  EXPECT_FALSE(queue_.next());
}

TEST_F(AidingQueueTest, MoreThanAnUpdateTakesAreABatchOfTheirOwn) {
  const int most = static_cast<int>(kMaxAiding);
  for (int i = 0; i < most; ++i) EXPECT_TRUE(queue_.add(measured(i)));
  EXPECT_FALSE(queue_.full_batch(milliseconds(500)));
  EXPECT_TRUE(queue_.add(measured(most)));
  EXPECT_FALSE(queue_.full_batch(milliseconds(most - 1)));  // the last is of later
  EXPECT_EQ(queue_.full_batch(milliseconds(500)), milliseconds(most - 1));
  EXPECT_EQ(take(500).size(), kMaxAiding);
  EXPECT_EQ(take(500), std::vector<int>{most});
}

TEST_F(AidingQueueTest, RefusesWhatItHasNoRoomFor) {
  int taken = 0;
  while (taken < 1000 && queue_.add(measured(taken))) ++taken;
  EXPECT_EQ(taken, 256);
  queue_.clear();
  EXPECT_FALSE(queue_.next());
  EXPECT_TRUE(queue_.taken().empty());
}

/// A body that turns and accelerates, with its samples.
struct Motion {
  explicit Motion(Random& random) : earlier(random.state()) {
    const Vector3d rate = random.normal_vector();
    const Vector3d force = random.normal_vector(3.0) + kGravity * Vector3d::UnitZ();
    for (int i = 0; i <= 30; ++i) {
      const double t = 0.005 * i;
      const Vector3d change = t * Vector3d::Ones();
      imu.push_back({from_seconds(t), rate + change, force - 4.0 * change});
    }
    earlier.time = from_seconds(0.012);
    later = carried(earlier);
  }
  /// The state at the end, from one at the time of the measurement.
  NavState carried(NavState x) const {
    imu.for_each_step(x.time, end, [&x](const ImuStep& step) { integrate(step, kGravity, x); });
    return x;
  }

  ImuBuffer imu{TimingOptions{}, ImuOptions{}};
  Time end = from_seconds(0.113);
  NavState earlier;
  NavState later;
};

struct Offset : AuxiliaryBlock<2> {
  static constexpr const char* kName = "offset";
  static constexpr double kSigma = 1.0;
  static constexpr double kWalk = 0.0;
};
/// A measurement that sees every block an external model may have, with unit noise: the position of
/// the radar, off by the auxiliary state, and its scaled velocity in its own axes.
struct Everything {
  static constexpr const char* kName = "everything";
  static constexpr int kDim = 6;
  using Blocks = BlockList<BodyPose, BodyVelocity, Offset, GyroBias, Extrinsics, DopplerScale>;
  struct Measurement {};
  bool evaluate(const Measurement& /*z*/, const RigidPose& T, const Vector3d& v,
                const Offset::Value& o, const Vector3d& b, const RigidPose& T_BS, double scale,
                ResidualOf<6>& r, JacobianOf<6, 21>* J, JacobianOf<6, 6>& R) const {
    const Vector3d v_B = T.R.transpose() * v + b.cross(T_BS.p);
    const Matrix3d scaled = (1.0 + scale) * T_BS.R.transpose();
    r << -(T.p + T.R * T_BS.p), -scaled * v_B;
    r.head<2>() -= o;
    if (J != nullptr) {
      J->setZero();
      J->block<3, 3>(0, 0) = -T.R * skew(T_BS.p);
      J->block<3, 3>(0, 3).setIdentity();
      J->block<2, 2>(0, 9).setIdentity();
      J->block<3, 3>(0, 17) = T.R;
      J->block<3, 3>(3, 0) = scaled * skew(T.R.transpose() * v);
      J->block<3, 3>(3, 6) = scaled * T.R.transpose();
      J->block<3, 3>(3, 11) = -scaled * skew(T_BS.p);
      J->block<3, 3>(3, 14) = skew(scaled * v_B);
      J->block<3, 3>(3, 17) = scaled * skew(b);
      J->block<3, 1>(3, 20) = T_BS.R.transpose() * v_B;
    }
    R.setIdentity();
    return true;
  }
};

/// Everything of the second of two radars.
class AidingRowsTest : public testing::Test {
 protected:
  AidingRowsTest() {
    EXPECT_TRUE(states.declare<Offset>());
    draw();
  }
  /// Another motion with other mountings.
  void draw() {
    motion = Motion(random);
    x.auxiliary.head<2>() << 0.3, -0.7;
    for (std::size_t r = 0; r < 2; ++r) {
      x.set_radar(r, {{random.rotation(), random.normal_vector(0.3)}, 0.02 * random.normal(), 0.0});
    }
  }
  Layout layout(double mounting_sigma, double scale_sigma) const {
    const CalibrationOptions estimated{.rotation_sigma = mounting_sigma,
                                       .translation_sigma = mounting_sigma,
                                       .time_offset_sigma = mounting_sigma,
                                       .doppler_scale_sigma = scale_sigma,
                                       .elevation_sigma = mounting_sigma};
    return Layout(estimated, 0, 0, states.size(), 2);
  }
  DenseRows rows_at(const NavState& nav, const Layout& layout) {
    const AidingMeasurement z(motion.earlier.time, Everything{}, {}, 1);
    const ImuIncrements since = imu_increments(z.time(), nav.time, nav, motion.imu);
    EXPECT_TRUE(
        linearize(z, since, nav, x, states, kGravity, aiding_columns(layout.of_radar(1)), &rows));
    return dense_rows({rows.begin(), rows.end()}, layout.size(0));
  }

  Random random{5};
  Motion motion{random};
  Estimate x;
  AuxiliaryStates states;
  AidingRows rows;
};

TEST_F(AidingRowsTest, TheStateOfItsTimeIsFoundAgain) {
  for (int i = 0; i < 20; ++i) {
    draw();
    const NavState& at = motion.earlier;
    const RadarState& radar = x.of_radar(1);
    ResidualOf<6> expected;
    JacobianOf<6, 6> R;
    Everything{}.evaluate({}, {at.q_WB.toRotationMatrix(), at.p_WB}, at.v_WB, x.auxiliary.head<2>(),
                          at.gyro_bias, RigidPose(radar.T_BS), radar.doppler_scale, expected,
                          nullptr, R);
    const VectorXd residual = rows_at(motion.later, layout(0.1, 0.1)).r;
    EXPECT_LT((residual - expected).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST_F(AidingRowsTest, RowsMatchCentralDifferences) {
  const Layout all = layout(0.1, 0.1);
  const Layout own = all.of_radar(1);
  constexpr double kStep = 1e-5;
  for (int run = 0; run < 20; ++run) {
    draw();
    const MatrixXd H = rows_at(motion.later, all).H;
    const Estimate kept = x;
    const auto moved = [&](int column, double step) {
      const VectorXd error = step * VectorXd::Unit(all.size(0), column);
      RadarState radar = kept.of_radar(1);
      const RigidPose T = Extrinsics::retract(RigidPose(radar.T_BS),
                                              error.segment<Extrinsics::kDof>(own.extrinsics()));
      radar.T_BS = {Quaternion(T.R), T.p};
      radar.doppler_scale += error[own.doppler_scale()];
      x.set_radar(1, radar);
      x.auxiliary.head<2>() = kept.auxiliary.head<2>() + error.segment<2>(own.auxiliary());
      return rows_at(perturbed(motion.later, error.head<body::kSize>()), all).r;
    };
    for (int column = 0; column < all.size(0); ++column) {
      if (column >= body::kAccelBias && column < body::kSize) continue;  // neglected
      const VectorXd numeric = (moved(column, -kStep) - moved(column, kStep)) / (2.0 * kStep);
      // what the gyro bias does is of first order in the turn
      const double slack = column >= body::kGyroBias && column < body::kAccelBias ? 0.01 : 1e-6;
      EXPECT_LT((H.col(column) - numeric).cwiseAbs().maxCoeff(), slack) << column;
    }
    const Layout other = all.of_radar(0);
    EXPECT_EQ(H.middleCols(other.extrinsics(), own.extrinsics() - body::kSize).norm(), 0.0);
    EXPECT_EQ(H.col(own.time_offset()).norm(), 0.0);
    EXPECT_EQ(H.col(own.elevation_error()).norm(), 0.0);
  }
}

TEST_F(AidingRowsTest, WhatIsNotEstimatedHasNoColumn) {
  const Layout all = layout(0.1, 0.1);
  const DenseRows with = rows_at(motion.later, all);
  for (const int scales : {0, 2}) {  // of the two radars
    const Layout some = layout(0.0, scales > 0 ? 0.1 : 0.0);
    const DenseRows without = rows_at(motion.later, some);
    rows[0].for_each_segment([](int column, const double*, int) { ASSERT_GE(column, 0); });
    EXPECT_EQ(without.H.cols(), body::kSize + scales + 2);
    EXPECT_EQ(without.r, with.r);
    EXPECT_EQ(without.H.leftCols(body::kSize), with.H.leftCols(body::kSize));
    EXPECT_EQ(without.H.rightCols(2), with.H.rightCols(2));
    if (scales == 0) continue;
    EXPECT_EQ(without.H.col(some.of_radar(1).doppler_scale()),
              with.H.col(all.of_radar(1).doppler_scale()));
  }
}

// The noise is correlated. What is not finite is outside the domain.
TEST_F(AidingRowsTest, RowsAreWhite) {
  const Vector3d r(1.0, 2.0, 3.0);
  PositionModel::Measurement z;
  z.covariance_W << 4.0, 1.0, 0.0, 1.0, 2.0, 0.5, 0.0, 0.5, 1.0;
  z.p_W = motion.later.p_WB + r;
  const auto rows_of_z = [&] {
    return linearize({motion.later.time, PositionModel{}, z}, {}, motion.later, {}, states,
                     kGravity, {}, &rows);
  };
  ASSERT_TRUE(rows_of_z());
  double squared = 0.0;
  for (const LinearRow& row : rows) squared += row.residual * row.residual;
  EXPECT_NEAR(squared, r.dot(z.covariance_W.inverse() * r), 1e-12);
  z.p_W.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(rows_of_z());
}

TEST(AuxiliaryStates, AreFoundByName) {
  AuxiliaryStates states;
  EXPECT_TRUE(states.declare<HeightOffset>());
  EXPECT_TRUE(states.declare<Offset>(3.0));
  EXPECT_FALSE(states.declare<Offset>());
  EXPECT_EQ(states.find("offset"), 1);
  EXPECT_EQ(states.find("height_offset"), 0);
  EXPECT_EQ(states.find("other"), -1);
  EXPECT_EQ(states.size(), 3);
  const AidingMeasurement range(Time{0}, GroundRangeModel{}, {});
  EXPECT_FALSE(range.is_declared(states));
  EXPECT_TRUE(AidingMeasurement(Time{0}, HeightModel{}, {}).is_declared(states));
}

}  // namespace
}  // namespace rio::test
