// SPDX-License-Identifier: BSD-3-Clause
#include "rio/propagate/predictor.hpp"

#include <gtest/gtest.h>

#include "support/constants.hpp"
#include "support/random_state.hpp"

namespace rio {
namespace {

using test::kGravity;

TEST(Predictor, SampleBySampleEqualsAllAtOnce) {
  test::Random random(6);
  const NavState start = random.state();
  ImuBuffer imu(TimingOptions{}, ImuOptions{});
  Predictor gradual(kGravity);
  gradual.rebase(start, imu);
  for (int i = 0; i < 50; ++i) {
    imu.push_back({Time(5'000'000 * (i - 3)), random.normal_vector(), random.normal_vector(5.0)});
    gradual.advance(imu);
  }
  Predictor at_once(kGravity);
  at_once.rebase(start, imu);
  EXPECT_EQ(gradual.state().time, imu.newest().time);
  EXPECT_EQ(at_once.state().time, imu.newest().time);
  EXPECT_LT(test::error_of(at_once.state(), gradual.state()).norm(), 1e-14);
}

}  // namespace
}  // namespace rio
