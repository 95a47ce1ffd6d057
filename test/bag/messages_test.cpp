// SPDX-License-Identifier: BSD-3-Clause
#include "rio/bag/messages.hpp"

#include <gtest/gtest.h>

#include "bag/ros_message.hpp"
#include "support/temp_dir.hpp"

namespace rio::bag {
namespace {

using test::bytes_of;
using test::Wire;

class Serialisation : public testing::TestWithParam<Wire::Kind> {
 protected:
  Encoding encoding() const { return GetParam() == Wire::kRos1 ? Encoding::kRos1 : Encoding::kCdr; }
  Topic of(const char* type) const { return {"", type, encoding(), ""}; }
  /// Two points with two channels.
  static std::string old_cloud() {
    Wire wire(GetParam());
    wire.header(Time(3), "eagle").put(std::uint32_t{2}).all({1.F, 2.F, 3.F, 4.F, 5.F, 6.F});
    wire.put(std::uint32_t{2});
    wire.text("Doppler").put(std::uint32_t{2}).put(-1.5F).put(2.5F);
    wire.text("Power").put(std::uint32_t{2}).put(10.F).put(20.F);
    return wire.bytes;
  }
};

TEST_P(Serialisation, ImuHasItsStampRatesAndForces) {
  const ImuSample sample{Time(1'700'000'000'987'654'321), {1.25, -2.5, 3.75}, {4.0, 5.5, -6.25}};
  const std::string bytes = imu_message(GetParam(), sample);
  const ImuMessage read = decode_imu_of(of(kImuType), bytes_of(bytes));
  EXPECT_EQ(read.sample.time, sample.time);
  EXPECT_EQ(read.header.stamp, sample.time);
  EXPECT_EQ(read.header.frame_id, "imu_link");
  EXPECT_EQ(read.sample.gyro_B, sample.gyro_B);
  EXPECT_EQ(read.sample.accel_B, sample.accel_B);
  EXPECT_TRUE(read.gyro && read.accel && !read.absent && !read.denied);
}

TEST_P(Serialisation, ImuWithoutAGyroscopeIsBelievedIfItsValuesAreZero) {
  const std::string none = imu_message(GetParam(), {}, -1.0);
  EXPECT_TRUE(decode_imu_of(of(kImuType), bytes_of(none)).absent);
  const std::string some = imu_message(GetParam(), {Time(1), {0.0, 0.1, 0.0}, {}}, -1.0);
  EXPECT_FALSE(decode_imu_of(of(kImuType), bytes_of(some)).absent);
  EXPECT_TRUE(decode_imu_of(of(kImuType), bytes_of(some)).denied);
}

TEST_P(Serialisation, CloudHasItsFieldsAndPointsInRows) {
  const std::vector<test::CloudField> fields = {{"x", 0, 7}, {"odd name", 5, 3}, {"d", 7, 8}};
  const test::Points points = {{1.5, -300, 0.1}, {2.5, 7, 0.2}, {3.5, 8, 0.3}, {4.5, 9, 1e-9}};
  const std::string bytes = cloud_message(GetParam(), Time(5), fields, points, 17, 2, 3);
  const PointCloud cloud = decode_cloud(encoding(), bytes_of(bytes));
  EXPECT_EQ(cloud.header.frame_id, "radar");
  EXPECT_EQ(fields_text(cloud.fields), "x float32 @0, odd name int16 @5, d float64 @7");
  ASSERT_EQ(cloud.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const PointField& field = cloud.fields[k];
      EXPECT_EQ(
          number_of_type(cloud.point(i).data() + field.offset, field.datatype, cloud.big_endian),
          points[i][k]);
    }
  }
}

TEST_P(Serialisation, TheOlderCloudHasAFieldForEachChannel) {
  const std::string bytes = old_cloud();
  const PointCloud cloud = decode_cloud_of(of(kOldCloudType), bytes_of(bytes));
  EXPECT_EQ(fields_text(cloud.fields),
            "x float32 @0, y float32 @4, z float32 @8, Doppler float32 @12, Power float32 @16");
  ASSERT_EQ(cloud.size(), 2U);
  const auto number = [&](std::uint64_t i, std::size_t k) {
    return number_of_type(cloud.point(i).data() + cloud.fields[k].offset, 7, cloud.big_endian);
  };
  EXPECT_EQ(number(1, 0), 4.0);
  EXPECT_EQ(number(0, 3), -1.5);
  EXPECT_EQ(number(1, 4), 20.0);
}

TEST_P(Serialisation, AShortMessageIsDamageWhereverItEnds) {
  std::string cloud = cloud_message(GetParam(), Time(0), test::ti_fields(), {{1, 2, 3, 4, 5}}, 32);
  cloud.pop_back();  // is not needed
  for (const auto& [type, bytes] :
       {std::pair(kImuType, imu_message(GetParam(), {})), std::pair(kCloudType, cloud),
        std::pair(kOldCloudType, old_cloud())}) {
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      const Bytes part = bytes_of(bytes).first(size);
      EXPECT_THROW(is_imu(type) ? (void)decode_imu_of(of(type), part)
                                : (void)decode_cloud_of(of(type), part),
                   Damage)
          << type << " " << size;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Bag, Serialisation,
                         testing::Values(Wire::kRos1, Wire::kCdr, Wire::kCdrBig));

/// The numbers of a cloud in front of its data.
std::string cloud_of(std::uint32_t width, std::uint32_t height, std::uint32_t step,
                     std::uint32_t row, std::uint32_t offset, std::uint8_t type) {
  Wire wire(Wire::kRos1);
  wire.header(Time(0), "").put(height).put(width).put(std::uint32_t{1});
  wire.text("x").put(offset).put(type).put(std::uint32_t{1});
  wire.put(std::uint8_t{0}).put(step).put(row).text(std::string(64, '\0')).put(std::uint8_t{1});
  return wire.bytes;
}

TEST(PointCloud, PointsOutsideOfTheDataAreRefused) {
  const auto decode = [](const std::string& bytes) {
    return decode_cloud(Encoding::kRos1, bytes_of(bytes)).size();
  };
  EXPECT_EQ(decode(cloud_of(4, 1, 16, 0, 12, 7)), 4U);  // the step of the only row does not matter
  EXPECT_EQ(decode(cloud_of(2, 2, 16, 32, 12, 7)), 4U);
  EXPECT_EQ(decode(cloud_of(0, 1, 0, 0, 0, 0)), 0U);
  EXPECT_ERROR(decode(cloud_of(5, 1, 16, 80, 0, 7)), "a cloud of 5 x 1 points");
  EXPECT_ERROR(decode(cloud_of(2, 2, 16, 33, 0, 7)), "a cloud of 2 x 2 points");
  EXPECT_ERROR(decode(cloud_of(1, 0xFFFFFFFF, 16, 0, 0, 7)), "a cloud of 1 x 4294967295 points");
  EXPECT_ERROR(decode(cloud_of(4, 1, 0, 0, 0, 7)), "points of 0 bytes");
  EXPECT_ERROR(decode(cloud_of(0xFFFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF, 0, 7)), "points");
  EXPECT_ERROR(decode(cloud_of(4, 1, 16, 64, 13, 7)), "\"x\" is of no known type or outside");
  EXPECT_ERROR(decode(cloud_of(4, 1, 16, 64, 0xFFFFFFFF, 7)), "\"x\" is of no known type");
  EXPECT_ERROR(decode(cloud_of(4, 1, 16, 64, 0, 9)), "\"x\" is of no known type or outside");
}

TEST(Cdr, OtherEncapsulationsAreRefused) {
  std::string bytes = imu_message(Wire::kCdr, {});
  bytes[1] = 3;  // a parameter list
  EXPECT_ERROR(decode_imu_of({"", kImuType, Encoding::kCdr, ""}, bytes_of(bytes)),
               "another way than plain CDR");
}

TEST(Cdr, VersionTwoAlignsToFourBytesAtMost) {
  const std::string bytes("\0\7\0\0\1\0\0\0\0\0\0\0\0\0\xF0\x3F", 16);
  WireReader reader = WireReader::cdr(bytes_of(bytes));
  EXPECT_EQ(reader.read<std::uint32_t>(), 1U);
  EXPECT_EQ(reader.read<double>(), 1.0);
}

TEST(BeginsWithHeader, IsKnownByTypeOrDefinition) {
  EXPECT_TRUE(begins_with_header({"/a", "sensor_msgs/Imu", Encoding::kCdr, ""}));
  EXPECT_TRUE(begins_with_header({"/a", "x/Y", Encoding::kRos1, "# A\n\nHeader header\nint8 a"}));
  EXPECT_TRUE(begins_with_header({"/a", "x/Y", Encoding::kCdr, "std_msgs/msg/Header header"}));
  EXPECT_FALSE(begins_with_header({"/a", "x/Y", Encoding::kRos1, "int8 a\nHeader header"}));
  EXPECT_FALSE(begins_with_header({"/a", "sensor_msgs/Imu", Encoding::kOther, ""}));
}

}  // namespace
}  // namespace rio::bag
