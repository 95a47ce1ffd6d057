// SPDX-License-Identifier: BSD-3-Clause
// After create() the estimator does not touch the heap, with every option that changes the hot
// path.
#include <algorithm>

#include "api/flying.hpp"
#include "rio/aiding.hpp"
#include "support/ranging.hpp"

namespace rio::test {
namespace {

template <class Fixture>
class Counted : public Fixture {
 protected:
  void SetUp() override {
    if (!AllocationGuard::kWorks) GTEST_SKIP() << "allocations are not counted under a sanitizer";
  }
};
using AllocationTest = Counted<testing::Test>;
using AllocationOfBackEnd = Counted<BackEndTest>;

TEST_F(AllocationTest, TheGuardSeesVectorsAndEigen) {
  const AllocationGuard guard;
  const std::vector<int> v(10);
  const int* const volatile used = v.data();  // else the compiler may leave the vector out
  ASSERT_NE(used, nullptr);
  const Eigen::MatrixXd m = Eigen::MatrixXd::Zero(5, static_cast<int>(v.size()));
  EXPECT_EQ(guard.count(), 2 + (m.size() == 50 ? 0 : 1));
}

void keep_many_landmarks(Options& o) {
  o.update.max_landmarks = 64;
  o.frontend.landmark_timeout = 1000.0;
  o.frontend.promote_after = 1;
}

struct Variant {
  const char* name;  ///< of a preset if nothing changes the default one
  std::function<void(Options&)> change;
};

const Variant kVariants[] = {
    {"default", [](Options&) {}},
    {"published-ekf", {}},
    {"published-smoother", {}},
    {"published-uncertainty", {}},
    {"doppler-only", {}},
    {"mounting searched", [](Options& o) { o.calibration.rotation_sigma = 3.0; }},
    {"smoother", [](Options& o) { o.backend = BackEnd::kSmoother; }},
    {"the largest state: 21 + 120 + 192 = 333",
     [](Options& o) {
       o.update.max_clones = 20;
       keep_many_landmarks(o);
     }},
    {"many landmarks, a long window, few iterations",
     [](Options& o) {
       o.backend = BackEnd::kSmoother;
       o.smoother.window = 19;
       o.smoother.max_iterations = 2;
       keep_many_landmarks(o);
     }},
};

TEST_F(AllocationTest, NoneAfterCreate) {
  const sim::Flight flight = flight_of(6, 25.0, sim::Scenario().max_duration);
  for (const Variant& variant : kVariants) {
    SCOPED_TRACE(variant.name);
    Options options = experiment::options_for(flight, "default");
    if (variant.change) {
      variant.change(options);
    } else {
      ASSERT_TRUE(preset(variant.name, &options));
    }
    int rows = 0;
    std::size_t points = 0;
    std::size_t landmarks = 0;
    const auto odometry =
        fly_without_heap({flight}, options, nullptr, [&](const Odometry& o, Time) {
          for (const ModelReport& model : o.report().models) rows += model.rows_used;
          points += o.points().size();
          landmarks += o.landmarks().size();
        });
    EXPECT_GT(rows, 1000);
    EXPECT_GT(points, 1000U);
    if (options.update.use_landmarks) {
      EXPECT_GT(landmarks, 0U);
    }
    const BodyCovariance P = odometry->covariance();
    const AllocationGuard guard;
    (void)odometry->reset(odometry->now(), P);
    odometry->reset();
    EXPECT_EQ(guard.count(), 0);
  }
}

TEST_P(AllocationOfBackEnd, NoneWhenTheVelocityIsReplaced) {
  const sim::Flight flight = flight_of(7, 10.0, sim::Scenario().max_duration);
  NavState wrong = flight.truth.front();
  wrong.v_WB += Vector3d(2.0, 2.0, 0.0);
  const auto odometry = fly_without_heap({flight}, options_for(flight), &wrong);
  EXPECT_EQ(odometry->counters().velocity_resets, 1U);
}

// A thousand detections a scan, all of them used.
TEST_P(AllocationOfBackEnd, NoneWithAnImagingRadar) {
  const sim::Flight flight = flight_of(3, sim::Scenario().path.length, 5.0, [](sim::Scenario& o) {
    for (double* density : {&o.room.floor_density, &o.room.wall_density, &o.room.ceiling_density,
                            &o.room.clutter_density}) {
      *density *= 50.0;
    }
    o.radar.max_static = 1000;
    o.radar.range_resolution /= 7.0;
    o.radar.doppler_resolution /= 7.0;
    o.radar.snr_1m_db = 78.0;
  });
  Options options = options_for(flight);
  options.frontend.max_detections = 1000;
  int most = 0;
  const auto odometry = fly_without_heap(
      {flight}, options, &flight.truth.front(),
      [&](const Odometry& o, Time) { most = std::max(most, o.report().static_detections); });
  EXPECT_GT(most, 400);
  const NavState& x = odometry->at_scan();
  EXPECT_LT((x.p_WB - flight.truth_at(x.time).p_WB).norm(), 0.1);
}

TEST_P(AllocationOfBackEnd, NoneWhenAnAnchorIsFound) {
  const sim::Flight flight = flight_of(3, 60.0, 60.0);
  Options options = options_for(flight);
  AuxiliaryState anchor = auxiliary_state<Anchor>();
  anchor.delayed = true;
  ASSERT_TRUE(options.auxiliary.declare(anchor));
  const auto add_range = [&flight](Odometry& o, Time now) {
    const double range = (Vector3d(6.0, 3.0, 4.0) - flight.truth_at(now).p_WB).norm();
    (void)o.add_measurement({now, RangeModel{}, {range, 0.1}});
  };
  const auto odometry = fly_without_heap({flight}, options, nullptr, add_range);
  EXPECT_TRUE(auxiliary<Anchor>(*odometry));
}

INSTANTIATE_TEST_SUITE_P(BackEnds, AllocationOfBackEnd, kBothBackEnds, back_end_name);

}  // namespace
}  // namespace rio::test
