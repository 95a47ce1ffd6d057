// SPDX-License-Identifier: BSD-3-Clause
#include "rio/checks/correction_check.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/measured.hpp"
#include "support/random_state.hpp"

namespace rio {
namespace {

constexpr CorrectionCheck::Window kWindow{std::chrono::seconds(1), 20, 10, std::chrono::seconds(2),
                                          0.005};

/// A filter of one bias alone, ten updates a second, each a measurement of it with sigma kNoise.
class BiasFilter {
 public:
  static constexpr double kNoise = 0.02;    // [rad/s]
  static constexpr double kSigma = 1.5e-4;  // of the bias, at the start
  static constexpr double kRate = 10.0;     // [Hz]

  explicit BiasFilter(test::Random* random) : random_(random), truth_(random->normal(kSigma)) {}

  double repeats = 1.0;  ///< measurements with the same error, in an update

  void step(double by) { truth_ += by; }

  /// What the check says in so many seconds, the first time.
  std::optional<LastingError> run(double seconds, CorrectionCheck* check) {
    for (int i = 0; i < static_cast<int>(seconds * kRate); ++i) {
      x_.time += from_seconds(1.0 / kRate);
      x_.p_WB.x() += 0.5 / kRate;
      check->predicted(x_, bias_, variance_);
      const double gain = variance_ / (variance_ + kNoise * kNoise / repeats);
      bias_ += gain * (truth_ + random_->normal(kNoise) - bias_);
      variance_ -= gain * variance_;
      if (auto opinion = check->corrected(x_, bias_, variance_)) return opinion;
    }
    return {};
  }

 private:
  test::Random* random_;
  double truth_;
  NavState x_;
  double bias_ = 0.0;
  double variance_ = kSigma * kSigma;
};

// Also where twenty measurements with one error are told as twenty.
TEST(CorrectionCheck, IsSilentOnARightBias) {
  test::Random random(1);
  for (const double repeats : {1.0, 20.0}) {
    int contradicted = 0;
    for (int i = 0; i < 100; ++i) {
      BiasFilter filter(&random);
      filter.repeats = repeats;
      CorrectionCheck check{kWindow};
      contradicted += filter.run(60.0, &check).has_value() ? 1 : 0;
    }
    const int most = repeats > 1.0 ? 10 : 2;  // 0.2 expected; with two sigmas most of them
    test::measured("windows of 100 minutes that contradict", contradicted,
                   "at most " + std::to_string(most));
    EXPECT_LE(contradicted, most);
  }
}

TEST(CorrectionCheck, FindsAStep) {
  constexpr double kStep = 0.02;
  test::Random random(2);
  double error = 0.0;
  for (int i = 0; i < 20; ++i) {
    BiasFilter filter(&random);
    CorrectionCheck check{kWindow};
    ASSERT_FALSE(filter.run(30.0, &check));
    filter.step(kStep);
    const auto opinion = filter.run(20.0, &check);
    ASSERT_TRUE(opinion);
    EXPECT_NEAR(opinion->duration, 20.0, 1.01);
    EXPECT_NEAR(opinion->moved_W.norm(), 0.5 * opinion->duration, 0.1);
    error += opinion->error / 20.0;
  }
  test::expect_between("mean error of the window [rad/s]", error, 0.25 * kStep, kStep);
}

// However large: half of the parts have to agree, and then for two seconds.
TEST(CorrectionCheck, WaitsUntilTheContradictionLasts) {
  test::Random random(6);
  BiasFilter filter(&random);
  CorrectionCheck check{kWindow};
  ASSERT_FALSE(filter.run(30.0, &check));
  filter.step(0.2);
  EXPECT_FALSE(filter.run(10.5, &check));
  EXPECT_TRUE(filter.run(3.0, &check));
}

// Of fewer than ten seconds nobody tells how they scatter.
TEST(CorrectionCheck, IsSilentInTheFirstTenSeconds) {
  test::Random random(7);
  for (const double step : {0.02, 0.2}) {
    BiasFilter filter(&random);
    CorrectionCheck check{kWindow};
    filter.step(step);
    EXPECT_FALSE(filter.run(9.0, &check)) << step;
    EXPECT_TRUE(filter.run(5.0, &check)) << step;
  }
}

// What a wrong scale of 2 % corrects in a change of the quantity is no contradiction.
TEST(CorrectionCheck, AllowsAScaleErrorOfTheChange) {
  for (const bool changes : {true, false}) {
    CorrectionCheck check{kWindow};
    NavState x;
    bool contradicted = false;
    double value = 0.0;
    for (int i = 0; i < 200; ++i) {  // the sum of corrections becomes 20 of its sigmas
      x.time += from_seconds(0.1);
      if (changes) value += 0.005;
      check.predicted(x, value, 1e-7);
      value += 3e-5;
      contradicted |= check.corrected(x, value, 0.995e-7).has_value();
    }
    EXPECT_EQ(contradicted, !changes);
  }
}

TEST(CorrectionCheck, ForgetsWhenItStartsOver) {
  test::Random random(4);
  BiasFilter filter(&random);
  CorrectionCheck check{kWindow};
  filter.step(0.02);
  ASSERT_TRUE(filter.run(20.0, &check));
  check.reset();
  EXPECT_FALSE(filter.run(0.2, &check));
}

}  // namespace
}  // namespace rio
