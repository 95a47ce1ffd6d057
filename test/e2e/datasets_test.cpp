// SPDX-License-Identifier: BSD-3-Clause
// Public data sets by name. No original is at hand: for each a short simulated flight is written
// with the topics, types, fields and axes that its sources tell, among decoys, and read by its
// name.
#include <gtest/gtest.h>

#include <map>
#include <optional>
#include <set>
#include <sstream>

#include "e2e/miniature.hpp"
#include "e2e/tool.hpp"
#include "rio/bag/dataset_presets.hpp"
#include "rio/io/dataset.hpp"
#include "rio/io/trajectory.hpp"
#include "support/measured.hpp"
#include "support/same_recording.hpp"

namespace rio::test {
namespace {

class DataSets : public Tool {
 protected:
  static void SetUpTestSuite() {
    Tool::SetUpTestSuite();
    flight_data_ = new io::Dataset(io::read_dataset(flight_));
    io::Dataset& data = *flight_data_;
    constexpr double kLength = 12.0;  // [s]
    const Time end = data.imu.front().time + from_seconds(kLength);
    std::erase_if(data.imu, [&](const ImuSample& s) { return s.time > end; });
    std::erase_if(data.scans, [&](const RadarScan& s) { return s.time > end; });
  }
  static void TearDownTestSuite() {
    delete flight_data_;
    Tool::TearDownTestSuite();
  }

  /// The flight with its radar turned as the data set has it, or along the axes of the IMU.
  static io::Dataset turned(const bag::DatasetPreset& preset) {
    io::Dataset data = *flight_data_;
    Quaternion of_preset = Quaternion::Identity();
    if (preset.is_mounted()) of_preset = preset.T_BS().rotation;
    const Matrix3d R = (of_preset.conjugate() * data.radar_info.T_BS->rotation).toRotationMatrix();
    for (RadarScan& scan : data.scans) {
      for (RadarDetection& d : scan.detections) d.point_S = R * d.point_S;
    }
    return data;
  }

  static void expect_same(const io::Dataset& read, const io::Dataset& put, double snr_step) {
    expect_same_recording(read, put, 1e-5, 1e-5,
                          [&](const RadarDetection& a, const RadarDetection& b) {
                            if (a.snr_db != 0.0) {
                              ASSERT_NEAR(a.snr_db, b.snr_db, snr_step);
                            }
                          });
  }

  /// Against the published rotations, of the axes of the chip: right, forward, up.
  static void expect_mounted(const std::optional<Pose>& T_BS, const std::string& name) {
    const std::map<std::string, Quaternion> published = {
        {"brio", {-0.20673802, 0.67620958, 0.67620958, -0.20673802}},
        {"ekf-rio-tc", {0.6532815, -0.2705981, 0.2705981, -0.6532815}}};
    const auto chip = published.find(name);
    ASSERT_EQ(T_BS.has_value(), chip != published.end());
    if (!T_BS) return;
    const Quaternion& q = T_BS->rotation;
    EXPECT_LT((q * Vector3d::UnitX() - chip->second * Vector3d::UnitY()).norm(), 1e-5);
    EXPECT_LT((q * Vector3d::UnitZ() - chip->second * Vector3d::UnitZ()).norm(), 1e-5);
  }

  /// info, check and replay of a recording; the path is near the true one.
  static void expect_runs(const std::string& recording, const std::string& options) {
    rio("info " + recording);
    rio("check " + recording + options);
    rio("replay " + recording + options + " --init static --quiet --no-check --out " +
        file("run.tum"));
    const double error = path_error(flight_, file("run.tum"), " --align yaw");
    expect_below("error of " + fs::path(recording).stem().string() + " [m]", error, 0.1);
  }

  inline static io::Dataset* flight_data_ = nullptr;
};

TEST_F(DataSets, EveryNameHasAMiniature) {
  std::set<std::string> names;
  std::set<std::string> written = {"hercules"};  // a folder, below
  for (const bag::DatasetPreset& preset : bag::dataset_presets()) names.insert(preset.name);
  for (const Miniature& mini : miniatures()) written.insert(mini.name);
  EXPECT_EQ(names, written);
}

TEST_F(DataSets, AreReadByTheirNames) {
  for (const Miniature& mini : miniatures()) {
    SCOPED_TRACE(mini.name);
    const bag::DatasetPreset& preset = bag::dataset_preset(mini.name);
    const io::Dataset put = turned(preset);
    const std::string recording = file(mini.name + ".bag");
    write_bag(recording, mini.format, messages_of(mini, put), 500);
    const std::string options = " --dataset " + mini.name;
    const Outcome convert = rio("convert " + recording + " " + file("out") + " --force" + options);
    const io::Dataset read = io::read_dataset(file("out"));
    expect_same(read, put, mini.has_int16() ? 0.051 : 1e-5);
    EXPECT_EQ(read.other_radars.size() + 1, mini.radars.size());
    expect_mounted(read.radar_info.T_BS, mini.name);
    EXPECT_EQ(read.baro.empty(), mini.pressure == "-");
    EXPECT_EQ(read.ground_truth.empty(), mini.truth == "-");
    for (const NavState& state : read.ground_truth) EXPECT_LT(state.p_WB.norm(), 50.0);
    if (*preset.doubt != '\0') {
      expect_parts(convert.output, {std::string("not sure: ") + preset.doubt});
    }
    expect_runs(recording, options);
    fs::remove_all(file("out"));
    fs::remove(recording);
  }
}

TEST_F(DataSets, MapAndCommandLineWinAndAWrongNameIsTold) {
  const Miniature mini = miniatures()[5];
  const std::string recording = file("mini");
  write_bag(recording, mini.format, messages_of(mini, *flight_data_), 500);
  const std::string map = dir_->write("map.yaml", "imu: {topic: /decoy/imu}\n");
  const auto gyro = [&](const std::string& options) {
    rio("convert " + recording + " " + file("own") + " --force --dataset ekf-rio-tc" + options);
    return io::read_dataset(file("own")).imu.front().gyro_B.x();
  };
  EXPECT_LT(gyro(""), 1.0);
  EXPECT_EQ(gyro(" --map " + map), 3.0);
  EXPECT_LT(gyro(" --map " + map + " --imu /imu/data"), 1.0);
  const Vector3d accel = io::read_dataset(file("own")).imu.front().accel_B;
  gyro(" --imu-axes frd");
  EXPECT_EQ(io::read_dataset(file("own")).imu.front().accel_B,
            Vector3d(accel.x(), -accel.y(), -accel.z()));
  fails(1, "replay " + recording + " --dataset colorada",
        {"no such data set: \"colorada\", did you mean \"coloradar\"?", "brio: ethz-asl/rio"});
  fails(1, "replay " + recording + " --dataset brio", {"no topic /imu/data_raw; there are"});
}

std::string floats(const std::vector<double>& values) {
  Wire wire(Wire::kRos1);
  for (const double value : values) wire.put(static_cast<float>(value));
  return wire.bytes;
}
std::string spaced(const Vector3d& a, const Vector3d& b, char separator) {
  std::ostringstream out;
  out.precision(17);
  for (const double value : a) out << value << separator;
  out << b.x() << separator << b.y() << separator << b.z();
  return out.str();
}

TEST_F(DataSets, AFolderOfColoRadar) {
  const io::Dataset put = turned(bag::dataset_preset("coloradar"));
  std::string imu;
  std::string stamps;
  for (const ImuSample& s : put.imu) {
    imu += spaced(s.accel_B, s.gyro_B, ' ') + "\n";
    stamps += io::seconds_text(s.time) + "\n";
  }
  dir_->write("colo/imu/imu_data.txt", imu);
  dir_->write("colo/imu/timestamps.txt", stamps);
  stamps.clear();
  for (std::size_t i = 0; i < put.scans.size(); ++i) {
    std::string bytes;
    for (const RadarDetection& d : put.scans[i].detections) {
      const Vector3d p = in_axes("rfu", d.point_S);
      bytes += floats({p.x(), p.y(), p.z(), d.snr_db, d.range_rate});
    }
    const std::string name = "radar_pointcloud_" + std::to_string(i) + ".bin";
    dir_->write("colo/single_chip/pointclouds/data/" + name, bytes);
    stamps += io::seconds_text(put.scans[i].time) + "\n";
  }
  dir_->write("colo/single_chip/pointclouds/timestamps.txt", stamps);
  const std::string folder = file("colo");
  expect_same(io::read_dataset(folder), put, 1e-5);
  const auto stream = io::open_dataset(folder);
  expect_same(io::collect(stream.get()), put, 1e-5);
  expect_runs(folder, "");
  expect_runs(folder, " --dataset coloradar");
  expect_runs(folder, " --axes ti");  // those of its files
  fails(1, "replay " + folder + " --radar /radar", {"it is none"});
  rio("convert " + folder + " " + file("asl") + " --sensors " + flight_);
  const io::Dataset asl = io::read_dataset(file("asl"));
  expect_same(asl, put, 1e-5);
  EXPECT_LT((asl.radar_info.T_BS->translation - put.radar_info.T_BS->translation).norm(), 1e-9);
  dir_->write("colo/single_chip/pointclouds/data/radar_pointcloud_3.bin", "damaged");
  const Parts cut = {"radar_pointcloud_3.bin: 7 bytes are no points of 20 bytes"};
  fails(1, "replay " + folder + " --quiet --out " + file("cut.tum"), cut);
  EXPECT_GT(lines_of(file("cut.tum")).size() + 2, lines_of(file("run.tum")).size());
  for (std::size_t k = 0; k < put.scans.size(); ++k) {  // of most it is another format
    dir_->write("colo/single_chip/pointclouds/data/radar_pointcloud_" + std::to_string(k) + ".bin",
                std::string(28, '\0'));
  }
  EXPECT_ERROR(io::read_dataset(folder), "28 bytes are no points of 20 bytes");
}

TEST_F(DataSets, AFolderOfHercules) {
  const io::Dataset put = turned(bag::dataset_preset("hercules"));
  std::string imu;
  for (const ImuSample& s : put.imu) {
    imu += std::to_string(s.time.count()) + ",0,0,0,1,0,0,0," + spaced(s.gyro_B, s.accel_B, ',') +
           ",0.1,0.2,0.3\n";
  }
  dir_->write("hercules/sensor_data/xsens_imu.csv", imu);
  for (const double sign : {-1.0, 1.0}) {
    for (const RadarScan& scan : put.scans) {
      std::string bytes;
      for (const RadarDetection& d : scan.detections) {
        const Vector3d& p = d.point_S;
        bytes += floats({p.x(), p.y(), p.z(), sign * d.range_rate, p.norm()}) + "\x07" +
                 floats({0.1, 0.2});
      }
      bytes += floats({NAN, 1, 1, 0, 1}) + "\x07" + floats({0.1, 0.2});
      dir_->write("hercules/Radar/Continental/" + std::to_string(scan.time.count()) + ".bin",
                  bytes);
    }
    if (sign > 0.0) continue;
    fails(3, "check " + file("hercules") + " --dataset hercules",
          {"-> `rio convert`, then negate the column doppler of radar0/data.csv"});
  }
  expect_same(io::read_dataset(file("hercules")), put, 0.0);
  rio("info " + file("hercules"),
      {std::to_string(put.scans.size()) + " points are not finite and are left out"});
  expect_runs(file("hercules"), " --dataset hercules");
}

}  // namespace
}  // namespace rio::test
