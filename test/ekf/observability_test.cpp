// SPDX-License-Identifier: BSD-3-Clause
// The default filter as a whole leaves position and heading unobservable: what it claims to know of
// them comes from its start alone.
//
// N: the four directions along which no sensor of this system sees a change, translation and the
// rotation about gravity, as errors of all blocks at one estimate.
// (E1) H N = 0 at every update and Phi N = N' between them: two filters that start with P0 and
//      P0 + alpha N N^T then have equal gains, hence equal estimates, and end with covariances that
//      differ by alpha N' N'^T, N' at the final estimate.
//      What was not known of the heading at the start is so never known later.
// References: Hesch et al. 2014 (null space of the stacked system), Huang et al. 2010.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>

#include "support/scanwise_flight.hpp"

namespace rio::test {
namespace {

using Eigen::MatrixXd;

constexpr double kTimeOffset = 0.02;  // told to nobody: the filter has to find it [s]

sim::Scenario scenario() {
  sim::Scenario scenario = ideal_flight();
  scenario.radar.stamp_offset = kTimeOffset;
  return scenario;
}

/// N at x for all blocks: columns 0 to 2 translation, column 3 rotation about gravity. Calibration
/// and biases do not change.
MatrixXd null_space(const Layout& layout, const Estimate& x) {
  MatrixXd N = MatrixXd::Zero(layout.size(static_cast<int>(x.landmarks.size())), 4);
  const Vector3d up = Vector3d::UnitZ();
  const auto pose = [&](int at, const RigidPose& T_WB) {
    N.block<3, 1>(at, 3) = T_WB.R.transpose() * up;
    N.block<3, 3>(at + 3, 0).setIdentity();
    N.block<3, 1>(at + 3, 3) = up.cross(T_WB.p);
  };
  pose(body::kAttitude, x.T_WB());
  N.block<3, 1>(body::kVelocity, 3) = up.cross(x.nav.v_WB);
  for (std::size_t i = 0; i < x.clones.size(); ++i) {
    pose(layout.clone(static_cast<int>(i)), x.clones[i].T_WB);
  }
  for (std::size_t i = 0; i < x.landmarks.size(); ++i) {
    const int at = layout.landmark(static_cast<int>(i));
    N.block<3, 3>(at, 0).setIdentity();
    N.block<3, 1>(at, 3) = up.cross(x.landmarks[i].p_W);
  }
  return N;
}

/// Filters that fly the same data from different P0.
class ObservabilityTest : public testing::Test {
 protected:
  /// From the true state with an ordinary P0 plus alpha N N^T.
  void begin(double alpha, EkfFlight* flight) const {
    NavState first = flight->flight().truth.front();
    first.p_WB += Vector3d(3.0, -2.0, 1.0);  // away from the axis that the rotation is about
    flight->begin(options_);
    Estimate x;
    x.nav = first;
    const MatrixXd N = null_space(flight->state_estimate().layout(), x).topRows(body::kSize);
    flight->pipeline().reset(first, flight->start_covariance() + alpha * N * N.transpose());
  }

  struct Comparison {
    double covariance = 0.0;  ///< largest element of P_b - P_a - alpha N N^T, over alpha
    double position = 0.0;    ///< largest distance of the two estimates [m]
    bool same_size = false;
    int rest_scans = 0;
    UpdateReport last;
  };
  /// (E1) over the whole flight.
  Comparison compare() {
    constexpr double kAlpha = 1.0;  // a radian, a metre: ten thousand times the ordinary P0
    begin(0.0, &a_);
    begin(kAlpha, &b_);
    Comparison c;
    while (!a_.over()) {
      EXPECT_EQ(a_.step(), Status::kOk);
      EXPECT_EQ(b_.step(), Status::kOk);
      const double apart = (a_.estimate().nav.p_WB - b_.estimate().nav.p_WB).norm();
      c.position = std::max(c.position, apart);
      c.rest_scans += a_.report().at_rest ? 1 : 0;
    }
    c.last = a_.report();
    const MatrixXd P_a = a_.state_estimate().covariance().matrix();
    const MatrixXd P_b = b_.state_estimate().covariance().matrix();
    c.same_size = P_a.rows() == P_b.rows();
    const Eigen::Index size = std::min(P_a.rows(), P_b.rows());
    const MatrixXd N = null_space(a_.state_estimate().layout(), a_.estimate()).topRows(size);
    const MatrixXd excess =
        P_b.topLeftCorner(size, size) - P_a.topLeftCorner(size, size) - kAlpha * N * N.transpose();
    c.covariance = excess.cwiseAbs().maxCoeff() / kAlpha;
    return c;
  }

  EkfFlight a_{scenario()};
  EkfFlight b_{scenario()};
  Options options_ = a_.options();
};

TEST_F(ObservabilityTest, AddedUncertaintyOfPositionAndHeadingStaysAsItIs) {
  const Comparison c = compare();
  // rounding of numbers around 1 over 600 updates; measured: 1e-9 and 1e-10
  EXPECT_TRUE(c.same_size);
  EXPECT_LT(c.covariance, 1e-6);
  EXPECT_LT(c.position, 1e-6);
  // every kind of block and of measurement has taken part
  EXPECT_GT(c.last.landmarks, 10);
  EXPECT_EQ(c.last.clones, options_.update.max_clones);
  EXPECT_GT(c.rest_scans, 10);
  EXPECT_EQ(c.last.calibration[static_cast<std::size_t>(Calibration::kTimeOffset)].observability,
            Observability::kObserved);
}

TEST_F(ObservabilityTest, TheTrailsKeepItSoToo) {
  options_.update.use_trails = true;
  const Comparison c = compare();
  EXPECT_LT(c.covariance, 1e-6);
  EXPECT_LT(c.position, 1e-6);
}

// Without re-expression, linearisation points that move make the filter believe it sees the
// heading.
TEST_F(ObservabilityTest, WithoutReexpressionItIsLost) {
  options_.update.consistent_covariance = false;
  const Comparison c = compare();
  EXPECT_GT(c.covariance, 1e-2);
  EXPECT_GT(c.position, 1e-2);
}

}  // namespace
}  // namespace rio::test
