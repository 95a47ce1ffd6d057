// SPDX-License-Identifier: BSD-3-Clause
// Public data sets by name. No original is at hand: for each a short simulated flight is written
// with the topics, types, fields and axes that its sources tell, among decoys, and read by its
// name.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <sstream>

#include "bag/bag_writer.hpp"
#include "e2e/tool.hpp"
#include "rio/bag/dataset_presets.hpp"
#include "rio/io/dataset.hpp"
#include "rio/io/trajectory.hpp"
#include "support/measured.hpp"
#include "support/same_recording.hpp"

namespace rio::test {
namespace {

/// As the sources of a data set describe it, apart from the table of the program. Axes: where x, y,
/// z point, of f, l, u: forward, left, up, and b, r, d, the opposite.
struct Miniature {
  std::string name;
  std::string format;
  std::string imu;
  std::string imu_axes;
  std::vector<std::string> radars;
  std::string axes;  ///< of the points
  std::string pressure;
  std::string truth;
  std::string fields;  ///< NAME=QUANTITY; *10: as int16; without a name: not among the fields

  Wire::Kind wire() const { return wire_of(format); }
  bool is_old() const { return fields.starts_with("Doppler"); }  ///< channels of PointCloud
  bool has_int16() const { return fields.find("*10") != std::string::npos; }
  std::string truth_type() const {
    return truth.find("pose") == std::string::npos || truth.find("odom") != std::string::npos
               ? "nav_msgs/Odometry"
               : "geometry_msgs/PoseStamped";
  }
};

/// Columns as in Miniature; - is none.
constexpr const char* kTable = R"(
icins-2021 ros1-none /sensor_platform/imu flu /sensor_platform/radar/scan rfu /sensor_platform/baro /ground_truth/pose x=x y=y z=z snr_db=snr noise_db=noise v_doppler_mps=doppler range=range
jgn-2022 ros1-none /sensor_platform/imu flu /sensor_platform/radar_left/scan,/sensor_platform/radar_right/scan,/sensor_platform/radar_center/scan rfu /sensor_platform/baro /ground_truth/pose x=x y=y z=z snr_db=snr noise_db=noise v_doppler_mps=doppler
irs-rtvi ros1-none /sensor_platform/imu flu /sensor_platform/radar/scan rfu - - x=x y=y z=z snr_db=snr noise_db=noise v_doppler_mps=doppler
brio ros1-none /imu/data_raw flu /radar/cfar_detections rfu /baro/pressure - x=x y=y z=z doppler=doppler snr=snr*10 noise=noise*10
aau ros1-none /mavros/imu/data_raw flu /ti_mmwave/radar_scan_pcl flu - /twins_cns4/vrpn_client/raw_pose x=x y=y z=z =doppler intensity=snr
ekf-rio-tc ros1-none /imu/data flu /ti_mmwave/radar_scan_pcl_0 flu - - x=x y=y z=z intensity=snr velocity=doppler
coloradar ros1-none /gx5/imu/data flu /mmWaveDataHdl/RScan rfu - /lidar_ground_truth x=x y=y z=z intensity=snr range=range doppler=doppler
hkust ros1-none /mavros/imu/data flu /radar_raw_message flu - /pos_vel_mocap/odom_TA azimuth=azimuth azimuthSTD=sigma elevation=elevation elevationSTD=sigma range=range rangeSTD=sigma velocity=doppler velocitySTD=sigma
ntu4dradlm ros1-none /vectornav/imu frd /radar_enhanced_pcl flu - - Doppler=doppler Range=range Power=snr Alpha=azimuth Beta=elevation
msc-rad4r ros1-none /imu/data flu /oculii_radar/point_cloud rdf - - x=x y=y z=z alpha=azimuth beta=elevation power=snr doppler=doppler range=range recoveredSpeed=sigma denoiseFlag=sigma
snail ros1-none /mti3dk/imu flu /ars548 flu - - x=x y=y z=z doppler=doppler intensity=snr range_std=sigma azimuth_std=sigma
mine-and-forest ros1-none /imu/data rfu /hugin_raf_1/radar_data flu - - x=x y=y z=z range=range azimuth=azimuth elevation=elevation power=snr doppler=doppler
orebro mcap-none /imu/data flu /hugin_1/radar_data,/hugin_2/radar_data,/hugin_3/radar_data flu - /icp_odom x=x y=y z=z range=range azimuth=azimuth elevation=elevation power=snr doppler=doppler
ntnu ros1-none /vectornav_driver_node/imu/data flu /radar/cloud flu - - x=x y=y z=z intensity=snr velocity=doppler
)";

std::vector<Miniature> miniatures() {
  std::vector<Miniature> all;
  std::istringstream table(kTable + 1);
  for (std::string line; std::getline(table, line);) {
    std::istringstream row(line);
    Miniature m;
    std::string radars;
    row >> m.name >> m.format >> m.imu >> m.imu_axes >> radars >> m.axes >> m.pressure >> m.truth;
    std::getline(row >> std::ws, m.fields);
    std::istringstream list(radars);
    for (std::string radar; std::getline(list, radar, ',');) m.radars.push_back(radar);
    all.push_back(m);
  }
  return all;
}

/// Forward, left, up in other axes.
Vector3d in_axes(const std::string& axes, const Vector3d& v) {
  Vector3d out;
  for (int i = 0; i < 3; ++i) {
    const char c = axes[static_cast<std::size_t>(i)];
    const double value = c == 'f' || c == 'b' ? v.x() : c == 'l' || c == 'r' ? v.y() : v.z();
    out[i] = c == 'b' || c == 'r' || c == 'd' ? -value : value;
  }
  return out;
}

double quantity(const std::string& name, const std::string& axes, const RadarDetection& d) {
  const Vector3d p = in_axes(axes, d.point_S);
  if (name == "x" || name == "y" || name == "z") return p[name[0] - 'x'];
  if (name == "range") return d.point_S.norm();
  if (name == "azimuth") return std::atan2(d.point_S.y(), d.point_S.x());
  if (name == "elevation") return std::asin(d.point_S.z() / d.point_S.norm());
  if (name == "doppler") return d.range_rate;
  if (name == "snr") return d.snr_db;
  if (name == "sigma") return 0.05;
  return name == "noise" ? d.noise_db : 1.0;
}

/// A sensor_msgs/PointCloud of ROS 1.
std::string old_cloud(Time stamp, const std::vector<CloudField>& channels, const Points& values,
                      const std::vector<Vector3d>& points) {
  Wire wire(Wire::kRos1);
  wire.header(stamp, "radar").put(static_cast<std::uint32_t>(points.size()));
  for (const Vector3d& p : points) {
    for (const double value : p) wire.put(static_cast<float>(value));
  }
  wire.put(static_cast<std::uint32_t>(channels.size()));
  for (std::size_t c = 0; c < channels.size(); ++c) {
    wire.text(channels[c].name).put(static_cast<std::uint32_t>(points.size()));
    for (const auto& row : values) wire.put(static_cast<float>(row[c]));
  }
  return wire.bytes;
}

std::string cloud_of(const Miniature& mini, const RadarScan& scan) {
  std::vector<CloudField> fields;
  std::vector<std::string> quantities;
  std::uint32_t step = 0;
  std::uint32_t hidden = 0;  // its place
  std::istringstream words(mini.fields);
  for (std::string word; words >> word;) {
    const std::size_t equals = word.find('=');
    const bool whole = word.ends_with("*10");
    if (equals == 0) hidden = step;
    if (equals > 0) {
      fields.push_back({word.substr(0, equals), step, static_cast<std::uint8_t>(whole ? 3 : 7)});
      quantities.push_back(word.substr(equals + 1));
    }
    step += whole ? 2 : 4;
  }
  Points rows;
  std::vector<Vector3d> points;
  for (const RadarDetection& d : scan.detections) {
    points.push_back(in_axes(mini.axes, d.point_S));
    std::vector<double>& row = rows.emplace_back();
    for (const std::string& name : quantities) {
      const bool whole = name.ends_with("*10");
      const double value = quantity(whole ? name.substr(0, name.size() - 3) : name, mini.axes, d);
      row.push_back(whole ? std::round(10.0 * value) : value);
    }
  }
  const Wire::Kind kind = mini.wire();
  if (mini.is_old()) return old_cloud(scan.time, fields, rows, points);
  std::string bytes = cloud_message(kind, scan.time, fields, rows, step);
  for (std::size_t i = 0; hidden > 0 && i < scan.detections.size(); ++i) {
    const auto value = static_cast<float>(scan.detections[i].range_rate);
    const std::size_t data = bytes.size() - 1 - scan.detections.size() * step;
    std::memcpy(bytes.data() + data + i * step + hidden, &value, sizeof(value));
  }
  return bytes;
}

std::string pose_message(Wire::Kind kind, const std::string& type, const NavState& state) {
  Wire wire(kind);
  wire.header(state.time, "world");
  const bool odometry = type == "nav_msgs/Odometry";
  if (odometry) wire.text("body");
  for (const double value : state.p_WB) wire.put(value);
  for (const double value : state.q_WB.coeffs()) wire.put(value);
  for (int i = 0; odometry && i < 36 + 6 + 36; ++i) wire.put(0.0);
  return wire.bytes;
}

/// The flight as the data set would have it: received 20 ms after its stamps, with decoys.
std::vector<Written> messages_of(const Miniature& mini, const io::Dataset& data) {
  const Wire::Kind kind = mini.wire();
  const Time delay(20'000'000);
  std::vector<Written> messages;
  const auto add = [&](const std::string& topic, const std::string& type, Time time,
                       const std::string& bytes) {
    if (topic != "-") messages.push_back({topic, type, time + delay, bytes});
  };
  std::size_t scan = 0;
  for (std::size_t i = 0; i < data.imu.size(); ++i) {
    ImuSample sample = data.imu[i];
    for (; scan < data.scans.size() && data.scans[scan].time < sample.time; ++scan) {
      for (const std::string& radar : mini.radars) {
        add(radar, mini.is_old() ? "sensor_msgs/PointCloud" : "sensor_msgs/PointCloud2",
            data.scans[scan].time, cloud_of(mini, data.scans[scan]));
      }
    }
    sample.gyro_B = in_axes(mini.imu_axes, sample.gyro_B);
    sample.accel_B = in_axes(mini.imu_axes, sample.accel_B);
    add(mini.imu, "sensor_msgs/Imu", sample.time, imu_message(kind, sample));
    sample.gyro_B.setConstant(3.0);
    add("/decoy/imu", "sensor_msgs/Imu", sample.time, imu_message(kind, sample));
    if (i % 20 != 0) continue;
    NavState state = data.ground_truth.at(i * (data.ground_truth.size() - 1) / data.imu.size());
    add(mini.truth, mini.truth_type(), state.time, pose_message(kind, mini.truth_type(), state));
    state.p_WB.setConstant(99.0);
    if (mini.truth != "-") {
      add("/decoy/pose", mini.truth_type(), state.time,
          pose_message(kind, mini.truth_type(), state));
    }
    Wire pressure(kind);
    pressure.header(sample.time, "baro").put(1.0e5 + static_cast<double>(i)).put(0.0);
    add(mini.pressure, "sensor_msgs/FluidPressure", sample.time, pressure.bytes);
  }
  return messages;
}

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
    measured("error of " + fs::path(recording).stem().string() + " [m]", error, "below 0.1");
    EXPECT_LT(error, 0.1);
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
  fails(1, "replay " + folder + " --axes flu", {"it is none"});
  rio("convert " + folder + " " + file("asl") + " --sensors " + flight_);
  const io::Dataset asl = io::read_dataset(file("asl"));
  expect_same(asl, put, 1e-5);
  EXPECT_LT((asl.radar_info.T_BS->translation - put.radar_info.T_BS->translation).norm(), 1e-9);
  dir_->write("colo/single_chip/pointclouds/data/radar_pointcloud_3.bin", "damaged");
  fails(1, "check " + folder, {"radar_pointcloud_3.bin: 7 bytes are no points of 20 bytes"});
}

TEST_F(DataSets, AFolderOfHercules) {
  const io::Dataset put = turned(bag::dataset_preset("hercules"));
  std::string imu;
  for (const ImuSample& s : put.imu) {
    imu += std::to_string(s.time.count()) + ",0,0,0,1,0,0,0," + spaced(s.gyro_B, s.accel_B, ',') +
           ",0.1,0.2,0.3\n";
  }
  dir_->write("hercules/sensor_data/xsens_imu.csv", imu);
  for (const RadarScan& scan : put.scans) {
    std::string bytes;
    for (const RadarDetection& d : scan.detections) {
      const Vector3d& p = d.point_S;
      bytes += floats({p.x(), p.y(), p.z(), d.range_rate, p.norm()}) + "\x07" + floats({0.1, 0.2});
    }
    bytes += floats({NAN, 1, 1, 0, 1}) + "\x07" + floats({0.1, 0.2});
    dir_->write("hercules/Radar/Continental/" + std::to_string(scan.time.count()) + ".bin", bytes);
  }
  expect_same(io::read_dataset(file("hercules")), put, 0.0);
  rio("info " + file("hercules"),
      {std::to_string(put.scans.size()) + " points are not finite and are left out"});
  expect_runs(file("hercules"), " --dataset hercules");
}

}  // namespace
}  // namespace rio::test
