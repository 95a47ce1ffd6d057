// SPDX-License-Identifier: BSD-3-Clause
// Measurements of other sensors: they come in any order and leave in that of their time, each at
// its own time as rows of a later state.
#include <gtest/gtest.h>

#include "rio/models/aids.hpp"
#include "rio/propagate/strapdown.hpp"
#include "rio/update/aiding.hpp"
#include "rio/update/aiding_queue.hpp"
#include "support/constants.hpp"
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

/// A measurement that sees all of the state and an auxiliary one, with unit noise.
struct Offset : AuxiliaryBlock<2> {
  static constexpr const char* kName = "offset";
  static constexpr double kSigma = 1.0;
  static constexpr double kWalk = 0.0;
};
struct Everything {
  static constexpr const char* kName = "everything";
  static constexpr int kDim = 6;
  using Blocks = BlockList<BodyPose, BodyVelocity, GyroBias, Offset>;
  struct Measurement {};
  bool evaluate(const Measurement& /*z*/, const RigidPose& T, const Vector3d& v, const Vector3d& b,
                const Offset::Value& o, Eigen::Matrix<double, 6, 1>& r,
                Eigen::Matrix<double, 6, 14>* J, Eigen::Matrix<double, 6, 6>& R) const {
    const Vector3d l(0.3, -0.2, 0.5);
    r << -(T.p + T.R * l), -(T.R.transpose() * v + b.cross(l));
    r.head<2>() -= o;
    if (J != nullptr) {
      J->setZero();
      J->block<3, 3>(0, 0) = -T.R * skew(l);
      J->block<3, 3>(0, 3).setIdentity();
      J->block<3, 3>(3, 0) = skew(T.R.transpose() * v);
      J->block<3, 3>(3, 6) = T.R.transpose();
      J->block<3, 3>(3, 9) = -skew(l);
      J->block<2, 2>(0, 12).setIdentity();
    }
    R.setIdentity();
    return true;
  }
};

class AidingRowsTest : public testing::Test {
 protected:
  AidingRowsTest() { EXPECT_TRUE(states.declare<Offset>()); }

  static constexpr AidingColumns kColumns = {0, -1, -1, 15};

  static Estimate with(const AuxiliaryValues& auxiliary) {
    Estimate x;
    x.auxiliary = auxiliary;
    return x;
  }
  Eigen::Matrix<double, 6, 1> residual(const NavState& x, const AuxiliaryValues& auxiliary) {
    const AidingMeasurement z(motion.earlier.time, Everything{}, {});
    const ImuIncrements since = imu_increments(motion.earlier.time, x.time, x, motion.imu);
    EXPECT_TRUE(linearize(z, since, x, with(auxiliary), states, kGravity, kColumns, &rows));
    Eigen::Matrix<double, 6, 1> r;
    for (std::size_t i = 0; i < 6; ++i) r[static_cast<Eigen::Index>(i)] = rows[i].residual;
    return r;
  }

  Random random{5};
  Motion motion{random};
  AuxiliaryStates states;
  AidingRows rows;
};

TEST_F(AidingRowsTest, TheStateOfItsTimeIsFoundAgain) {
  for (int i = 0; i < 20; ++i) {
    motion = Motion(random);
    const NavState& at = motion.earlier;
    Eigen::Matrix<double, 6, 1> expected;
    Eigen::Matrix<double, 6, 6> R;
    Everything{}.evaluate({}, {at.q_WB.toRotationMatrix(), at.p_WB}, at.v_WB, at.gyro_bias,
                          Offset::Value::Zero(), expected, nullptr, R);
    const AuxiliaryValues none = AuxiliaryValues::Zero();
    EXPECT_LT((residual(motion.later, none) - expected).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST_F(AidingRowsTest, RowsMatchCentralDifferences) {
  for (int run = 0; run < 20; ++run) {
    motion = Motion(random);
    AuxiliaryValues auxiliary = AuxiliaryValues::Zero();
    auxiliary.head<2>() << 0.3, -0.7;
    residual(motion.later, auxiliary);
    const AidingRows at = rows;
    constexpr double kStep = 1e-5;
    for (int column = 0; column < 14; ++column) {
      const auto moved = [&](double step) {
        if (column < 12) {
          return residual(perturbed(motion.later, step * BodyVector::Unit(column)), auxiliary);
        }
        return residual(motion.later, auxiliary + step * AuxiliaryValues::Unit(column - 12));
      };
      const Eigen::Matrix<double, 6, 1> numeric = (moved(-kStep) - moved(kStep)) / (2.0 * kStep);
      for (std::size_t i = 0; i < 6; ++i) {
        const double analytic = at[i].h[static_cast<std::size_t>(column)];
        // what the gyro bias does is of first order in the turn
        const double slack = column >= 9 && column < 12 ? 0.01 : 1e-6;
        EXPECT_NEAR(analytic, numeric[static_cast<Eigen::Index>(i)], slack) << column << " " << i;
      }
    }
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
                     kGravity, kColumns, &rows);
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
