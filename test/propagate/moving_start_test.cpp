// SPDX-License-Identifier: BSD-3-Clause
#include "rio/propagate/moving_start.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/constants.hpp"
#include "support/symmetric.hpp"

namespace rio::test {
namespace {

using std::chrono::milliseconds;

/// What an IMU measures that turns steadily and accelerates in turns forwards and backwards.
class Turning {
 public:
  ImuSample sample(int i) const {
    const double t = 0.005 * i;
    const Vector3d force =
        kGravity * Vector3d::UnitZ() + 2.0 * std::sin(9.0 * t) * Vector3d::UnitX();
    return {Time(milliseconds(5 * i)), rate_B, attitude(i).conjugate() * force};
  }
  Quaternion attitude(int i) const {
    return Quaternion(Eigen::AngleAxisd(0.005 * i * rate_B.norm(), rate_B.normalized()));
  }
  Vector3d rate_B{0.5, -0.3, 0.2};
};

/// A sample at rest or at constant speed, each 5 ms.
ImuSample steady(int i, const Vector3d& force_B = kGravity * Vector3d::UnitZ()) {
  return {Time(milliseconds(5 * i)), Vector3d::Zero(), force_B};
}

/// The start from samples i = 0, 1, ...
template <class Sample>
Alignment start(const StartOptions& options, const Sample& sample) {
  MovingStart moving(options, kGravity);
  for (int i = 0; i < 2000; ++i) {
    if (const auto found = moving.add(sample(i))) return *found;
  }
  ADD_FAILURE() << "no start";
  return {};
}

TEST(MovingStart, IsLevelAlthoughTheBodyTurns) {
  StartOptions options;
  options.max_wait = 4.0;
  const Turning imu;
  const Alignment found = start(options, [&](int i) { return imu.sample(i); });
  EXPECT_EQ(found.state.time, Time(milliseconds(4000)));
  EXPECT_TRUE(found.state.v_WB.isZero());
  const Vector3d up = found.state.q_WB * imu.attitude(800).conjugate() * Vector3d::UnitZ();
  // 2 m/s^2 back and forth at 9 rad/s leave a tenth of it in a mean over 1.5 s
  EXPECT_LT(std::acos(up.z()), 0.03);
  EXPECT_TRUE(is_positive_definite(found.covariance));
  EXPECT_GT(std::sqrt(found.covariance(0, 0)), 0.05);
}

TEST(MovingStart, WaitsForEverByDefault) {
  MovingStart moving(StartOptions{}, kGravity);
  for (int i = 0; i < 20000; ++i) ASSERT_FALSE(moving.add(Turning().sample(i)));
}

TEST(MovingStart, CountsItsWaitAnewAfterAReset) {
  StartOptions options;
  options.max_wait = 1.0;
  const Turning imu;
  MovingStart moving(options, kGravity);
  for (int i = 0; i < 150; ++i) EXPECT_FALSE(moving.add(imu.sample(i)));
  moving.reset();
  for (int i = 150; i < 350; ++i) EXPECT_FALSE(moving.add(imu.sample(i)));
  EXPECT_TRUE(moving.add(imu.sample(350)));
}

// The mean is over the last `duration`, not over the wait.
TEST(MovingStart, ForgetsWhatWasBeforeItsDuration) {
  const StartOptions options{.duration = 0.5, .max_wait = 4.0};
  const Quaternion tilted(Eigen::AngleAxisd(0.3, Vector3d::UnitX()));
  const Alignment found = start(options, [&](int i) {
    return i < 400 ? steady(i) : steady(i, kGravity * (tilted.conjugate() * Vector3d::UnitZ()));
  });
  EXPECT_LT(found.state.q_WB.angularDistance(tilted), 0.3 * 0.05);  // exp(-2 / 0.5) = 0.02
}

// A shorter mean says less; of a sample after a pause no more than itself is taken.
TEST(MovingStart, IsAsSureAsItsMeanIsLong) {
  StartOptions options;
  options.duration = 1.5;
  const auto sigma = [&options](double wait) {
    options.max_wait = wait;
    return std::sqrt(start(options, [](int i) { return steady(i); }).covariance(0, 0));
  };
  EXPECT_NEAR(sigma(0.3) / sigma(1.5), 5.0, 1e-9);
  EXPECT_EQ(sigma(3.0), sigma(1.5));

  options.max_wait = 3.0;
  MovingStart moving(options, kGravity);
  for (int i = 0; i < 200; ++i) ASSERT_FALSE(moving.add(steady(i)));
  const Vector3d tilted(1.0, 0.0, kGravity);
  const auto after = moving.add(steady(2000, tilted));
  ASSERT_TRUE(after);
  EXPECT_LT((after->state.q_WB * tilted.normalized() - Vector3d::UnitZ()).norm(), 1e-9);
}

}  // namespace
}  // namespace rio::test
