// SPDX-License-Identifier: BSD-3-Clause
// Damaged recordings: whatever the bytes, the readers end, with a bounded amount of memory.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdlib>
#include <random>

#include "bag/bag_writer.hpp"
#include "rio/bag/recording.hpp"
#include "rio/bag/summary.hpp"
#include "rio/io/scan_folder.hpp"
#include "support/measured.hpp"
#include "support/temp_dir.hpp"

namespace rio::bag {
namespace {

/// Flips bits, puts in numbers that are lengths at their worst, cuts, repeats and removes.
class Mutator {
 public:
  explicit Mutator(unsigned seed) : random_(seed) {}

  std::string operator()(std::string bytes) {
    for (int n = 1 + below(4); n > 0 && bytes.size() > 8; --n) mutate(&bytes);
    return bytes;
  }

 private:
  int below(std::size_t limit) { return static_cast<int>(random_() % limit); }

  void mutate(std::string* bytes) {
    const auto place = static_cast<std::size_t>(below(bytes->size() - 4));
    static const std::string kLengths[] = {
        {"\xFF\xFF\xFF\xFF", 4}, {"\xFF\xFF\xFF\x7F", 4}, {"\0\0\0\x40", 4}, {"\0\0\0\0", 4}};
    switch (below(6)) {
      case 0:
      case 1:
        (*bytes)[place] = static_cast<char>((*bytes)[place] ^ (1 << below(8)));
        break;
      case 2:
        (*bytes)[place] = static_cast<char>(below(256));
        break;
      case 3:
        bytes->replace(place, 4, kLengths[below(4)]);
        break;
      case 4:
        bytes->erase(place, 1 + static_cast<std::size_t>(below(bytes->size() - place)));
        break;
      default:
        bytes->insert(place, bytes->substr(place / 2, 1 + static_cast<std::size_t>(below(200))));
    }
  }

  std::minstd_rand random_;
};

double peak_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

#if defined(__SANITIZE_ADDRESS__)
constexpr bool kSanitised = true;  // g++
#elif defined(__has_feature)
constexpr bool kSanitised = __has_feature(address_sanitizer);  // clang++
#else
constexpr bool kSanitised = false;
#endif

class Mutation : public testing::TestWithParam<std::string> {};

TEST_P(Mutation, DamagedFilesEndInMessagesOrAnError) {
  const char* const asked = std::getenv("RIO_MUTATIONS");
  const int count = asked == nullptr ? 500 : std::atoi(asked);
  const test::TempDir dir;
  test::write_bag(dir.path() / "good", GetParam(), test::at_rest(test::wire_of(GetParam()), 3), 11);
  const std::string good = dir.read("good");
  const double before = peak_megabytes();
  int read = 0;
  int partly = 0;
  int refused = 0;
  for (int i = 0; i < count; ++i) {
    const auto path = dir.write("bad", Mutator(static_cast<unsigned>(i + 1))(good));
    try {
      const Recording recording = read_recording(path, {});
      recording.damage.empty() ? ++read : ++partly;
      EXPECT_LE(recording.dataset.imu.size(), 200U);  // 30 in the good one; parts may be repeated
      summary_text(summarise(open_messages(path).get()));
    } catch (const std::runtime_error&) {
      ++refused;
    }
  }
  EXPECT_EQ(read + partly + refused, count);
  EXPECT_GT(partly, count / 50);
  test::measured(GetParam() + ": read in part, of " + std::to_string(count), partly, "some");
  const double grown = peak_megabytes() - before;
  test::measured(GetParam() + ": growth of memory [MB]", grown, "below 64 where not sanitised");
  if (!kSanitised) {
    EXPECT_LT(grown, 64.0);
  }
}

TEST(MutatedMessages, DamagedMessagesAreDecodedOrRefused) {
  for (const test::Wire::Kind kind : {test::Wire::kRos1, test::Wire::kCdr, test::Wire::kCdrBig}) {
    const Encoding encoding = kind == test::Wire::kRos1 ? Encoding::kRos1 : Encoding::kCdr;
    const std::string imu = imu_message(kind, {});
    const std::string cloud =
        cloud_message(kind, Time(0), test::ti_fields(), {{1, 2, 3, 4, 5}, {6, 7, 8, 9, 0}}, 32);
    test::Wire old(kind);
    old.header(Time(0), "old").put(std::uint32_t{1}).put(1.F).put(2.F).put(3.F);
    old.put(std::uint32_t{1}).text("Doppler").put(std::uint32_t{1}).put(4.F);
    test::Wire point(kind);
    point.header(Time(0), "ti").put(std::uint16_t{0});
    for (int k = 0; k < 5; ++k) point.put(1.F);
    point.put(std::uint16_t{0}).put(1.F).put(2.F);
    test::Wire returns(kind);
    returns.header(Time(0), "ros").put(std::uint32_t{2});
    for (int k = 0; k < 10; ++k) returns.put(1.F);
    test::Wire pose(kind);
    pose.header(Time(0), "map");
    test::Wire odometry(kind);
    odometry.header(Time(0), "map").text("body");
    test::Wire frames(kind);
    frames.put(std::uint32_t{1}).header(Time(0), "a").text("b");
    for (test::Wire* wire : {&pose, &odometry, &frames}) {
      for (int k = 0; k < 7; ++k) wire->put(k == 6 ? 1.0 : 0.0);
    }
    for (int k = 0; k < 36 + 6; ++k) odometry.put(0.0);
    test::Wire px4(kind);
    px4.put(std::uint64_t{1}).put(1.F).put(2.F).put(3.F).put(std::uint32_t{1}).put(std::int32_t{0});
    px4.put(1.F).put(2.F).put(3.F).put(std::uint32_t{1});
    const std::pair<const char*, std::string> others[] = {
        {kImuType, imu},
        {kPx4ImuType, px4.bytes},
        {kPoseType, pose.bytes},
        {kOdometryType, odometry.bytes},
        {kPressureType, test::Wire(kind).header(Time(0), "b").put(1e5).put(0.0).bytes},
        {"tf2_msgs/TFMessage", frames.bytes}};
    const std::pair<const char*, std::string> clouds[] = {
        {kCloudType, cloud},
        {kOldCloudType, old.bytes},
        {kTiScanType, test::block(point.bytes) + test::block(point.bytes)},
        {kRadarScanType, returns.bytes}};
    int refused = 0;
    const char* const asked = std::getenv("RIO_MUTATIONS");
    const int kCount = asked == nullptr ? 10'000 : std::atoi(asked);
    const int all = 10 * kCount;
    for (int i = 0; i < kCount; ++i) {
      Mutator mutate(static_cast<unsigned>(i + 1));
      const auto bytes_of = [](const std::string& text) {
        return Bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
      };
      const auto attempt = [&](const auto& decode) {
        try {
          decode();
        } catch (const std::runtime_error&) {
          ++refused;
        }
      };
      const auto topic = [encoding](const char* type) {
        return Topic{"/tf_static", type, encoding, ""};
      };
      Header header;
      bool has_velocity = false;
      for (const auto& [type, good] : others) {
        const std::string bytes = mutate(good);
        const Topic of = topic(type);
        attempt([&, type = type] {
          if (is_imu(type)) (void)decode_imu_of(of, bytes_of(bytes));
          if (is_truth(type)) (void)decode_truth(of, bytes_of(bytes), &header, &has_velocity);
          if (is_transforms(of)) (void)decode_transforms(encoding, bytes_of(bytes));
          if (of.type == kPressureType) (void)decode_pressure(encoding, bytes_of(bytes), &header);
        });
      }
      for (const auto& [type, good] : clouds) {
        const std::string bytes = mutate(good);
        (void)ti_point_id(encoding, bytes_of(bytes));
        attempt([&, type = type] {
          const PointCloud read = decode_cloud_of({"", type, encoding, ""}, bytes_of(bytes));
          std::vector<RadarDetection> detections;
          PointMap(read.fields, {}).convert(read, &detections);
          EXPECT_LE(detections.size(), bytes.size());
        });
      }
    }
    EXPECT_GT(refused, kCount);
    EXPECT_LT(refused, all);
    test::measured("refused of " + std::to_string(all), refused, "some, not all");
  }
}

// Sequences with a file per scan: text of the IMU and the stamps, points, names.
TEST(MutatedSequences, DamagedFilesAreReadOrRefused) {
  const char* const asked = std::getenv("RIO_MUTATIONS");
  const int count = asked == nullptr ? 2000 : std::atoi(asked);
  const std::string points(58, '\1');
  const std::string stamp = "Radar/Continental/1700000000000000000.bin";
  using Files = std::vector<std::pair<std::string, std::string>>;
  const Files sequences[] = {
      {{"imu/imu_data.txt", "0.1 0.2 9.8 0 0 0\n0.1 0.2 9.8 0 0 0\n"},
       {"imu/timestamps.txt", "1700000000.01\n1700000000.02\n"},
       {"single_chip/pointclouds/timestamps.txt", "1700000000.015\n"},
       {"single_chip/pointclouds/data/radar_pointcloud_0.bin", std::string(40, '\1')}},
      {{"sensor_data/xsens_imu.csv",
        "1700000000000000000,0,0,0,1,0,0,0,0.1,0.2,0.3,1,2,9.8,0,0,0\n"},
       {stamp, points}}};
  const test::TempDir dir;
  int read = 0, refused = 0;
  for (int i = 0; i < count; ++i) {
    Mutator mutate(static_cast<unsigned>(i + 1));
    const Files& files = sequences[i % 2];
    const std::size_t bad = static_cast<std::size_t>(i / 2) % (files.size() + 1);
    const std::string folder = "sequence/";
    for (std::size_t k = 0; k < files.size(); ++k) {
      dir.write(folder + files[k].first, k == bad ? mutate(files[k].second) : files[k].second);
    }
    if (bad == files.size()) {  // a stamp in a name
      dir.write(folder + "Radar/Continental/" + (i % 4 < 2 ? "9" : "-") + "999999999999999999.bin",
                points);
    }
    try {
      const auto stream = io::open_scan_folder(dir.path() / "sequence");
      const io::Dataset data = io::collect(stream.get());
      EXPECT_FALSE(data.imu.empty() || data.scans.empty());
      ++read;
    } catch (const std::runtime_error&) {
      ++refused;
    }
    std::filesystem::remove_all(dir.path() / "sequence");
  }
  EXPECT_EQ(read + refused, count);
  EXPECT_GT(read, count / 20);
  EXPECT_GT(refused, count / 20);
}

INSTANTIATE_TEST_SUITE_P(Bag, Mutation, testing::ValuesIn(test::formats()), test::format_name);

}  // namespace
}  // namespace rio::bag
