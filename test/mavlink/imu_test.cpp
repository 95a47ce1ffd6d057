// SPDX-License-Identifier: BSD-3-Clause
// The IMU of an autopilot at rest reads +g upwards here, whatever the message.
#include "rio/mavlink/imu.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace rio::mavlink::test {
namespace {

HighresImu some_highres() {
  HighresImu message;
  message.time_usec = 1'000'001;
  message.accel = {0.5F, 0.25F, -9.75F};
  message.gyro = {0.125F, 0.5F, -0.25F};
  message.fields_updated = 0x3F;
  return message;
}

TEST(MavlinkImu, HighresIsInSiUnits) {
  const auto sample = imu_sample(some_highres());
  ASSERT_TRUE(sample);
  EXPECT_EQ(sample->time, Time(1'000'001'000));
  EXPECT_EQ(sample->accel_B, Vector3d(0.5, -0.25, 9.75));
  EXPECT_EQ(sample->gyro_B, Vector3d(0.125, -0.5, 0.25));
}

TEST(MavlinkImu, OldAndOddValuesAreNoSample) {
  for (int bit = 0; bit < 6; ++bit) {
    HighresImu message = some_highres();
    message.fields_updated = static_cast<std::uint16_t>(0xFFFF ^ (1 << bit));
    EXPECT_FALSE(imu_sample(message)) << bit;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    HighresImu message = some_highres();
    message.accel[i] = kUnknown;
    EXPECT_FALSE(imu_sample(message));
    message = some_highres();
    message.gyro[i] = std::numeric_limits<float>::infinity();
    EXPECT_FALSE(imu_sample(message));
  }
}

TEST(MavlinkImu, ScaledIsInThousandths) {
  ScaledImu message;
  message.time_boot_ms = 4'294'967'295U;
  message.accel = {100, 200, -1000};
  message.gyro = {1, -2, 3000};
  const ImuSample sample = imu_sample(message);
  EXPECT_EQ(sample.time, std::chrono::milliseconds(4'294'967'295));
  EXPECT_LT((sample.accel_B - Vector3d(0.980665, -1.96133, 9.80665)).norm(), 1e-12);
  EXPECT_LT((sample.gyro_B - Vector3d(0.001, 0.002, -3.0)).norm(), 1e-12);
}

TEST(MavlinkImu, RawIsInWhatTheSenderSays) {
  RawImu message;
  message.time_usec = std::numeric_limits<std::uint64_t>::max();
  message.accel = {0, 0, -1000};
  message.gyro = {-32768, 0, 500};
  EXPECT_LT((imu_sample(message).accel_B - Vector3d(0, 0, 9.80665)).norm(), 1e-12);
  EXPECT_NEAR(imu_sample(message).gyro_B.z(), -0.5, 1e-12);
  EXPECT_GT(imu_sample(message).time, Time{0});
  const ImuSample other = imu_sample(message, {9.81 / 2048.0, 0.01});
  EXPECT_NEAR(other.accel_B.z(), 9.81 * 1000 / 2048, 1e-12);
  EXPECT_NEAR(other.gyro_B.x(), -327.68, 1e-12);
}

}  // namespace
}  // namespace rio::mavlink::test
