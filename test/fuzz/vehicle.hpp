// SPDX-License-Identifier: BSD-3-Clause
// Options from the bytes of the fuzzer, and a vehicle to fly with them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <type_traits>
#include <vector>

#include "fuzz/fuzz.hpp"
#include "rio/core/so3.hpp"
#include "rio/models/aids.hpp"
#include "rio/option_fields.hpp"
#include "rio/types.hpp"

namespace rio::fuzz {

/// One field to a value in its range, at its border, or anywhere.
inline void mutate(Input& in, const FieldInfo& info, double* value) {
  const int kind = in.byte();
  if (kind < 16) {
    *value = in.real();
  } else if (kind < 40) {
    *value = info.min;
  } else if (kind < 64) {
    *value = info.max;
  } else if (kind < 160) {
    *value *= std::exp2(in.word() / 8192.0);
  } else {
    *value = info.min + (info.max - info.min) * (in.byte() / 255.0);
  }
}

template <class T>
void mutate_field(Input& in, const FieldInfo& info, T& value) {
  if constexpr (std::is_same_v<T, bool>) {
    value = in.byte() % 2 == 1;
  } else if constexpr (std::is_enum_v<T>) {
    value = static_cast<T>(in.below(static_cast<int>(info.max) + 1));
  } else if constexpr (std::is_same_v<T, Quaternion>) {
    value = quaternion_exp(Vector3d(in.word(), in.word(), in.word()) * 1e-4);
  } else if constexpr (std::is_same_v<T, Vector3d>) {
    mutate(in, info, &value[in.below(3)]);
  } else if constexpr (std::is_same_v<T, int>) {
    double number = value;
    mutate(in, info, &number);
    value = std::abs(number) < 2e9 ? static_cast<int>(number) : std::numeric_limits<int>::max();
  } else {
    mutate(in, info, &value);
  }
}

/// Those of a preset, a few of them changed; valid or not.
inline Options options_of(Input& in) {
  Options o;
  constexpr int kPresetCount = std::size(kPresets);
  const int start = in.byte();
  RIO_FUZZ_CHECK(preset(kPresets[start % kPresetCount], &o));
  if ((start / kPresetCount) % 2 == 1) {
    o.backend = o.backend == BackEnd::kEkf ? BackEnd::kSmoother : BackEnd::kEkf;
  }
  if ((start & 32) != 0) {  // further sensors
    RIO_FUZZ_CHECK(o.other_radars.push_back({{Quaternion(0.0, 0.0, 0.0, 1.0), {-0.1, 0.0, 0.0}}}));
    if ((start & 128) != 0) {  // of another kind
      o.other_radars[0].kind = o.radar;
      o.other_radars[0].kind->max_doppler = 6.0;
    }
    RIO_FUZZ_CHECK(o.auxiliary.declare<HeightOffset>());
    o.timing.aiding_delay = (start & 64) != 0 ? 0.3 : 0.0;
  }
  for (int n = in.byte() % 8; n > 0; --n) {
    int index = in.byte();
    visit_fields(o, [&](const FieldInfo& info, auto& value) {
      if (index-- == 0) mutate_field(in, info, value);
    });
  }
  // memory and time, not correctness
  o.timing.imu_buffer = std::min(o.timing.imu_buffer, 4096);
  o.timing.scan_queue = std::min(o.timing.scan_queue, 16);
  return o;
}

/// With IMU and radar whose data are right to a millimetre and cost nothing: it stands for 1.6 s,
/// then swings about, level, amid a cloud of reflectors.
class Vehicle {
 public:
  /// Where the radar sits, and gravity, as `options` say.
  explicit Vehicle(const Options& options)
      : T_BS_(options.radar.T_BS), gravity_(options.imu.gravity) {
    for (Vector3d& point : reflectors_W_) point = 6.0 * Vector3d(noise(), noise(), 0.4 * noise());
  }

  /// True state `t` seconds after the start, without a stamp.
  NavState state(double t) const {
    NavState x;
    const double s = std::fmax(0.0, t - kStand);
    x.q_WB = quaternion_exp(Vector3d(0.0, 0.0, 0.6 * (1.0 - std::cos(0.4 * s))));
    x.p_WB = {2.0 * (1.0 - std::cos(0.5 * s)), 1.0 - std::cos(0.7 * s),
              0.3 * (1.0 - std::cos(0.9 * s))};
    x.v_WB = {std::sin(0.5 * s), 0.7 * std::sin(0.7 * s), 0.27 * std::sin(0.9 * s)};
    return x;
  }

  ImuSample imu(double t) {
    const double s = std::fmax(0.0, t - kStand);
    const double go = t > kStand ? 1.0 : 0.0;
    const Vector3d a_W(go * 0.5 * std::cos(0.5 * s), go * 0.49 * std::cos(0.7 * s),
                       go * 0.243 * std::cos(0.9 * s) + gravity_);
    ImuSample sample;
    sample.gyro_B = Vector3d(0.0, 0.0, 0.24 * std::sin(0.4 * s)) + 1e-3 * noise3();
    sample.accel_B = state(t).q_WB.conjugate() * a_W + 1e-2 * noise3();
    return sample;
  }

  /// @param v_error added to the velocity the Doppler tells [m/s]
  RadarScan scan(double t, const Vector3d& v_error) {
    const NavState x = state(t);
    const double rate = 0.24 * std::sin(0.4 * std::fmax(0.0, t - kStand));
    const Vector3d lever_B = Vector3d(0.0, 0.0, rate).cross(T_BS_.translation);
    const Quaternion R_SB = T_BS_.rotation.conjugate();
    const Vector3d v_S = R_SB * (x.q_WB.conjugate() * (x.v_WB + v_error) + lever_B);
    RadarScan scan;
    for (const Vector3d& point_W : reflectors_W_) {
      const Vector3d point_B = x.q_WB.conjugate() * (point_W - x.p_WB);
      const Vector3d point_S = R_SB * (point_B - T_BS_.translation);
      if (point_S.x() < 0.3) continue;
      scan.detections.push_back({point_S + 0.01 * noise3(),
                                 -point_S.normalized().dot(v_S) + 0.01 * noise(),
                                 20.0 + 4.0 * noise()});
    }
    return scan;
  }

 private:
  static constexpr double kStand = 1.6;  // [s]
  static constexpr int kReflectors = 28;

  /// In [-1, 1).
  double noise() {
    random_ = random_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(random_ >> 11U) * 0x1p-52 - 1.0;
  }
  Vector3d noise3() {
    const double x = noise();
    const double y = noise();
    return {x, y, noise()};
  }

  Pose T_BS_;
  double gravity_;
  std::uint64_t random_ = 1;
  std::vector<Vector3d> reflectors_W_ = std::vector<Vector3d>(kReflectors);
};

}  // namespace rio::fuzz
