// SPDX-License-Identifier: BSD-3-Clause
// Faults of recordings, and what `rio check` is to say of each.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "check/check.hpp"
#include "rio/core/so3.hpp"
#include "rio/io/dataset.hpp"

namespace rio::test {

using check::Finding;
using check::Findings;
using check::Source;
using check::Verdict;

inline constexpr double kHalfTurn = 3.14159265358979323846;

inline Findings check_it(const io::Dataset& dataset, Source source = Source::kBag) {
  Options options;
  io::apply_sensor_info(dataset, &options);
  return check::check_recording(dataset, options, source);
}

inline std::string text_of(const Findings& findings) {
  std::string text;
  for (const Finding& f : findings) {
    text += std::string(to_string(f.verdict)) + " " + f.subject + ": " + f.text + " -> " +
            f.change + "\n";
  }
  return text;
}

inline const Finding* find(const Findings& findings, const std::string& subject) {
  for (const Finding& f : findings) {
    if (f.subject == subject) return &f;
  }
  return nullptr;
}

inline void each_detection(io::Dataset* d, const std::function<void(RadarDetection*)>& change) {
  for (RadarScan& scan : d->scans) {
    for (RadarDetection& detection : scan.detections) change(&detection);
  }
}

inline void turn_mounting(io::Dataset* d, const Vector3d& phi, bool in_body) {
  Quaternion& q = d->radar_info.T_BS->rotation;
  q = in_body ? quaternion_exp(phi) * q : q * quaternion_exp(phi);
}

/// A fault, and what is said of it.
struct Fault {
  const char* name;
  std::function<void(io::Dataset*)> make;
  const char* subject;
  const char* text;    ///< in the sentence
  const char* change;  ///< in what is to be changed
};

inline std::vector<Fault> faults() {
  const double quarter = 0.5 * kHalfTurn;
  return {
      {"DopplerSign",
       [](io::Dataset* d) {
         each_detection(d, [](RadarDetection* r) { r->range_rate = -r->range_rate; });
       },
       "axes and Doppler sign", "the Doppler has the wrong sign", "--approaching"},
      {"MountingTurned90AboutTheBody",
       [=](io::Dataset* d) {
         turn_mounting(d, {0.0, 0.0, quarter}, true);
       },
       "axes and Doppler sign", "turned by 90 deg about the -z axis of the body", "quaternion"},
      {"MountingTurned180AboutTheBody",
       [](io::Dataset* d) {
         turn_mounting(d, {0.0, 0.0, kHalfTurn}, true);
       },
       "axes and Doppler sign", "turned by 180 deg about the z axis of the body", "quaternion"},
      {"MountingUpsideDown",
       [](io::Dataset* d) {
         turn_mounting(d, {kHalfTurn, 0.0, 0.0}, false);
       },
       "axes and Doppler sign", "turned by 180 deg about the x axis of the radar", "quaternion"},
      {"AxesOfTheChip",  // right, forward, up for forward, left, up
       [](io::Dataset* d) {
         each_detection(d, [](RadarDetection* r) {
           const Vector3d p = r->point_S;
           r->point_S = {-p.y(), p.x(), p.z()};
         });
       },
       "axes and Doppler sign", "turned by 90 deg about the -z axis of the radar", "quaternion"},
      {"AxesSwapped",
       [](io::Dataset* d) {
         each_detection(d, [](RadarDetection* r) { std::swap(r->point_S.x(), r->point_S.y()); });
       },
       "axes and Doppler sign", "x and y of the points are swapped", "--axes"},
      {"AxisMirrored",
       [](io::Dataset* d) {
         each_detection(d, [](RadarDetection* r) { r->point_S.y() = -r->point_S.y(); });
       },
       "axes and Doppler sign", "y of the points has the wrong sign", "--axes"},
      {"GyroInDegrees",
       [](io::Dataset* d) {
         for (ImuSample& s : d->imu) s.gyro_B *= 180.0 / kHalfTurn;
       },
       "gyro unit", "deg/s", "--gyro-unit deg/s"},
      {"AccelerometerInG",
       [](io::Dataset* d) {
         for (ImuSample& s : d->imu) s.accel_B /= 9.80665;
       },
       "accelerometer unit", "it is in g", "--accel-unit g"},
      {"AccelerometerInMilliG",
       [](io::Dataset* d) {
         for (ImuSample& s : d->imu) s.accel_B *= 1e3 / 9.80665;
       },
       "accelerometer unit", "it is in mg", "--accel-unit mg"},
      {"DopplerInKilometresPerHour",
       [](io::Dataset* d) { each_detection(d, [](RadarDetection* r) { r->range_rate *= 3.6; }); },
       "Doppler scale", "km/h", "*0.27"},
      {"NoOverlap",
       [](io::Dataset* d) {
         for (RadarScan& scan : d->scans) scan.time += from_seconds(4000.0);
       },
       "clocks", "both for 0.0 s", "--radar-offset"},
      {"RadarAFrameLate",
       [](io::Dataset* d) {
         for (RadarScan& scan : d->scans) scan.time += from_seconds(1.0 / 15.0);
       },
       "delay of the radar", "moved by -", "time_offset: 0.0"},
  };
}

}  // namespace rio::test
