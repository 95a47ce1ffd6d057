// SPDX-License-Identifier: BSD-3-Clause
// A short flight as each public data set would hold it, by what its sources tell.
#pragma once

#include <cmath>
#include <cstddef>
#include <sstream>
#include <string>
#include <vector>

#include "bag/bag_writer.hpp"
#include "rio/io/dataset.hpp"

namespace rio::test {

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
inline constexpr const char* kTable = R"(
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

inline std::vector<Miniature> miniatures() {
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
inline Vector3d in_axes(const std::string& axes, const Vector3d& v) {
  Vector3d out;
  for (int i = 0; i < 3; ++i) {
    const char c = axes[static_cast<std::size_t>(i)];
    const double value = c == 'f' || c == 'b' ? v.x() : c == 'l' || c == 'r' ? v.y() : v.z();
    out[i] = c == 'b' || c == 'r' || c == 'd' ? -value : value;
  }
  return out;
}

inline double quantity(const std::string& name, const std::string& axes, const RadarDetection& d) {
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
inline std::string old_cloud(Time stamp, const std::vector<CloudField>& channels,
                             const Points& values, const std::vector<Vector3d>& points) {
  Wire wire(Wire::kRos1);
  wire.header(stamp, "radar").put(static_cast<std::uint32_t>(points.size()));
  for (const Vector3d& p : points) wire.all(Eigen::Vector3f(p.cast<float>()));
  wire.put(static_cast<std::uint32_t>(channels.size()));
  for (std::size_t c = 0; c < channels.size(); ++c) {
    wire.text(channels[c].name).put(static_cast<std::uint32_t>(points.size()));
    for (const auto& row : values) wire.put(static_cast<float>(row[c]));
  }
  return wire.bytes;
}

inline std::string cloud_of(const Miniature& mini, const RadarScan& scan) {
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

inline std::string pose_message(Wire::Kind kind, const std::string& type, const NavState& state) {
  Wire wire(kind);
  wire.header(state.time, "world");
  const bool odometry = type == "nav_msgs/Odometry";
  if (odometry) wire.text("body");
  wire.all(state.p_WB).all(state.q_WB.coeffs());
  if (odometry) wire.repeat(36 + 6 + 36, 0.0);
  return wire.bytes;
}

/// The flight as the data set would have it: received 20 ms after its stamps, with decoys.
inline std::vector<Written> messages_of(const Miniature& mini, const io::Dataset& data) {
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
    add(mini.pressure, "sensor_msgs/FluidPressure", sample.time,
        pressure_message(kind, sample.time, 1.0e5 + static_cast<double>(i)));
  }
  return messages;
}

}  // namespace rio::test
