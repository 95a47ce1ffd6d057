// SPDX-License-Identifier: BSD-3-Clause
// Options from the bytes of the fuzzer.
#pragma once

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <type_traits>

#include "fuzz/fuzz.hpp"
#include "rio/core/so3.hpp"
#include "rio/models/aids.hpp"
#include "rio/option_fields.hpp"

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

}  // namespace rio::fuzz
