// SPDX-License-Identifier: BSD-3-Clause
#include "check/faults.hpp"

#include <string>
#include <utility>

#include "rio/core/so3.hpp"

namespace rio::check {

namespace {

MakeFault turned(const Vector3d& phi, bool in_body) {
  return [=](io::Dataset* d) { turn_mounting(d, phi, in_body); };
}
MakeFault late(double seconds) {
  return [=](io::Dataset* d) { delay_scans(d, seconds); };
}

std::vector<Fault> make_faults() {
  const double quarter = 0.5 * kHalfTurn;
  return {
      {"DopplerSign", "Doppler of the other sign",
       of_detections([](RadarDetection& r) { r.range_rate = -r.range_rate; }),
       "axes and Doppler sign", "the Doppler has the wrong sign", "--approaching",
       "Doppler by the ranges"},
      {"MountingTurned90AboutTheBody", "mounting turned by 90 deg about the vertical",
       turned({0.0, 0.0, quarter}, true), "axes and Doppler sign",
       "turned by 90 deg about the -z axis of the body", "quaternion"},
      {"MountingTurned180AboutTheBody", "mounting turned by 180 deg about the vertical",
       turned({0.0, 0.0, kHalfTurn}, true), "axes and Doppler sign",
       "turned by 180 deg about the z axis of the body", "quaternion"},
      {"MountingUpsideDown", "radar upside down", turned({kHalfTurn, 0.0, 0.0}, false),
       "axes and Doppler sign", "turned by 180 deg about the x axis of the radar", "quaternion"},
      {"AxesOfTheChip",
       "points in the axes of the chip",  // right, forward, up for forward, left, up
       of_detections([](RadarDetection& r) {
         const Vector3d p = r.point_S;
         r.point_S = {-p.y(), p.x(), p.z()};
       }),
       "axes and Doppler sign", "turned by 90 deg about the -z axis of the radar", "quaternion"},
      {"AxesSwapped", "x and y of the points swapped",
       of_detections([](RadarDetection& r) { std::swap(r.point_S.x(), r.point_S.y()); }),
       "axes and Doppler sign", "x and y of the points are swapped", "--axes"},
      {"AxisMirrored", "y of the points mirrored",
       of_detections([](RadarDetection& r) { r.point_S.y() = -r.point_S.y(); }),
       "axes and Doppler sign", "y of the points has the wrong sign", "--axes"},
      {"PointsInMillimetres", "points in mm",
       of_detections([](RadarDetection& r) { r.point_S *= 1e3; }), "distances", "not in metres",
       "--field x=NAME*0.001"},
      {"PointsInCentimetres", "points in cm",
       of_detections([](RadarDetection& r) { r.point_S *= 1e2; }), "distances", "not in metres",
       "--field x=NAME*0.01, y and z alike"},
      {"GyroInDegrees", "gyro in deg/s",
       of_samples([](ImuSample& s) { s.gyro_B *= 180.0 / kHalfTurn; }), "gyro unit", "deg/s",
       "--gyro-unit deg/s", "gyro unit by the points"},
      {"AccelerometerInG", "accelerometer in g",
       of_samples([](ImuSample& s) { s.accel_B /= 9.80665; }), "accelerometer unit", "it is in g",
       "--accel-unit g"},
      {"AccelerometerInMilliG", "accelerometer in mg",
       of_samples([](ImuSample& s) { s.accel_B *= 1e3 / 9.80665; }), "accelerometer unit",
       "it is in mg", "--accel-unit mg"},
      {"DopplerInKilometresPerHour", "Doppler in km/h",
       of_detections([](RadarDetection& r) { r.range_rate *= 3.6; }), "Doppler scale", "km/h",
       "*0.27", "Doppler by the ranges"},
      {"ImuInForwardRightDown", "IMU in forward, right, down",
       in_axes([](const Vector3d& v) { return Vector3d(v.x(), -v.y(), -v.z()); }),
       "axes and Doppler sign", "the IMU is in frd", "--imu-axes frd"},
      {"ImuColumnsSwapped", "x and y of the IMU swapped",
       in_axes([](const Vector3d& v) { return Vector3d(v.y(), v.x(), v.z()); }), "axes of the IMU",
       "x and y of the IMU are swapped", "x and y of the IMU are swapped"},
      {"AccelerometerFirst", "accelerometer before the gyro",
       of_samples([](ImuSample& s) { std::swap(s.gyro_B, s.accel_B); }), "accelerometer unit",
       "gyro and accelerometer are exchanged", "exchange"},
      {"DopplerAndSnrSwapped", "Doppler and SNR swapped",
       of_detections([](RadarDetection& r) { std::swap(r.range_rate, r.snr_db); }), "Doppler",
       "the SNR is: the two are exchanged", "doppler="},
      {"NoOverlap", "radar on another clock", late(4000.0), "clocks", "both for 0.0 s",
       "--radar-offset"},
      {"RadarAFrameLate", "scans 67 ms late, a frame at 15 Hz", late(1.0 / 15.0),
       "delay of the radar", "moved by -", "time_offset: 0.0"},
      {"RadarSecondsLate", "scans 1.5 s late", late(1.5), "delay of the radar", "moved by -1.",
       "--radar-offset"},
  };
}

}  // namespace

void turn_mounting(io::Dataset* dataset, const Vector3d& phi, bool in_body) {
  Quaternion& q = dataset->radar_info.T_BS->rotation;
  q = in_body ? quaternion_exp(phi) * q : q * quaternion_exp(phi);
}

const std::vector<Fault>& faults() {
  static const std::vector<Fault> all = make_faults();
  return all;
}

const Finding* naming(const Findings& findings, const Fault& fault) {
  for (const Finding& f : findings) {
    const bool says = f.text.find(fault.text) != std::string::npos &&
                      f.change.find(fault.change) != std::string::npos;
    const bool subject = f.subject == fault.subject || f.subject == fault.also;
    if (subject && f.verdict != Verdict::kOk && says) return &f;
  }
  return nullptr;
}

}  // namespace rio::check
