// SPDX-License-Identifier: BSD-3-Clause
#include "rio/checks/heading_check.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/constants.hpp"
#include "support/measured.hpp"
#include "support/random_state.hpp"

namespace rio {
namespace {

/// A filter of the bias alone, ten updates a second, each a measurement of it with sigma kNoise.
class BiasFilter {
 public:
  static constexpr double kNoise = 0.02;    // [rad/s]
  static constexpr double kSigma = 1.5e-4;  // of the bias, at the start
  static constexpr double kRate = 10.0;     // [Hz]

  explicit BiasFilter(test::Random* random) : random_(random) {
    truth_ = random->normal_vector(kSigma);
    x_.nav.q_WB = test::rotation_of({0.1, -0.2, 0.7});
    P_.diagonal().segment<3>(body::kGyroBias).setConstant(kSigma * kSigma);
  }

  double repeats = 1.0;  ///< measurements with the same error, in an update

  Vector3d up_B() const { return x_.nav.q_WB.conjugate() * Vector3d::UnitZ(); }
  void step(const Vector3d& by) { truth_ += by; }

  /// What the check says in so many seconds, the first time.
  std::optional<GyroBiasStep> run(double seconds, HeadingCheck* check) {
    for (int i = 0; i < static_cast<int>(seconds * kRate); ++i) {
      x_.nav.time += from_seconds(1.0 / kRate);
      x_.nav.p_WB.x() += 0.5 / kRate;
      check->predicted(x_, P_);
      const Vector3d z = truth_ + random_->normal_vector(kNoise);
      auto P = P_.block<3, 3>(body::kGyroBias, body::kGyroBias);
      const Matrix3d K = P * (P + kNoise * kNoise / repeats * Matrix3d::Identity()).inverse();
      x_.nav.gyro_bias += K * (z - x_.nav.gyro_bias);
      P -= (K * P).eval();
      if (auto opinion = check->corrected(x_, P_)) return opinion;
    }
    return {};
  }

 private:
  test::Random* random_;
  Vector3d truth_;
  Estimate x_;
  BodyCovariance P_ = BodyCovariance::Zero();
};

// Also where twenty measurements with one error are told as twenty.
TEST(HeadingCheck, IsSilentOnARightBias) {
  test::Random random(1);
  for (const double repeats : {1.0, 20.0}) {
    int contradicted = 0;
    for (int i = 0; i < 100; ++i) {
      BiasFilter filter(&random);
      filter.repeats = repeats;
      HeadingCheck check{Options{}};
      contradicted += filter.run(60.0, &check).has_value() ? 1 : 0;
    }
    const int most = repeats > 1.0 ? 10 : 2;  // 0.2 expected; with two sigmas most of them
    test::measured("windows of 100 minutes that contradict", contradicted,
                   "at most " + std::to_string(most));
    EXPECT_LE(contradicted, most);
  }
}

TEST(HeadingCheck, FindsAStepAboutTheVertical) {
  constexpr double kStep = 0.02;
  test::Random random(2);
  double error = 0.0;
  for (int i = 0; i < 20; ++i) {
    BiasFilter filter(&random);
    HeadingCheck check{Options{}};
    ASSERT_FALSE(filter.run(30.0, &check));
    filter.step(kStep * filter.up_B());
    const auto opinion = filter.run(20.0, &check);
    ASSERT_TRUE(opinion);
    EXPECT_NEAR(opinion->duration, 20.0, 1.01);
    EXPECT_NEAR(opinion->moved_W.norm(), 0.5 * opinion->duration, 0.1);
    error += opinion->error / 20.0;
  }
  test::expect_between("mean error of the window [rad/s]", error, 0.25 * kStep, kStep);
}

// However large: half of the parts have to agree, and then for two seconds.
TEST(HeadingCheck, WaitsUntilTheContradictionLasts) {
  test::Random random(6);
  BiasFilter filter(&random);
  HeadingCheck check{Options{}};
  ASSERT_FALSE(filter.run(30.0, &check));
  filter.step(0.2 * filter.up_B());
  EXPECT_FALSE(filter.run(10.5, &check));
  EXPECT_TRUE(filter.run(3.0, &check));
}

// Of fewer than ten seconds nobody tells how they scatter.
TEST(HeadingCheck, IsSilentInTheFirstTenSeconds) {
  test::Random random(7);
  for (const double step : {0.02, 0.2}) {
    BiasFilter filter(&random);
    HeadingCheck check{Options{}};
    filter.step(step * filter.up_B());
    EXPECT_FALSE(filter.run(9.0, &check)) << step;
    EXPECT_TRUE(filter.run(5.0, &check)) << step;
  }
}

TEST(HeadingCheck, LeavesTheOtherAxesToGravity) {
  test::Random random(3);
  BiasFilter filter(&random);
  HeadingCheck check{Options{}};
  filter.step(0.02 * filter.up_B().unitOrthogonal());
  EXPECT_FALSE(filter.run(20.0, &check));
}

TEST(HeadingCheck, ForgetsWhenItStartsOverAndCanBeSwitchedOff) {
  test::Random random(4);
  BiasFilter filter(&random);
  HeadingCheck check{Options{}};
  filter.step(0.02 * filter.up_B());
  ASSERT_TRUE(filter.run(20.0, &check));
  check.reset();
  EXPECT_FALSE(filter.run(0.2, &check));
  Options options;
  options.checks.heading = false;
  HeadingCheck off(options);
  EXPECT_FALSE(filter.run(20.0, &off));
}

}  // namespace
}  // namespace rio
